#pragma once

#include <string>
#include <string_view>

#include "graspd/keys/key_files.hpp"

namespace graspd::keys {

inline constexpr std::size_t kKeyCharacters_n = 40;

/// Whether this is 32 bytes in Z85.
bool is_key(std::string_view text);

/// A .pub file, and a line of an allow-list.
std::string public_line(const PublicKey& key);

}  // namespace graspd::keys

#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "graspd/types/result.hpp"

namespace graspd::keys {

struct TextFile {
  std::string text;
  mode_t mode = 0;
};

/// A regular file of at most a megabyte, with the mode it had when it was read.
Result<TextFile> read_text(const std::filesystem::path& path);

/// \returns INVALID_ARGUMENT where the file is there already.
Result<void> create_file(const std::filesystem::path& path, std::string_view text, mode_t mode);

/// Replaces a file as one step: whoever reads it sees all of the old text or all of the new.
Result<void> replace_file(const std::filesystem::path& path, std::string_view text, mode_t mode);

std::vector<std::string> lines_of(std::string_view text);
std::vector<std::string> words_of(std::string_view line);
/// Blank, or a comment.
bool says_nothing(std::string_view line);

}  // namespace graspd::keys

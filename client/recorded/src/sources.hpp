#pragma once

#include "graspd/codec/codec.hpp"
#include "graspd/recorded/questions.hpp"

namespace graspd::recorded {

inline codec::Bytes bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

Result<std::unique_ptr<Questions>> open_rawlog(const std::filesystem::path& path,
                                               std::optional<AskWith> ask_with);
Result<std::unique_ptr<Questions>> open_flights(const std::filesystem::path& path);

}  // namespace graspd::recorded

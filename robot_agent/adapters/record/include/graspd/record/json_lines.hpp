#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

#include "graspd/types/result.hpp"

/// What happened, as files with one JSON object a line. Lengths are metres, poses 16 numbers row by
/// row, durations milliseconds.
namespace graspd::record {

/// A file that grows line by line; each line is on the disk when `add` returns.
class JsonLines {
 public:
  /// An older file of this name is replaced; its folder is made where it is missing.
  /// \returns INVALID_ARGUMENT where the file can't be made.
  static Result<JsonLines> create(const std::filesystem::path& path);

  /// \returns INTERNAL where the disk takes no more.
  Result<void> add(std::string_view json);

 private:
  explicit JsonLines(std::filesystem::path path) : path_(std::move(path)), file_(path_) {}

  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace graspd::record

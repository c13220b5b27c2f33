#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "graspd/types/answer.hpp"
#include "graspd/types/result.hpp"

namespace graspd::recorded {

/// What was answered to one question.
struct Answered {
  std::string name;               ///< the question's
  std::uint32_t depth_crc32 = 0;  ///< of the depth image: which frame it was
  Result<PlanAnswer> answer;
};

/// The answers to a recording, as a file of JSON lines.
class AnswersWriter {
 public:
  /// \returns INVALID_ARGUMENT where the file can't be made.
  static Result<AnswersWriter> create(const std::filesystem::path& path);
  /// The line is in the file when this returns.
  /// \returns INTERNAL where the disk takes no more.
  Result<void> add(const Answered& answered);

 private:
  explicit AnswersWriter(std::filesystem::path path) : path_(std::move(path)), file_(path_) {}

  std::filesystem::path path_;
  std::ofstream file_;
};

/// Reads what `AnswersWriter` wrote, line by line.
class AnswersReader {
 public:
  /// \returns INVALID_ARGUMENT where there is no such file.
  static Result<AnswersReader> open(const std::filesystem::path& path);
  /// Nothing after the last one.
  /// \returns INVALID_ARGUMENT with file and line for what `AnswersWriter` did not write.
  Result<std::optional<Answered>> next();

 private:
  explicit AnswersReader(std::filesystem::path path) : path_(std::move(path)), file_(path_) {}

  std::filesystem::path path_;
  std::ifstream file_;
  std::size_t line_n_ = 0;
};

}  // namespace graspd::recorded

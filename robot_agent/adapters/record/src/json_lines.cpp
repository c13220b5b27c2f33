#include "graspd/record/json_lines.hpp"

namespace graspd::record {

Result<JsonLines> JsonLines::create(const std::filesystem::path& path) {
  std::error_code error;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
  JsonLines lines(path);
  if (!lines.file_) {
    return invalid("{}: can't be written; may you write into this folder?", path.string());
  }
  return lines;
}

Result<void> JsonLines::add(std::string_view json) {
  file_ << json << '\n' << std::flush;
  if (!file_) {
    return fail(Code::kInternal, "{}: can't be written; is the disk full?", path_.string());
  }
  return {};
}

}  // namespace graspd::record

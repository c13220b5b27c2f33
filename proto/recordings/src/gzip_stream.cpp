#include "gzip_stream.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace graspd {
namespace {

// As MRPT: level 1, since depth images are recorded while a cell works.
constexpr char kWriteMode[] = "wb1";

unsigned clamp_to_unsigned(size_t count) {
  return static_cast<unsigned>(std::min<size_t>(count, std::numeric_limits<int>::max()));
}

}  // namespace

GzipStream::GzipStream(const std::filesystem::path& path, Mode mode)
    : path_(path), file_(gzopen(path.c_str(), mode == Mode::kRead ? "rb" : kWriteMode)) {}

bool GzipStream::flush() {
  if (gzflush(file_, Z_SYNC_FLUSH) != Z_OK) good_ = false;
  return good_;
}

bool GzipStream::close() {
  if (file_ == nullptr) return good_;
  if (gzclose(file_) != Z_OK) good_ = false;
  file_ = nullptr;
  return good_;
}

size_t GzipStream::Read(void* buffer, size_t count) {
  const int read_n = gzread(file_, buffer, clamp_to_unsigned(count));
  int code = Z_OK;
  gzerror(file_, &code);  // a file cut short is Z_BUF_ERROR, with a count that is no error
  if (read_n < 0 || code != Z_OK) good_ = false;
  return static_cast<size_t>(std::max(read_n, 0));
}

size_t GzipStream::Write(const void* buffer, size_t count) {
  const int written_n = gzwrite(file_, buffer, clamp_to_unsigned(count));
  if (written_n < 0 || static_cast<size_t>(written_n) != count) good_ = false;
  return static_cast<size_t>(std::max(written_n, 0));
}

uint64_t GzipStream::Seek(int64_t, TSeekOrigin) {
  throw std::logic_error("a gzip stream has no other place than its next byte");
}

uint64_t GzipStream::getTotalBytesCount() const {
  std::error_code error;
  const auto size = std::filesystem::file_size(path_, error);
  return error ? 0 : size;
}

uint64_t GzipStream::getPosition() const {
  return file_ == nullptr ? 0 : static_cast<uint64_t>(gzoffset(file_));
}

}  // namespace graspd

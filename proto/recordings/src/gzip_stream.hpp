#pragma once

#include <mrpt/io/CStream.h>
#include <zlib.h>

#include <filesystem>

namespace graspd {

/// A gzip file as an MRPT stream. MRPT's own one takes a damaged or cut file for one that has
/// ended, and can't say whether the last bytes were written.
class GzipStream : public mrpt::io::CStream {
 public:
  enum class Mode { kRead, kWrite };

  GzipStream(const std::filesystem::path& path, Mode mode);
  ~GzipStream() override { close(); }
  GzipStream(const GzipStream&) = delete;
  GzipStream& operator=(const GzipStream&) = delete;

  bool is_open() const { return file_ != nullptr; }
  /// All is well so far: what has been read was as it was written, and what ended had an end.
  bool good() const { return good_; }
  /// What has been written so far can be read, whatever becomes of this process.
  /// \returns whether it has reached the file.
  bool flush();
  /// \returns whether all bytes have reached the file.
  bool close();

  size_t Read(void* buffer, size_t count) override;
  size_t Write(const void* buffer, size_t count) override;
  uint64_t Seek(int64_t, TSeekOrigin) override;
  /// Compressed bytes.
  uint64_t getTotalBytesCount() const override;
  uint64_t getPosition() const override;
  std::string getStreamDescription() const override { return path_.string(); }

 private:
  std::filesystem::path path_;
  gzFile file_ = nullptr;
  bool good_ = true;
};

}  // namespace graspd

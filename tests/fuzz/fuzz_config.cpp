#include <sys/mman.h>
#include <unistd.h>

#include "check.hpp"
#include "graspd/formats/cell.hpp"
#include "graspd/parts/part.hpp"
#include "graspd/service/config.hpp"

// Every kind of YAML file that graspd reads: of a server, a cell, a camera, a part. What is refused
// has a sentence that names the file, and a server's configuration is written as it is read.
namespace graspd::fuzz {
namespace {

/// A file in memory, the same one each time.
class File {
 public:
  const std::string& write(const void* data, std::size_t size) {
    check(ftruncate(descriptor_, 0) == 0, "the file is emptied");
    check(pwrite(descriptor_, data, size, 0) == static_cast<ssize_t>(size), "the file is written");
    return path_;
  }

 private:
  int descriptor_ = memfd_create("config", MFD_CLOEXEC);
  std::string path_ = "/proc/self/fd/" + std::to_string(descriptor_);
};

template <class T>
bool is_read(const Result<T>& result, const std::string& path) {
  if (result) return true;
  check(result.error().code == Code::kInvalidArgument, "a fault of a file is INVALID_ARGUMENT");
  check(result.error().message.find(path) == 0, "a fault names its file");
  return false;
}

}  // namespace
}  // namespace graspd::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace graspd;
  static fuzz::File file;
  const std::string& path = file.write(data, size);
  fuzz::is_read(read_cell(path), path);
  fuzz::is_read(read_camera(path), path);
  fuzz::is_read(parts::read_part_file(path), path);
  const auto config = service::read_config(path);
  if (!fuzz::is_read(config, path)) return 0;
  (void)service::validate(*config);
  const std::string written = service::to_yaml(*config);
  file.write(written.data(), written.size());
  const auto again = service::read_config(path);
  fuzz::check(again.has_value(), "what is written can be read");
  fuzz::check(service::to_yaml(*again) == written, "and says the same");
  return 0;
}

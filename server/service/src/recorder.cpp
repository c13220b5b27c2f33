#include "recorder.hpp"

#include <algorithm>
#include <fstream>
#include <vector>

namespace graspd::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRequest = ".request";
constexpr const char* kDepth = ".depth";

void write(const fs::path& path, const zmq::message_t& frame) {
  std::ofstream file(path, std::ios::binary);
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  file.write(static_cast<const char*>(frame.data()), static_cast<std::streamsize>(frame.size()));
  file.flush();
  if (!file) throw fs::filesystem_error("no room", path, std::make_error_code(std::errc::io_error));
}

void remove_oldest(const fs::path& folder, std::size_t most_n) {
  std::vector<std::pair<fs::file_time_type, fs::path>> requests;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != kRequest) continue;
    requests.emplace_back(entry.last_write_time(), entry.path());
  }
  if (requests.size() <= most_n) return;
  std::sort(requests.begin(), requests.end());
  for (std::size_t i = 0; i + most_n < requests.size(); ++i) {
    fs::path path = requests[i].second;
    fs::remove(path);
    fs::remove(path.replace_extension(kDepth));
  }
}

}  // namespace

Result<fs::path> Recorder::keep(const RequestId& id, const zmq::message_t& envelope,
                                const zmq::message_t& payload) const {
  fs::path request = folder_ / (hexadecimal(id) + kRequest);
  fs::path depth = request;
  depth.replace_extension(kDepth);
  try {
    if (fs::create_directories(folder_)) fs::permissions(folder_, fs::perms::owner_all);
    remove_oldest(folder_, kMost_n - 1);
    write(depth, payload);
    write(request, envelope);
    return request;
  } catch (const fs::filesystem_error& error) {
    std::error_code ignored;
    fs::remove(depth, ignored);
    return fail(Code::kInternal, "record_failed: {} could not be kept: {}; check the folder",
                request.string(), error.code().message());
  }
}

}  // namespace graspd::service

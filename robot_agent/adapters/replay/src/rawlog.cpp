#include "graspd/recordings/rawlog.hpp"

#include "recording.hpp"

namespace graspd::replay {
namespace {

class RawlogCamera final : public agent::Camera {
 public:
  explicit RawlogCamera(RawlogReader reader) : reader_(std::move(reader)) {}
  Result<std::optional<DepthFrame>> next() override {
    auto recorded = reader_.next();
    if (!recorded) return tl::unexpected(recorded.error());
    if (!*recorded) return std::nullopt;
    return std::move((*recorded)->frame);
  }

 private:
  RawlogReader reader_;
};

}  // namespace

Result<std::unique_ptr<agent::Camera>> open_rawlog(const std::filesystem::path& path) {
  auto reader = RawlogReader::open(path);
  if (!reader) return tl::unexpected(reader.error());
  return std::make_unique<RawlogCamera>(*std::move(reader));
}

}  // namespace graspd::replay

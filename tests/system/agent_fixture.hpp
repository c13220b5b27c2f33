#pragma once

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "graspd/formats/bop.hpp"
#include "graspd/recordings/rawlog.hpp"
#include "serve_process.hpp"
#include "serve_scene.hpp"

/// The real agent, at a real server, replaying recordings of bars on a floor.
namespace graspd::testing {

using nlohmann::json;

inline const Eigen::Vector3d kStick_m(0.1, 0.03, 0.02);

/// The reference file with every key that it comments out.
inline std::string with_every_key(const std::filesystem::path& reference) {
  std::string text;
  std::ifstream stream(reference);
  for (std::string line; std::getline(stream, line);) {
    const bool is_key = line.size() > 2 && line[0] == '#' && (line[1] != ' ' || line[2] == ' ');
    text += (is_key && line.find(':') != std::string::npos ? line.substr(1) : line) + "\n";
  }
  return text;
}

class AgentTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_ = new Shared;
    write_box_part(shared_->folder, "bar", 1, kBar_m * 1000);
    write_box_part(shared_->folder, "stick", 2, kStick_m * 1000);
    shared_->server = std::make_unique<ServeProcess>(
        std::vector<std::string>{"--parts", shared_->folder.path() / "parts", "--workers", "1"});
    ASSERT_TRUE(shared_->server->wait_ready());
  }
  static void TearDownTestSuite() {
    delete shared_;
    shared_ = nullptr;
  }

  /// A bar apart from the two others: the one to be picked first.
  static std::vector<Block> three_bars() {
    return {bar_at(-0.12, -0.07, 0.4, kBar_m), bar_at(0.08, 0.0, -0.3, kBar_m),
            bar_at(0.1, 0.08, 0.9, kBar_m)};
  }
  static DepthFrame frame_of(const std::vector<Block>& blocks,
                             const CameraIntrinsics& camera = kinect_v2()) {
    return render(camera, kHeight_m, blocks);
  }

  std::filesystem::path write_bop(const std::vector<DepthFrame>& frames) {
    BopSceneWriter scene(folder.path() / "scene");
    for (std::size_t i = 0; i < frames.size(); ++i) {
      BopImage image;
      image.im_id = static_cast<int>(i);
      image.frame = frames[i];
      image.bin = BopBin{T_base_camera_above(kHeight_m).inverse(), {0.4, 0.3, 0.15}};
      EXPECT_TRUE(scene.add(image));
    }
    EXPECT_TRUE(scene.finish());
    return folder.path() / "scene";
  }
  std::filesystem::path write_rawlog(const std::vector<DepthFrame>& frames) {
    const auto path = folder.path() / "frames.rawlog";
    auto rawlog = RawlogWriter::create(path);
    for (const DepthFrame& frame : frames) EXPECT_TRUE(rawlog->add(frame, 1e9));
    return path;
  }

  /// \param more lines of the configuration
  std::filesystem::path write_config(const std::string& kind,
                                     const std::filesystem::path& recording,
                                     const std::string& part, const std::string& more = "") {
    return folder.write(
        kind + "_cell.yaml",
        fmt::format("cell: {0}\nservers: ['{1}']\nparts: [{{id: {2}}}]\nbudget_ms: 20000\n"
                    "camera: {{kind: {0}, path: {3}}}\narm: {{path: {0}_arm.jsonl}}\n"
                    "records: {0}_records\noverlays: {0}_overlays\n"
                    "T_base_place: [1, 0, 0, 0.4, 0, -1, 0, 0, 0, 0, -1, 0.1, 0, 0, 0, 1]\n{4}",
                    kind, shared_->server->data_endpoint, part, recording.string(), more));
  }
  Finished agent(const std::filesystem::path& config, const std::string& more = "") const {
    return run(fmt::format("{} run --config {} --out {} {}", ROBOT_AGENT, config.string(),
                           folder.path().string(), more));
  }
  std::vector<json> lines(const std::filesystem::path& file) const {
    std::vector<json> lines;
    std::ifstream stream(folder.path() / file);
    for (std::string line; std::getline(stream, line);) lines.push_back(json::parse(line));
    return lines;
  }
  /// The folder of the cell's only run.
  std::filesystem::path run_folder(const std::string& cell) const {
    const std::filesystem::directory_iterator runs(folder.path() / (cell + "_records"));
    return runs->path();
  }
  std::vector<json> picks(const std::string& cell) const {
    return lines(relative(run_folder(cell), folder.path()) / "picks.jsonl");
  }
  static std::vector<std::string> all(const std::vector<json>& lines, const std::string& key) {
    std::vector<std::string> values;
    for (const json& line : lines) values.push_back(line.value(key, "-"));
    return values;
  }

  TemporaryFolder folder;
  struct Shared {
    TemporaryFolder folder;
    std::unique_ptr<ServeProcess> server;
  };
  static inline Shared* shared_ = nullptr;
};

}  // namespace graspd::testing

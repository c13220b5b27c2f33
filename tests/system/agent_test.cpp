#include <future>
#include <random>

#include "agent_fixture.hpp"
#include "graspd/keys/allow_list.hpp"
#include "graspd/keys/key_files.hpp"

namespace graspd::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST_F(AgentTest, PicksUntilTheBinIsEmpty) {
  const auto bars = three_bars();
  const auto scene = write_bop({frame_of(bars), frame_of({bars[1], bars[2]}), frame_of({})});
  const Finished finished = agent(write_config("bop", scene, "bar"));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("done, 2 parts placed: BIN_EMPTY"));

  const std::vector<json> frames = picks("bop");
  // What is left has not moved: the server did not register it again.
  EXPECT_THAT(all(frames, "outcome"), ElementsAre("PLANNED", "UNCHANGED", "BIN_EMPTY"));
  EXPECT_THAT(all(frames, "verdict"), ElementsAre("PLACED", "PLACED", "-"));
  const json& first = frames.at(0).at("grasp");
  EXPECT_EQ(first.at("part"), "bar");
  EXPECT_NEAR(first.at("T_base_grasp").at(3).get<double>(), -0.12, 0.02) << "its x";
  EXPECT_NEAR(first.at("T_base_grasp").at(7).get<double>(), 0.07, 0.02) << "and y";
  EXPECT_GT(first.at("opening_width_m").get<double>(), kBar_m.y());

  const std::vector<json> orders = lines("bop_arm.jsonl");
  EXPECT_EQ(orders.at(0).at("bin").at("inner_size_m").at(0), 0.4);
  const auto steps = all(orders, "step");
  EXPECT_EQ(std::count(steps.begin(), steps.end(), "close"), 2);
  EXPECT_EQ(steps.back(), "out_of_view");
  for (const char* picture : {"000000.png", "000001.png", "000002.png"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "bop_overlays" / picture)) << picture;
  }
}

TEST_F(AgentTest, AsksInItsCellsNameUnderItsKey) {
  const keys::KeyPair own = keys::make_key_pair("bop");
  ASSERT_TRUE(keys::write_key_pair(keys::make_key_pair("server"), folder.path()));
  ASSERT_TRUE(keys::write_key_pair(own, folder.path()));
  ASSERT_TRUE(keys::write_key_pair(keys::make_key_pair("other"), folder.path()));
  ASSERT_TRUE(keys::allow(folder.path() / "allowed_cells", {own.cell, own.public_key}));
  ServeProcess server({"--parts", shared_->folder.path() / "parts", "--workers", "1", "--key",
                       folder.path() / "server.key", "--allowed-cells",
                       folder.path() / "allowed_cells"});
  ASSERT_TRUE(server.wait_ready());
  const auto scene = write_bop({frame_of({})});
  const auto config = [&](const std::string& keys) {
    return write_config("bop", scene, "bar", keys);
  };
  const std::string there = "--server " + server.data_endpoint;
  const Finished served = agent(config("server_key: server.pub\nkey_file: bop.key\n"), there);
  EXPECT_EQ(served.exit_code, 0) << served.output;
  EXPECT_THAT(served.output, HasSubstr("BIN_EMPTY"));
  const Finished other = agent(config("server_key: server.pub\nkey_file: other.key\n"), there);
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output,
              HasSubstr("key_file: holds the key of 'other', but this cell is 'bop'"));
  const Finished half = agent(config("key_file: bop.key\n"), there);
  EXPECT_EQ(half.exit_code, 2);
  EXPECT_THAT(half.output, HasSubstr("server_key"));
}

TEST_F(AgentTest, TwoCellsWithDifferentCamerasAndPartsAtTheSameTime) {
  const CameraIntrinsics other{640, 480, 525, 525, 319.5, 239.5, {}};
  const auto scene = write_bop({frame_of(three_bars())});
  const auto rawlog = write_rawlog({frame_of({bar_at(0.08, -0.05, 0.7, kStick_m)}, other)});
  const auto bars = write_config("bop", scene, "bar");
  const auto sticks =
      write_config("rawlog", rawlog, "stick",
                   "T_base_camera: [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0.75, 0, 0, 0, 1]\n"
                   "bin: {T_base_bin: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],\n"
                   "      inner_size_m: [0.4, 0.3, 0.15]}\n");
  auto first = std::async(std::launch::async, [&] { return agent(bars); });
  auto second = std::async(std::launch::async, [&] { return agent(sticks); });
  for (auto* running : {&first, &second}) {
    const Finished finished = running->get();
    EXPECT_EQ(finished.exit_code, 0) << finished.output;
    EXPECT_THAT(finished.output, HasSubstr("no more frames after 1"));
  }
  EXPECT_EQ(picks("bop").at(0).at("grasp").at("part"), "bar");
  const json stick = picks("rawlog").at(0);
  EXPECT_EQ(stick.at("objects"), 1);
  EXPECT_EQ(stick.at("grasp").at("part"), "stick");
  EXPECT_NEAR(stick.at("grasp").at("T_base_grasp").at(7).get<double>(), 0.05, 0.02);
}

TEST_F(AgentTest, ABadFrameIsSkippedAndNamed) {
  DepthFrame covered = frame_of({});
  std::fill(covered.depth.begin(), covered.depth.end(), std::uint16_t{0});
  const auto scene = write_bop({covered, frame_of(three_bars())});
  const Finished finished = agent(write_config("bop", scene, "bar", "retries: {pause_s: 0.01}\n"));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("check the camera and its cover"));
  EXPECT_THAT(all(picks("bop"), "code"), ElementsAre("INVALID_ARGUMENT", "OK"));
}

TEST_F(AgentTest, ATruncatedRawlogGivesItsWholeFramesAndThenSaysWhereItBroke) {
  // Noise, so that the compressed frames are of one length, and the cut hits the second.
  DepthFrame frame = frame_of(three_bars());
  std::minstd_rand noise(1);
  for (std::uint16_t& z : frame.depth) z = static_cast<std::uint16_t>(z + noise() % 2);
  const auto rawlog = write_rawlog({frame, frame});
  std::filesystem::resize_file(rawlog, std::filesystem::file_size(rawlog) * 3 / 4);
  const Finished finished = agent(write_config("rawlog", rawlog, "bar"));
  EXPECT_EQ(finished.exit_code, 1) << finished.output;
  EXPECT_THAT(finished.output,
              AllOf(HasSubstr(rawlog.string()), HasSubstr("broken after 1 frames")));
  EXPECT_THAT(picks("rawlog"), SizeIs(1));
}

TEST_F(AgentTest, AServerThatIsNotThereIsNamed) {
  const auto scene = write_bop({frame_of({}), frame_of({})});
  const auto config =
      write_config("bop", scene, "bar", "retries: {max_failures_n: 1, pause_s: 0.01}\n");
  const Finished finished = agent(config, "--server tcp://127.0.0.1:9");
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(finished.output, AllOf(HasSubstr("UNAVAILABLE"), HasSubstr("tcp://127.0.0.1:9"),
                                     HasSubstr("2 failures in a row")));
  EXPECT_THAT(all(picks("bop"), "code"), ElementsAre("UNAVAILABLE", "UNAVAILABLE"));
}

TEST_F(AgentTest, AnUnknownPartStopsAtOnceAndSaysWhatThereIs) {
  const auto scene = write_bop({frame_of(three_bars()), frame_of(three_bars())});
  const Finished finished = agent(write_config("bop", scene, "bolt"));
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(finished.output, AllOf(HasSubstr("UNKNOWN_PART"), HasSubstr("bolt"), HasSubstr("bar"),
                                     HasSubstr("stick")));
  EXPECT_THAT(picks("bop"), SizeIs(1));
}

TEST_F(AgentTest, FaultsInTheConfigurationAreAllNamedWithFileAndLine) {
  const auto config = folder.write("cell.yaml",
                                   "cell: a\n"
                                   "parts: []\n"
                                   "camera: {kind: stereo, path: nowhere}\n"
                                   "speed: 3\n"
                                   "reactions: {on_bin_empty: stir, on_none_reachable: pray}\n"
                                   "stir: {speed_share: 2}\n"
                                   "averaged_frames_n: 8\n");
  const Finished finished = agent(config);
  EXPECT_EQ(finished.exit_code, 2);
  const std::string file = config.string();
  EXPECT_THAT(
      finished.output,
      AllOf(HasSubstr(file + ":2: 'parts' must name at least one part"),
            HasSubstr(file + ":3: 'stereo' is no kind of camera; known: bop | rawlog | openni2"),
            HasSubstr(file + ":4: unknown key 'speed'"), HasSubstr("'T_base_place'"),
            HasSubstr(file + ":5: 'on_bin_empty' can't be stir"),
            HasSubstr(file + ":5: 'pray' is no reaction; known: stop | wait | stir | ask"),
            HasSubstr(file + ":6: 'speed_share' must be above 0"),
            HasSubstr(file + ":7: 'averaged_frames_n' is for live cameras")));
}

TEST_F(AgentTest, TheReferenceConfigurationIsOneWithAndWithoutItsOptionalKeys) {
  const auto scene = write_bop({frame_of({})});
  const std::filesystem::path cells = std::filesystem::path(GRASPD_SOURCE_DIR) / "deploy/cells";
  write_camera(folder, "camera.yaml", kinect_v2(), kHeight_m);
  const auto full = folder.write("full.yaml", with_every_key(cells / "tees.yaml"));
  for (const auto& config :
       {cells / "tees.yaml", cells / "kinect_tees.yaml", cells / "realsense_elbows.yaml", full}) {
    const Finished finished =
        agent(config, "--server tcp://127.0.0.1:9 --frames 1 --recording " + scene.string());
    EXPECT_EQ(finished.exit_code, 1);
    EXPECT_THAT(finished.output, HasSubstr("no server answers at tcp://127.0.0.1:9"));
  }
}

TEST_F(AgentTest, ABinBehindTheCameraIsRefusedBeforeAnythingMoves) {
  const auto scene = write_bop({frame_of({})});
  const auto config = write_config("bop", scene, "bar",
                                   "bin: {T_base_bin: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 9, "
                                   "0, 0, 0, 1], inner_size_m: [0.4, 0.3, 0.15]}\n");
  const Finished finished = agent(config);
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, HasSubstr("behind the camera"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "bop_arm.jsonl"));
}

TEST_F(AgentTest, AMissingRecordingIsNamed) {
  const Finished finished = agent(write_config("rawlog", "/no/such.rawlog", "bar"));
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, HasSubstr("/no/such.rawlog"));
}

TEST_F(AgentTest, EndsOnSigtermAfterThePickInHand) {
  const auto rawlog = write_rawlog({frame_of(three_bars())});
  const auto config = write_config("rawlog", rawlog, "bar");
  folder.write("rawlog_cell.yaml", [&] {
    std::ifstream stream(config);
    std::string text(std::istreambuf_iterator<char>(stream), {});
    return text.replace(text.find("kind: rawlog"), 12, "loop: true, kind: rawlog");
  }());
  // Its first two lines, the header and a pick, show that it runs.
  const Finished finished =
      run(fmt::format("cd {2}; mkfifo out; {0} run --config {1} >out 2>log & exec 3<out; "
                      "read -r line <&3; read -r line <&3; kill -TERM $!; cat <&3; wait $!; "
                      "code=$?; cat log; exit $code",
                      ROBOT_AGENT, config.string(), folder.path().string()));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("asked to stop"));
  EXPECT_EQ(lines("rawlog_arm.jsonl").back().at("step"), "out_of_view");
}

}  // namespace
}  // namespace graspd::testing

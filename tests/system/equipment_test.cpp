#include <regex>

#include "agent_fixture.hpp"
#include "fake_controller.hpp"
#include "motion_support.hpp"

/// The real agent, with a real arm's driver and a gripper's commands, and in their place a
/// controller and a script of ours.
namespace graspd::testing {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Beside the posture out of view, so that the first motion is one.
const std::vector<float> kStart_rad{-1.2F, -0.3904F, 0.1922F, 0, 0.1982F, -1.5708F};

constexpr const char* kOutOfView = "-1.5708, -0.3904, 0.1922, 0, 0.1982, -1.5708";

class EquipmentTest : public AgentTest {
 protected:
  EquipmentTest() {
    // The Anno, but fast: the controller moves in real time.
    std::string urdf = anno_xml();
    urdf = std::regex_replace(urdf, std::regex(R"(velocity="[^"]*")"), R"(velocity="6")");
    urdf = std::regex_replace(urdf, std::regex(R"(acceleration="[^"]*")"), R"(acceleration="60")");
    folder.write("arm.urdf", urdf);
    write_gripper("");
    write_bop({frame_of({bar_at(0.02, 0.01, 0.4, kBar_m)}), frame_of({})});
  }

  /// A gripper that writes down its orders; it holds something when it was last told to close.
  /// \param first lines of the script before that.
  void write_gripper(const std::string& first) const {
    folder.write("gripper", fmt::format("cd {}\n{}\n[ $1 = holds ] || echo $* >>orders\n"
                                        "[ $1 != holds ] || [ \"$(tail -n 1 orders)\" = close ]\n",
                                        folder.path().string(), first));
  }
  std::vector<std::string> gripper_orders() const {
    std::vector<std::string> orders;
    std::ifstream file(folder.path() / "orders");
    for (std::string line; std::getline(file, line);) orders.push_back(line);
    return orders;
  }

  /// An arm that plans in the cell of simulated_tees.yaml. \param kind with its own keys.
  static std::string planned(const std::string& kind, const std::string& posture = kOutOfView) {
    return fmt::format(
        "{}\n  motion:\n    urdf: arm.urdf\n    max_straight_speed_m_s: 2\n"
        "    T_flange_grasp: [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, -0.17, 0, 0, 0, 1]\n"
        "    out_of_view_rad: [{}]\n    table_z_m: 0",
        kind, posture);
  }
  /// The one that the controller drives.
  std::string our_arm(const std::string& posture = kOutOfView) const {
    return planned(fmt::format("kind: simple_message\n  host: 127.0.0.1\n  motion_port: {}\n"
                               "  state_port: {}\n  full_speed_rad_s: 6\n  watchdog_s: 0.5\n"
                               "  reply_timeout_s: 0.5",
                               controller.motion_port(), controller.state_port()),
                   posture);
  }
  std::filesystem::path write_cell(const std::string& arm) const {
    return folder.write(
        "cell.yaml",
        fmt::format("cell: real\nservers: ['{0}']\nbudget_ms: 20000\nparts: [{{id: bar}}]\n"
                    "camera: {{kind: bop, path: scene}}\n"
                    "T_base_camera: [0, 1, 0, 0.30, 1, 0, 0, 0, 0, 0, -1, 0.75, 0, 0, 0, 1]\n"
                    "bin:\n  T_base_bin: [0, -1, 0, 0.30, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n"
                    "  inner_size_m: [0.30, 0.24, 0.12]\n"
                    "gripper:\n  jaw_size_m: [0.008, 0.016, 0.12]\n"
                    "  palm_size_m: [0.10, 0.06, 0.05]\n  retreat_m: 0.16\n"
                    "  output:\n    open: [sh, {1}, open, '{{width_mm}}']\n"
                    "    close: [sh, {1}, close]\n    sensor: [sh, {1}, holds]\n    settle_s: 0\n"
                    "T_base_place: [1, 0, 0, 0, 0, -1, 0, -0.31, 0, 0, -1, 0.07, 0, 0, 0, 1]\n"
                    "arm:\n  {2}\nrecords: real_records\n",
                    shared_->server->data_endpoint, (folder.path() / "gripper").string(), arm));
  }
  /// What is kept of a run that was stopped.
  json stopped_run() const {
    std::ifstream file(run_folder("real") / "run.json");
    json run = json::parse(file);
    EXPECT_EQ(run.at("state"), "STOPPED");
    return run;
  }
  void expect_not_moved() const {
    EXPECT_THAT(controller.points(), IsEmpty());
    EXPECT_EQ(controller.joints(), kStart_rad);
    EXPECT_THAT(gripper_orders(), IsEmpty());
  }

  FakeController controller{kStart_rad};
};

TEST_F(EquipmentTest, AWholePick) {
  const Finished finished = agent(write_cell(our_arm()));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("done, 1 parts placed: BIN_EMPTY"));
  EXPECT_THAT(all(picks("real"), "verdict"), ElementsAre("PLACED", "-"));
  EXPECT_THAT(gripper_orders(),
              ElementsAre(ContainsRegex("^open [0-9.]+$"), "close", ContainsRegex("^open ")));
  const auto out_of_view_rad = joints({-1.5708, -0.3904, 0.1922, 0, 0.1982, -1.5708});
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(controller.joints()[static_cast<std::size_t>(i)], out_of_view_rad[i], 0.01);
  }
  EXPECT_EQ(controller.stops_n(), 0);
}

TEST_F(EquipmentTest, ACameraOfWhichNobodySaysWhereItStandsMovesNoArm) {
  const auto camera = folder.write(
      "camera.yaml",
      "image_width: 512\nimage_height: 424\n"
      "camera_matrix: {rows: 3, cols: 3, data: [365.5, 0, 255, 0, 365.5, 205, 0, 0, 1]}\n");
  const auto cell = write_cell(our_arm());
  std::ifstream file(cell);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t pose = text.find("T_base_camera:");
  text.erase(pose, text.find('\n', pose) + 1 - pose);
  text.replace(text.find("path: scene"), 11, "path: scene, calibration: camera.yaml");
  const Finished refused = agent(folder.write("cell.yaml", text));
  EXPECT_EQ(refused.exit_code, 2) << refused.output;
  EXPECT_THAT(refused.output, HasSubstr(camera.string() + ": T_base_camera is missing"));
  expect_not_moved();
}

TEST_F(EquipmentTest, AGripperIsTriedWithAnArmThatOnlyWritesDown) {
  const Finished finished = agent(write_cell("kind: record"));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(gripper_orders(),
              ElementsAre(ContainsRegex("^open [0-9.]+$"), "close", ContainsRegex("^open ")));
  EXPECT_THAT(all(lines("arm.jsonl"), "step"), ::testing::Contains("approach"));
  EXPECT_THAT(controller.points(), IsEmpty());
}

/// Controllers that fail in the pick, on the way to the bin.
struct Trouble {
  const char* name;
  Misbehaviour misbehaviour;
  const char* sentence;
};
void PrintTo(const Trouble& trouble, std::ostream* out) { *out << trouble.name; }

class ArmInTrouble : public EquipmentTest, public ::testing::WithParamInterface<Trouble> {};

TEST_P(ArmInTrouble, StopsTheCellAndThePickIsKept) {
  controller.misbehave(GetParam().misbehaviour, /*good_motions_n=*/1);
  const Finished finished = agent(write_cell(our_arm()));
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(finished.output, ContainsRegex(GetParam().sentence));
  const std::vector<json> kept = picks("real");
  EXPECT_THAT(all(kept, "verdict"), ElementsAre("FAULT"));
  EXPECT_THAT(all(kept, "message"), Each(ContainsRegex(GetParam().sentence)));
  EXPECT_THAT(stopped_run().at("reason").get<std::string>(), ContainsRegex(GetParam().sentence));
  EXPECT_THAT(gripper_orders(), ElementsAre(ContainsRegex("^open "))) << "nothing was let go";
}

INSTANTIATE_TEST_SUITE_P(
    Equipment, ArmInTrouble,
    ::testing::Values(
        Trouble{"vanishes", Misbehaviour::kVanishes,
                "pre_grasp: .* closed the connection; the stop was not confirmed .*: the arm may "
                "be moving, use the emergency stop"},
        Trouble{"emergency_stop", Misbehaviour::kEmergencyStop,
                "pre_grasp: the emergency stop is pressed; the arm was stopped"},
        Trouble{"error", Misbehaviour::kReportsError,
                "pre_grasp: the controller reports error 1234; the arm was stopped"},
        Trouble{"silence", Misbehaviour::kFallsSilent,
                "pre_grasp: .* fell silent: .*; the arm was stopped"}),
    [](const auto& tested) { return tested.param.name; });

TEST_F(EquipmentTest, AGripperThatDoesNotConfirmStopsTheCellWhereItIs) {
  write_gripper("if [ $1 = close ]; then echo no air >&2; exit 3; fi");
  const Finished finished = agent(write_cell(our_arm()));
  EXPECT_EQ(finished.exit_code, 1);
  const std::string sentence =
      "close: the gripper did not confirm to close: 'sh' ended with 3: no air";
  EXPECT_THAT(finished.output, HasSubstr(sentence));
  EXPECT_THAT(all(picks("real"), "verdict"), ElementsAre("FAULT"));
  EXPECT_EQ(stopped_run().at("reason"), sentence);
  EXPECT_GE(controller.stops_n(), 1);
  EXPECT_FALSE(controller.is_moving());
}

TEST_F(EquipmentTest, AskedToStopInThePickItStillPlacesThePart) {
  write_gripper("[ $1 != close ] || kill -TERM $PPID");
  const Finished finished = agent(write_cell(our_arm()));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("done, 1 parts placed: asked to stop"));
  EXPECT_THAT(all(picks("real"), "verdict"), ElementsAre("PLACED"));
}

TEST_F(EquipmentTest, AnArmBeyondItsLimitsIsNotMoved) {
  folder.write("arm.urdf",
               std::regex_replace(anno_xml(), std::regex(R"(lower="-2.0071")"), R"(lower="-0.1")"));
  const Finished finished = agent(write_cell(our_arm("-1.5708, 0, 0.1922, 0, 0.1982, 0")));
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(finished.output, AllOf(HasSubstr("the arm stands beyond its limits: joint_2"),
                                     HasSubstr("move it back by hand")));
  EXPECT_THAT(stopped_run().at("reason").get<std::string>(), HasSubstr("beyond its limits"));
  expect_not_moved();
}

TEST_F(EquipmentTest, AUrdfThatIsNoneOrOfAnotherArmIsNamedBeforeAnythingMoves) {
  const auto refusal = [&](const std::string& posture) {
    const Finished finished = agent(write_cell(our_arm(posture)));
    EXPECT_EQ(finished.exit_code, 2) << finished.output;
    return finished.output;
  };
  const std::string path = (folder.path() / "arm.urdf").string();
  EXPECT_THAT(refusal("0, 0, 0, 0, 0"), HasSubstr(path + " has 6 joints"));
  EXPECT_THAT(refusal("0, 9, 0, 0, 0, 0"), HasSubstr("out of view: joint_2 would be at 9.000"));
  folder.write("arm.urdf", "<sdf/>");
  EXPECT_THAT(refusal("0, 0, 0, 0, 0, 0"), HasSubstr(path));
  std::filesystem::remove(path);
  EXPECT_THAT(refusal("0, 0, 0, 0, 0, 0"), HasSubstr(path));
  expect_not_moved();
}

TEST_F(EquipmentTest, AControllerThatIsNotThereIsNamed) {
  const Finished finished =
      agent(write_cell(planned("kind: simple_message\n  host: 127.0.0.1\n  motion_port: 9")));
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(finished.output,
              HasSubstr("no connection to the controller at 127.0.0.1:9: Connection refused"));
}

TEST_F(EquipmentTest, AnArmOverRosNeedsABuildWithItAndAMaster) {
  const Finished finished = agent(write_cell(planned("kind: ros")));
#ifdef GRASPD_ROS
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(finished.output, HasSubstr("no ROS master answers at"));
#else
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, HasSubstr("built without ROS: build it with -DGRASPD_ROS=ON"));
#endif
}

TEST_F(EquipmentTest, WhatAnArmNeedsAndTheConfigurationLacksIsAllNamed) {
  const auto config =
      folder.write("cell.yaml",
                   "cell: real\nparts: [{id: bar}]\n"
                   "camera: {kind: openni2}\n"
                   "averaged_frames_n: 33\n"
                   "arm: {kind: simple_message, motion_port: 70000}\n"
                   "T_base_place: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n"
                   "gripper: {output: {close: [true]}}\n");
  const Finished finished = agent(config);
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output,
              AllOf(HasSubstr("key 'calibration' is missing"), HasSubstr("key 'host' is missing"),
                    HasSubstr("'motion_port' must be 1 to 65535"), HasSubstr("key 'urdf'"),
                    HasSubstr("'averaged_frames_n' must be 1 to 32"),
                    HasSubstr("key 'open' is missing"), HasSubstr("add the section 'bin'")));
}

TEST_F(EquipmentTest, OnlyASimulatedCellHasAPileAndItsOwnGripper) {
  const Finished pile = agent(write_cell(our_arm()), "--pile 3");
  EXPECT_EQ(pile.exit_code, 2);
  EXPECT_THAT(pile.output, HasSubstr("--pile and --seed are for a simulated cell"));
  const Finished gripper = agent(write_cell(planned("kind: simulated\n  pile: {parts: parts}")));
  EXPECT_EQ(gripper.exit_code, 2);
  EXPECT_THAT(gripper.output, HasSubstr("a simulated cell has its own gripper"));
}

}  // namespace
}  // namespace graspd::testing

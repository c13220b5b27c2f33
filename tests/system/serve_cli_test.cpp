#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "serve_process.hpp"
#include "serve_scene.hpp"

// The command lines, as a person uses them.
namespace graspd::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// One server for all tests here: none of them changes it.
class GraspTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    write_box_part(*folder_, "bar", 1, kBar_m * 1000);
    const CameraIntrinsics camera = kinect_v2();
    write_camera(*folder_, "camera.yaml", camera, kHeight_m);
    folder_->write("cell.yaml",
                   "bin:\n  T_base_bin: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n"
                   "  inner_size_m: [0.4, 0.3, 0.1]\n  wall_thickness_m: 0.003\n");
    write_frame(*folder_, "bars.png",
                render(camera, kHeight_m,
                       {bar_at(0.05, 0.03, 0.4, kBar_m), bar_at(-0.08, 0.02, -0.9, kBar_m)}));
    write_frame(*folder_, "floor.png", render(camera, kHeight_m, {}));
    write_frame(*folder_, "small.png", render({64, 48, 50, 50, 32, 24, {}}, kHeight_m, {}));
    server_ = new ServeProcess({"--parts", (folder_->path() / "parts").string(), "--workers", "1"});
    ASSERT_TRUE(server_->wait_ready());
  }
  static void TearDownTestSuite() {
    delete server_;
    delete folder_;
  }

  static std::string path(const std::string& name) { return (folder_->path() / name).string(); }
  static Finished grasp(const std::string& arguments) {
    return run(std::string(GRASP) + " " + arguments);
  }
  static std::string question(const std::string& depth) {
    return "plan --server " + server_->data_endpoint + " --depth " + path(depth) + " --camera " +
           path("camera.yaml") + " --cell " + path("cell.yaml") + " ";
  }

  static inline TemporaryFolder* folder_ = nullptr;
  static inline ServeProcess* server_ = nullptr;
};

TEST_F(GraspTest, PrintsTheRankedTableAndDrawsTheOverlay) {
  const Finished planned = grasp(question("bars.png") + "--part bar --overlay " + path("plan.png"));
  EXPECT_EQ(planned.exit_code, 0) << planned.output;
  EXPECT_THAT(planned.output,
              AllOf(HasSubstr("rank"), HasSubstr("P_grasp"), HasSubstr("open mm"),
                    HasSubstr("outcome   PLANNED, "), HasSubstr("217088 pixels → 217088 readings"),
                    HasSubstr("queue "), HasSubstr("round trip")));
  EXPECT_GT(std::filesystem::file_size(path("plan.png")), 1000u);
}

TEST_F(GraspTest, AnEmptyBinHasItsOwnExitCode) {
  const Finished empty = grasp(question("floor.png") + "--part bar");
  EXPECT_EQ(empty.exit_code, 4);
  EXPECT_THAT(empty.output,
              AllOf(HasSubstr("BIN_EMPTY"), HasSubstr("reason"), Not(HasSubstr("rank"))));
}

TEST_F(GraspTest, PrintsNothingButJson) {
  const Finished planned = grasp(question("bars.png") + "--part bar --json");
  EXPECT_EQ(planned.exit_code, 0);
  EXPECT_EQ(planned.output.front(), '{');
  EXPECT_THAT(planned.output, HasSubstr("\"PLANNED\""));
}

TEST_F(GraspTest, NamedMethodsReachTheServer) {
  const Finished planned = grasp(question("bars.png") +
                                 "--part bar --segmentation euclidean --registration pca_icp "
                                 "--order ascending --encoding rvl --max-grasps 1");
  EXPECT_EQ(planned.exit_code, 0) << planned.output;
  EXPECT_THAT(planned.output, HasSubstr(", 1 grasp\n"));
  const Finished unknown = grasp(question("bars.png") + "--part bar --segmentation kmeans");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, HasSubstr("improved_dbscan,dbscan"));
}

TEST_F(GraspTest, SaysWhatIsWrongWithItsInput) {
  const Finished part = grasp(question("bars.png") + "--part gizmo");
  EXPECT_EQ(part.exit_code, 2);
  EXPECT_THAT(part.output, HasSubstr("UNKNOWN_PART: part 'gizmo'"));

  const Finished missing = grasp(question("nowhere.png") + "--part bar");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.output, HasSubstr("nowhere.png"));

  const Finished size = grasp(question("small.png") + "--part bar");
  EXPECT_EQ(size.exit_code, 2);
  EXPECT_THAT(size.output, HasSubstr("small.png has 64 × 48 pixels, but"));
}

TEST_F(GraspTest, SaysWhereNoServerIs) {
  const Finished absent = grasp("plan --server tcp://127.0.0.1:1 --depth " + path("bars.png") +
                                " --camera " + path("camera.yaml") + " --part bar");
  EXPECT_EQ(absent.exit_code, 3);
  EXPECT_THAT(absent.output,
              HasSubstr("UNAVAILABLE: no server answers at tcp://127.0.0.1:1; check"));
  const Finished endpoint = grasp("health --server localhost");
  EXPECT_EQ(endpoint.exit_code, 2);
  EXPECT_THAT(endpoint.output, HasSubstr("'localhost' is no server's endpoint"));
}

TEST_F(GraspTest, HealthOnBothEndpoints) {
  const Finished health =
      grasp("health --server " + server_->data_endpoint + " --server " + server_->control_endpoint);
  EXPECT_EQ(health.exit_code, 0);
  EXPECT_THAT(health.output, AllOf(HasSubstr(server_->data_endpoint),
                                   HasSubstr(server_->control_endpoint), HasSubstr("ready")));
  const Finished json = grasp("health --json --server " + server_->control_endpoint);
  EXPECT_EQ(json.output.front(), '{');
  const Finished partly =
      grasp("health --server " + server_->data_endpoint + " --server tcp://127.0.0.1:1");
  EXPECT_EQ(partly.exit_code, 3);
  EXPECT_THAT(partly.output, HasSubstr("ready"));
}

TEST_F(GraspTest, StatsSaysWhatTheServerHasDone) {
  grasp(question("bars.png") + "--part bar");
  grasp(question("bars.png") + "--part gizmo");
  const Finished once =
      grasp("stats --once --server " + server_->data_endpoint + " --server tcp://127.0.0.1:1");
  EXPECT_EQ(once.exit_code, 3) << "one does not answer";
  EXPECT_THAT(once.output, AllOf(HasSubstr(server_->data_endpoint + "  ready"),
                                 HasSubstr("tcp://127.0.0.1:1"), HasSubstr("UNAVAILABLE")));
  EXPECT_THAT(once.output, ::testing::ContainsRegex("registration +[1-9][0-9]* +[0-9.]+\n"));
  EXPECT_EQ(grasp("stats --once --server " + server_->control_endpoint).exit_code, 0);
  // Live: a table each time, until told to end; no escape codes where no terminal is.
  const Finished live = run("timeout 2 " + std::string(GRASP) +
                            " stats --interval-ms 100 --server " + server_->control_endpoint);
  const std::regex header("plans/s");
  EXPECT_GE(std::distance(std::sregex_iterator(live.output.begin(), live.output.end(), header), {}),
            2);
  EXPECT_THAT(live.output, Not(HasSubstr("\033")));
}

TEST_F(GraspTest, TheClientLibrarysExampleRuns) {
  const Finished example = run(std::string(CLIENT_EXAMPLE) + " " + server_->data_endpoint + " " +
                               path("camera.yaml") + " " + path("bars.png") + " bar");
  EXPECT_EQ(example.exit_code, 0) << example.output;
  EXPECT_THAT(example.output, HasSubstr("PLANNED"));
}

TEST_F(GraspTest, PartCheckSaysWhatIsWrongWithAMesh) {
  const std::string check = std::string(GRASP_SERVER) + " part check ";
  const Finished good = run(check + path("parts/bar/box.stl"));
  EXPECT_EQ(good.exit_code, 0) << good.output;
  EXPECT_THAT(good.output, HasSubstr("80.0"));
  const Finished metres = run(check + path("parts/bar/box.stl") + " --unit m");
  EXPECT_EQ(metres.exit_code, 1);
  EXPECT_THAT(metres.output, HasSubstr("error"));
  EXPECT_EQ(run(check + path("nowhere.stl")).exit_code, 2);
}

TEST_F(GraspTest, PartCheckListsThePickPointsThatThePartFileTeachesAndTheMeshHas) {
  const std::string check = std::string(GRASP_SERVER) + " part check ";
  const Finished own = run(check + GRASPD_SOURCE_DIR "/deploy/parts/tee/part.yaml");
  EXPECT_EQ(own.exit_code, 0) << own.output;
  EXPECT_THAT(own.output, AllOf(HasSubstr("branch_end"), HasSubstr("part file"),
                                HasSubstr("antipodal_1"), HasSubstr("flat_1")));
  const Finished mesh = run(check + path("parts/bar/box.stl"));
  EXPECT_THAT(mesh.output, AllOf(HasSubstr("antipodal_1"), Not(HasSubstr("part file"))));

  std::ofstream(path("parts/bar/wrong.yaml"))
      << "id: bar\nmesh: box.stl\nmesh_unit: mm\n"
         "pick_points:\n  - {name: end, position_mm: [500, 0, 0]}\n";
  const Finished outside = run(check + path("parts/bar/wrong.yaml"));
  EXPECT_EQ(outside.exit_code, 1);
  EXPECT_THAT(outside.output, AllOf(HasSubstr("wrong.yaml: pick point 'end': position_mm"),
                                    HasSubstr("lies outside of the mesh")));
  std::ofstream(path("parts/bar/wrong.yaml")) << "id: bar\n";
  const Finished incomplete = run(check + path("parts/bar/wrong.yaml"));
  EXPECT_EQ(incomplete.exit_code, 2);
  EXPECT_THAT(incomplete.output, HasSubstr("key 'mesh' is missing"));
}

}  // namespace
}  // namespace graspd::testing

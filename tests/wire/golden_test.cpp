#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "graspd/codec/codec.hpp"
#include "same_message.hpp"
#include "schema.hpp"

/// The bytes that earlier releases sent, kept in golden/. Today's decoder must read them, and
/// today's encoder must still make them: what is already in the field goes on working.
///
/// A release that adds fields adds a file: write its content below as a function of its own, add
/// a row, and run this test once with GRASPD_WRITE_GOLDEN=1, which writes files that are not there.
/// It never touches one that is: a golden file that no longer matches is a broken promise.
namespace graspd::testing {
namespace {

namespace fs = std::filesystem;

const fs::path kGolden = fs::path(GRASPD_SOURCE_DIR) / "tests" / "wire" / "golden";

// Rotations whose quaternions and matrices are exact, so that no rounding gets into the bytes.
Eigen::Isometry3d pose(double x_m, double y_m, double z_m, const Eigen::Quaterniond& q) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(x_m, y_m, z_m);
  T.linear() = q.toRotationMatrix();
  return T;
}
const Eigen::Quaterniond kIdentity(1, 0, 0, 0);
const Eigen::Quaterniond kDown(0, 1, 0, 0);
const Eigen::Quaterniond kCyclic(0.5, 0.5, -0.5, 0.5);

RequestId id_from(std::uint8_t first) {
  RequestId id;
  for (auto& byte : id) byte = first++;
  return id;
}

Request plan_request() {
  const FrameDescription frame{.camera = {.width_px = 512,
                                          .height_px = 424,
                                          .fx_px = 365.5,
                                          .fy_px = 365.25,
                                          .cx_px = 255.5,
                                          .cy_px = 205.75,
                                          .distortion = {0.0905, -0.268, 0.001, -0.002, 0.095}},
                               .depth_scale_m = 0.001,
                               .encoding = DepthEncoding::kRvl,
                               .payload_bytes = 123456,
                               .payload_crc32 = 0xcbf43926};
  PlanRequest plan;
  plan.T_base_camera = pose(0.3125, 0, 0.875, kDown);
  plan.bin = Bin{.T_base_bin = pose(0.3125, 0.0625, 0.0125, kIdentity),
                 .inner_size_m = {0.24, 0.22, 0.12},
                 .wall_thickness_m = 0.003};
  plan.parts = {{.id = "tee", .priority = 2}, {.id = "elbow", .priority = -1.5}};
  plan.gripper = {.kind = GripperKind::kSuction,
                  .min_opening_m = 0.001,
                  .max_opening_m = 0.085,
                  .clearance_m = 0.004,
                  .standoff_m = 0.07,
                  .retreat_m = 0.11,
                  .jaw_size_m = {0.008, 0.016, 0.045},
                  .palm_size_m = {0.1, 0.06, 0.05},
                  .cup_diameter_m = 0.02};
  plan.options = {.segmentation = Segmentation::kRegionGrowing,
                  .registration = Registration::kVerified,
                  .order = GraspOrder::kAscending,
                  .p_system = PSystem::kSupport,
                  .strategy = Strategy::kPreferredApproach,
                  .strategy_vector_base_m = {0, 0.25, -1},
                  .max_grasps_n = 17,
                  .explain_rejected = true,
                  .outlines = true};
  plan.last_plan = LastPlan{.objects = {{.id = 300,
                                         .part_id = "tee",
                                         .T_base_part = pose(0.25, -0.125, 0.0625, kCyclic),
                                         .p_base_segment_centroid_m = {0.26, -0.12, 0.07},
                                         .score = 0.75,
                                         .visible_fraction = 0.5},
                                        {.id = 0, .part_id = "elbow"}},
                            .picked_object_id = 0};
  plan.failed_spots = {
      {.p_base_m = {0.3, 0.01, 0.05}, .radius_m = 0.015, .failures_n = 2, .reason = {}}};
  return {.id = id_from(1),
          .attempt = 2,
          .cell = "cell-1",
          .budget_ms = 1500,
          .call = PlanCall{frame, plan}};
}

/// With why a spot is to be avoided.
Request reason_request() {
  Request request = plan_request();
  std::get<PlanCall>(request.call).plan.failed_spots[0].reason =
      "joint 4 would turn to 95°, beyond its limit";
  return request;
}

Request crop_box_request() {
  Request request = plan_request();
  auto& [frame, plan] = std::get<PlanCall>(request.call);
  frame.encoding = DepthEncoding::kRaw;
  frame.payload_bytes = 512 * 424 * 2;
  plan.bin.reset();
  plan.crop_box =
      CropBox{.T_base_box = pose(0.3125, 0.0625, 0.0625, kIdentity), .size_m = {0.24, 0.22, 0.12}};
  plan.gripper = {};
  plan.options = {};
  plan.last_plan.reset();
  plan.failed_spots.clear();
  return request;
}

Request health_request() {
  return {
      .id = id_from(0xf0), .attempt = 1, .cell = "cell-1", .budget_ms = 200, .call = HealthCall{}};
}

const ServerInfo kServer{.build = "0.1.0", .catalogue_hash = "c0ffee", .config_hash = "beef"};

Object tee() {
  return {.id = 7,
          .part_id = "tee",
          .T_base_part = pose(0.25, -0.125, 0.0625, kCyclic),
          .score = 0.875,
          .visible_fraction = 0.75,
          .inlier_fraction = 0.9,
          .refuted_fraction = 0.02,
          .rms_m = 0.0011,
          .p_base_segment_centroid_m = {0.26, -0.12, 0.07},
          .lies_on_ids = {8},
          .supports_ids = {},
          .entangled_ids = {},
          .double_pick_ids = {},
          .grs = {.grs = 0.41,
                  .p_self = 0.4,
                  .p_grasp = 0.01,
                  .p_system = 1,
                  .height_m = 0.05,
                  .inclination_rad = 0.3,
                  .neighbour_ids = {8},
                  .overlap_points_n = 12,
                  .overlap_ids = {8},
                  .load = 0,
                  .cover = 0},
          .outline_px = {100.5f, 200.25f, 101.5f, 200.25f, 101, 202}};
}

Object elbow() {
  Object object;
  object.id = 8;
  object.part_id = "elbow";
  object.supports_ids = {7};
  return object;
}

Grasp grasp(CheckState cloud, const std::string& reason) {
  return {.object_id = 7,
          .pick_point = "principal_axis",
          .T_base_grasp = pose(0.26, -0.12, 0.07, kDown),
          .opening_width_m = 0.031,
          .standoff_m = 0.08,
          .retreat_m = 0.1,
          .score = 0.41,
          .checks = {
              {.check = Check::kOpening, .state = CheckState::kPassed, .reason = ""},
              {.check = Check::kGripperCloud, .state = cloud, .reason = reason},
              {.check = Check::kGripperParts, .state = CheckState::kPassed, .reason = ""},
              {.check = Check::kGripperBin, .state = CheckState::kPassed, .reason = ""},
              {.check = Check::kHeldPart, .state = CheckState::kNotRun, .reason = "switched off"}}};
}

Answer plan_answer() {
  PlanAnswer plan{
      .outcome = Outcome::kPlanned,
      .reason = "",
      .warnings = {"3 % of the bin has no reading"},
      .funnel = {217088, 200000, 24000, 12000, 11000, 21, 640, 2, 5, 1, {1, 2, 3, 4, 5}},
      .objects = {tee(), elbow()},
      .grasps = {grasp(CheckState::kPassed, "")},
      .rejected_grasps = {grasp(CheckState::kFailed, "left jaw touches 12 points")},
      .fill_level = 0.375,
      .bin_drift_m = {},
      .timings = {{"queue", 1200}, {"segmentation", 84'000'000}},
      .server = kServer};
  return {.id = id_from(1), .code = Code::kOk, .message = "", .retry_after_ms = 0, .body = plan};
}

/// With what the pile graph added.
Answer pile_answer() {
  Answer answer = plan_answer();
  auto& plan = std::get<PlanAnswer>(answer.body);
  plan.objects[0].entangled_ids = {8};
  plan.objects[1].entangled_ids = {7};
  plan.objects[1].double_pick_ids = {7};
  plan.objects[1].grs.load = 0.75;
  plan.objects[1].grs.cover = 0.5;
  return answer;
}

/// With how far the bin is off.
Answer drifted_answer() {
  Answer answer = plan_answer();
  std::get<PlanAnswer>(answer.body).bin_drift_m = 0.0084;
  return answer;
}

Answer health_answer() {
  return {.id = id_from(0xf0),
          .code = Code::kOk,
          .message = "",
          .retry_after_ms = 0,
          .body = HealthAnswer{.state = ServerState::kReady,
                               .workers_n = 4,
                               .workers_busy_n = 3,
                               .queued_n = 2,
                               .answered_n = 5'000'000'000,
                               .uptime_s = 86400.5,
                               .part_ids = {"tee", "elbow"},
                               .server = kServer,
                               .answers_by_code = {},
                               .stages = {}}};
}

/// With what the server counts.
Answer stats_answer() {
  Answer answer = health_answer();
  auto& health = std::get<HealthAnswer>(answer.body);
  health.answers_by_code = {{Code::kOk, 4'000'000'000}, {Code::kBusy, 12}};
  health.stages = {{"queue", 7, 1'200'000}, {"registration", 7, 560'000'000}};
  health.workers_lost_n = 3;
  health.memory_bytes = 5'000'000'000;
  return answer;
}

Answer refusal() {
  return {.id = id_from(1),
          .code = Code::kBusy,
          .message = "2 frames wait before this one; retry after 120 ms or ask another server",
          .retry_after_ms = 120,
          .body = {}};
}

void write_if_missing(const fs::path& path, const std::string& bytes) {
  const char* write = std::getenv("GRASPD_WRITE_GOLDEN");
  if (!write || std::string(write) != "1" || fs::exists(path)) return;
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

template <class Message, class Encode, class Decode>
void expect_golden(const std::string& name, const Message& content, Encode encode, Decode decode) {
  const fs::path path = kGolden / (name + ".bin");
  const std::string encoded = encode(content);
  write_if_missing(path, encoded);
  const std::string golden = read_file(path);
  ASSERT_FALSE(golden.empty()) << path << " is missing";
  const auto decoded = decode(as_bytes(golden));
  ASSERT_TRUE(decoded) << path << ": " << decoded.error().message;
  EXPECT_TRUE(same(*decoded, content)) << path;
  EXPECT_TRUE(encoded == golden) << path << ": the encoder makes other bytes than it did";
}

std::map<std::string, Request> requests() {
  return {{"0.1.0_crop_box_request", crop_box_request()},
          {"0.1.0_health_request", health_request()},
          {"0.1.0_plan_request", plan_request()},
          {"0.1.0_reason_request", reason_request()}};
}

std::map<std::string, Answer> answers() {
  return {{"0.1.0_health_answer", health_answer()},
          {"0.1.0_plan_answer", plan_answer()},
          {"0.1.0_refusal", refusal()},
          {"0.1.0_stats_answer", stats_answer()},
          {"0.1.0_pile_answer", pile_answer()},
          {"0.1.0_drifted_answer", drifted_answer()}};
}

TEST(Golden, Requests) {
  for (const auto& [name, content] : requests()) {
    expect_golden(name, content, codec::encode_request, codec::decode_request);
  }
}

TEST(Golden, Answers) {
  for (const auto& [name, content] : answers()) {
    expect_golden(name, content, codec::encode_answer, codec::decode_answer);
  }
}

TEST(Golden, EveryFileIsTested) {
  for (const auto& file : fs::directory_iterator(kGolden)) {
    const std::string name = file.path().stem();
    EXPECT_TRUE(requests().contains(name) || answers().contains(name)) << file.path();
  }
}

}  // namespace
}  // namespace graspd::testing

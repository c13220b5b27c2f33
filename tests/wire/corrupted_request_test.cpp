#include <gtest/gtest.h>

#include "graspd/codec/codec.hpp"
#include "random_messages.hpp"
#include "schema.hpp"

/// A valid request with exactly one thing wrong, for every check of the decoder.
namespace graspd::testing {
namespace {

struct RequestRow {
  std::string name;
  std::vector<Edit> edits;
  std::string words;  ///< that the sentence must have: the field's path and what is wrong
  Code code = Code::kInvalidArgument;
};

void PrintTo(const RequestRow& row, std::ostream* out) { *out << row.name; }

/// Every field set, a bin and no crop box, a parallel-jaw gripper.
std::string valid_request() {
  RandomMessages random(42);
  Request request = random.plan_request();
  PlanCall& call = std::get<PlanCall>(request.call);
  while (!call.plan.bin) call.plan = random.any_plan();
  call.plan.parts = {{.id = "tee", .priority = 1}, {.id = "elbow", .priority = 2}};
  call.plan.gripper.kind = GripperKind::kParallelJaw;
  call.plan.last_plan->objects = {LastObject{.id = 3, .part_id = "tee"},
                                  LastObject{.id = 4, .part_id = "tee"}};
  call.frame.encoding = DepthEncoding::kRaw;
  call.frame.camera.width_px = 64;
  call.frame.camera.height_px = 48;
  call.frame.camera.cx_px = 31.5;
  call.frame.camera.cy_px = 23.5;
  call.frame.payload_bytes = 64 * 48 * 2;
  return codec::encode_request(request);
}

class CorruptedRequest : public ::testing::TestWithParam<RequestRow> {};

TEST_P(CorruptedRequest, IsRefusedWithASentence) {
  static const std::string valid = valid_request();
  ASSERT_TRUE(codec::decode_request(as_bytes(valid)))
      << codec::decode_request(as_bytes(valid)).error().message;
  const std::string corrupted = schema::edit("Request", valid, GetParam().edits);
  const auto decoded = codec::decode_request(as_bytes(corrupted));
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, GetParam().code) << name_of(decoded.error().code);
  EXPECT_NE(decoded.error().message.find(GetParam().words), std::string::npos)
      << decoded.error().message;
}

const std::string kFrame = "plan.frame.";
const std::string kPlan = "plan.request.";
const std::string kGripper = "plan.request.gripper.";
const std::string kLast = "plan.request.last_plan.objects";
const std::string kBox =
    "{ T_base_box { translation_m { z: 0 } rotation { w: 1 } } size_m { x: 1 y: 1 z: 1 } }";

std::vector<Edit> times(int n, const Edit& edit) {
  return std::vector<Edit>(static_cast<std::size_t>(n), edit);
}

std::string quoted(const std::string& text) { return '"' + text + '"'; }

/// Replaces the bin by a crop box whose given field is then changed.
std::vector<Edit> crop_box(const Edit& edit) {
  return {{kPlan + "T_base_camera.translation_m", "{ x: 0 y: 0 z: -1 }"},
          {kPlan + "T_base_camera.rotation", "{ w: 1 x: 0 y: 0 z: 0 }"},
          {kPlan + "bin", kClear},
          {kPlan + "crop_box", kBox},
          edit};
}

INSTANTIATE_TEST_SUITE_P(
    Envelope, CorruptedRequest,
    ::testing::Values(
        RequestRow{"version_2",
                   {{"protocol_version", "2"}},
                   "protocol_version: 2; this server speaks 1",
                   Code::kUnsupportedVersion},
        RequestRow{"version_missing",
                   {{"protocol_version", kClear}},
                   "protocol_version: 0",
                   Code::kUnsupportedVersion},
        RequestRow{"id_missing", {{"id", kClear}}, "id: 0 bytes; an id has 16"},
        RequestRow{"id_short", {{"id", quoted("123456789012345")}}, "id: 15 bytes; an id has 16"},
        RequestRow{"id_long", {{"id", quoted("12345678901234567")}}, "id: 17 bytes; an id has 16"},
        RequestRow{"attempt_0", {{"attempt", "0"}}, "attempt: 0; the first attempt is 1"},
        RequestRow{
            "cell_long", {{"cell", quoted(std::string(129, 'c'))}}, "cell: a name of 129 bytes"},
        RequestRow{"cell_newline", {{"cell", quoted("a\\nb")}}, "cell: control character 0x0a"},
        RequestRow{"cell_delete", {{"cell", quoted("a\\177b")}}, "cell: control character 0x7f"},
        RequestRow{"call_missing", {{"plan", kClear}}, "call: missing; one of plan and health"},
        RequestRow{"frame_missing", {{"plan.frame", kClear}}, "plan.frame: missing"},
        RequestRow{"request_missing", {{"plan.request", kClear}}, "plan.request: missing"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Frame, CorruptedRequest,
    ::testing::Values(
        RequestRow{"camera_missing", {{kFrame + "camera", kClear}}, "plan.frame.camera: missing"},
        RequestRow{"width_0",
                   {{kFrame + "camera.width_px", "0"}},
                   "plan.frame.camera: an image of 0 × 48"},
        RequestRow{"height_negative", {{kFrame + "camera.height_px", "-48"}}, "64 × -48"},
        RequestRow{
            "width_2049", {{kFrame + "camera.width_px", "2049"}}, "each side must be 8 … 2048"},
        RequestRow{"fx_nan", {{kFrame + "camera.fx_px", "nan"}}, "plan.frame.camera.fx_px: nan"},
        RequestRow{"fx_0", {{kFrame + "camera.fx_px", "0"}}, "plan.frame.camera.fx_px: 0"},
        RequestRow{
            "fy_infinite", {{kFrame + "camera.fy_px", "inf"}}, "plan.frame.camera.fy_px: inf"},
        RequestRow{
            "fy_negative", {{kFrame + "camera.fy_px", "-365"}}, "plan.frame.camera.fy_px: -365"},
        RequestRow{"cx_nan", {{kFrame + "camera.cx_px", "nan"}}, "plan.frame.camera.cx_px: nan"},
        RequestRow{"cy_nan", {{kFrame + "camera.cy_px", "nan"}}, "plan.frame.camera.cy_px: nan"},
        RequestRow{"cx_outside",
                   {{kFrame + "camera.cx_px", "1000"}},
                   "plan.frame.camera: principal point"},
        RequestRow{
            "k1_nan", {{kFrame + "camera.distortion.k1", "nan"}}, "camera.distortion.k1: nan"},
        RequestRow{
            "k2_nan", {{kFrame + "camera.distortion.k2", "nan"}}, "camera.distortion.k2: nan"},
        RequestRow{
            "p1_nan", {{kFrame + "camera.distortion.p1", "nan"}}, "camera.distortion.p1: nan"},
        RequestRow{
            "p2_nan", {{kFrame + "camera.distortion.p2", "nan"}}, "camera.distortion.p2: nan"},
        RequestRow{
            "k3_nan", {{kFrame + "camera.distortion.k3", "nan"}}, "camera.distortion.k3: nan"},
        RequestRow{"k3_huge", {{kFrame + "camera.distortion.k3", "101"}}, "camera.distortion: 101"},
        RequestRow{
            "scale_nan", {{kFrame + "depth_scale_m", "nan"}}, "plan.frame.depth_scale_m: nan"},
        RequestRow{
            "scale_0", {{kFrame + "depth_scale_m", "0"}}, "plan.frame.depth_scale_m: 0 m per unit"},
        RequestRow{"encoding_missing",
                   {{kFrame + "encoding", kClear}},
                   "plan.frame.encoding: 0 is no depth encoding; say RAW | RVL"},
        RequestRow{"encoding_99", {{kFrame + "encoding", "99"}}, "plan.frame.encoding: 99"},
        RequestRow{"payload_0", {{kFrame + "payload_bytes", "0"}}, "plan.frame.payload_bytes: 0"},
        RequestRow{"payload_not_the_image",
                   {{kFrame + "payload_bytes", "6142"}},
                   "plan.frame.payload_bytes: 6142; 64 × 48 pixels of 2 bytes are 6144"},
        RequestRow{"payload_too_large",
                   {{kFrame + "payload_bytes", "1048577"}},
                   "plan.frame.payload_bytes: 1048577; 1 … 1048576 are taken"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Poses, CorruptedRequest,
    ::testing::Values(
        RequestRow{
            "missing", {{kPlan + "T_base_camera", kClear}}, "plan.request.T_base_camera: missing"},
        RequestRow{"no_translation",
                   {{kPlan + "T_base_camera.translation_m", kClear}},
                   "plan.request.T_base_camera.translation_m: missing"},
        RequestRow{"no_rotation",
                   {{kPlan + "T_base_camera.rotation", kClear}},
                   "plan.request.T_base_camera.rotation: missing"},
        RequestRow{"x_nan",
                   {{kPlan + "T_base_camera.translation_m.x", "nan"}},
                   "plan.request.T_base_camera.translation_m.x: nan"},
        RequestRow{
            "y_nan", {{kPlan + "T_base_camera.translation_m.y", "nan"}}, "translation_m.y: nan"},
        RequestRow{"z_infinite",
                   {{kPlan + "T_base_camera.translation_m.z", "-inf"}},
                   "translation_m.z: -inf"},
        RequestRow{"millimetres",
                   {{kPlan + "T_base_camera.translation_m.z", "750"}},
                   "plan.request.T_base_camera: 750 m from the origin; poses are in metres"},
        RequestRow{"w_nan",
                   {{kPlan + "T_base_camera.rotation.w", "nan"}},
                   "plan.request.T_base_camera.rotation.w: nan"},
        RequestRow{"q_x_nan", {{kPlan + "T_base_camera.rotation.x", "nan"}}, "rotation.x: nan"},
        RequestRow{"q_y_nan", {{kPlan + "T_base_camera.rotation.y", "nan"}}, "rotation.y: nan"},
        RequestRow{"q_z_nan", {{kPlan + "T_base_camera.rotation.z", "nan"}}, "rotation.z: nan"},
        RequestRow{
            "q_zero",
            {{kPlan + "T_base_camera.rotation", kClear}, {kPlan + "T_base_camera.rotation", "{}"}},
            "plan.request.T_base_camera.rotation: w 0 x 0 y 0 z 0 has norm 0; a unit quaternion"},
        RequestRow{"q_long",
                   {{kPlan + "T_base_camera.rotation", "{ w: 0 x: 1.0011 y: 0 z: 0 }"}},
                   "has norm 1.001; a unit quaternion has norm 1 ± 0.001"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Workspace, CorruptedRequest,
    ::testing::Values(
        RequestRow{"bin_pose_missing",
                   {{kPlan + "bin.T_base_bin", kClear}},
                   "plan.request.bin.T_base_bin: missing"},
        RequestRow{"bin_size_missing",
                   {{kPlan + "bin.inner_size_m", kClear}},
                   "plan.request.bin.inner_size_m: missing"},
        RequestRow{"bin_size_nan",
                   {{kPlan + "bin.inner_size_m.y", "nan"}},
                   "plan.request.bin.inner_size_m.y: nan"},
        RequestRow{"bin_flat", {{kPlan + "bin.inner_size_m.z", "0"}}, "every side must be above 0"},
        RequestRow{"bin_wall_nan",
                   {{kPlan + "bin.wall_thickness_m", "nan"}},
                   "plan.request.bin.wall_thickness_m: nan"},
        RequestRow{"bin_wall_negative",
                   {{kPlan + "bin.wall_thickness_m", "-0.01"}},
                   "plan.request.bin.wall_thickness_m: -0.01 is outside"},
        RequestRow{"bin_behind_the_camera",
                   {{kPlan + "T_base_camera.rotation", "{ w: 1 x: 0 y: 0 z: 0 }"},
                    {kPlan + "T_base_camera.translation_m.z", "50"}},
                   "plan.request.bin.T_base_bin: the bin's floor is"},
        RequestRow{"bin_and_crop_box",
                   {{kPlan + "crop_box", kBox}},
                   "plan.request.bin and crop_box are both given"},
        RequestRow{"box_pose_missing", crop_box({kPlan + "crop_box.T_base_box", kClear}),
                   "plan.request.crop_box.T_base_box: missing"},
        RequestRow{"box_size_missing", crop_box({kPlan + "crop_box.size_m", kClear}),
                   "plan.request.crop_box.size_m: missing"},
        RequestRow{"box_size_negative", crop_box({kPlan + "crop_box.size_m.x", "-1"}),
                   "plan.request.crop_box.size_m: -1"},
        RequestRow{
            "box_behind_the_camera",
            crop_box({kPlan + "crop_box.T_base_box.translation_m.z", "-2"}),
            "plan.request.crop_box.T_base_box: the box's centre is 1.000 m behind the camera"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Parts, CorruptedRequest,
    ::testing::Values(
        RequestRow{"none", {{kPlan + "parts", kClear}}, "plan.request.parts: none requested"},
        RequestRow{"too_many", times(31, {kPlan + "parts", "{ id: 'tee' }"}),
                   "plan.request.parts: 33 entries; at most 32 are taken"},
        RequestRow{
            "id_empty", {{kPlan + "parts[1].id", quoted("")}}, "plan.request.parts[1].id: empty"},
        RequestRow{"id_long",
                   {{kPlan + "parts[0].id", quoted(std::string(129, 'p'))}},
                   "plan.request.parts[0].id: a name of 129 bytes; at most 128 are taken"},
        RequestRow{"id_control",
                   {{kPlan + "parts[0].id", quoted("\\033[2J")}},
                   "plan.request.parts[0].id: control character 0x1b"},
        RequestRow{"priority_nan",
                   {{kPlan + "parts[1].priority", "nan"}},
                   "plan.request.parts[1].priority: nan"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    GripperAndOptions, CorruptedRequest,
    ::testing::Values(
        RequestRow{
            "gripper_missing", {{kPlan + "gripper", kClear}}, "plan.request.gripper: missing"},
        RequestRow{"kind_missing",
                   {{kGripper + "kind", kClear}},
                   "plan.request.gripper.kind: 0 is no gripper kind; say PARALLEL_JAW | SUCTION"},
        RequestRow{"kind_99", {{kGripper + "kind", "99"}}, "plan.request.gripper.kind: 99"},
        RequestRow{"min_nan", {{kGripper + "min_opening_m", "nan"}}, "gripper.min_opening_m: nan"},
        RequestRow{
            "min_negative", {{kGripper + "min_opening_m", "-0.1"}}, "gripper.min_opening_m: -0.1"},
        RequestRow{"max_nan", {{kGripper + "max_opening_m", "nan"}}, "gripper.max_opening_m: nan"},
        RequestRow{"max_85_mm",
                   {{kGripper + "max_opening_m", "85"}},
                   "gripper.max_opening_m: 85 is outside"},
        RequestRow{"max_below_min",
                   {{kGripper + "max_opening_m", "0.01"}},
                   "plan.request.gripper: max_opening_m 0.01 is not above min_opening_m"},
        RequestRow{
            "clearance_nan", {{kGripper + "clearance_m", "nan"}}, "gripper.clearance_m: nan"},
        RequestRow{"standoff_nan", {{kGripper + "standoff_m", "nan"}}, "gripper.standoff_m: nan"},
        RequestRow{"retreat_nan", {{kGripper + "retreat_m", "nan"}}, "gripper.retreat_m: nan"},
        RequestRow{
            "jaw_missing", {{kGripper + "jaw_size_m", kClear}}, "gripper.jaw_size_m: missing"},
        RequestRow{
            "jaw_0", {{kGripper + "jaw_size_m.x", "0"}}, "plan.request.gripper.jaw_size_m: 0 ×"},
        RequestRow{
            "palm_missing", {{kGripper + "palm_size_m", kClear}}, "gripper.palm_size_m: missing"},
        RequestRow{"palm_nan", {{kGripper + "palm_size_m.z", "nan"}}, "gripper.palm_size_m.z: nan"},
        RequestRow{
            "cup_nan", {{kGripper + "cup_diameter_m", "nan"}}, "gripper.cup_diameter_m: nan"},
        RequestRow{"suction_without_cup",
                   {{kGripper + "kind", "SUCTION"}, {kGripper + "cup_diameter_m", "0"}},
                   "plan.request.gripper.cup_diameter_m: a suction gripper needs a cup"},
        RequestRow{
            "segmentation_99",
            {{kPlan + "options.segmentation", "99"}},
            "plan.request.options.segmentation: 99 is no segmentation; say "
            "SEGMENTATION_UNSPECIFIED | IMPROVED_DBSCAN | DBSCAN | EUCLIDEAN | REGION_GROWING | "
            "GRID_DBSCAN"},
        RequestRow{"registration_99",
                   {{kPlan + "options.registration", "99"}},
                   "plan.request.options.registration: 99 is no registration"},
        RequestRow{"order_99", {{kPlan + "options.order", "99"}}, "options.order: 99 is no order"},
        RequestRow{
            "p_system_99", {{kPlan + "options.p_system", "99"}}, "options.p_system: 99 is no"},
        RequestRow{
            "strategy_99", {{kPlan + "options.strategy", "99"}}, "options.strategy: 99 is no"},
        RequestRow{"strategy_vector_nan",
                   {{kPlan + "options.strategy_vector_base_m.x", "nan"}},
                   "options.strategy_vector_base_m.x: nan"},
        RequestRow{"nearest_to_what",
                   {{kPlan + "options.strategy", "NEAREST"},
                    {kPlan + "options.strategy_vector_base_m", kClear}},
                   "options.strategy_vector_base_m: missing"},
        RequestRow{"approach_from_where",
                   {{kPlan + "options.strategy", "PREFERRED_APPROACH"},
                    {kPlan + "options.strategy_vector_base_m", kClear}},
                   "options.strategy_vector_base_m: missing"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Memory, CorruptedRequest,
    ::testing::Values(
        RequestRow{"objects_too_many", times(99, {kLast, "{}"}),
                   "plan.request.last_plan.objects: 101 entries; at most 100 are taken"},
        RequestRow{"id_twice",
                   {{kLast + "[1].id", "3"}},
                   "plan.request.last_plan.objects[1].id: 3 stands twice"},
        RequestRow{"part_control",
                   {{kLast + "[0].part_id", quoted("\\t")}},
                   "plan.request.last_plan.objects[0].part_id: control character 0x09"},
        RequestRow{"pose_missing",
                   {{kLast + "[1].T_base_part", kClear}},
                   "plan.request.last_plan.objects[1].T_base_part: missing"},
        RequestRow{
            "pose_skewed",
            {{kLast + "[0].T_base_part.rotation.z", "0.5"}},
            "plan.request.last_plan.objects[0].T_base_part.rotation: w 1 x 0 y 0 z 0.5 has norm"},
        RequestRow{"centroid_missing",
                   {{kLast + "[1].p_base_segment_centroid_m", kClear}},
                   "plan.request.last_plan.objects[1].p_base_segment_centroid_m: missing"},
        RequestRow{"centroid_nan",
                   {{kLast + "[1].p_base_segment_centroid_m.z", "nan"}},
                   "objects[1].p_base_segment_centroid_m.z: nan"},
        RequestRow{"score_nan", {{kLast + "[0].score", "nan"}}, "last_plan.objects[0].score: nan"},
        RequestRow{"visible_nan",
                   {{kLast + "[0].visible_fraction", "nan"}},
                   "last_plan.objects[0].visible_fraction: nan"},
        RequestRow{"spots_too_many", times(257, {kPlan + "failed_spots", "{}"}),
                   "entries; at most 256 are taken"},
        RequestRow{"spot_nowhere",
                   {{kPlan + "failed_spots[0].p_base_m", kClear}},
                   "plan.request.failed_spots[0].p_base_m: missing"},
        RequestRow{"spot_nan",
                   {{kPlan + "failed_spots[0].p_base_m.x", "nan"}},
                   "plan.request.failed_spots[0].p_base_m.x: nan"},
        RequestRow{"radius_0",
                   {{kPlan + "failed_spots[0].radius_m", "0"}},
                   "plan.request.failed_spots[0]: needs a finite point and a radius above 0"},
        RequestRow{"reason_control",
                   {{kPlan + "failed_spots[0].reason", quoted("\\n")}},
                   "plan.request.failed_spots[0].reason: control character 0x0a"},
        RequestRow{"radius_nan",
                   {{kPlan + "failed_spots[0].radius_m", "nan"}},
                   "plan.request.failed_spots[0].radius_m: nan"}),
    kRowName);

}  // namespace
}  // namespace graspd::testing

#include <gtest/gtest.h>

#include "graspd/codec/codec.hpp"
#include "random_messages.hpp"
#include "schema.hpp"

/// A valid request with exactly one thing wrong, for every check of the decoder.
namespace graspd::testing {
namespace {

struct Row {
  std::string name;
  std::vector<Edit> edits;
  std::string words;  ///< that the sentence must have: the field's path and what is wrong
  Code code = Code::kInvalidArgument;
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }

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

class CorruptedRequest : public ::testing::TestWithParam<Row> {};

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

const auto kRowName = [](const auto& row) { return row.param.name; };
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
        Row{"version_2",
            {{"protocol_version", "2"}},
            "protocol_version: 2; this server speaks 1",
            Code::kUnsupportedVersion},
        Row{"version_missing",
            {{"protocol_version", kClear}},
            "protocol_version: 0",
            Code::kUnsupportedVersion},
        Row{"id_missing", {{"id", kClear}}, "id: 0 bytes; an id has 16"},
        Row{"id_short", {{"id", quoted("123456789012345")}}, "id: 15 bytes; an id has 16"},
        Row{"id_long", {{"id", quoted("12345678901234567")}}, "id: 17 bytes; an id has 16"},
        Row{"attempt_0", {{"attempt", "0"}}, "attempt: 0; the first attempt is 1"},
        Row{"cell_long", {{"cell", quoted(std::string(129, 'c'))}}, "cell: a name of 129 bytes"},
        Row{"cell_newline", {{"cell", quoted("a\\nb")}}, "cell: control character 0x0a"},
        Row{"cell_delete", {{"cell", quoted("a\\177b")}}, "cell: control character 0x7f"},
        Row{"call_missing", {{"plan", kClear}}, "call: missing; one of plan and health"},
        Row{"frame_missing", {{"plan.frame", kClear}}, "plan.frame: missing"},
        Row{"request_missing", {{"plan.request", kClear}}, "plan.request: missing"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Frame, CorruptedRequest,
    ::testing::Values(
        Row{"camera_missing", {{kFrame + "camera", kClear}}, "plan.frame.camera: missing"},
        Row{"width_0",
            {{kFrame + "camera.width_px", "0"}},
            "plan.frame.camera: an image of 0 × 48"},
        Row{"height_negative", {{kFrame + "camera.height_px", "-48"}}, "64 × -48"},
        Row{"width_2049", {{kFrame + "camera.width_px", "2049"}}, "each side must be 8 … 2048"},
        Row{"fx_nan", {{kFrame + "camera.fx_px", "nan"}}, "plan.frame.camera.fx_px: nan"},
        Row{"fx_0", {{kFrame + "camera.fx_px", "0"}}, "plan.frame.camera.fx_px: 0"},
        Row{"fy_infinite", {{kFrame + "camera.fy_px", "inf"}}, "plan.frame.camera.fy_px: inf"},
        Row{"fy_negative", {{kFrame + "camera.fy_px", "-365"}}, "plan.frame.camera.fy_px: -365"},
        Row{"cx_nan", {{kFrame + "camera.cx_px", "nan"}}, "plan.frame.camera.cx_px: nan"},
        Row{"cy_nan", {{kFrame + "camera.cy_px", "nan"}}, "plan.frame.camera.cy_px: nan"},
        Row{"cx_outside",
            {{kFrame + "camera.cx_px", "1000"}},
            "plan.frame.camera: principal point"},
        Row{"k1_nan", {{kFrame + "camera.distortion.k1", "nan"}}, "camera.distortion.k1: nan"},
        Row{"k2_nan", {{kFrame + "camera.distortion.k2", "nan"}}, "camera.distortion.k2: nan"},
        Row{"p1_nan", {{kFrame + "camera.distortion.p1", "nan"}}, "camera.distortion.p1: nan"},
        Row{"p2_nan", {{kFrame + "camera.distortion.p2", "nan"}}, "camera.distortion.p2: nan"},
        Row{"k3_nan", {{kFrame + "camera.distortion.k3", "nan"}}, "camera.distortion.k3: nan"},
        Row{"k3_huge", {{kFrame + "camera.distortion.k3", "101"}}, "camera.distortion: 101"},
        Row{"scale_nan", {{kFrame + "depth_scale_m", "nan"}}, "plan.frame.depth_scale_m: nan"},
        Row{"scale_0", {{kFrame + "depth_scale_m", "0"}}, "plan.frame.depth_scale_m: 0 m per unit"},
        Row{"encoding_missing",
            {{kFrame + "encoding", kClear}},
            "plan.frame.encoding: 0 is no depth encoding; say RAW | RVL"},
        Row{"encoding_99", {{kFrame + "encoding", "99"}}, "plan.frame.encoding: 99"},
        Row{"payload_0", {{kFrame + "payload_bytes", "0"}}, "plan.frame.payload_bytes: 0"},
        Row{"payload_not_the_image",
            {{kFrame + "payload_bytes", "6142"}},
            "plan.frame.payload_bytes: 6142; 64 × 48 pixels of 2 bytes are 6144"},
        Row{"payload_too_large",
            {{kFrame + "payload_bytes", "1048577"}},
            "plan.frame.payload_bytes: 1048577; 1 … 1048576 are taken"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Poses, CorruptedRequest,
    ::testing::Values(
        Row{"missing", {{kPlan + "T_base_camera", kClear}}, "plan.request.T_base_camera: missing"},
        Row{"no_translation",
            {{kPlan + "T_base_camera.translation_m", kClear}},
            "plan.request.T_base_camera.translation_m: missing"},
        Row{"no_rotation",
            {{kPlan + "T_base_camera.rotation", kClear}},
            "plan.request.T_base_camera.rotation: missing"},
        Row{"x_nan",
            {{kPlan + "T_base_camera.translation_m.x", "nan"}},
            "plan.request.T_base_camera.translation_m.x: nan"},
        Row{"y_nan", {{kPlan + "T_base_camera.translation_m.y", "nan"}}, "translation_m.y: nan"},
        Row{"z_infinite",
            {{kPlan + "T_base_camera.translation_m.z", "-inf"}},
            "translation_m.z: -inf"},
        Row{"millimetres",
            {{kPlan + "T_base_camera.translation_m.z", "750"}},
            "plan.request.T_base_camera: 750 m from the origin; poses are in metres"},
        Row{"w_nan",
            {{kPlan + "T_base_camera.rotation.w", "nan"}},
            "plan.request.T_base_camera.rotation.w: nan"},
        Row{"q_x_nan", {{kPlan + "T_base_camera.rotation.x", "nan"}}, "rotation.x: nan"},
        Row{"q_y_nan", {{kPlan + "T_base_camera.rotation.y", "nan"}}, "rotation.y: nan"},
        Row{"q_z_nan", {{kPlan + "T_base_camera.rotation.z", "nan"}}, "rotation.z: nan"},
        Row{"q_zero",
            {{kPlan + "T_base_camera.rotation", kClear}, {kPlan + "T_base_camera.rotation", "{}"}},
            "plan.request.T_base_camera.rotation: w 0 x 0 y 0 z 0 has norm 0; a unit quaternion"},
        Row{"q_long",
            {{kPlan + "T_base_camera.rotation", "{ w: 0 x: 1.0011 y: 0 z: 0 }"}},
            "has norm 1.001; a unit quaternion has norm 1 ± 0.001"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Workspace, CorruptedRequest,
    ::testing::Values(
        Row{"bin_pose_missing",
            {{kPlan + "bin.T_base_bin", kClear}},
            "plan.request.bin.T_base_bin: missing"},
        Row{"bin_size_missing",
            {{kPlan + "bin.inner_size_m", kClear}},
            "plan.request.bin.inner_size_m: missing"},
        Row{"bin_size_nan",
            {{kPlan + "bin.inner_size_m.y", "nan"}},
            "plan.request.bin.inner_size_m.y: nan"},
        Row{"bin_flat", {{kPlan + "bin.inner_size_m.z", "0"}}, "every side must be above 0"},
        Row{"bin_wall_nan",
            {{kPlan + "bin.wall_thickness_m", "nan"}},
            "plan.request.bin.wall_thickness_m: nan"},
        Row{"bin_wall_negative",
            {{kPlan + "bin.wall_thickness_m", "-0.01"}},
            "plan.request.bin.wall_thickness_m: -0.01 is outside"},
        Row{"bin_behind_the_camera",
            {{kPlan + "T_base_camera.rotation", "{ w: 1 x: 0 y: 0 z: 0 }"},
             {kPlan + "T_base_camera.translation_m.z", "50"}},
            "plan.request.bin.T_base_bin: the bin's floor is"},
        Row{"bin_and_crop_box",
            {{kPlan + "crop_box", kBox}},
            "plan.request.bin and crop_box are both given"},
        Row{"box_pose_missing", crop_box({kPlan + "crop_box.T_base_box", kClear}),
            "plan.request.crop_box.T_base_box: missing"},
        Row{"box_size_missing", crop_box({kPlan + "crop_box.size_m", kClear}),
            "plan.request.crop_box.size_m: missing"},
        Row{"box_size_negative", crop_box({kPlan + "crop_box.size_m.x", "-1"}),
            "plan.request.crop_box.size_m: -1"},
        Row{"box_behind_the_camera",
            crop_box({kPlan + "crop_box.T_base_box.translation_m.z", "-2"}),
            "plan.request.crop_box.T_base_box: the box's centre is 1.000 m behind the camera"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Parts, CorruptedRequest,
    ::testing::Values(
        Row{"none", {{kPlan + "parts", kClear}}, "plan.request.parts: none requested"},
        Row{"too_many", times(31, {kPlan + "parts", "{ id: 'tee' }"}),
            "plan.request.parts: 33 entries; at most 32 are taken"},
        Row{"id_empty", {{kPlan + "parts[1].id", quoted("")}}, "plan.request.parts[1].id: empty"},
        Row{"id_long",
            {{kPlan + "parts[0].id", quoted(std::string(129, 'p'))}},
            "plan.request.parts[0].id: a name of 129 bytes; at most 128 are taken"},
        Row{"id_control",
            {{kPlan + "parts[0].id", quoted("\\033[2J")}},
            "plan.request.parts[0].id: control character 0x1b"},
        Row{"priority_nan",
            {{kPlan + "parts[1].priority", "nan"}},
            "plan.request.parts[1].priority: nan"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    GripperAndOptions, CorruptedRequest,
    ::testing::Values(
        Row{"gripper_missing", {{kPlan + "gripper", kClear}}, "plan.request.gripper: missing"},
        Row{"kind_missing",
            {{kGripper + "kind", kClear}},
            "plan.request.gripper.kind: 0 is no gripper kind; say PARALLEL_JAW | SUCTION"},
        Row{"kind_99", {{kGripper + "kind", "99"}}, "plan.request.gripper.kind: 99"},
        Row{"min_nan", {{kGripper + "min_opening_m", "nan"}}, "gripper.min_opening_m: nan"},
        Row{"min_negative", {{kGripper + "min_opening_m", "-0.1"}}, "gripper.min_opening_m: -0.1"},
        Row{"max_nan", {{kGripper + "max_opening_m", "nan"}}, "gripper.max_opening_m: nan"},
        Row{"max_85_mm",
            {{kGripper + "max_opening_m", "85"}},
            "gripper.max_opening_m: 85 is outside"},
        Row{"max_below_min",
            {{kGripper + "max_opening_m", "0.01"}},
            "plan.request.gripper: max_opening_m 0.01 is not above min_opening_m"},
        Row{"clearance_nan", {{kGripper + "clearance_m", "nan"}}, "gripper.clearance_m: nan"},
        Row{"standoff_nan", {{kGripper + "standoff_m", "nan"}}, "gripper.standoff_m: nan"},
        Row{"retreat_nan", {{kGripper + "retreat_m", "nan"}}, "gripper.retreat_m: nan"},
        Row{"jaw_missing", {{kGripper + "jaw_size_m", kClear}}, "gripper.jaw_size_m: missing"},
        Row{"jaw_0", {{kGripper + "jaw_size_m.x", "0"}}, "plan.request.gripper.jaw_size_m: 0 ×"},
        Row{"palm_missing", {{kGripper + "palm_size_m", kClear}}, "gripper.palm_size_m: missing"},
        Row{"palm_nan", {{kGripper + "palm_size_m.z", "nan"}}, "gripper.palm_size_m.z: nan"},
        Row{"cup_nan", {{kGripper + "cup_diameter_m", "nan"}}, "gripper.cup_diameter_m: nan"},
        Row{"suction_without_cup",
            {{kGripper + "kind", "SUCTION"}, {kGripper + "cup_diameter_m", "0"}},
            "plan.request.gripper.cup_diameter_m: a suction gripper needs a cup"},
        Row{"segmentation_99",
            {{kPlan + "options.segmentation", "99"}},
            "plan.request.options.segmentation: 99 is no segmentation; say "
            "SEGMENTATION_UNSPECIFIED | IMPROVED_DBSCAN | DBSCAN | EUCLIDEAN | REGION_GROWING | "
            "GRID_DBSCAN"},
        Row{"registration_99",
            {{kPlan + "options.registration", "99"}},
            "plan.request.options.registration: 99 is no registration"},
        Row{"order_99", {{kPlan + "options.order", "99"}}, "options.order: 99 is no order"},
        Row{"p_system_99", {{kPlan + "options.p_system", "99"}}, "options.p_system: 99 is no"},
        Row{"strategy_99", {{kPlan + "options.strategy", "99"}}, "options.strategy: 99 is no"},
        Row{"strategy_vector_nan",
            {{kPlan + "options.strategy_vector_base_m.x", "nan"}},
            "options.strategy_vector_base_m.x: nan"},
        Row{"nearest_to_what",
            {{kPlan + "options.strategy", "NEAREST"},
             {kPlan + "options.strategy_vector_base_m", kClear}},
            "options.strategy_vector_base_m: missing"},
        Row{"approach_from_where",
            {{kPlan + "options.strategy", "PREFERRED_APPROACH"},
             {kPlan + "options.strategy_vector_base_m", kClear}},
            "options.strategy_vector_base_m: missing"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Memory, CorruptedRequest,
    ::testing::Values(
        Row{"objects_too_many", times(99, {kLast, "{}"}),
            "plan.request.last_plan.objects: 101 entries; at most 100 are taken"},
        Row{"id_twice",
            {{kLast + "[1].id", "3"}},
            "plan.request.last_plan.objects[1].id: 3 stands twice"},
        Row{"part_control",
            {{kLast + "[0].part_id", quoted("\\t")}},
            "plan.request.last_plan.objects[0].part_id: control character 0x09"},
        Row{"pose_missing",
            {{kLast + "[1].T_base_part", kClear}},
            "plan.request.last_plan.objects[1].T_base_part: missing"},
        Row{"pose_skewed",
            {{kLast + "[0].T_base_part.rotation.z", "0.5"}},
            "plan.request.last_plan.objects[0].T_base_part.rotation: w 1 x 0 y 0 z 0.5 has norm"},
        Row{"centroid_missing",
            {{kLast + "[1].p_base_segment_centroid_m", kClear}},
            "plan.request.last_plan.objects[1].p_base_segment_centroid_m: missing"},
        Row{"centroid_nan",
            {{kLast + "[1].p_base_segment_centroid_m.z", "nan"}},
            "objects[1].p_base_segment_centroid_m.z: nan"},
        Row{"score_nan", {{kLast + "[0].score", "nan"}}, "last_plan.objects[0].score: nan"},
        Row{"visible_nan",
            {{kLast + "[0].visible_fraction", "nan"}},
            "last_plan.objects[0].visible_fraction: nan"},
        Row{"spots_too_many", times(257, {kPlan + "failed_spots", "{}"}),
            "entries; at most 256 are taken"},
        Row{"spot_nowhere",
            {{kPlan + "failed_spots[0].p_base_m", kClear}},
            "plan.request.failed_spots[0].p_base_m: missing"},
        Row{"spot_nan",
            {{kPlan + "failed_spots[0].p_base_m.x", "nan"}},
            "plan.request.failed_spots[0].p_base_m.x: nan"},
        Row{"radius_0",
            {{kPlan + "failed_spots[0].radius_m", "0"}},
            "plan.request.failed_spots[0]: needs a finite point and a radius above 0"},
        Row{"reason_control",
            {{kPlan + "failed_spots[0].reason", quoted("\\n")}},
            "plan.request.failed_spots[0].reason: control character 0x0a"},
        Row{"radius_nan",
            {{kPlan + "failed_spots[0].radius_m", "nan"}},
            "plan.request.failed_spots[0].radius_m: nan"}),
    kRowName);

}  // namespace
}  // namespace graspd::testing

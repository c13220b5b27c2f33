#include <gtest/gtest.h>

#include "graspd/codec/codec.hpp"
#include "random_messages.hpp"
#include "schema.hpp"

/// A valid answer with exactly one thing wrong, for every check of the decoder.
namespace graspd::testing {
namespace {

enum class Kind { kPlan, kHealth, kRefusal };

struct AnswerRow {
  std::string name;
  Kind kind;
  std::vector<Edit> edits;
  std::string words;  ///< that the sentence must have: the field's path and what is wrong
};

void PrintTo(const AnswerRow& row, std::ostream* out) { *out << row.name; }

/// Every field set, two objects with ids 1 and 2, PLANNED.
Answer valid_answer(Kind kind) {
  RandomMessages random(42);
  if (kind == Kind::kHealth) return random.health_answer();
  if (kind == Kind::kRefusal) return random.refusal();
  PlanAnswer plan = random.any_plan_answer();
  plan.outcome = Outcome::kPlanned;
  plan.objects.resize(1);
  plan.objects[0].id = 1;
  plan.objects.push_back(plan.objects[0]);
  plan.objects[1].id = 2;
  for (Object& object : plan.objects) {
    object.lies_on_ids = object.supports_ids = {1};
    object.entangled_ids = object.double_pick_ids = {1};
    object.grs.neighbour_ids = object.grs.overlap_ids = {2};
  }
  for (auto* grasps : {&plan.grasps, &plan.rejected_grasps}) {
    for (Grasp& grasp : *grasps) grasp.object_id = 2;
  }
  Answer answer = random.plan_answer();
  answer.body = plan;
  return answer;
}

class CorruptedAnswer : public ::testing::TestWithParam<AnswerRow> {};

TEST_P(CorruptedAnswer, IsInternalWithASentence) {
  const std::string valid = codec::encode_answer(valid_answer(GetParam().kind));
  ASSERT_TRUE(codec::decode_answer(as_bytes(valid)))
      << codec::decode_answer(as_bytes(valid)).error().message;
  const std::string corrupted = schema::edit("Answer", valid, GetParam().edits);
  const auto decoded = codec::decode_answer(as_bytes(corrupted));
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, Code::kInternal);
  EXPECT_NE(decoded.error().message.find("broken answer: "), std::string::npos);
  EXPECT_NE(decoded.error().message.find(GetParam().words), std::string::npos)
      << decoded.error().message;
}

std::vector<AnswerRow> rows_of_one_number(const std::string& parent,
                                          const std::vector<std::string>& names) {
  std::vector<AnswerRow> rows;
  for (const std::string& name : names) {
    const std::string path = parent + name;
    rows.push_back({name, Kind::kPlan, {{path, "nan"}}, path + ": nan is not a finite number"});
  }
  return rows;
}

const std::string kObject = "plan.objects[1].";
const std::string kGrasp = "plan.grasps[0].";

INSTANTIATE_TEST_SUITE_P(
    Envelope, CorruptedAnswer,
    ::testing::Values(
        AnswerRow{"version_2",
                  Kind::kPlan,
                  {{"protocol_version", "2"}},
                  "protocol_version: 2; this client speaks 1"},
        AnswerRow{"id_short", Kind::kPlan, {{"id", "\"123\""}}, "id: 3 bytes; an id has 16"},
        AnswerRow{"code_missing",
                  Kind::kRefusal,
                  {{"code", kClear}},
                  "code: 0 is no code; say OK | INVALID_ARGUMENT | UNSUPPORTED_VERSION"},
        AnswerRow{"code_99", Kind::kRefusal, {{"code", "99"}}, "code: 99 is no code"},
        AnswerRow{
            "refusal_with_body", Kind::kPlan, {{"code", "BUSY"}}, "body: given with code BUSY"},
        AnswerRow{
            "ok_without_body", Kind::kRefusal, {{"code", "OK"}}, "body: missing with code OK"},
        AnswerRow{
            "refusal_without_message", Kind::kRefusal, {{"message", kClear}}, "message: empty"},
        AnswerRow{"state_missing",
                  Kind::kHealth,
                  {{"health.state", kClear}},
                  "health.state: 0 is no server state; say STARTING | READY | DRAINING"},
        AnswerRow{"state_99", Kind::kHealth, {{"health.state", "99"}}, "health.state: 99"},
        AnswerRow{
            "uptime_nan", Kind::kHealth, {{"health.uptime_s", "nan"}}, "health.uptime_s: nan"},
        AnswerRow{
            "server_missing", Kind::kHealth, {{"health.server", kClear}}, "health.server: missing"},
        AnswerRow{"counted_code_missing",
                  Kind::kHealth,
                  {{"health.answers_by_code[0].code", kClear}},
                  "health.answers_by_code[0].code: 0 is no code; say OK"},
        AnswerRow{"counted_code_99",
                  Kind::kHealth,
                  {{"health.answers_by_code[0].code", "99"}},
                  "health.answers_by_code[0].code: 99 is no code"},
        AnswerRow{"counted_stage_newline",
                  Kind::kHealth,
                  {{"health.stages[0].stage", "\"\\n\""}},
                  "health.stages[0].stage: control character 0x0a"},
        AnswerRow{"server_build",
                  Kind::kHealth,
                  {{"health.server.build", "\"\\n\""}},
                  "health.server.build: control character 0x0a"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Plan, CorruptedAnswer,
    ::testing::Values(
        AnswerRow{"outcome_missing",
                  Kind::kPlan,
                  {{"plan.outcome", kClear}},
                  "plan.outcome: 0 is no outcome; say PLANNED | UNCHANGED"},
        AnswerRow{"outcome_99", Kind::kPlan, {{"plan.outcome", "99"}}, "plan.outcome: 99"},
        AnswerRow{"no_without_reason",
                  Kind::kPlan,
                  {{"plan.outcome", "BIN_EMPTY"}, {"plan.reason", kClear}},
                  "plan.reason: empty; outcome BIN_EMPTY needs a sentence"},
        AnswerRow{"funnel_missing", Kind::kPlan, {{"plan.funnel", kClear}}, "plan.funnel: missing"},
        AnswerRow{
            "fill_level_nan", Kind::kPlan, {{"plan.fill_level", "nan"}}, "plan.fill_level: nan"},
        AnswerRow{
            "bin_drift_nan", Kind::kPlan, {{"plan.bin_drift_m", "nan"}}, "plan.bin_drift_m: nan"},
        AnswerRow{"stage_newline",
                  Kind::kPlan,
                  {{"plan.timings[0].stage", "\"\\n\""}},
                  "plan.timings[0].stage: control character"},
        AnswerRow{"server_missing", Kind::kPlan, {{"plan.server", kClear}}, "plan.server: missing"},
        AnswerRow{"catalogue_hash_long",
                  Kind::kPlan,
                  {{"plan.server.catalogue_hash", '"' + std::string(129, 'f') + '"'}},
                  "plan.server.catalogue_hash: a name of 129 bytes"},
        AnswerRow{"config_hash_long",
                  Kind::kPlan,
                  {{"plan.server.config_hash", '"' + std::string(129, 'f') + '"'}},
                  "plan.server.config_hash: a name of 129 bytes"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    Object, CorruptedAnswer,
    ::testing::Values(
        AnswerRow{"id_twice",
                  Kind::kPlan,
                  {{kObject + "id", "1"}},
                  "plan.objects: id 1 stands twice; ids are unique"},
        AnswerRow{"part_control",
                  Kind::kPlan,
                  {{kObject + "part_id", "\"\\033\""}},
                  "plan.objects[1].part_id: control character"},
        AnswerRow{"pose_missing",
                  Kind::kPlan,
                  {{kObject + "T_base_part", kClear}},
                  "plan.objects[1].T_base_part: missing"},
        AnswerRow{"pose_skewed",
                  Kind::kPlan,
                  {{kObject + "T_base_part.rotation.w", "2"}},
                  "plan.objects[1].T_base_part.rotation: w 2"},
        AnswerRow{"centroid_missing",
                  Kind::kPlan,
                  {{kObject + "p_base_segment_centroid_m", kClear}},
                  "plan.objects[1].p_base_segment_centroid_m: missing"},
        AnswerRow{"lies_on_nobody",
                  Kind::kPlan,
                  {{kObject + "lies_on_ids", "7"}},
                  "plan.objects[1].lies_on_ids[1]: 7 is the id of none of the answer's objects"},
        AnswerRow{"supports_nobody",
                  Kind::kPlan,
                  {{kObject + "supports_ids", "7"}},
                  "plan.objects[1].supports_ids[1]: 7"},
        AnswerRow{"entangled_with_nobody",
                  Kind::kPlan,
                  {{kObject + "entangled_ids", "7"}},
                  "plan.objects[1].entangled_ids[1]: 7"},
        AnswerRow{"takes_nobody_along",
                  Kind::kPlan,
                  {{kObject + "double_pick_ids", "7"}},
                  "plan.objects[1].double_pick_ids[1]: 7"},
        AnswerRow{"grs_missing",
                  Kind::kPlan,
                  {{kObject + "grs", kClear}},
                  "plan.objects[1].grs: missing"},
        AnswerRow{"neighbour_of_nobody",
                  Kind::kPlan,
                  {{kObject + "grs.neighbour_ids", "7"}},
                  "plan.objects[1].grs.neighbour_ids[1]: 7"},
        AnswerRow{"overlaps_nobody",
                  Kind::kPlan,
                  {{kObject + "grs.overlap_ids", "7"}},
                  "plan.objects[1].grs.overlap_ids[1]: 7"},
        AnswerRow{"outline_odd",
                  Kind::kPlan,
                  {{kObject + "outline_px", "1"}},
                  "plan.objects[1].outline_px: "},
        AnswerRow{"outline_nan",
                  Kind::kPlan,
                  {{kObject + "outline_px", kClear},
                   {kObject + "outline_px", "1"},
                   {kObject + "outline_px", "nan"}},
                  "plan.objects[1].outline_px[1]: nan"}),
    kRowName);

INSTANTIATE_TEST_SUITE_P(
    ObjectNumber, CorruptedAnswer,
    ::testing::ValuesIn(rows_of_one_number(kObject, {"score", "visible_fraction", "inlier_fraction",
                                                     "refuted_fraction", "rms_m"})),
    kRowName);
INSTANTIATE_TEST_SUITE_P(GrsNumber, CorruptedAnswer,
                         ::testing::ValuesIn(rows_of_one_number(
                             kObject + "grs.", {"grs", "p_self", "p_grasp", "p_system", "height_m",
                                                "inclination_rad"})),
                         kRowName);
INSTANTIATE_TEST_SUITE_P(GraspNumber, CorruptedAnswer,
                         ::testing::ValuesIn(rows_of_one_number(kGrasp,
                                                                {"opening_width_m", "standoff_m",
                                                                 "retreat_m", "room_m", "score"})),
                         kRowName);

INSTANTIATE_TEST_SUITE_P(
    Grasp, CorruptedAnswer,
    ::testing::Values(
        AnswerRow{"of_nobody",
                  Kind::kPlan,
                  {{kGrasp + "object_id", "7"}},
                  "plan.grasps[0].object_id: 7 is the id of none of the answer's objects"},
        AnswerRow{"rejected_of_nobody",
                  Kind::kPlan,
                  {{"plan.rejected_grasps[0].object_id", "7"}},
                  "plan.rejected_grasps[0].object_id: 7"},
        AnswerRow{"pick_point_control",
                  Kind::kPlan,
                  {{kGrasp + "pick_point", "\"\\n\""}},
                  "plan.grasps[0].pick_point: control character"},
        AnswerRow{"pose_missing",
                  Kind::kPlan,
                  {{kGrasp + "T_base_grasp", kClear}},
                  "plan.grasps[0].T_base_grasp: missing"},
        AnswerRow{"pose_nan",
                  Kind::kPlan,
                  {{kGrasp + "T_base_grasp.translation_m.x", "nan"}},
                  "plan.grasps[0].T_base_grasp.translation_m.x: nan"},
        AnswerRow{"check_missing",
                  Kind::kPlan,
                  {{kGrasp + "checks[0].check", kClear}},
                  "plan.grasps[0].checks[0].check: 0 is no check; say OPENING | GRIPPER_CLOUD"},
        AnswerRow{
            "check_99", Kind::kPlan, {{kGrasp + "checks[0].check", "99"}}, "checks[0].check: 99"},
        AnswerRow{
            "check_state_missing",
            Kind::kPlan,
            {{kGrasp + "checks[0].state", kClear}},
            "plan.grasps[0].checks[0].state: 0 is no check state; say PASSED | FAILED | NOT_RUN"}),
    kRowName);

TEST(Answer, ServersOfOtherVersionsCanSaySo) {
  Answer refusal = valid_answer(Kind::kRefusal);
  refusal.code = Code::kUnsupportedVersion;
  const std::string bytes =
      schema::edit("Answer", codec::encode_answer(refusal), {{"protocol_version", "2"}});
  const auto decoded = codec::decode_answer(as_bytes(bytes));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->code, Code::kUnsupportedVersion);
  EXPECT_EQ(decoded->message, refusal.message);
}

}  // namespace
}  // namespace graspd::testing

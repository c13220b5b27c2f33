#pragma once

#include <numbers>
#include <random>

#include "fields.hpp"

namespace graspd::testing {

/// Random messages that are valid and have every field set, to something other than its default
/// wherever it may be. The same seed makes the same messages.
class RandomMessages {
 public:
  explicit RandomMessages(std::uint64_t seed) : rng_(seed) {}

  Request plan_request() { return request(PlanCall{any_frame_description(), any_plan()}); }
  Request health_request() { return request(HealthCall{}); }
  /// Either of the two.
  Request any_request() { return flip() ? plan_request() : health_request(); }

  PlanRequest any_plan();
  /// A frame of noise around a metre, with some pixels that have no reading.
  DepthFrame any_depth_frame();
  FrameDescription any_frame_description();

  PlanAnswer any_plan_answer();
  HealthAnswer any_health_answer();
  Answer plan_answer() { return answer(any_plan_answer()); }
  Answer health_answer() { return answer(any_health_answer()); }
  Answer refusal();
  /// Any of the three.
  Answer any_answer();

  int integer(int low, int high) { return std::uniform_int_distribution(low, high)(rng_); }
  double number(double low, double high) { return std::uniform_real_distribution(low, high)(rng_); }
  bool flip() { return integer(0, 1) == 1; }
  Eigen::Isometry3d pose();

 private:
  template <class T>
  T any() {
    T value{};
    fill(value);
    return value;
  }

  void fill(double& value) { value = number(0.1, 0.9); }
  void fill(float& value) { value = static_cast<float>(number(0.1, 500)); }
  void fill(int& value) { value = integer(16, 500); }
  void fill(std::uint8_t& value) { value = static_cast<std::uint8_t>(integer(1, 255)); }
  void fill(std::uint32_t& value) { value = static_cast<std::uint32_t>(integer(1, 1'000'000)); }
  void fill(std::uint64_t& value) { value = rng_() | 1; }
  void fill(std::int64_t& value) { value = 1 + static_cast<std::int64_t>(rng_() >> 20); }
  void fill(bool& value) { value = true; }
  void fill(Eigen::Vector3d& value) { value = {any<double>(), any<double>(), any<double>()}; }
  void fill(Eigen::Isometry3d& value) { value = pose(); }
  void fill(std::string& value) {
    value.resize(static_cast<std::size_t>(integer(1, 12)));
    for (char& c : value) c = static_cast<char>(integer('a', 'z'));
  }
  template <class T>
  void fill(std::optional<T>& value) {
    value = any<T>();
  }
  template <class T>
  void fill(std::vector<T>& values) {
    values.resize(static_cast<std::size_t>(integer(1, 3)));
    for (T& value : values) fill(value);
  }
  template <class T, std::size_t n>
  void fill(std::array<T, n>& values) {
    for (T& value : values) fill(value);
  }
  template <class E>
  requires std::is_enum_v<E>
  void fill(E& value) {
    const auto& values = EnumNames<E>::values;
    value = values[integer(0, static_cast<int>(std::size(values)) - 1)].first;
  }
  template <class S>
  requires requires(S& s) { fields(s); }
  void fill(S& value) {
    std::apply([this](auto&... field) { (fill(field), ...); }, fields(value));
  }

  Request request(std::variant<PlanCall, HealthCall> call);
  Answer answer(std::variant<std::monostate, PlanAnswer, HealthAnswer> body);
  CameraIntrinsics any_camera();

  std::mt19937_64 rng_;
};

inline Eigen::Isometry3d RandomMessages::pose() {
  const Eigen::Vector3d axis(number(-1, 1), number(-1, 1), number(0.1, 1));
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translate(Eigen::Vector3d(number(-1, 1), number(-1, 1), number(-1, 1)));
  T.rotate(Eigen::AngleAxisd(number(-3, 3), axis.normalized()));
  return T;
}

inline CameraIntrinsics RandomMessages::any_camera() {
  auto camera = any<CameraIntrinsics>();
  camera.fx_px = number(200, 1000);
  camera.fy_px = number(200, 1000);
  camera.cx_px = number(0, camera.width_px);
  camera.cy_px = number(0, camera.height_px);
  return camera;
}

inline FrameDescription RandomMessages::any_frame_description() {
  FrameDescription frame{.camera = any_camera()};
  frame.depth_scale_m = number(1e-4, 1e-2);
  frame.encoding = any<DepthEncoding>();
  frame.payload_bytes = any<std::uint32_t>();
  if (frame.encoding == DepthEncoding::kRaw) {
    frame.payload_bytes =
        static_cast<std::uint32_t>(2 * frame.camera.width_px * frame.camera.height_px);
  }
  frame.payload_crc32 = static_cast<std::uint32_t>(rng_()) | 1;
  return frame;
}

inline DepthFrame RandomMessages::any_depth_frame() {
  DepthFrame frame{.camera = any_camera(), .depth_scale_m = number(1e-4, 1e-2), .depth = {}};
  frame.depth.resize(static_cast<std::size_t>(frame.camera.width_px) *
                     static_cast<std::size_t>(frame.camera.height_px));
  for (auto& z : frame.depth) {
    z = static_cast<std::uint16_t>(integer(0, 9) == 0 ? 0 : integer(990, 1010));
  }
  return frame;
}

inline PlanRequest RandomMessages::any_plan() {
  auto plan = any<PlanRequest>();
  Eigen::Isometry3d T_base_workspace = pose();
  T_base_workspace.translation() = plan.T_base_camera * Eigen::Vector3d(0, 0, number(0.5, 2));
  if (flip()) {
    plan.bin->T_base_bin = T_base_workspace;
    plan.crop_box.reset();
  } else {
    plan.crop_box->T_base_box = T_base_workspace;
    plan.bin.reset();
  }
  plan.gripper.max_opening_m = plan.gripper.min_opening_m + 0.1;
  std::uint32_t id = 0;
  for (LastObject& object : plan.last_plan->objects) {
    object.id = id += static_cast<std::uint32_t>(integer(1, 9));
  }
  return plan;
}

inline PlanAnswer RandomMessages::any_plan_answer() {
  auto answer = any<PlanAnswer>();
  std::uint32_t last_id = 0;
  for (Object& object : answer.objects) {
    object.id = last_id += static_cast<std::uint32_t>(integer(1, 9));
    object.outline_px.resize(2 * object.outline_px.size(), 0.5f);
  }
  const auto lead_to_an_object = [&](std::uint32_t& id) {
    id = answer
             .objects[static_cast<std::size_t>(
                 integer(0, static_cast<int>(answer.objects.size()) - 1))]
             .id;
  };
  for (Object& object : answer.objects) {
    for (auto* ids :
         {&object.lies_on_ids, &object.supports_ids, &object.entangled_ids, &object.double_pick_ids,
          &object.grs.neighbour_ids, &object.grs.overlap_ids}) {
      for (auto& id : *ids) lead_to_an_object(id);
    }
  }
  for (Grasp& grasp : answer.grasps) lead_to_an_object(grasp.object_id);
  for (Grasp& grasp : answer.rejected_grasps) lead_to_an_object(grasp.object_id);
  return answer;
}

inline HealthAnswer RandomMessages::any_health_answer() {
  auto answer = any<HealthAnswer>();
  for (CodeCount& count : answer.answers_by_code) {
    if (count.code == Code::kUnavailable) count.code = Code::kBusy;  // never on the wire
  }
  return answer;
}

inline Request RandomMessages::request(std::variant<PlanCall, HealthCall> call) {
  return {.id = any<RequestId>(),
          .attempt = any<std::uint32_t>(),
          .cell = any<std::string>(),
          .budget_ms = any<std::uint32_t>(),
          .call = std::move(call)};
}

inline Answer RandomMessages::answer(std::variant<std::monostate, PlanAnswer, HealthAnswer> body) {
  return {.id = any<RequestId>(),
          .code = Code::kOk,
          .message = any<std::string>(),
          .retry_after_ms = any<std::uint32_t>(),
          .body = std::move(body)};
}

inline Answer RandomMessages::refusal() {
  Answer refusal = answer(std::monostate{});
  const auto last_on_wire = static_cast<int>(Code::kInternal);
  refusal.code = static_cast<Code>(integer(static_cast<int>(Code::kOk) + 1, last_on_wire));
  return refusal;
}

inline Answer RandomMessages::any_answer() {
  switch (integer(0, 2)) {
    case 0:
      return plan_answer();
    case 1:
      return health_answer();
    default:
      return refusal();
  }
}

}  // namespace graspd::testing

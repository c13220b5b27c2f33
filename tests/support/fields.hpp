#pragma once

#include <tuple>

#include "graspd/types/envelope.hpp"

/// The fields of every struct that crosses the wire, in their order. Structured bindings make it
/// complete: a struct that gains a field does not compile here until the field is added.
namespace graspd::testing {

inline auto fields(CameraIntrinsics& s) {
  auto& [a, b, c, d, e, f, g] = s;
  return std::tie(a, b, c, d, e, f, g);
}
inline auto fields(FrameDescription& s) {
  auto& [a, b, c, d, e] = s;
  return std::tie(a, b, c, d, e);
}
inline auto fields(DepthFrame& s) {
  auto& [a, b, c, stays_in_the_cell] = s;
  return std::tie(a, b, c);
}
inline auto fields(Bin& s) {
  auto& [a, b, c] = s;
  return std::tie(a, b, c);
}
inline auto fields(CropBox& s) {
  auto& [a, b] = s;
  return std::tie(a, b);
}
inline auto fields(Gripper& s) {
  auto& [a, b, c, d, e, f, g, h, i] = s;
  return std::tie(a, b, c, d, e, f, g, h, i);
}
inline auto fields(RequestedPart& s) {
  auto& [a, b] = s;
  return std::tie(a, b);
}
inline auto fields(PlanOptions& s) {
  auto& [a, b, c, d, e, f, g, h, i, j] = s;
  return std::tie(a, b, c, d, e, f, g, h, i, j);
}
inline auto fields(LastObject& s) {
  auto& [a, b, c, d, e, f] = s;
  return std::tie(a, b, c, d, e, f);
}
inline auto fields(LastPlan& s) {
  auto& [a, b] = s;
  return std::tie(a, b);
}
inline auto fields(FailedSpot& s) {
  auto& [a, b, c, d] = s;
  return std::tie(a, b, c, d);
}
inline auto fields(PlanRequest& s) {
  auto& [a, b, c, d, e, f, g, h] = s;
  return std::tie(a, b, c, d, e, f, g, h);
}
inline auto fields(CheckReport& s) {
  auto& [a, b, c] = s;
  return std::tie(a, b, c);
}
inline auto fields(Funnel& s) {
  auto& [a, b, c, d, e, f, g, h, i, j, k] = s;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k);
}
inline auto fields(GrsTerms& s) {
  auto& [a, b, c, d, e, f, g, h, i, j, k] = s;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k);
}
inline auto fields(Object& s) {
  auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = s;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o);
}
inline auto fields(Grasp& s) {
  auto& [a, b, c, d, e, f, g, h, i] = s;
  return std::tie(a, b, c, d, e, f, g, h, i);
}
inline auto fields(StageTiming& s) {
  auto& [a, b] = s;
  return std::tie(a, b);
}
inline auto fields(ServerInfo& s) {
  auto& [a, b, c] = s;
  return std::tie(a, b, c);
}
inline auto fields(PlanAnswer& s) {
  auto& [a, b, c, d, e, f, g, h, i, j, k] = s;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k);
}
inline auto fields(CodeCount& s) {
  auto& [a, b] = s;
  return std::tie(a, b);
}
inline auto fields(StageTotal& s) {
  auto& [a, b, c] = s;
  return std::tie(a, b, c);
}
inline auto fields(HealthAnswer& s) {
  auto& [a, b, c, d, e, f, g, h, i, j, k, l] = s;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k, l);
}
inline auto fields(PlanCall& s) {
  auto& [a, b] = s;
  return std::tie(a, b);
}
inline auto fields(HealthCall&) { return std::tie(); }
inline auto fields(Request& s) {
  auto& [a, b, c, d, e] = s;
  return std::tie(a, b, c, d, e);
}
inline auto fields(Answer& s) {
  auto& [a, b, c, d, e] = s;
  return std::tie(a, b, c, d, e);
}

}  // namespace graspd::testing

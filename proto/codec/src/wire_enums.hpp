#pragma once

#include <stdexcept>
#include <utility>

#include "field.hpp"
#include "graspd/types/envelope.hpp"
#include "graspd/v1/envelope.pb.h"

/// Which value of the types is which value on the wire. Values that are not listed never cross it.
namespace graspd::codec {

template <class E>
struct WireEnum;

template <>
struct WireEnum<Code> {
  using Wire = v1::Answer::Code;
  static constexpr std::pair<Code, Wire> values[] = {
      {Code::kOk, v1::Answer::OK},
      {Code::kInvalidArgument, v1::Answer::INVALID_ARGUMENT},
      {Code::kUnsupportedVersion, v1::Answer::UNSUPPORTED_VERSION},
      {Code::kUnauthenticated, v1::Answer::UNAUTHENTICATED},
      {Code::kUnknownPart, v1::Answer::UNKNOWN_PART},
      {Code::kBusy, v1::Answer::BUSY},
      {Code::kSuperseded, v1::Answer::SUPERSEDED},
      {Code::kDeadlineExceeded, v1::Answer::DEADLINE_EXCEEDED},
      {Code::kDraining, v1::Answer::DRAINING},
      {Code::kRejectedPoison, v1::Answer::REJECTED_POISON},
      {Code::kInternal, v1::Answer::INTERNAL}};
};

template <>
struct WireEnum<ServerState> {
  using Wire = v1::HealthAnswer::State;
  static constexpr std::pair<ServerState, Wire> values[] = {
      {ServerState::kStarting, v1::HealthAnswer::STARTING},
      {ServerState::kReady, v1::HealthAnswer::READY},
      {ServerState::kDraining, v1::HealthAnswer::DRAINING}};
};

template <>
struct WireEnum<DepthEncoding> {
  using Wire = v1::FrameDescription::Encoding;
  static constexpr std::pair<DepthEncoding, Wire> values[] = {
      {DepthEncoding::kRaw, v1::FrameDescription::RAW},
      {DepthEncoding::kRvl, v1::FrameDescription::RVL}};
};

template <>
struct WireEnum<GripperKind> {
  using Wire = v1::Gripper::Kind;
  static constexpr std::pair<GripperKind, Wire> values[] = {
      {GripperKind::kParallelJaw, v1::Gripper::PARALLEL_JAW},
      {GripperKind::kSuction, v1::Gripper::SUCTION}};
};

template <>
struct WireEnum<Segmentation> {
  using Wire = v1::PlanOptions::Segmentation;
  static constexpr std::pair<Segmentation, Wire> values[] = {
      {Segmentation::kServerDefault, v1::PlanOptions::SEGMENTATION_UNSPECIFIED},
      {Segmentation::kImprovedDbscan, v1::PlanOptions::IMPROVED_DBSCAN},
      {Segmentation::kDbscan, v1::PlanOptions::DBSCAN},
      {Segmentation::kEuclidean, v1::PlanOptions::EUCLIDEAN},
      {Segmentation::kRegionGrowing, v1::PlanOptions::REGION_GROWING},
      {Segmentation::kGridDbscan, v1::PlanOptions::GRID_DBSCAN}};
};

template <>
struct WireEnum<Registration> {
  using Wire = v1::PlanOptions::Registration;
  static constexpr std::pair<Registration, Wire> values[] = {
      {Registration::kServerDefault, v1::PlanOptions::REGISTRATION_UNSPECIFIED},
      {Registration::kPcaIcp, v1::PlanOptions::PCA_ICP},
      {Registration::kSacIaIcp, v1::PlanOptions::SAC_IA_ICP},
      {Registration::kNdtIcp, v1::PlanOptions::NDT_ICP},
      {Registration::kVerified, v1::PlanOptions::VERIFIED}};
};

template <>
struct WireEnum<GraspOrder> {
  using Wire = v1::PlanOptions::Order;
  static constexpr std::pair<GraspOrder, Wire> values[] = {
      {GraspOrder::kServerDefault, v1::PlanOptions::ORDER_UNSPECIFIED},
      {GraspOrder::kDescending, v1::PlanOptions::DESCENDING},
      {GraspOrder::kAscending, v1::PlanOptions::ASCENDING}};
};

template <>
struct WireEnum<PSystem> {
  using Wire = v1::PlanOptions::PSystem;
  static constexpr std::pair<PSystem, Wire> values[] = {
      {PSystem::kServerDefault, v1::PlanOptions::P_SYSTEM_UNSPECIFIED},
      {PSystem::kCount, v1::PlanOptions::COUNT},
      {PSystem::kSupport, v1::PlanOptions::SUPPORT}};
};

template <>
struct WireEnum<Strategy> {
  using Wire = v1::PlanOptions::Strategy;
  static constexpr std::pair<Strategy, Wire> values[] = {
      {Strategy::kServerDefault, v1::PlanOptions::STRATEGY_UNSPECIFIED},
      {Strategy::kGrs, v1::PlanOptions::GRS},
      {Strategy::kHighest, v1::PlanOptions::HIGHEST},
      {Strategy::kMostVisible, v1::PlanOptions::MOST_VISIBLE},
      {Strategy::kNearest, v1::PlanOptions::NEAREST},
      {Strategy::kPreferredApproach, v1::PlanOptions::PREFERRED_APPROACH}};
};

template <>
struct WireEnum<Check> {
  using Wire = v1::CheckReport::Check;
  static constexpr std::pair<Check, Wire> values[] = {
      {Check::kOpening, v1::CheckReport::OPENING},
      {Check::kGripperCloud, v1::CheckReport::GRIPPER_CLOUD},
      {Check::kGripperParts, v1::CheckReport::GRIPPER_PARTS},
      {Check::kGripperBin, v1::CheckReport::GRIPPER_BIN},
      {Check::kHeldPart, v1::CheckReport::HELD_PART}};
};

template <>
struct WireEnum<CheckState> {
  using Wire = v1::CheckReport::State;
  static constexpr std::pair<CheckState, Wire> values[] = {
      {CheckState::kPassed, v1::CheckReport::PASSED},
      {CheckState::kFailed, v1::CheckReport::FAILED},
      {CheckState::kNotRun, v1::CheckReport::NOT_RUN}};
};

template <>
struct WireEnum<Outcome> {
  using Wire = v1::PlanAnswer::Outcome;
  static constexpr std::pair<Outcome, Wire> values[] = {
      {Outcome::kPlanned, v1::PlanAnswer::PLANNED},
      {Outcome::kUnchanged, v1::PlanAnswer::UNCHANGED},
      {Outcome::kBinEmpty, v1::PlanAnswer::BIN_EMPTY},
      {Outcome::kBinNotFound, v1::PlanAnswer::BIN_NOT_FOUND},
      {Outcome::kNoneRegistered, v1::PlanAnswer::NONE_REGISTERED},
      {Outcome::kAllInCollision, v1::PlanAnswer::ALL_IN_COLLISION},
      {Outcome::kNoneReachable, v1::PlanAnswer::NONE_REACHABLE}};
};

template <class E>
WireEnum<E>::Wire to_wire(E value) {
  for (const auto& [ours, wire] : WireEnum<E>::values) {
    if (ours == value) return wire;
  }
  throw std::invalid_argument(
      fmt::format("{} '{}' has no value in graspd.v1", EnumNames<E>::what, name_of(value)));
}

template <class E>
E from_wire(typename WireEnum<E>::Wire value, const Field& at) {
  for (const auto& [ours, wire] : WireEnum<E>::values) {
    if (wire == value) return ours;
  }
  std::string names;
  const auto* descriptor = google::protobuf::GetEnumDescriptor<typename WireEnum<E>::Wire>();
  for (const auto& [ours, wire] : WireEnum<E>::values) {
    if (!names.empty()) names += " | ";
    names += descriptor->FindValueByNumber(wire)->name();
  }
  at.refuse("{} is no {}; say {}", static_cast<int>(value), EnumNames<E>::what, names);
  return E{};
}

}  // namespace graspd::codec

#pragma once

#include <limits>
#include <vector>

#include "field.hpp"
#include "graspd/types/envelope.hpp"
#include "graspd/v1/envelope.pb.h"

/// Plain types to messages of the schema, and back: a pair of functions for each message. `write`
/// copies what it is given; `read` checks what it copies.
namespace graspd::codec {

void write(const Eigen::Vector3d& vector, v1::Vector3& out);
void write(const Eigen::Isometry3d& pose, v1::Pose& out);

void write(const CameraIntrinsics& camera, v1::CameraIntrinsics& out);
void write(const FrameDescription& frame, v1::FrameDescription& out);
void write(const Bin& bin, v1::Bin& out);
void write(const CropBox& box, v1::CropBox& out);
void write(const RequestedPart& part, v1::RequestedPart& out);
void write(const Gripper& gripper, v1::Gripper& out);
void write(const PlanOptions& options, v1::PlanOptions& out);
void write(const LastObject& object, v1::LastObject& out);
void write(const LastPlan& plan, v1::LastPlan& out);
void write(const FailedSpot& spot, v1::FailedSpot& out);
void write(const PlanRequest& request, v1::PlanRequest& out);

void write(const Funnel& funnel, v1::Funnel& out);
void write(const GrsTerms& terms, v1::GrsTerms& out);
void write(const Object& object, v1::Object& out);
void write(const CheckReport& report, v1::CheckReport& out);
void write(const Grasp& grasp, v1::Grasp& out);
void write(const StageTiming& timing, v1::StageTiming& out);
void write(const ServerInfo& server, v1::ServerInfo& out);
void write(const PlanAnswer& answer, v1::PlanAnswer& out);
void write(const CodeCount& count, v1::CodeCount& out);
void write(const StageTotal& total, v1::StageTotal& out);
void write(const HealthAnswer& answer, v1::HealthAnswer& out);

Eigen::Vector3d read(const v1::Vector3& in, const Field& at);
Eigen::Isometry3d read(const v1::Pose& in, const Field& at);

CameraIntrinsics read(const v1::CameraIntrinsics& in, const Field& at);
FrameDescription read(const v1::FrameDescription& in, const Field& at);
Bin read(const v1::Bin& in, const Field& at);
CropBox read(const v1::CropBox& in, const Field& at);
RequestedPart read(const v1::RequestedPart& in, const Field& at);
Gripper read(const v1::Gripper& in, const Field& at);
PlanOptions read(const v1::PlanOptions& in, const Field& at);
LastObject read(const v1::LastObject& in, const Field& at);
LastPlan read(const v1::LastPlan& in, const Field& at);
FailedSpot read(const v1::FailedSpot& in, const Field& at);
PlanRequest read(const v1::PlanRequest& in, const Field& at);

Funnel read(const v1::Funnel& in, const Field& at);
GrsTerms read(const v1::GrsTerms& in, const Field& at);
Object read(const v1::Object& in, const Field& at);
CheckReport read(const v1::CheckReport& in, const Field& at);
Grasp read(const v1::Grasp& in, const Field& at);
StageTiming read(const v1::StageTiming& in, const Field& at);
ServerInfo read(const v1::ServerInfo& in, const Field& at);
PlanAnswer read(const v1::PlanAnswer& in, const Field& at);
CodeCount read(const v1::CodeCount& in, const Field& at);
StageTotal read(const v1::StageTotal& in, const Field& at);
HealthAnswer read(const v1::HealthAnswer& in, const Field& at);

/// What can be said of a frame before its payload is there.
/// \returns INVALID_ARGUMENT; fields are named relative to the description.
Result<void> validate(const FrameDescription& frame);

template <class T, class Message>
void write_list(const std::vector<T>& list, google::protobuf::RepeatedPtrField<Message>& out) {
  out.Reserve(static_cast<int>(list.size()));
  for (const T& entry : list) write(entry, *out.Add());
}

/// Counts before it converts, so that a list too long costs nothing.
template <class Message>
auto read_list(const google::protobuf::RepeatedPtrField<Message>& in, const Field& at,
               std::size_t max_n = std::numeric_limits<std::size_t>::max()) {
  std::vector<decltype(read(in.Get(0), at))> list;
  const auto n = static_cast<std::size_t>(in.size());
  if (n > max_n) {
    at.refuse("{} entries; at most {} are taken", n, max_n);
    return list;
  }
  list.reserve(n);
  for (int i = 0; i < in.size(); ++i) list.push_back(read(in.Get(i), at[i]));
  return list;
}

}  // namespace graspd::codec

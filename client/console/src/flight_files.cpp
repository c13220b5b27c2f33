#include "flight_files.hpp"

#include <fstream>
#include <numeric>

#include "graspd/codec/codec.hpp"

namespace graspd::console {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kNanosecondsPerMillisecond = 1e6;

codec::Bytes bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

Result<FlightRecord> read_flight(const fs::path& file) {
  std::error_code error;
  const auto bytes_n = fs::file_size(file, error);
  if (error) return invalid("{}: {}", file.string(), error.message());
  if (bytes_n > codec::kMaxFlightRecord_bytes) {
    return invalid("{}: {} bytes are too many for a flight record", file.string(), bytes_n);
  }
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  auto flight = codec::decode_flight(bytes_of(bytes));
  if (!flight) return invalid("{}: {}", file.string(), flight.error().message);
  return flight;
}

Result<FrameDescription> frame_of(const FlightRecord& flight) {
  const auto request = codec::decode_request(bytes_of(flight.request));
  if (!request) return tl::unexpected(request.error());
  const auto* call = std::get_if<PlanCall>(&request->call);
  if (call == nullptr) return invalid("this flight is no plan request");
  return call->frame;
}

bool is_plain_name(std::string_view name) {
  return !name.empty() && name.front() != '.' && name.find_first_of("/\\") == std::string::npos &&
         name.find('\0') == std::string::npos;
}

}  // namespace

Result<fs::path> find_flight(const std::vector<fs::path>& folders, const std::string& name) {
  const std::size_t slash = name.find('/');
  if (slash == std::string::npos || !is_plain_name(std::string_view(name).substr(0, slash)) ||
      !is_plain_name(std::string_view(name).substr(slash + 1)) ||
      !name.ends_with(kFlightExtension)) {
    return invalid("'{}' is no name of a flight; it is CELL/TIME_ID{}", name, kFlightExtension);
  }
  std::error_code error;
  for (const fs::path& folder : folders) {
    if (fs::is_regular_file(folder / name, error)) return folder / name;
  }
  return invalid("{} is no longer kept by the flight recorder", name);
}

Result<PlanSeen> read_plan(const fs::path& file) {
  auto flight = read_flight(file);
  if (!flight) return tl::unexpected(flight.error());
  const auto answer = codec::decode_answer(bytes_of(flight->answer));
  if (!answer) return tl::unexpected(answer.error());
  PlanSeen seen;
  seen.cell = flight->cell;
  seen.flight = (file.parent_path().filename() / file.filename()).string();
  seen.stamp_s = flight->stamp_s;
  seen.code = name_of(answer->code);
  seen.message = answer->message;
  if (const auto* plan = std::get_if<PlanAnswer>(&answer->body)) {
    seen.outcome = name_of(plan->outcome);
    seen.message = plan->reason;
    seen.objects_n = plan->objects.size();
    seen.grasps_n = plan->grasps.size();
    seen.fill_level = plan->fill_level;
    for (const StageTiming& stage : plan->timings) {
      seen.server_ms += static_cast<double>(stage.duration_ns) / kNanosecondsPerMillisecond;
    }
  }
  return seen;
}

Result<std::string> flight_json(const fs::path& file) {
  const auto flight = read_flight(file);
  if (!flight) return tl::unexpected(flight.error());
  const auto frame = frame_of(*flight);
  if (!frame) return tl::unexpected(frame.error());
  const auto request = codec::plan_request_json(bytes_of(flight->request));
  if (!request) return tl::unexpected(request.error());
  const auto answer = codec::decode_answer(bytes_of(flight->answer));
  if (!answer) return tl::unexpected(answer.error());
  const auto plan = codec::plan_answer_json(bytes_of(flight->answer));
  const CameraIntrinsics& camera = frame->camera;
  const json head = {{"cell", flight->cell},
                     {"stamp_s", flight->stamp_s},
                     {"code", name_of(answer->code)},
                     {"message", answer->message},
                     {"camera",
                      {{"width_px", camera.width_px},
                       {"height_px", camera.height_px},
                       {"fx_px", camera.fx_px},
                       {"fy_px", camera.fy_px},
                       {"cx_px", camera.cx_px},
                       {"cy_px", camera.cy_px},
                       {"distortion", camera.distortion}}},
                     {"depth_scale_m", frame->depth_scale_m}};
  const std::string text = head.dump(-1, ' ', false, json::error_handler_t::replace);
  return fmt::format(R"({},"request":{},"answer":{}}})", text.substr(0, text.size() - 1), *request,
                     plan ? *plan : "null");
}

Result<std::string> flight_depth(const fs::path& file) {
  const auto flight = read_flight(file);
  if (!flight) return tl::unexpected(flight.error());
  const auto description = frame_of(*flight);
  if (!description) return tl::unexpected(description.error());
  const auto frame = codec::decode_frame(*description, bytes_of(flight->depth_image));
  if (!frame) return tl::unexpected(frame.error());
  const auto raw = codec::encode_frame(*frame, DepthEncoding::kRaw);
  return std::string(reinterpret_cast<const char*>(raw.payload.data()), raw.payload.size());
}

}  // namespace graspd::console

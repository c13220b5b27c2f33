#include "check_request.hpp"

#include <cmath>

namespace graspd::perception {
namespace {

Result<PartList> find_parts(const PlanRequest& request, const parts::Catalogue& catalogue) {
  PartList found;
  for (const RequestedPart& requested : request.parts) {
    const auto part = catalogue.get(requested.id);
    if (!part) return tl::unexpected(part.error());
    found.push_back(*part);
  }
  return found;
}

/// A part that is longer than the bin's diagonal can't lie in it: one of the two sizes is wrong.
Result<void> check_room(const PlanRequest& request, const PartList& parts) {
  if (!request.bin) return {};
  const Eigen::Vector3d& size_m = request.bin->inner_size_m;
  for (const parts::Part* part : parts) {
    if (part->diameter_m <= size_m.norm()) continue;
    return invalid(
        "bin.inner_size_m: {:.3g} × {:.3g} × {:.3g} m has no room for part '{}', which is {:.3g} m "
        "across; check the bin's size, and the unit of the part's mesh",
        size_m.x(), size_m.y(), size_m.z(), part->id, part->diameter_m);
  }
  return {};
}

}  // namespace

Result<PartList> check_request(const DepthFrame& frame, const PlanRequest& request,
                               const parts::Catalogue& catalogue) {
  if (auto ok = validate(frame); !ok) return tl::unexpected(ok.error());
  if (auto ok = validate(request); !ok) return tl::unexpected(ok.error());
  auto parts = find_parts(request, catalogue);
  if (!parts) return parts;
  if (auto ok = check_room(request, *parts); !ok) return tl::unexpected(ok.error());
  return parts;
}

std::vector<std::string> too_small_parts(const PartList& parts, const CameraIntrinsics& camera,
                                         double distance_m, double least_px) {
  const double pixel_m2 = distance_m * distance_m / (camera.fx_px * camera.fy_px);
  std::vector<std::string> sentences;
  for (const parts::Part* part : parts) {
    const double shown_px = static_cast<double>(part->registration.largest_view_m2()) / pixel_m2;
    if (shown_px >= least_px) continue;
    sentences.push_back(fmt::format(
        "part '{}' shows {:.0f} pixels at most from {:.2f} m, and its pose can't be told from less "
        "than {:.0f}: bring the camera to {:.2f} m, or use one of longer focal length",
        part->id, shown_px, distance_m, least_px, distance_m * std::sqrt(shown_px / least_px)));
  }
  return sentences;
}

}  // namespace graspd::perception

#include "propose_pick_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "antipodal_pairs.hpp"
#include "approach_sectors.hpp"
#include "flat_patches.hpp"
#include "graspd/types/request.hpp"
#include "pick_point_images.hpp"
#include "triangle_tree.hpp"

namespace graspd::parts {
namespace {

constexpr std::size_t kMaxPoints = 24;
/// With their images: a candidate of each is made for every part that is found.
constexpr std::size_t kMaxImages = 96;
constexpr std::size_t kMinPoints = 4;
/// Of the diameter: nearer ones are as good as the same.
constexpr double kMinSpread = 0.08;
/// Of the diameter, that a right angle between two lines counts.
constexpr double kRightAngleSpread = 0.5;
constexpr std::size_t kMaxSectors = 2;  // of one pair
/// A cup stays on its normal; this is what `PickPoint` wants to know of jaws.
constexpr double kCupCone_rad = 0.1;

/// A place with the line that is grasped along, and how good it is from 0 to 1.
struct Spot {
  Eigen::Vector3d position_m;
  Eigen::Vector3d line;
  double quality = 0;
};

/// From the barycentre to the line through a place: the arm at which gravity turns the part.
double lever_m(const Part& part, const Eigen::Vector3d& p_m, const Eigen::Vector3d& line) {
  const Eigen::Vector3d d_m = part.barycentre_m - p_m;
  return (d_m - line.dot(d_m) * line).norm();
}

/// Farthest-point sampling: first the best spot, then always the one that is farthest from all
/// chosen ones and their images, the better of equals. `use` says whether a choice was one.
class SpreadChoice {
 public:
  /// \param both_ways whether a line is the same as its opposite.
  SpreadChoice(const std::vector<Spot>& spots, const std::vector<Eigen::Isometry3d>& turns,
               double diameter_m, bool both_ways)
      : spots_(spots),
        turns_(turns),
        diameter_m_(diameter_m),
        both_ways_(both_ways),
        spread_(spots.size(), 1) {}

  template <class Use>
  void choose(std::size_t most_n, const Use& use) {
    for (std::size_t chosen_n = 0; chosen_n < most_n;) {
      const std::size_t best = farthest();
      if (best == spots_.size()) return;
      if (use(best)) {
        ++chosen_n;
        for (const Eigen::Isometry3d& T : turns_) keep_away_from(T, spots_[best]);
      }
      spread_[best] = 0;
    }
  }

 private:
  std::size_t farthest() const {
    std::size_t best = spots_.size();
    double most = 0;
    for (std::size_t i = 0; i < spots_.size(); ++i) {
      const double gain = spread_[i] * (0.5 + spots_[i].quality);
      if (spread_[i] < kMinSpread || gain <= most) continue;
      most = gain;
      best = i;
    }
    return best;
  }

  void keep_away_from(const Eigen::Isometry3d& T, const Spot& chosen) {
    const Eigen::Vector3d position_m = T * chosen.position_m;
    const Eigen::Vector3d line = T.linear() * chosen.line;
    for (std::size_t i = 0; i < spots_.size(); ++i) {
      const double apart = (spots_[i].position_m - position_m).norm() / diameter_m_;
      // 1 − cos² and 1 − cos rather than angles: alike where it matters, and cheap.
      const double cosine = line.dot(spots_[i].line);
      const double turned =
          kRightAngleSpread * kRightAngleSpread * (1 - (both_ways_ ? cosine * cosine : cosine));
      spread_[i] = std::min(spread_[i], std::sqrt(apart * apart + turned));
    }
  }

  const std::vector<Spot>& spots_;
  const std::vector<Eigen::Isometry3d>& turns_;
  double diameter_m_;
  bool both_ways_;
  std::vector<double> spread_;  ///< of each spot, in diameters, from all that are chosen
};

std::vector<PickPoint> jaw_points(const Part& part, const TriangleTree& tree,
                                  const std::vector<Eigen::Isometry3d>& turns, std::size_t most_n) {
  const auto pairs = antipodal_pairs(part.mesh, tree, part.diameter_m);
  std::vector<Spot> spots;
  for (const AntipodalPair& pair : pairs) {
    const double near = 1 - lever_m(part, pair.middle_m, pair.closing) / part.diameter_m;
    const double slender = 1 - pair.width_m / part.diameter_m;
    spots.push_back({pair.middle_m, pair.closing,
                     (pair.friction_margin + pair.pad_share + near + slender) / 4});
  }
  std::vector<PickPoint> points;
  const double tip_reach_m = pad_radius_m(part.diameter_m);
  SpreadChoice(spots, turns, part.diameter_m, true).choose(most_n, [&](std::size_t i) {
    auto sectors = approach_sectors(pairs[i], tip_reach_m, part.surface);
    if (sectors.size() > kMaxSectors) sectors.resize(kMaxSectors);
    for (const ApproachSector& sector : sectors) {
      if (points.size() == most_n) break;
      points.push_back({{},
                        pairs[i].middle_m,
                        sector.approach,
                        pairs[i].closing,
                        sector.cone_rad,
                        tip_reach_m,
                        pairs[i].width_m,
                        spots[i].quality,
                        std::string(name_of(GripperKind::kParallelJaw)),
                        true});
    }
    return !sectors.empty();
  });
  return points;
}

std::vector<PickPoint> cup_points(const Part& part, const TriangleTree& tree,
                                  const std::vector<Eigen::Isometry3d>& turns, std::size_t most_n) {
  const auto patches = flat_patches(part.mesh, tree);
  double widest_m = 0;
  for (const FlatPatch& patch : patches) widest_m = std::max(widest_m, patch.radius_m);
  std::vector<Spot> spots;
  for (const FlatPatch& patch : patches) {
    const double near = 1 - lever_m(part, patch.centre_m, patch.normal) / part.diameter_m;
    spots.push_back({patch.centre_m, patch.normal, (near + patch.radius_m / widest_m) / 2});
  }
  std::vector<PickPoint> points;
  SpreadChoice(spots, turns, part.diameter_m, false).choose(most_n, [&](std::size_t i) {
    points.push_back({{},
                      patches[i].centre_m,
                      -patches[i].normal,
                      patches[i].normal.unitOrthogonal(),
                      kCupCone_rad,
                      0,
                      2 * patches[i].radius_m,
                      spots[i].quality,
                      std::string(name_of(GripperKind::kSuction)),
                      true});
    return true;
  });
  return points;
}

void sort_and_name(std::vector<PickPoint>& points, std::string_view kind) {
  std::stable_sort(points.begin(), points.end(),
                   [](const auto& a, const auto& b) { return a.priority > b.priority; });
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].name = fmt::format("{}_{}", kind, i + 1);
  }
}

}  // namespace

std::vector<PickPoint> propose_pick_points(const Part& part) {
  const TriangleTree tree(part.mesh);
  const auto turns = turns_of(part.symmetries);
  const std::size_t most_n = std::clamp(kMaxImages / turns.size(), kMinPoints, kMaxPoints);
  std::vector<PickPoint> points = jaw_points(part, tree, turns, most_n);
  sort_and_name(points, "antipodal");
  std::vector<PickPoint> cups = cup_points(part, tree, turns, most_n);
  sort_and_name(cups, "flat");
  std::move(cups.begin(), cups.end(), std::back_inserter(points));
  return points;
}

}  // namespace graspd::parts

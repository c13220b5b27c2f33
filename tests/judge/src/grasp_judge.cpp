#include "graspd/judge/grasp_judge.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <array>
#include <map>

#include "jaw_contacts.hpp"

namespace graspd::judge {
namespace {

using MeshModel = fcl::BVHModel<fcl::OBBRSSd>;

constexpr double kFloorThickness_m = 0.05;
/// Contacts that a lift by so much does not open hold the part. The first is above what the
/// simulated piles' parts reach into each other.
constexpr std::array kLifts_m{0.003, 0.01};

std::shared_ptr<MeshModel> model_of(const parts::Mesh& mesh) {
  auto model = std::make_shared<MeshModel>();
  model->beginModel(static_cast<int>(mesh.triangles.size()),
                    static_cast<int>(mesh.vertices_m.size()));
  std::vector<fcl::Vector3d> vertices;
  for (const auto& vertex : mesh.vertices_m) vertices.emplace_back(vertex.cast<double>());
  std::vector<fcl::Triangle> triangles;
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.emplace_back(static_cast<std::size_t>(a), static_cast<std::size_t>(b),
                           static_cast<std::size_t>(c));
  }
  model->addSubModel(vertices, triangles);
  model->endModel();
  return model;
}

bool collide(const fcl::CollisionGeometryd& a, const Eigen::Isometry3d& T_bin_a,
             const fcl::CollisionGeometryd& b, const Eigen::Isometry3d& T_bin_b) {
  fcl::CollisionResultd result;
  return fcl::collide(&a, T_bin_a, &b, T_bin_b, fcl::CollisionRequestd(), result) > 0;
}

struct PlacedBox {
  Eigen::Vector3d size_m;
  Eigen::Isometry3d T_bin_box;

  bool meets(const PlacedBox& other) const {
    return collide(fcl::Boxd(size_m), T_bin_box, fcl::Boxd(other.size_m), other.T_bin_box);
  }
};

PlacedBox place(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m,
                const Eigen::Isometry3d& T_bin_frame) {
  return {high_m - low_m, T_bin_frame * Eigen::Translation3d((low_m + high_m) / 2)};
}

/// All that jaws and palm pass through from pre-grasp to grasp: they move along their own z, and
/// what a box sweeps so is a longer box.
std::array<PlacedBox, 3> swept_gripper(const Gripper& gripper, const TrueGrasp& grasp) {
  const Eigen::Vector3d& jaw = gripper.jaw_size_m;
  const Eigen::Vector3d& palm = gripper.palm_size_m;
  const double inner_m = grasp.opening_width_m / 2;
  const double top_m = -jaw.z() - grasp.standoff_m;
  const auto box = [&](const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m) {
    return place(low_m, high_m, grasp.T_bin_grasp);
  };
  return {box({-inner_m - jaw.x(), -jaw.y() / 2, top_m}, {-inner_m, jaw.y() / 2, 0}),
          box({inner_m, -jaw.y() / 2, top_m}, {inner_m + jaw.x(), jaw.y() / 2, 0}),
          box({-palm.x() / 2, -palm.y() / 2, top_m - palm.z()},
              {palm.x() / 2, palm.y() / 2, -jaw.z()})};
}

std::vector<PlacedBox> walls_of(const TrueBin& bin) {
  const double x = bin.inner_size_m.x() / 2, y = bin.inner_size_m.y() / 2;
  const double z = bin.inner_size_m.z(), wall = bin.wall_m;
  const auto box = [](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    return place(low, high, Eigen::Isometry3d::Identity());
  };
  return {box({-x - wall, -y - wall, 0}, {-x, y + wall, z}),
          box({x, -y - wall, 0}, {x + wall, y + wall, z}), box({-x, -y - wall, 0}, {x, -y, z}),
          box({-x, y, 0}, {x, y + wall, z})};
}

bool has_part(const std::vector<Contact>& contacts, std::size_t part) {
  return std::ranges::any_of(contacts,
                             [&](const Contact& contact) { return contact.part == part; });
}

}  // namespace

struct GraspJudge::Impl {
  std::vector<TruePart> parts;
  std::vector<std::shared_ptr<MeshModel>> models;  // of each part
  std::vector<Eigen::Vector3d> centres_m;          // of each part
  std::vector<double> radii_m;                     // of its mesh about that
  std::vector<PlacedBox> walls;
  PlacedBox floor;
  Gripper gripper;
  double friction;

  std::optional<std::size_t> part_in(const PlacedBox& box) const {
    const fcl::Boxd shape(box.size_m);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const double distance_m = (box.T_bin_box.translation() - centres_m[i]).norm();
      if (distance_m > radii_m[i] + box.size_m.norm() / 2) continue;
      if (collide(shape, box.T_bin_box, *models[i], parts[i].T_bin_part)) return i;
    }
    return std::nullopt;
  }

  std::optional<Judgement> collision(const TrueGrasp& grasp) const {
    const auto boxes = swept_gripper(gripper, grasp);
    for (const PlacedBox& box : boxes) {
      if (box.meets(floor)) return Judgement{Finding::kCollisionFloor, {}};
      for (const PlacedBox& wall : walls) {
        if (box.meets(wall)) return Judgement{Finding::kCollisionWall, {}};
      }
    }
    for (const PlacedBox& box : boxes) {
      if (const auto part = part_in(box)) return Judgement{Finding::kCollisionPart, part};
    }
    return std::nullopt;
  }

  Judgement closing(const TrueGrasp& grasp) const {
    JawContacts contacts(gripper, grasp.opening_width_m);
    const Eigen::AlignedBox3d& between_m = contacts.between_m();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Eigen::Vector3d centre_m = grasp.T_bin_grasp.inverse() * centres_m[i];
      if (between_m.exteriorDistance(centre_m) > radii_m[i]) continue;
      contacts.add(i, parts[i].part->mesh, grasp.T_bin_grasp.inverse() * parts[i].T_bin_part);
    }
    const auto low = contacts.at_low_jaw();
    const auto high = contacts.at_high_jaw();
    if (low.empty()) return {Finding::kNothingBetween, {}};
    const auto at_x = [](const Contact& contact) { return contact.p_m.x(); };
    const Contact& first_low = *std::ranges::min_element(low, {}, at_x);
    const Contact& first_high = *std::ranges::max_element(high, {}, at_x);
    if (at_x(first_high) - at_x(first_low) <= gripper.min_opening_m) {
      return {Finding::kNothingBetween, {}};
    }
    const std::size_t held = first_low.part;
    for (std::size_t other = 0; other < parts.size(); ++other) {
      if (other != held && has_part(low, other) && has_part(high, other)) {
        return {Finding::kTwoParts, held};
      }
    }
    if (first_high.part != held) return {Finding::kTwoParts, held};
    const bool holds = in_force_closure(low, high, friction);
    return {holds ? Finding::kGood : Finding::kNoForceClosure, held};
  }
};

GraspJudge::GraspJudge(std::vector<TruePart> parts, const TrueBin& bin, const Gripper& gripper,
                       double friction)
    : impl_(std::make_unique<Impl>()) {
  std::map<const parts::Part*, std::shared_ptr<MeshModel>> models;
  for (const TruePart& part : parts) {
    auto& model = models[part.part];
    if (!model) {
      model = model_of(part.part->mesh);
      model->computeLocalAABB();
    }
    impl_->models.push_back(model);
    impl_->centres_m.emplace_back(part.T_bin_part * model->aabb_center);
    impl_->radii_m.push_back(model->aabb_radius);
  }
  impl_->parts = std::move(parts);
  impl_->walls = walls_of(bin);
  const Eigen::Vector3d table_m(10, 10, kFloorThickness_m);
  impl_->floor = {table_m, Eigen::Isometry3d(Eigen::Translation3d(0, 0, -kFloorThickness_m / 2))};
  impl_->gripper = gripper;
  impl_->friction = friction;
}
GraspJudge::GraspJudge(GraspJudge&&) noexcept = default;
GraspJudge& GraspJudge::operator=(GraspJudge&&) noexcept = default;
GraspJudge::~GraspJudge() = default;

const std::vector<TruePart>& GraspJudge::parts() const { return impl_->parts; }
const Gripper& GraspJudge::gripper() const { return impl_->gripper; }

Judgement GraspJudge::judge(const TrueGrasp& grasp) const {
  if (const auto collision = impl_->collision(grasp)) return *collision;
  return impl_->closing(grasp);
}

bool GraspJudge::lifts_free(std::size_t part) const {
  const MeshModel& model = *impl_->models[part];
  for (std::size_t i = 0; i < impl_->parts.size(); ++i) {
    const double distance_m = (impl_->centres_m[i] - impl_->centres_m[part]).norm();
    if (i == part || distance_m > impl_->radii_m[i] + impl_->radii_m[part] + kLifts_m.back()) {
      continue;
    }
    const auto meets_after = [&](double lift_m) {
      return collide(model, Eigen::Translation3d(0, 0, lift_m) * impl_->parts[part].T_bin_part,
                     *impl_->models[i], impl_->parts[i].T_bin_part);
    };
    if (std::ranges::any_of(kLifts_m, meets_after)) return false;
  }
  return true;
}

}  // namespace graspd::judge

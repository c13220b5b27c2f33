#include "graspd/simulation/pile.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bullet_world.hpp"
#include "random.hpp"

namespace graspd::simulation {
namespace {

constexpr double kDropDamping = 0.05;
constexpr double kDropGap_m = 0.005;

struct Body {
  std::size_t kind = 0;
  btRigidBody* body = nullptr;
};

/// One pile in the making.
class Drop {
 public:
  Drop(const std::vector<PartShape>& shapes, const PileOptions& options,
       const Eigen::Vector3d& bin_inner_size_m, std::uint64_t seed)
      : shapes_(shapes),
        options_(options),
        inner_m_(bin_inner_size_m),
        random_(seed),
        world_(bin_inner_size_m, options.friction, options.restitution) {}

  void release_all(const std::vector<int>& counts) {
    std::vector<std::size_t> order;
    for (std::size_t kind = 0; kind < counts.size(); ++kind) {
      order.insert(order.end(), std::size_t(counts[kind]), kind);
    }
    for (std::size_t i = order.size(); i > 1; --i) {
      std::swap(order[i - 1], order[std::size_t(random_.uniform() * double(i))]);
    }
    for (const std::size_t kind : order) {
      bodies_.push_back({kind, world_.add(shapes_[kind])});
      release(bodies_.back(), bodies_.size() - 1);
    }
  }

  /// \returns whether all parts came to rest.
  bool settle() {
    const double start_s = pile_.simulated_s;
    double still_speed_m_s = 0;
    do {
      set_damping(settling_damping(pile_.simulated_s - start_s, kDropDamping));
      const std::vector<Eigen::Isometry3d> before = poses();
      const double window_start_s = pile_.simulated_s;
      while (pile_.simulated_s < window_start_s + options_.still_for_s) step();
      still_speed_m_s = farthest_move_m(before) / (pile_.simulated_s - window_start_s);
    } while (still_speed_m_s >= options_.still_speed_m_s &&
             pile_.simulated_s < start_s + options_.settle_within_s);
    return still_speed_m_s < options_.still_speed_m_s;
  }

  /// Drops every part that lies beside the bin again. \returns whether there was one.
  bool drop_strays_again() {
    bool any = false;
    set_damping(kDropDamping);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!is_stray(bodies_[i])) continue;
      release(bodies_[i], i);
      ++pile_.dropped_again_n;
      any = true;
    }
    return any;
  }

  void remove_strays() {
    std::erase_if(bodies_, [this](const Body& body) {
      if (!is_stray(body)) return false;
      world_.remove(body.body);
      ++pile_.removed_n;
      return true;
    });
  }

  Pile result() {
    for (const Body& body : bodies_) {
      pile_.parts.push_back({body.kind, pose_of(*body.body, shapes_[body.kind])});
    }
    pile_.deepest_penetration_m = world_.deepest_penetration_m();
    return pile_;
  }

 private:
  /// Puts a part above all that is below it, turned at random, and lets it fall for a moment.
  void release(const Body& body, std::size_t index) {
    const PartShape& shape = shapes_[body.kind];
    const auto across_m = [&](double inner_m) {
      const double room_m = std::max(0.0, inner_m / 2 - shape.radius_m);
      return random_.uniform(-room_m, room_m);
    };
    Eigen::Isometry3d T_bin_part = Eigen::Isometry3d::Identity();
    T_bin_part.linear() = random_.rotation().toRotationMatrix();
    Eigen::Vector3d centre_m(across_m(inner_m_.x()), across_m(inner_m_.y()), 0);
    centre_m.z() = highest_point_m(centre_m, shape.radius_m, index) + kDropGap_m + shape.radius_m;
    T_bin_part.translation() = centre_m - T_bin_part.linear() * shape.centre_of_mass_m;
    place(*body.body, shape, T_bin_part, {0, 0, -options_.drop_speed_m_s});
    const double until_s = pile_.simulated_s + options_.drop_every_s;
    while (pile_.simulated_s < until_s) step();
  }

  /// Of all parts but one within a vertical cylinder.
  double highest_point_m(const Eigen::Vector3d& axis_m, double radius_m, std::size_t except) const {
    double highest_m = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (i == except) continue;
      btVector3 low, high;
      bodies_[i].body->getAabb(low, high);
      const Eigen::AlignedBox3d box(to_metres(low), to_metres(high));
      const Eigen::Vector3d nearest_m = axis_m.cwiseMax(box.min()).cwiseMin(box.max());
      if ((nearest_m - axis_m).head<2>().norm() < radius_m) {
        highest_m = std::max(highest_m, box.max().z());
      }
    }
    return highest_m;
  }

  void step() {
    world_.step(options_.step_s);
    pile_.simulated_s += options_.step_s;
    const auto limit = btScalar(options_.drop_speed_m_s * kScale);
    for (const Body& body : bodies_) {
      const btVector3 velocity = body.body->getLinearVelocity();
      if (velocity.length() > limit) {
        body.body->setLinearVelocity(velocity * (limit / velocity.length()));
      }
    }
  }

  std::vector<Eigen::Isometry3d> poses() const {
    std::vector<Eigen::Isometry3d> poses;
    for (const Body& body : bodies_) poses.push_back(pose_of(*body.body, shapes_[body.kind]));
    return poses;
  }

  /// Of any point of any part, since it lay as in `before`. (Speeds would not do: in a pile at rest
  /// the solver's velocities tremble about zero.)
  double farthest_move_m(const std::vector<Eigen::Isometry3d>& before) const {
    double farthest_m = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const PartShape& shape = shapes_[bodies_[i].kind];
      const Eigen::Isometry3d now = pose_of(*bodies_[i].body, shape);
      const double shift_m =
          (now * shape.centre_of_mass_m - before[i] * shape.centre_of_mass_m).norm();
      const double turn_rad =
          Eigen::AngleAxisd(before[i].linear().transpose() * now.linear()).angle();
      farthest_m = std::max(farthest_m, shift_m + turn_rad * shape.radius_m);
    }
    return farthest_m;
  }

  bool is_stray(const Body& body) const {
    const Eigen::Vector3d centre_m =
        pose_of(*body.body, shapes_[body.kind]) * shapes_[body.kind].centre_of_mass_m;
    return std::abs(centre_m.x()) > inner_m_.x() / 2 || std::abs(centre_m.y()) > inner_m_.y() / 2 ||
           centre_m.z() < 0;
  }

  void set_damping(double damping) {
    for (const Body& body : bodies_) body.body->setDamping(btScalar(damping), btScalar(damping));
  }

  const std::vector<PartShape>& shapes_;
  const PileOptions& options_;
  Eigen::Vector3d inner_m_;
  Random random_;
  BulletWorld world_;
  std::vector<Body> bodies_;
  Pile pile_;
};

Result<void> check(const std::vector<int>& counts, std::size_t kinds_n,
                   const Eigen::Vector3d& bin_inner_size_m) {
  if (counts.size() != kinds_n) {
    return invalid("counts: {} numbers for {} kinds of part; give one each", counts.size(),
                   kinds_n);
  }
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (counts[k] < 0) return invalid("counts[{}]: {} parts; give 0 or more", k, counts[k]);
  }
  if (!(bin_inner_size_m.minCoeff() > 0) || !bin_inner_size_m.allFinite()) {
    return invalid("bin_inner_size_m: {} x {} x {}; all three must be positive",
                   bin_inner_size_m.x(), bin_inner_size_m.y(), bin_inner_size_m.z());
  }
  return {};
}

}  // namespace

struct PileMaker::Impl {
  std::vector<PartShape> shapes;
  PileOptions options;
};

PileMaker::PileMaker(const std::vector<parts::Mesh>& kinds, const PileOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  for (const parts::Mesh& mesh : kinds) {
    impl_->shapes.push_back(make_part_shape(mesh, {}, options.density_kg_m3));
  }
}
PileMaker::PileMaker(PileMaker&&) noexcept = default;
PileMaker& PileMaker::operator=(PileMaker&&) noexcept = default;
PileMaker::~PileMaker() = default;

Result<Pile> PileMaker::drop(const std::vector<int>& counts,
                             const Eigen::Vector3d& bin_inner_size_m, std::uint64_t seed) const {
  if (auto ok = check(counts, impl_->shapes.size(), bin_inner_size_m); !ok) {
    return tl::unexpected(ok.error());
  }
  const PileOptions& options = impl_->options;
  std::string why;
  for (int attempt = 0; attempt < options.max_attempts_n; ++attempt) {
    Drop drop(impl_->shapes, options, bin_inner_size_m, Random(seed, attempt).next());
    drop.release_all(counts);
    bool still = drop.settle();
    for (int drops = 1; drops < options.max_drops_n && drop.drop_strays_again(); ++drops) {
      still = drop.settle();
    }
    drop.remove_strays();
    Pile pile = drop.result();
    if (still && pile.deepest_penetration_m <= options.max_penetration_m) return pile;
    why = still ? fmt::format("parts penetrate by {:.1f} mm", 1e3 * pile.deepest_penetration_m)
                : "parts kept moving";
  }
  return fail(Code::kInternal, "pile with seed {}: {} in each of {} attempts; use another seed",
              seed, why, options.max_attempts_n);
}

}  // namespace graspd::simulation

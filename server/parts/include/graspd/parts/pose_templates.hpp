#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace graspd::parts {

/// What a distant camera sees around points of the part: a template for each of a few anchors in
/// each view. A template has 64 samples on four rings about its anchor, each as deep as the surface
/// seen there lies behind the anchor, so that the depth image around a reading, sampled alike, says
/// by subtraction whether the reading may be the anchor. Sixteen places on a ring make a turn about
/// the line of sight a turn of the samples.
struct PoseTemplates {
  static constexpr int kTurns = 16;
  static constexpr int kRings = 4;
  static constexpr int kSamples = kTurns * kRings;
  static constexpr std::array<float, kRings> kRadii{0.07F, 0.16F, 0.27F, 0.40F};  ///< diameters
  static constexpr std::size_t kReadAhead = 16;
  static constexpr float kUnit = 0.01F;  ///< of the depths, in diameters

  /// kSamples of each template, the rings of one direction beside each other; the first direction
  /// is the view's x, the next ones turn towards its y.
  std::vector<std::int8_t> depths;
  /// Bit i: the part is seen at sample i. What lies beyond its outline may be at any depth.
  std::vector<std::uint64_t> inside;
  /// The anchors' normals in their view's frame: sine and cosine of the angle to z, and in turns
  /// the one about it, from x to y. Each followed by kReadAhead zeros for kernels that load whole
  /// vectors.
  std::vector<float> normal_sine, normal_cosine, normal_turns;
  std::vector<Eigen::Vector3f> anchors_m;
  std::vector<std::uint32_t> views;          ///< of each template, index into R_view_part
  std::vector<Eigen::Matrix3f> R_view_part;  ///< z along the line of sight, away from the camera

  std::size_t size() const { return views.size(); }
  /// \param normal unit, or 0. \returns its sine, cosine and turns, as above.
  static std::array<float, 3> polar(const Eigen::Vector3f& normal);
};

}  // namespace graspd::parts

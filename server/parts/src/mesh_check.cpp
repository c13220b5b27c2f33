#include "graspd/parts/mesh_check.hpp"

#include <algorithm>
#include <map>

#include "length_unit.hpp"
#include "mesh_geometry.hpp"
#include "mesh_topology.hpp"
#include "symmetries_sentence.hpp"
#include "text.hpp"
#include "wall_thickness.hpp"

namespace graspd::parts {
namespace {

// Between the sizes that make_part refuses and these, a unit is likely but not surely wrong.
constexpr double kSmallPart_m = 0.010;
constexpr double kLargePart_m = 1.0;
// Triangles beyond this tell a depth camera nothing, and every rendering pays for them.
constexpr std::size_t kManyTriangles = 100'000;
// Narrower than this, a part's shape is lost in the pixels at its silhouette.
constexpr double kMinPixelsAcross = 10;
// Of the surface: less than this is an edge or a point, not a wall.
constexpr double kWallShare = 0.1;
// Flatter than this many standard deviations, a part that lies down is a ripple of the floor.
constexpr double kMinThicknessSigmas = 4;
constexpr double kKinectNearest_m = 0.5;
// Of the diameter: no part is as thin, and no hole in a solid as wide.
constexpr double kFlatShare = 0.001;
constexpr double kSheetRimShare = 0.9;

class Findings {
 public:
  template <class... Args>
  void add(Severity severity, std::string topic, fmt::format_string<Args...> format,
           Args&&... args) {
    findings_.push_back(
        {severity, std::move(topic), fmt::format(format, std::forward<Args>(args)...)});
  }
  /// Says that all is well, unless this topic has a finding.
  template <class... Args>
  void add_if_none(const std::string& topic, fmt::format_string<Args...> format, Args&&... args) {
    const bool has_one = std::any_of(findings_.begin(), findings_.end(),
                                     [&](const MeshFinding& f) { return f.topic == topic; });
    if (!has_one) add(Severity::kOk, topic, format, std::forward<Args>(args)...);
  }
  bool has_error() const {
    return std::ranges::any_of(findings_,
                               [](const MeshFinding& f) { return f.severity == Severity::kError; });
  }
  std::vector<MeshFinding> take() { return std::move(findings_); }

 private:
  std::vector<MeshFinding> findings_;
};

std::string in_text(const Eigen::Vector3d& p_m) { return in_mm(p_m) + " mm"; }

Eigen::Vector3d vertex_m(const Mesh& mesh, int index) {
  return mesh.vertices_m[static_cast<std::size_t>(index)].cast<double>();
}

Eigen::Vector3d middle_m(const Mesh& mesh, const Edge& edge) {
  return 0.5 * (vertex_m(mesh, edge.first) + vertex_m(mesh, edge.second));
}

Eigen::Vector3d centroid_m(const Mesh& mesh, std::size_t triangle) {
  return triangle_of(mesh, mesh.triangles[triangle]).centroid_m();
}

Eigen::Vector3d extents_m(const Mesh& mesh, const Eigen::Matrix3d& axes) {
  Eigen::AlignedBox3d box;
  for (const auto& vertex : mesh.vertices_m) box.extend(axes.transpose() * vertex.cast<double>());
  return box.sizes();
}

/// Length, width and thickness. Where the part is as long as wide its principal axes may be turned
/// by any angle, so the CAD file's own axes are tried as well: the tighter box counts.
Eigen::Vector3d sorted_extents_m(const Mesh& mesh) {
  const Eigen::Vector3d cad = extents_m(mesh, Eigen::Matrix3d::Identity());
  const Eigen::Vector3d principal = extents_m(mesh, principal_axes(mesh));
  Eigen::Vector3d extents = cad.prod() <= principal.prod() ? cad : principal;
  std::sort(extents.begin(), extents.end(), std::greater<>());
  return extents;
}

void check_units(double diameter, const Eigen::Vector3d& extents, const SensorResolution& sensor,
                 std::optional<LengthUnit> declared, Findings& findings) {
  const bool is_impossible = diameter < kMinDiameter_m || diameter > kMaxDiameter_m;
  const bool is_small = diameter < kSmallPart_m;
  if (is_impossible || is_small || diameter > kLargePart_m) {
    const double across_px = sensor.focal_length_px * extents[1] / sensor.distance_m;
    findings.add(is_impossible ? Severity::kError : Severity::kWarning, "units",
                 "The part is {:.4g} mm across, too {} for a bin of parts: {}.{}", diameter * 1e3,
                 is_small ? "small" : "large", probable_unit(diameter, declared),
                 is_impossible || !is_small
                     ? std::string()
                     : fmt::format(" If its unit is right, it is {:.1f} pixels wide at {:.2f} m; "
                                   "telling its pose takes {:.0f}.",
                                   across_px, sensor.distance_m, kMinPixelsAcross));
  }
  findings.add_if_none("units", "The part measures {:.1f} × {:.1f} × {:.1f} mm.", extents[0] * 1e3,
                       extents[1] * 1e3, extents[2] * 1e3);
}

void check_normals(const Mesh& mesh, const MeshTopology& topology, Findings& findings) {
  if (!topology.inconsistent_edges.empty()) {
    const std::size_t n = topology.reversed_triangles.size();
    findings.add(
        Severity::kWarning, "normals",
        "{} of {} triangles {} wound against their neighbours{}: graspd turns them over when it "
        "loads the part, but use \"recalculate normals outside\" for other programs.",
        n, mesh.triangles.size(), n == 1 ? "is" : "are",
        n == 0
            ? std::string()
            : ", the first at " + in_text(centroid_m(mesh, topology.reversed_triangles.front())));
  } else if (is_inside_out(mesh)) {
    findings.add(Severity::kWarning, "normals",
                 "All triangles face into the part (its volume is {:.4g} cm³): graspd turns them "
                 "over when it loads the part, but flip the normals for other programs.",
                 signed_volume_m3(mesh) * 1e6);
  } else if (!topology.is_closed()) {
    findings.add(Severity::kOk, "normals",
                 "All triangles are wound alike; whether outwards can't be told of a surface that "
                 "is not closed.");
  }
  findings.add_if_none("normals", "All triangles face outwards.");
}

/// Boundary edges that hang together, as one box for each hole, the widest first.
std::vector<Eigen::AlignedBox3d> hole_boxes_m(const Mesh& mesh, const MeshTopology& topology) {
  DisjointSets vertices(mesh.vertices_m.size());
  for (const auto& [a, b] : topology.boundary_edges) {
    vertices.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  }
  std::map<std::size_t, Eigen::AlignedBox3d> box_of;
  for (const auto& [a, b] : topology.boundary_edges) {
    Eigen::AlignedBox3d& box = box_of[vertices.find(static_cast<std::size_t>(a))];
    box.extend(vertex_m(mesh, a));
    box.extend(vertex_m(mesh, b));
  }
  std::vector<Eigen::AlignedBox3d> boxes;
  boxes.reserve(box_of.size());
  for (const auto& [root, box] : box_of) boxes.push_back(box);
  std::stable_sort(boxes.begin(), boxes.end(), [](const auto& a, const auto& b) {
    return a.diagonal().norm() > b.diagonal().norm();
  });
  return boxes;
}

/// Some files hold an outline filled with triangles, or the sheets of a drawing.
void check_solid(const Mesh& mesh, const MeshTopology& topology, const Eigen::Vector3d& extents,
                 double diameter, Findings& findings) {
  if (extents[2] < kFlatShare * diameter) {
    findings.add(Severity::kError, "solid",
                 "The mesh is flat ({:.2g} mm thick): a drawing rather than a solid. Export the "
                 "part's solid body from your CAD program.",
                 extents[2] * 1e3);
    return;
  }
  const auto holes = hole_boxes_m(mesh, topology);
  if (holes.empty() || holes.front().diagonal().norm() < kSheetRimShare * diameter) return;
  findings.add(Severity::kError, "solid",
               "The surface is open along a rim as wide as the part ({:.4g} mm): a sheet without "
               "thickness rather than a solid. Thicken or close it in your CAD program.",
               holes.front().diagonal().norm() * 1e3);
}

void check_edges(const Mesh& mesh, const MeshTopology& topology, Findings& findings) {
  if (!topology.boundary_edges.empty()) {
    const auto holes = hole_boxes_m(mesh, topology);
    findings.add(Severity::kWarning, "holes",
                 "The surface has {} hole{} ({} open edges), the widest {:.4g} mm across at {}: "
                 "close {} in your mesh program, or the part's volume and barycentre are guesses.",
                 holes.size(), holes.size() == 1 ? "" : "s", topology.boundary_edges.size(),
                 holes.front().diagonal().norm() * 1e3, in_text(holes.front().center()),
                 holes.size() == 1 ? "it" : "them");
  }
  findings.add_if_none("holes", "The surface is closed.");
  if (!topology.non_manifold_edges.empty()) {
    findings.add(Severity::kWarning, "edges",
                 "At {} edge{} more than two triangles meet, the first at {}: unite the bodies or "
                 "remove inner faces in your CAD program.",
                 topology.non_manifold_edges.size(),
                 topology.non_manifold_edges.size() == 1 ? "" : "s",
                 in_text(middle_m(mesh, topology.non_manifold_edges.front())));
  }
  findings.add_if_none("edges", "No edge has more than two triangles.");
}

void check_triangles(const Mesh& mesh, const MeshTopology& topology, Findings& findings) {
  const std::size_t n = mesh.triangles.size();
  if (!topology.degenerate_triangles.empty()) {
    findings.add(Severity::kWarning, "triangles",
                 "{} of {} triangles {} no area, the first at {}: remove degenerate faces in "
                 "your mesh program.",
                 topology.degenerate_triangles.size(), n,
                 topology.degenerate_triangles.size() == 1 ? "has" : "have",
                 in_text(centroid_m(mesh, topology.degenerate_triangles.front())));
  }
  if (!topology.duplicate_triangles.empty()) {
    findings.add(Severity::kWarning, "triangles",
                 "{} of {} triangles {} there twice, the first at {}: remove duplicate faces in "
                 "your mesh program.",
                 topology.duplicate_triangles.size(), n,
                 topology.duplicate_triangles.size() == 1 ? "is" : "are",
                 in_text(centroid_m(mesh, topology.duplicate_triangles.front())));
  }
  if (n > kManyTriangles) {
    findings.add(Severity::kWarning, "triangles",
                 "The mesh has {} triangles, more than a depth camera can see: reduce it to below "
                 "{} (quadric edge collapse; `grasp_server part new` does it) to load and draw it "
                 "faster.",
                 n, kManyTriangles);
  }
  findings.add_if_none("triangles", "{} triangles, none degenerate, none twice.", n);
}

void check_pieces(const MeshTopology& topology, Findings& findings) {
  const auto& pieces = topology.triangles_of_piece;
  if (pieces.size() > 1) {
    findings.add(Severity::kWarning, "pieces",
                 "The mesh has {} separate pieces ({} triangles in the largest, {} in the "
                 "smallest): unite them, and delete what is hidden inside or not the part.",
                 pieces.size(), pieces.front(), pieces.back());
  }
  findings.add_if_none("pieces", "The mesh is one piece.");
}

void say_symmetries(const Mesh& mesh, Findings& findings) {
  findings.add(Severity::kOk, "symmetries",
               "{}. If that is wrong, part.yaml can say what is right.",
               symmetries_sentence(find_symmetries(mesh)));
}

void check_size(const Eigen::Vector3d& extents, const SensorResolution& sensor,
                Findings& findings) {
  const double across_m = extents[1];
  const double across_px = sensor.focal_length_px * across_m / sensor.distance_m;
  if (across_px < kMinPixelsAcross) {
    const double needed_m = sensor.focal_length_px * across_m / kMinPixelsAcross;
    findings.add(Severity::kWarning, "size",
                 "At {:.2f} m the part is {:.1f} pixels wide ({:.4g} mm); telling its pose takes "
                 "{:.0f}: bring the camera to {:.2f} m{}.",
                 sensor.distance_m, across_px, across_m * 1e3, kMinPixelsAcross, needed_m,
                 needed_m < kKinectNearest_m
                     ? ", which is nearer than a Kinect v2 sees, or use one of longer focal length"
                     : "");
  }
  const double thickness_m = extents[2];
  if (thickness_m < kMinThicknessSigmas * sensor.depth_noise_m) {
    findings.add(Severity::kWarning, "size",
                 "The part is {:.4g} mm thick, below {:.0f} times the depth noise of {:.4g} mm: "
                 "lying flat it can't be told from what it lies on. Nearness helps little; it "
                 "takes a camera with a noise of at most {:.2g} mm.",
                 thickness_m * 1e3, kMinThicknessSigmas, sensor.depth_noise_m * 1e3,
                 thickness_m / kMinThicknessSigmas * 1e3);
  }
  findings.add_if_none("size", "At {:.2f} m the part is {:.0f} × {:.0f} pixels.", sensor.distance_m,
                       sensor.focal_length_px * extents[0] / sensor.distance_m, across_px);
}

void check_walls(const Mesh& mesh, const SensorResolution& sensor, Findings& findings) {
  const double pixel_m = sensor.distance_m / sensor.focal_length_px;
  const std::vector<double> thicknesses_m = wall_thicknesses_m(mesh);
  const auto thin_n = std::count_if(thicknesses_m.begin(), thicknesses_m.end(),
                                    [&](double thickness_m) { return thickness_m < pixel_m; });
  const double share = static_cast<double>(thin_n) / static_cast<double>(thicknesses_m.size());
  if (share > kWallShare) {
    findings.add(
        Severity::kWarning, "walls",
        "{:.0f} % of the surface are walls or ribs thinner than a pixel, which is {:.2g} mm "
        "wide at {:.2f} m: seen on edge they vanish from the depth image, so that only "
        "their faces can tell the pose.",
        share * 100, pixel_m * 1e3, sensor.distance_m);
  }
  findings.add_if_none("walls", "Its walls are thicker than a pixel, which is {:.2g} mm wide.",
                       pixel_m * 1e3);
}

}  // namespace

std::vector<MeshFinding> check_mesh(const Mesh& mesh, const SensorResolution& sensor,
                                    std::optional<LengthUnit> declared) {
  Findings findings;
  if (mesh.triangles.empty()) {
    findings.add(Severity::kError, "triangles",
                 "The mesh has 0 triangles: export the part's solid as a triangle mesh.");
    return findings.take();
  }
  const MeshTopology topology = analyse_topology(mesh);
  const Eigen::Vector3d extents = sorted_extents_m(mesh);
  const double diameter = diameter_m(mesh);
  check_units(diameter, extents, sensor, declared, findings);
  check_normals(mesh, topology, findings);
  check_solid(mesh, topology, extents, diameter, findings);
  check_edges(mesh, topology, findings);
  check_triangles(mesh, topology, findings);
  check_pieces(topology, findings);
  say_symmetries(mesh, findings);
  // Of a part in the wrong unit, pixels say nothing, nor of what is no solid.
  if (diameter >= kSmallPart_m && diameter <= kLargePart_m && !findings.has_error()) {
    check_size(extents, sensor, findings);
    if (topology.is_closed()) check_walls(mesh, sensor, findings);
  }
  return findings.take();
}

}  // namespace graspd::parts

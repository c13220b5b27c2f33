#include "graspd/parts/catalogue.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace graspd::parts {
namespace {

/// Hashes values, not memory: no padding, one byte order, no −0.0.
class ContentHash {
 public:
  void add(std::int64_t value) {
    std::array<unsigned char, 8> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      bytes[i] = static_cast<unsigned char>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void add(double value) { add(std::bit_cast<std::int64_t>(value + 0.0)); }
  void add(const std::string& text) {
    add(static_cast<std::int64_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }
  template <class Scalar>
  void add(const Eigen::Matrix<Scalar, 3, 1>& vector) {
    for (const Scalar value : vector) add(static_cast<double>(value));
  }
  /// To 1e-9: the last bit of a sine is not the same on every machine.
  void add_rounded(double value) { add(std::int64_t{std::llround(value * 1e9)}); }
  template <class Derived>
  void add_rounded(const Eigen::MatrixBase<Derived>& matrix) {
    for (const double value : matrix.reshaped()) add_rounded(value);
  }
  void add_size(std::size_t size) { add(static_cast<std::int64_t>(size)); }

  std::string hex() const {
    return fmt::format("{:016x}", XXH3_64bits(bytes_.data(), bytes_.size()));
  }

 private:
  std::vector<unsigned char> bytes_;
};

void add_mesh(ContentHash& hash, const Mesh& mesh) {
  hash.add_size(mesh.vertices_m.size());
  for (const auto& vertex_m : mesh.vertices_m) hash.add(vertex_m);
  hash.add_size(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (const int index : triangle) hash.add(std::int64_t{index});
  }
}

void add_symmetries(ContentHash& hash, const Symmetries& symmetries) {
  hash.add_size(symmetries.discrete.size());
  for (const auto& T : symmetries.discrete) hash.add_rounded(T.matrix());
  hash.add_size(symmetries.continuous.size());
  for (const auto& symmetry : symmetries.continuous) {
    hash.add_rounded(symmetry.axis);
    hash.add_rounded(symmetry.point_m);
  }
}

void add_pick_point(ContentHash& hash, const PickPoint& point) {
  hash.add(point.name);
  hash.add_rounded(point.position_m);
  hash.add_rounded(point.approach);
  hash.add_rounded(point.closing);
  hash.add_rounded(point.approach_cone_rad);
  hash.add_rounded(point.tip_reach_m);
  hash.add_rounded(point.width_m);
  hash.add_rounded(point.priority);
  hash.add(point.gripper);
  hash.add(std::int64_t{point.is_proposed});
}

std::string hash_of(const std::vector<Part>& parts) {
  ContentHash hash;
  for (const Part& part : parts) {
    hash.add(part.id);
    hash.add(std::int64_t{part.bop_obj_id});
    add_mesh(hash, part.mesh);
    add_symmetries(hash, part.symmetries);
    hash.add_size(part.pick_points.size());
    for (const PickPoint& point : part.pick_points) add_pick_point(hash, point);
  }
  return hash.hex();
}

/// An id or a BOP number that two parts share, as a sentence; empty where there is none.
std::string clash_of(const std::vector<Part>& parts) {
  for (auto part = parts.begin(); part != parts.end(); ++part) {
    for (auto other = parts.begin(); other != part; ++other) {
      if (other->id == part->id) return fmt::format("two parts have the id '{}'", part->id);
      if (part->bop_obj_id != 0 && other->bop_obj_id == part->bop_obj_id) {
        return fmt::format("the parts '{}' and '{}' have the same bop_obj_id {}", other->id,
                           part->id, part->bop_obj_id);
      }
    }
  }
  return {};
}

std::vector<std::filesystem::path> part_files(const std::filesystem::path& directory,
                                              std::error_code& error) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
    const auto file = entry.path() / "part.yaml";
    std::error_code ignored;  // what can't be looked at holds no part
    if (std::filesystem::exists(file, ignored)) files.push_back(file);
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

Catalogue::Catalogue(std::vector<Part> parts) : parts_(std::move(parts)) {
  if (const std::string clash = clash_of(parts_); !clash.empty())
    throw std::invalid_argument(clash);
  hash_ = hash_of(parts_);
}

Result<Catalogue> Catalogue::load(const std::filesystem::path& directory) {
  std::error_code error;
  const auto files = part_files(directory, error);
  if (error) {
    return invalid("part catalogue {}: the folder can't be read ({})", directory.string(),
                   error.message());
  }
  if (files.empty()) {
    return invalid("part catalogue {}: no folder in it holds a part.yaml", directory.string());
  }
  std::vector<Part> parts;
  std::string faults;
  for (const auto& file : files) {
    auto part = read_part_file(file).and_then(make_part);
    if (part) {
      parts.push_back(std::move(*part));
    } else {
      faults += (faults.empty() ? "" : "\n") + part.error().message;
    }
  }
  if (!faults.empty()) return invalid("{}", faults);
  if (const std::string clash = clash_of(parts); !clash.empty()) {
    return invalid("part catalogue {}: {}", directory.string(), clash);
  }
  return Catalogue(std::move(parts));
}

const Part* Catalogue::find(std::string_view id) const {
  const auto found =
      std::find_if(parts_.begin(), parts_.end(), [&](const Part& part) { return part.id == id; });
  return found == parts_.end() ? nullptr : &*found;
}

Result<const Part*> Catalogue::get(std::string_view id) const {
  if (const Part* part = find(id)) return part;
  std::vector<std::string_view> known;
  for (const Part& part : parts_) known.push_back(part.id);
  return fail(Code::kUnknownPart, "parts: no part '{}' in the catalogue; it has: {}", id,
              fmt::join(known, ", "));
}

const Part* Catalogue::find_bop(int obj_id) const {
  if (obj_id == 0) return nullptr;  // 0 says that a part has no number
  const auto found = std::find_if(parts_.begin(), parts_.end(),
                                  [&](const Part& part) { return part.bop_obj_id == obj_id; });
  return found == parts_.end() ? nullptr : &*found;
}

}  // namespace graspd::parts

#include "part_shapes.hpp"

#include <bit>

#include "graspd/parts/mesh.hpp"
#include "graspd/parts/part.hpp"

namespace graspd::console {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostTriangles_n = 200'000;
static_assert(std::endian::native == std::endian::little);

}  // namespace

Result<std::string> part_triangles(const fs::path& catalogue, const std::string& id) {
  std::error_code error;
  for (fs::directory_iterator entry(catalogue, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path file = entry->path() / "part.yaml";
    if (!fs::exists(file, error)) continue;
    const auto part = parts::read_part_file(file);
    if (!part || part->id != id) continue;
    const auto mesh = parts::load_mesh(part->mesh_file, part->mesh_unit);
    if (!mesh) return tl::unexpected(mesh.error());
    if (mesh->triangles.size() > kMostTriangles_n) {
      return invalid("part '{}' has {} triangles, more than the {} that a page draws", id,
                     mesh->triangles.size(), kMostTriangles_n);
    }
    std::string bytes;
    bytes.reserve(mesh->triangles.size() * 3 * sizeof(Eigen::Vector3f));
    for (const auto& corners : mesh->triangles) {
      for (const int corner : corners) {
        const Eigen::Vector3f& p_part_m = mesh->vertices_m[static_cast<std::size_t>(corner)];
        bytes.append(reinterpret_cast<const char*>(p_part_m.data()), sizeof(Eigen::Vector3f));
      }
    }
    return bytes;
  }
  return invalid("{}: the catalogue has no part '{}'; --parts says where it is", catalogue.string(),
                 id);
}

}  // namespace graspd::console

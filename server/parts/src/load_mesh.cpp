#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <bit>
#include <cctype>
#include <cmath>
#include <unordered_map>

#include "graspd/parts/mesh.hpp"
#include "length_unit.hpp"

namespace graspd::parts {
namespace {

struct PositionHash {
  std::size_t operator()(const std::array<float, 3>& p) const {
    std::size_t hash = 0;
    for (const float value : p) hash = hash * 1'000'003U ^ std::bit_cast<std::uint32_t>(value);
    return hash;
  }
};

/// Joins vertices at the very same place. STL has three of its own for every triangle.
class VertexMerger {
 public:
  explicit VertexMerger(double metres_per_unit) : metres_per_unit_(metres_per_unit) {}

  int index_of(const aiVector3D& position) {
    // + 0 turns −0 into 0, which compares equal but has other bits.
    const std::array<float, 3> key{position.x + 0.0F, position.y + 0.0F, position.z + 0.0F};
    const auto [entry, is_new] = indices_.emplace(key, static_cast<int>(vertices_m_.size()));
    if (is_new) {
      const Eigen::Vector3d p(key[0], key[1], key[2]);
      vertices_m_.push_back((p * metres_per_unit_).cast<float>());
    }
    return entry->second;
  }

  std::vector<Eigen::Vector3f> take() { return std::move(vertices_m_); }

 private:
  double metres_per_unit_;
  std::vector<Eigen::Vector3f> vertices_m_;
  std::unordered_map<std::array<float, 3>, int, PositionHash> indices_;
};

bool is_finite(const aiVector3D& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

Result<Mesh> to_mesh(const aiScene& scene, LengthUnit unit, const std::string& name) {
  Mesh mesh;
  VertexMerger merger(metres_per(unit));
  std::size_t others_n = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[m];
    others_n += part.mNumFaces == 0 ? part.mNumVertices : 0;
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) {
        ++others_n;
        continue;
      }
      std::array<int, 3> triangle{};
      for (unsigned k = 0; k < 3; ++k) {
        const aiVector3D& position = part.mVertices[face.mIndices[k]];
        if (!is_finite(position)) {
          return invalid("mesh {}: a vertex is not a finite number; export the part again", name);
        }
        triangle[k] = merger.index_of(position);
      }
      mesh.triangles.push_back(triangle);
    }
  }
  if (mesh.triangles.empty()) {
    return invalid("mesh {}: it has 0 triangles{}; export the part's solid as a triangle mesh",
                   name, others_n > 0 ? fmt::format(", only {} points or lines", others_n) : "");
  }
  mesh.vertices_m = merger.take();
  return mesh;
}

}  // namespace

Result<Mesh> load_mesh(const std::filesystem::path& path, LengthUnit unit) {
  const std::string name = path.string();
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return invalid("mesh {}: there is no such file", name);
  if (!std::filesystem::is_regular_file(path, error)) return invalid("mesh {}: is no file", name);
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != ".stl" && extension != ".ply" && extension != ".obj") {
    return invalid("mesh {}: graspd reads STL, PLY and OBJ; export the part as one of them", name);
  }
  Assimp::Importer importer;
  const aiScene* scene =
      importer.ReadFile(name, aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (scene == nullptr) {
    return invalid("mesh {}: can't be read ({}); export the part again", name,
                   importer.GetErrorString());
  }
  return to_mesh(*scene, unit, name);
}

}  // namespace graspd::parts

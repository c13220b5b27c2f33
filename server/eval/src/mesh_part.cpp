#include "graspd/eval/mesh_part.hpp"

namespace graspd::eval {

Result<parts::Part> mesh_part(const std::filesystem::path& mesh, parts::LengthUnit unit,
                              int bop_obj_id) {
  parts::PartDescription description;
  description.id = mesh.stem().string();
  description.name = description.id;
  description.mesh_file = mesh;
  description.mesh_unit = unit;
  description.bop_obj_id = bop_obj_id;
  return parts::make_part(description);
}

}  // namespace graspd::eval

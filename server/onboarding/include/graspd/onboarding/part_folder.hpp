#pragma once

#include <filesystem>
#include <string>

#include "graspd/parts/part.hpp"

namespace graspd::onboarding {

/// Where a new part, or a new version of one, goes: FOLDER/ID with part.yaml, ID_1.stl, and of a
/// part that has been replaced part_1.yaml beside ID_2.stl.
struct PartVersion {
  std::filesystem::path folder;  ///< of this part
  std::string id;
  int version = 1;
  int bop_obj_id = 1;             ///< the part's own, or the next one that is free
  bool is_there_already = false;  ///< with this very mesh: nothing is written

  std::filesystem::path part_file() const { return folder / "part.yaml"; }
  /// ID_VERSION.stl
  std::string mesh_name() const;
};

/// \param is_replacing whether another version may take the place of the one that is there
/// \returns INVALID_ARGUMENT where the id is wrong, or another folder's; and where another version
/// is there that is not to be replaced, with what to do.
Result<PartVersion> version_in(const std::filesystem::path& parts, const std::string& id,
                               const parts::Mesh& mesh, bool is_replacing);

/// Writes the mesh as STL in millimetres, where it is not there already.
/// \returns the part as a server will load it; INVALID_ARGUMENT where the mesh can't be written, or
/// can't be a part
Result<parts::Part> write_mesh(const PartVersion& version, const parts::Mesh& mesh);

/// Then part.yaml, in one step, so that a server that reloads sees the old version or the new one.
/// \param remarks lines for the file's head
Result<void> write_part_file(const PartVersion& version, const std::string& remarks);

/// Takes back what `write_mesh` wrote, where the part comes to nothing.
void discard_mesh(const PartVersion& version);

}  // namespace graspd::onboarding

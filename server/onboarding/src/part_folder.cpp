#include "graspd/onboarding/part_folder.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <fstream>
#include <sstream>
#include <system_error>

#include "graspd/parts/part_version.hpp"

namespace graspd::onboarding {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "STL is little-endian");

template <class Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_point(std::string& bytes, const Eigen::Vector3f& point) {
  for (const float value : point) append(bytes, value);
}

/// Binary, in millimetres.
std::string stl_of(const parts::Mesh& mesh) {
  constexpr float kMillimetresPerMetre = 1e3F;
  std::string bytes(80, '\0');
  append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    const auto corner = [&](std::size_t k) -> Eigen::Vector3f {
      return kMillimetresPerMetre * mesh.vertices_m[static_cast<std::size_t>(triangle[k])];
    };
    append_point(bytes, (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized());
    for (std::size_t k = 0; k < 3; ++k) append_point(bytes, corner(k));
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string content_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

Result<void> write_file(const fs::path& path, const std::string& content) {
  std::ofstream file(path, std::ios::binary);
  file << content << std::flush;
  if (!file)
    return invalid("{}: can't be written; may you write there, is the disk full?", path.string());
  return {};
}

/// The parts that are there, as far as their files can be read.
std::vector<parts::PartDescription> descriptions_in(const fs::path& folder) {
  std::vector<parts::PartDescription> found;
  std::error_code ignored;  // a folder that is not there has no parts
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    std::error_code none;
    if (!fs::exists(entry.path() / "part.yaml", none)) continue;
    if (auto part = parts::read_part_file(entry.path() / "part.yaml")) found.push_back(*part);
  }
  return found;
}

bool is_part_id(const std::string& id) {
  return !id.empty() && id.front() != '.' && std::ranges::all_of(id, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  });
}

/// In quotes, since YAML would read a name like "1.0" as a number.
std::string part_yaml(const PartVersion& version, const std::string& remarks) {
  std::string text;
  std::istringstream lines(remarks);
  for (std::string line; std::getline(lines, line);)
    text += line.empty() ? "#\n" : "# " + line + "\n";
  return text + fmt::format(
                    "id: \"{}\"\nversion: {}\nbop_obj_id: {}\nmesh: \"{}\"\n"
                    "mesh_unit: mm\n",
                    version.id, version.version, version.bop_obj_id, version.mesh_name());
}

}  // namespace

std::string PartVersion::mesh_name() const { return fmt::format("{}_{}.stl", id, version); }

Result<PartVersion> version_in(const fs::path& parts, const std::string& id,
                               const parts::Mesh& mesh, bool is_replacing) {
  if (!is_part_id(id)) {
    return invalid("--name {}: a part is named with letters, digits, '_', '-' and '.'", id);
  }
  PartVersion version{parts / id, id};
  const parts::PartDescription* old = nullptr;
  const auto known = descriptions_in(parts);
  for (const auto& part : known) {
    version.bop_obj_id = std::max(version.bop_obj_id, part.bop_obj_id + 1);
    if (part.file == version.part_file()) {
      old = &part;
    } else if (part.id == id) {
      return invalid("--name {}: {} has that id already; choose another name", id,
                     part.file.string());
    }
  }
  std::error_code error;
  if (old == nullptr && fs::exists(version.part_file(), error)) {
    return invalid(
        "{}: is there and can't be read (`grasp_server part check` says why); mend or "
        "remove it, or choose another --name",
        version.part_file().string());
  }
  if (old == nullptr) return version;
  version.version = parts::read_part_version(version.part_file());
  if (old->bop_obj_id > 0) version.bop_obj_id = old->bop_obj_id;
  version.is_there_already = content_of(old->mesh_file) == stl_of(mesh);
  if (version.is_there_already) return version;
  if (!is_replacing) {
    return invalid(
        "{}: version {} of '{}' is there, with another mesh. To put this one in its place as "
        "version "
        "{} say --replace (the old file stays beside it, as part_{}.yaml); to have both, choose "
        "another --name",
        version.part_file().string(), version.version, id, version.version + 1, version.version);
  }
  ++version.version;
  return version;
}

Result<parts::Part> write_mesh(const PartVersion& version, const parts::Mesh& mesh) {
  if (version.is_there_already)
    return parts::read_part_file(version.part_file()).and_then(parts::make_part);
  std::error_code error;
  fs::create_directories(version.folder, error);
  if (error) return invalid("{}: can't be made: {}", version.folder.string(), error.message());
  parts::PartDescription description;
  description.file = version.part_file();
  description.id = version.id;
  description.name = version.id;
  description.bop_obj_id = version.bop_obj_id;
  description.mesh_file = version.folder / version.mesh_name();
  if (auto ok = write_file(description.mesh_file, stl_of(mesh)); !ok) {
    return tl::unexpected(ok.error());
  }
  return parts::make_part(description);
}

Result<void> write_part_file(const PartVersion& version, const std::string& remarks) {
  if (version.is_there_already) return {};
  const fs::path file = version.part_file();
  const fs::path next = version.folder / "part.yaml.new";
  if (auto ok = write_file(next, part_yaml(version, remarks)); !ok) return ok;
  std::error_code error;
  if (version.version > 1) {
    fs::copy_file(file, version.folder / fmt::format("part_{}.yaml", version.version - 1),
                  fs::copy_options::overwrite_existing, error);
    if (error) return invalid("{}: can't be kept: {}", file.string(), error.message());
  }
  fs::rename(next, file, error);
  if (error) return invalid("{}: can't be written: {}", file.string(), error.message());
  return {};
}

void discard_mesh(const PartVersion& version) {
  if (version.is_there_already) return;
  std::error_code ignored;  // what is left over is no part without its part.yaml
  fs::remove(version.folder / version.mesh_name(), ignored);
  fs::remove(version.folder, ignored);  // where it is empty
}

}  // namespace graspd::onboarding

#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "graspd/parts/part.hpp"

namespace graspd::parts {

/// The parts a server knows. Immutable after loading, so any number of threads may read it.
class Catalogue {
 public:
  Catalogue() = default;
  /// \throws std::invalid_argument where two parts share an id or a BOP number.
  explicit Catalogue(std::vector<Part> parts);

  /// Loads every DIRECTORY/*/part.yaml, in the order of their folder names.
  /// \returns INVALID_ARGUMENT naming each file that is wrong.
  static Result<Catalogue> load(const std::filesystem::path& directory);

  const std::vector<Part>& parts() const { return parts_; }
  /// Null where there is no such part.
  const Part* find(std::string_view id) const;
  /// \returns UNKNOWN_PART naming those that there are.
  Result<const Part*> get(std::string_view id) const;
  /// By its number in BOP scenes; null where there is none.
  const Part* find_bop(int obj_id) const;
  /// Of everything that can change an answer: meshes, symmetries, pick points.
  const std::string& hash() const { return hash_; }

 private:
  std::vector<Part> parts_;
  std::string hash_;
};

}  // namespace graspd::parts

#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graspd/keys/key_files.hpp"

namespace graspd::keys {

/// Which cells may use a server: a file with the lines of their .pub files. A cell may have several
/// keys, so that a new one can be brought in before the old one goes; a key has one cell.
class AllowList {
 public:
  /// Lines that are wrong let nobody in; they are named in `faults`, and the rest is kept.
  /// \returns INVALID_ARGUMENT for a file that can't be read, or that others than its user may
  /// write.
  static Result<AllowList> read(const std::filesystem::path& path);

  /// The cell that a public key belongs to. Valid as long as the list.
  std::optional<std::string_view> cell_of(std::string_view public_key) const;
  const std::vector<PublicKey>& entries() const { return entries_; }
  /// A sentence for each line that is wrong, with its place.
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  void take(const std::string& line, const std::string& place);

  std::vector<PublicKey> entries_;
  std::vector<std::string> faults_;
  std::map<std::string, std::string, std::less<>> cells_;  ///< by public key
};

/// Adds a key at the end of the file, which is made where it is missing.
/// \returns INVALID_ARGUMENT for a key that is in the list already.
Result<void> allow(const std::filesystem::path& path, const PublicKey& key);
/// Takes all keys of a cell out. Nothing else in the file changes. \returns how many there were,
/// or INVALID_ARGUMENT where there was none.
Result<std::size_t> revoke(const std::filesystem::path& path, std::string_view cell);

}  // namespace graspd::keys

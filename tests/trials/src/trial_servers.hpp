#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "graspd/trials/load.hpp"
#include "graspd/trials/trials.hpp"
#include "serve_process.hpp"
#include "temporary_folder.hpp"

/// What all trials begin and end with.
namespace graspd::trials {

/// Keys of servers and their cells, on disk as an operator has them.
class Keyring {
 public:
  /// All cells are allowed at first.
  explicit Keyring(const std::vector<std::string>& cells);
  /// The same cells' keys, and a server's of its own.
  explicit Keyring(const std::map<std::string, keys::ClientKeys>& cells);
  const std::map<std::string, keys::ClientKeys>& of_cells() const { return of_cells_; }
  /// What a server is told of them.
  std::vector<std::string> server_words() const;
  /// Takes the cell from the list of those that a server lets in, when it reads it again.
  void revoke(const std::string& cell) const;

 private:
  testing::TemporaryFolder folder_;
  std::map<std::string, keys::ClientKeys> of_cells_;
};

/// The one place where the trials' servers get their configuration.
std::unique_ptr<testing::ServeProcess> start_server(int workers_n, const std::string& endpoint = {},
                                                    const Keyring* keys = nullptr,
                                                    const std::string& log = {});
LoadOptions cells_of(const std::vector<std::string>& endpoints, int cells_n);
/// \throws std::runtime_error where the server does not answer.
HealthAnswer health_of(const std::string& endpoint);
/// That a process has open.
std::size_t descriptors_n(pid_t pid);
Seen seen_in(const History& history);

}  // namespace graspd::trials

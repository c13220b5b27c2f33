#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "graspd/client/client.hpp"
#include "graspd/types/result.hpp"

/// What operators look at: a web page of cells, their last frames, plans and picks. It shows what
/// is kept anyway (the servers' flight recorders, the agents' records, the servers' health) and
/// writes nothing.
namespace graspd::console {

/// What a console shows, and where it listens.
struct ConsoleOptions {
  std::vector<std::filesystem::path> flights;  ///< folders of servers' flight recorders
  std::vector<std::filesystem::path> records;  ///< folders with agents' runs in them
  std::filesystem::path parts;                 ///< the catalogue, for the parts' shapes
  std::filesystem::path page;                  ///< index.html and what it loads
  std::string host = "127.0.0.1";
  int port = 8080;  ///< 0 takes a free one
  /// Asked once a second, while somebody looks; empty: no server is asked.
  std::function<std::vector<client::ServerHealth>()> ask_servers;
};

/// Whether only this machine can reach it.
bool is_loopback(const std::string& host);

/// Serves until it is destroyed, from threads of its own.
class Console {
 public:
  /// \returns INVALID_ARGUMENT where the page is not there or the port can't be had.
  static Result<Console> start(ConsoleOptions options);

  Console(Console&&) noexcept;
  Console& operator=(Console&&) noexcept;
  ~Console();

  /// http://HOST:PORT, with the port that it got.
  const std::string& url() const;

 private:
  class Impl;
  explicit Console(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::console

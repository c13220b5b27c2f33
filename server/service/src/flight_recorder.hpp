#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "flight_folder.hpp"
#include "graspd/service/config.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/envelope.hpp"

namespace graspd::service {

/// One request that a worker was given, and what came of it. The messages are shared with whoever
/// sends them.
struct Flight {
  std::string cell;
  RequestId id{};
  ServerInfo server;
  zmq::message_t request;
  zmq::message_t depth_image;
  zmq::message_t answer;
};

/// Keeps the last requests of each cell for `grasp replay`, one file each (flight.proto), in a
/// folder of limited size.
///
/// Nobody waits for it: `keep` hands a flight to a thread of its own, which writes. Where the disk
/// is full, or slower than the requests come, flights are lost; that is said once, and once when it
/// is over.
class FlightRecorder {
 public:
  explicit FlightRecorder(const FlightRecorderConfig& config);
  /// Writes what is waiting.
  ~FlightRecorder();
  FlightRecorder(const FlightRecorder&) = delete;
  FlightRecorder& operator=(const FlightRecorder&) = delete;

  bool is_on() const { return thread_.joinable(); }
  /// The name of a flight that is answered now: names are in the order of their time.
  static std::string name_of(const RequestId& id);
  std::filesystem::path path_of(const std::string& cell, const std::string& name) const {
    return folder_.path_of(cell, name);
  }
  void keep(std::string name, Flight flight);
  /// What is to be said of it since the last call.
  std::vector<std::string> news();

 private:
  struct Waiting {
    std::string name;
    double stamp_s = 0;
    Flight flight;
  };

  void run();
  Result<void> write(const Waiting& waiting);
  void lost(const std::string& why);
  void kept();

  FlightFolder folder_;  ///< the thread's, but for `path_of`
  std::mutex mutex_;
  std::condition_variable wake_;
  // Guarded by mutex_:
  std::deque<Waiting> waiting_;
  std::vector<std::string> news_;
  std::size_t lost_n_ = 0;  ///< since the last one that was kept
  bool stop_ = false;
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace graspd::service

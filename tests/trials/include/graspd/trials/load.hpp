#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "graspd/load/generator.hpp"
#include "graspd/trials/history.hpp"
#include "graspd/trials/question.hpp"

namespace graspd::trials {

/// Who asks what of whom.
struct LoadOptions {
  std::vector<std::string> endpoints;
  std::string name = "cell";  ///< cells are name_0, name_1, …, each with a client of its own
  int cells_n = 1;
  int in_flight_n = 1;  ///< of each cell, in a closed loop
  std::string script = "sleep_20";
  std::chrono::milliseconds budget{5000};
  client::DispatchOptions dispatch{};
  std::map<std::string, keys::ClientKeys> keys;  ///< by cell; who has none comes without
};

/// The same questions over and over, so that their answers can be compared.
inline constexpr std::uint32_t kQuestions_n = 50;

/// Asks one question and notes what came of it. \param planned the instant its time counts from
void ask(client::Client& client, const Question& question, std::chrono::milliseconds budget,
         TimePoint planned, History& history);

/// Clients that each ask again as soon as they are answered, until the object's end.
class ClosedLoop {
 public:
  ClosedLoop(const LoadOptions& options, History& history);

  /// Waits for what is in flight.
  void stop() { loop_.stop(); }

 private:
  std::unique_ptr<load::Generator> generator_;
  load::ClosedLoop loop_;
};

/// Asks at planned instants, whether or not earlier questions are answered, and counts time from
/// those instants, so that a server that is slow can't slow the clock down. Cells take turns; they
/// are connected before the first one.
void run_open_loop(const LoadOptions& options, double rate_hz, int requests_n, History& history);

}  // namespace graspd::trials

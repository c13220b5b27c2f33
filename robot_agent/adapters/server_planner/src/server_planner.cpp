#include "graspd/server_planner/server_planner.hpp"

#include <stdexcept>

#include "graspd/client/client.hpp"

namespace graspd::agent {
namespace {

class ServerPlanner final : public Planner {
 public:
  ServerPlanner(const std::vector<std::string>& endpoints, client::ClientOptions options,
                std::chrono::milliseconds budget)
      : client_(endpoints, std::move(options)), budget_(budget) {}

  PlanReply plan(const DepthFrame& frame, const PlanRequest& request) override {
    const RequestId id = client::new_request_id();
    return {hexadecimal(id), client_.plan(frame, request, budget_, id)};
  }

 private:
  client::Client client_;
  std::chrono::milliseconds budget_;
};

}  // namespace

Result<std::unique_ptr<Planner>> connect_planner(const std::vector<std::string>& endpoints,
                                                 const std::string& cell,
                                                 std::chrono::milliseconds budget,
                                                 std::optional<keys::ClientKeys> keys) {
  if (keys && keys->own.cell != cell) {
    return invalid("key_file: holds the key of '{}', but this cell is '{}'", keys->own.cell, cell);
  }
  client::ClientOptions options;
  options.cell = cell;
  options.keys = std::move(keys);
  try {
    return std::make_unique<ServerPlanner>(endpoints, std::move(options), budget);
  } catch (const std::invalid_argument& e) {
    return invalid("servers: {}", e.what());
  }
}

}  // namespace graspd::agent

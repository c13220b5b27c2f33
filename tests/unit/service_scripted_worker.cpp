#include <string>

#include "service_script.hpp"

/// What a test's front starts as its worker process: --endpoint E --identity I
int main(int count, char** words) {
  graspd::service::WorkerOptions options;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string key = words[i];
    if (key == "--endpoint") options.endpoint = words[i + 1];
    if (key == "--identity") options.identity = words[i + 1];
  }
  options.server = graspd::service::kScriptedServer;
  graspd::service::prepare_worker_process(512);
  graspd::service::run_worker(options, graspd::service::scripted_plan);
}

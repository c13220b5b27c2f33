#pragma once

#include <gtest/gtest.h>
#include <sys/syscall.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "service_front_support.hpp"
#include "temporary_folder.hpp"

/// Fronts with keys, which let in the cell 'tees' to begin with.
namespace graspd::service {

class AuthenticationTest : public ::testing::Test {
 protected:
  AuthenticationTest()
      : server_(keys::make_key_pair("server")), tees_(keys::make_key_pair("tees")) {
    allow(tees_);
  }

  std::filesystem::path list() const { return folder_.path() / "allowed_cells"; }
  void allow(const keys::KeyPair& pair) const {
    const auto allowed = keys::allow(list(), {pair.cell, pair.public_key});
    ASSERT_TRUE(allowed) << allowed.error().message;
  }
  void disallow(const std::string& cell) const { ASSERT_TRUE(keys::revoke(list(), cell)); }

  ServerConfig config() const {
    ServerConfig config = with_http(1);
    config.insecure = false;
    config.allowed_cells = list();
    return config;
  }
  auto with_keys() const {
    return [this](FrontOptions& options) {
      options.authentication = Authentication{server_, keys::AllowList::read(list()).value()};
    };
  }
  client::ClientOptions options_with(const keys::KeyPair& own) const {
    client::ClientOptions options = options_of(own.cell);
    options.keys = keys::ClientKeys{server_.public_key, own};
    return options;
  }
  static Result<PlanAnswer> plan(client::Client& client) {
    return client.plan(example_frame(), example_request(), kBudget);
  }
  /// Asks until it is let in, or isn't any more.
  static void wait_until(client::Client& client, bool let_in) {
    while (plan(client).has_value() != let_in) {
    }
  }

  testing::TemporaryFolder folder_;
  keys::KeyPair server_;
  keys::KeyPair tees_;
  ThreadLauncher launcher_ = threads();
};

/// Ends the thread that answers libzmq, as a crash of that thread alone would.
inline void kill_zap_thread() {
  struct sigaction action {};
  action.sa_handler = [](int) { syscall(SYS_exit, 0); };
  sigaction(SIGUSR1, &action, nullptr);
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string name;
    std::getline(std::ifstream(task.path() / "comm"), name);
    if (name != "zap") continue;
    syscall(SYS_tgkill, getpid(), std::stoi(task.path().filename()), SIGUSR1);
    while (std::filesystem::exists(task.path())) std::this_thread::yield();
    return;
  }
  FAIL() << "there is no thread named zap";
}

}  // namespace graspd::service

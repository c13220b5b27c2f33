#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "serve_process.hpp"
#include "serve_scene.hpp"

// The server as its package installs it: what it tells systemd, and where it finds its
// configuration. tests/deploy runs the package itself.
namespace graspd::testing {
namespace {

using ::testing::HasSubstr;

/// Stands for systemd: the socket that services write to (sd_notify(3)).
class NotifySocket {
 public:
  explicit NotifySocket(const std::string& path) : fd_(socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un address{AF_UNIX, {}};
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    const timeval patience{30, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    if (bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
      throw std::runtime_error("bind: " + path);
    }
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
    setenv("WATCHDOG_USEC", "1000000", 1);
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    close(fd_);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  /// The next message that is no WATCHDOG=1; those are counted.
  std::string next() {
    std::array<char, 512> buffer;
    for (;;) {
      const ssize_t read_n = recv(fd_, buffer.data(), buffer.size(), 0);
      if (read_n < 0) return "nothing in 30 s";
      const std::string message(buffer.data(), static_cast<std::size_t>(read_n));
      if (message != "WATCHDOG=1") return message;
      ++alive_n;
    }
  }

  int alive_n = 0;

 private:
  int fd_;
};

TEST(ServeInstalled, TellsSystemdWhatItIsAtAndThatItIsAlive) {
  const TemporaryFolder folder;
  write_box_part(folder, "bar", 1, {80, 24, 20});
  NotifySocket systemd((folder.path() / "notify").string());
  ServeProcess server({"--parts", (folder.path() / "parts").string(), "--workers", "1"});
  EXPECT_THAT(systemd.next(), HasSubstr("STATUS=waiting for the workers"));
  EXPECT_THAT(systemd.next(), HasSubstr("READY=1\n"));
  server.kill(SIGHUP);
  EXPECT_THAT(systemd.next(), HasSubstr("RELOADING=1\n"));
  EXPECT_THAT(systemd.next(), HasSubstr("READY=1\n"));
  server.kill(SIGTERM);
  EXPECT_THAT(systemd.next(), HasSubstr("STOPPING=1\n"));
  EXPECT_EQ(server.wait(), 0);
  EXPECT_GE(systemd.alive_n, 1);
}

TEST(ServeInstalled, FindsItsConfigurationInTheRootThatItLiesIn) {
  const TemporaryFolder root;
  std::filesystem::create_directories(root.path() / "usr/bin");
  const auto program = root.path() / "usr/bin/grasp_server";
  std::filesystem::copy_file(GRASP_SERVER, program);
  const std::string without = run(program.string() + " serve").output;
  EXPECT_THAT(without, HasSubstr("key_file and allowed_cells are missing")) << "the defaults";
  const auto config = root.write("etc/graspd/server.yaml", "workers_n: many\n");
  const Finished with = run(program.string() + " serve");
  EXPECT_EQ(with.exit_code, 2);
  EXPECT_THAT(with.output, HasSubstr(config.string() + ":1"));
}

}  // namespace
}  // namespace graspd::testing

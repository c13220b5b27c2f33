#include "graspd/console/console.hpp"

#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "flight_files.hpp"
#include "graspd/codec/codec.hpp"
#include "http_get.hpp"
#include "temporary_folder.hpp"

namespace graspd::console {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using testing::http_get;
using ::testing::Not;
using ::testing::SizeIs;

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string flight_of(const std::string& cell) {
  DepthFrame frame;
  frame.camera = {16, 12, 20, 20, 7.5, 5.5, {}};
  frame.depth.assign(192, 700);
  const auto encoded = codec::encode_frame(frame, DepthEncoding::kRvl);
  PlanRequest plan;
  plan.T_base_camera.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  plan.T_base_camera.translation().z() = 0.75;
  plan.parts = {{"tee", 0}};
  PlanAnswer nothing;
  nothing.outcome = Outcome::kBinEmpty;
  nothing.reason = "nothing there";
  Request request;
  request.cell = cell;
  request.budget_ms = 100;
  request.call = PlanCall{encoded.description, plan};
  Answer answer;
  answer.code = Code::kOk;
  answer.body = nothing;
  FlightRecord flight;
  flight.cell = cell;
  flight.stamp_s = 12;
  flight.request = codec::encode_request(request);
  flight.depth_image = text_of(encoded.payload);
  flight.answer = codec::encode_answer(answer);
  return codec::encode_flight(flight);
}

class ConsoleTest : public ::testing::Test {
 protected:
  ConsoleTest() {
    folder.write("page/index.html", "<!doctype html>");
    folder.write("secret", "not for you");
    folder.write("flights/cell/.hidden.flight", "not for you");
    ConsoleOptions options;
    options.flights = {folder.path() / "flights"};
    options.records = {folder.path() / "records"};
    options.parts = folder.path() / "parts";
    options.page = folder.path() / "page";
    options.port = 0;
    console = Console::start(options);
    if (!console) throw std::runtime_error(console.error().message);
    url = console->url().substr(0, console->url().size() - 1);
  }
  void add_flight(const std::string& name, const std::string& bytes) const {
    const auto part = folder.write("flights/" + name + ".part", bytes);
    std::filesystem::rename(part, folder.path() / "flights" / name);
  }
  /// What it says to these bytes, until it closes or has said `until`.
  std::string say(const std::string& request, const std::string& until = "\n\n\n") const {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const timeval patience{10, 0};
    setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(write(fd, request.data(), request.size()), static_cast<ssize_t>(request.size()));
    std::string said;
    std::array<char, 4096> buffer;
    while (said.find(until) == std::string::npos) {
      const ssize_t n = read(fd, buffer.data(), buffer.size());
      if (n <= 0) break;
      said.append(buffer.data(), static_cast<std::size_t>(n));
    }
    close(fd);
    return said;
  }
  std::string get(const std::string& target, const std::string& host = "localhost",
                  const std::string& until = "\n\n\n") const {
    return say(
        fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", target, host),
        until);
  }
  std::string status(const std::string& target) const { return get(target).substr(9, 3); }

  testing::TemporaryFolder folder;
  Result<Console> console = invalid("not started");
  std::string url;
};

TEST_F(ConsoleTest, ServesThePageThatMayLoadNothingFromElsewhere) {
  const std::string said = get("/");
  EXPECT_THAT(said, HasSubstr("200 OK"));
  EXPECT_THAT(said, HasSubstr("<!doctype html>"));
  EXPECT_THAT(said, HasSubstr("default-src 'none'"));
  EXPECT_THAT(said, HasSubstr("nosniff"));
}

TEST_F(ConsoleTest, ServesNothingOutsideItsFolders) {
  for (const char* target :
       {"/../secret", "/%2e%2e/secret", "/..%2fsecret", "//secret", "/./../secret",
        "/api/flight?name=../secret", "/api/flight?name=../x.flight",
        "/api/flight?name=/etc/passwd", "/api/flight?name=cell/.hidden.flight",
        "/api/depth?name=cell/../../x.flight", "/api/flight?name=cell%2f%2e%2e%2fx.flight",
        "/api/depth?name=cell/x%00.flight", "/api/part?id=../../secret", "/api/flight"}) {
    EXPECT_EQ(status(target), "404") << target;
    EXPECT_THAT(get(target), Not(HasSubstr("not for you"))) << target;
  }
}

TEST_F(ConsoleTest, AnswersToNoOtherNameThanLocalhost) {
  EXPECT_THAT(get("/", "evil.example:80"), HasSubstr("403"));
  EXPECT_THAT(get("/", "127.0.0.1:1"), HasSubstr("200 OK"));
  EXPECT_THAT(get("/", "[::1]:1"), HasSubstr("200 OK"));
}

TEST_F(ConsoleTest, StreamsWhatIsRecorded) {
  add_flight("cell/2026-11-23T00-00-00.000001Z_01.flight", flight_of("cell"));
  const std::string said = get("/api/events", "localhost", "BIN_EMPTY");
  EXPECT_THAT(said, HasSubstr("text/event-stream"));
  EXPECT_THAT(said, HasSubstr(R"("cell":"cell")"));
  EXPECT_THAT(said, HasSubstr("nothing there"));
}

TEST_F(ConsoleTest, GivesTheFrameAndThePlanOfAFlight) {
  const std::string name = "cell/2026-11-23T00-00-00.000001Z_01.flight";
  add_flight(name, flight_of("cell"));
  const std::string said = http_get(url, "/api/flight?name=" + name).body;
  const json flight = json::parse(said, nullptr, false);
  ASSERT_FALSE(flight.is_discarded()) << said;
  EXPECT_EQ(flight["camera"]["width_px"], 16);
  EXPECT_EQ(flight["request"]["parts"][0]["id"], "tee");
  EXPECT_EQ(flight["answer"]["outcome"], "BIN_EMPTY");
  const auto depth = http_get(url, "/api/depth?name=" + name);
  ASSERT_THAT(depth.body, SizeIs(384));
  EXPECT_EQ(
      static_cast<unsigned char>(depth.body[0]) + 256 * static_cast<unsigned char>(depth.body[1]),
      700);
}

TEST_F(ConsoleTest, PassesOverWhatIsDamaged) {
  std::string cut = flight_of("cell");
  cut.resize(cut.size() / 2);
  add_flight("cell/2026-11-23T00-00-00.000001Z_01.flight", cut);
  add_flight("cell/2026-11-23T00-00-00.000002Z_02.flight", std::string(4'000'000, 'x'));
  folder.write("records/run/run.json", "{");
  folder.write("records/run/picks.jsonl", "what\n");
  add_flight("cell/2026-11-23T00-00-00.000003Z_03.flight", flight_of("cell"));
  get("/api/events", "localhost", "BIN_EMPTY");
  EXPECT_THAT(json::parse(http_get(url, "/api/history?cell=cell").body), SizeIs(1));
  EXPECT_EQ(status("/api/flight?name=cell/2026-11-23T00-00-00.000001Z_01.flight"), "404");
}

TEST_F(ConsoleTest, AMissingPageIsNamed) {
  ConsoleOptions options;
  options.page = folder.path() / "nowhere";
  options.port = 0;
  const auto started = Console::start(options);
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("nowhere"));
}

TEST_F(ConsoleTest, ATakenPortIsNamed) {
  ConsoleOptions options;
  options.page = folder.path() / "page";
  options.port = std::stoi(url.substr(url.rfind(':') + 1));
  const auto started = Console::start(options);
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("in use"));
}

}  // namespace
}  // namespace graspd::console

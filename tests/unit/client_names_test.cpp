#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <mutex>

#include "client_fake_server.hpp"
#include "client_support.hpp"
#include "graspd/client/client.hpp"

// Endpoints with a host's name, against a resolver that says what the test says.
namespace graspd::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Addresses = std::vector<std::string>;

constexpr seconds kNamesBudget{20};

/// What names stand for, which may change; shared with the clients, whose lookups may outlive them.
class Names {
 public:
  void set(const std::string& host, Addresses addresses) {
    const std::lock_guard lock(state_->mutex);
    state_->addresses[host] = std::move(addresses);
  }
  void delay(milliseconds delay) {
    const std::lock_guard lock(state_->mutex);
    state_->delay = delay;
  }
  ClientOptions options(milliseconds every = milliseconds(20)) const {
    ClientOptions options;
    options.names.every = every;
    options.names.resolve = [state = state_](const std::string& host) -> Result<Addresses> {
      std::unique_lock lock(state->mutex);
      const milliseconds pause = state->delay;
      lock.unlock();
      std::this_thread::sleep_for(pause);
      lock.lock();
      const auto found = state->addresses.find(host);
      if (found == state->addresses.end()) return fail(Code::kUnavailable, "Name not known");
      return found->second;
    };
    options.names.on_warning = [state = state_](const std::string& message) {
      const std::lock_guard lock(state->mutex);
      state->warnings.push_back(message);
    };
    return options;
  }
  std::vector<std::string> warnings() const {
    const std::lock_guard lock(state_->mutex);
    return state_->warnings;
  }

 private:
  struct State {
    std::mutex mutex;
    std::map<std::string, Addresses> addresses;
    std::vector<std::string> warnings;
    milliseconds delay{0};
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

/// Servers of one port: 127.0.0.1, 127.0.0.2, …
class Pods {
 public:
  explicit Pods(std::size_t number) {
    for (std::size_t i = 0; i < number; ++i) start();
  }
  void start(FakeServer::Script script = {}) {
    const std::string address = fmt::format("127.0.0.{}", servers.size() + 1);
    if (!script) script = says(address);
    servers.push_back(std::make_unique<FakeServer>(
        std::move(script), fmt::format("tcp://{}:{}", address, port_.empty() ? "*" : port_)));
    const std::string& endpoint = servers.back()->endpoint;
    port_ = endpoint.substr(endpoint.rfind(':') + 1);
  }
  std::string endpoint(const std::string& host = "graspd") const {
    return fmt::format("tcp://{}:{}", host, port_);
  }

  std::vector<std::unique_ptr<FakeServer>> servers;

 private:
  std::string port_;
};

std::string asked(Client& client) {
  const auto answer = client.plan(example_frame(), example_request(), kNamesBudget);
  return answer ? answer->reason : answer.error().message;
}

std::vector<std::string> endpoints_of(Client& client, milliseconds budget = kNamesBudget) {
  std::vector<std::string> endpoints;
  for (const ServerHealth& server : client.health(budget)) {
    endpoints.push_back(server.endpoint);
  }
  return endpoints;
}

/// \returns whether it came true within the budget.
bool eventually(const std::function<bool()>& is_true) {
  const TimePoint end = Clock::now() + kNamesBudget;
  while (!is_true()) {
    if (Clock::now() > end) return false;
    std::this_thread::sleep_for(milliseconds(5));
  }
  return true;
}

TEST(ClientNames, AllAddressesOfANameAreServers) {
  Pods pods(3);
  Names names;
  names.set("graspd", {"127.0.0.3", "127.0.0.1", "127.0.0.2"});
  Client client({pods.endpoint()}, names.options());
  EXPECT_THAT(
      endpoints_of(client),
      ElementsAre(pods.servers[0]->endpoint, pods.servers[1]->endpoint, pods.servers[2]->endpoint));
  std::map<std::string, int> asked_n;
  for (int i = 0; i < 30; ++i) ++asked_n[asked(client)];
  EXPECT_THAT(asked_n, SizeIs(3));
}

TEST(ClientNames, OneServersDeathFailsNoRequest) {
  Pods pods(2);
  Names names;
  names.set("graspd", {"127.0.0.1", "127.0.0.2"});
  Client client({pods.endpoint()}, names.options());
  (void)client.health(kNamesBudget);
  for (int i = 0; i < 20; ++i) {
    if (i == 5) pods.servers[0]->stop();
    EXPECT_THAT(asked(client), HasSubstr("127.0.0."));
  }
  EXPECT_EQ(asked(client), "127.0.0.2");
}

TEST(ClientNames, ServersThatComeAreFoundAndThoseThatGoAreLeft) {
  Pods pods(2);
  Names names;
  names.set("graspd", {"127.0.0.1"});
  Client client({pods.endpoint()}, names.options());
  EXPECT_EQ(asked(client), "127.0.0.1");
  names.set("graspd", {"127.0.0.1", "127.0.0.2"});
  EXPECT_TRUE(eventually([&] { return asked(client) == "127.0.0.2"; }));
  names.set("graspd", {"127.0.0.2"});
  EXPECT_TRUE(eventually([&] { return endpoints_of(client).size() == 1; }));
  EXPECT_TRUE(eventually([&] { return asked(client) == "127.0.0.2"; }));
  const std::size_t before_n = 20;
  for (std::size_t i = 0; i < before_n; ++i) EXPECT_EQ(asked(client), "127.0.0.2");
  names.set("graspd", {"127.0.0.1", "127.0.0.2"});
  EXPECT_TRUE(eventually([&] { return asked(client) == "127.0.0.1"; }));
}

TEST(ClientNames, WhatIsInFlightToAServerThatGoesIsAnswered) {
  Names names;
  Pods pods(0);
  std::promise<void> arrived;
  std::promise<void> released;
  pods.start([&](const Request& request) {
    arrived.set_value();
    released.get_future().wait();
    return std::vector{ok(request, "at last")};
  });
  pods.start();
  names.set("graspd", {"127.0.0.1"});
  Client client({pods.endpoint()}, names.options());
  auto answer = client.submit(example_frame(), example_request(), kNamesBudget);
  arrived.get_future().wait();
  names.set("graspd", {"127.0.0.2"});
  EXPECT_TRUE(eventually([&] {
    // Not for long: the first server answers nobody now.
    return endpoints_of(client, milliseconds(50)) == std::vector{pods.servers[1]->endpoint};
  }));
  EXPECT_EQ(asked(client), "127.0.0.2");
  released.set_value();
  const auto result = answer.get();
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->reason, "at last");
}

TEST(ClientNames, ANameWithoutAnAddressIsSaidByTheCall) {
  Names names;
  Client client({"tcp://nowhere:5555"}, names.options());
  const auto answer = client.plan(example_frame(), example_request(), kNamesBudget);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kUnavailable);
  EXPECT_EQ(answer.error().message,
            "tcp://nowhere:5555: 'nowhere' has no address (Name not known); check the name, and "
            "that this machine's resolver knows it");
  const auto health = client.health();
  ASSERT_THAT(health, SizeIs(1));
  EXPECT_EQ(health[0].endpoint, "tcp://nowhere:5555");
  EXPECT_THAT(health[0].health.error().message, HasSubstr("'nowhere' has no address"));
  EXPECT_THAT(names.warnings(), IsEmpty());
}

TEST(ClientNames, BesideOtherServersItIsAWarningOnce) {
  Pods pods(1);
  Names names;
  Client client({"tcp://nowhere:5555", pods.endpoint("127.0.0.1")}, names.options());
  EXPECT_EQ(asked(client), "127.0.0.1");
  EXPECT_TRUE(eventually([&] { return !names.warnings().empty(); }));
  std::this_thread::sleep_for(milliseconds(1200));  // it has been looked up again
  EXPECT_THAT(names.warnings(), ElementsAre(HasSubstr("'nowhere' has no address")));
}

TEST(ClientNames, ANameThatIsNotKnownAnyMoreKeepsItsAddresses) {
  Pods pods(1);
  Names names;
  names.set("graspd", {"127.0.0.1"});
  Client client({pods.endpoint()}, names.options());
  EXPECT_EQ(asked(client), "127.0.0.1");
  names.set("graspd", {});
  EXPECT_TRUE(eventually([&] { return !names.warnings().empty(); }));
  EXPECT_THAT(names.warnings(), ElementsAre(HasSubstr("the addresses it had are kept")));
  EXPECT_EQ(asked(client), "127.0.0.1");
}

TEST(ClientNames, AnAddressThatTwoNamesShareIsOneServer) {
  Pods pods(1);
  Names names;
  names.set("one", {"127.0.0.1"});
  names.set("other", {"127.0.0.1"});
  Client client({pods.endpoint("one"), pods.endpoint("other"), pods.endpoint("127.0.0.1")},
                names.options());
  EXPECT_THAT(endpoints_of(client), ElementsAre(pods.servers[0]->endpoint));
}

TEST(ClientNames, ASlowLookupKeepsNobodyWaiting) {
  Pods pods(1);
  Names names;
  names.delay(seconds(2));
  const TimePoint start = Clock::now();
  {
    Client client({"tcp://slow:5555", pods.endpoint("127.0.0.1")}, names.options());
    EXPECT_EQ(asked(client), "127.0.0.1");
    const auto health = client.health(milliseconds(200));
    ASSERT_THAT(health, SizeIs(2));
    EXPECT_THAT(health[1].health.error().message, HasSubstr("still being looked up"));
  }
  EXPECT_LT(Clock::now() - start, milliseconds(1800));
}

TEST(ClientNames, ALostServerIsLookedUpAgain) {
  Pods pods(2);
  Names names;
  names.set("graspd", {"127.0.0.1"});
  Client client({pods.endpoint()}, names.options(std::chrono::hours(1)));
  EXPECT_EQ(asked(client), "127.0.0.1");
  names.set("graspd", {"127.0.0.2"});
  pods.servers[0]->stop();
  EXPECT_TRUE(eventually([&] { return asked(client) == "127.0.0.2"; }));
}

TEST(ClientNames, TheSystemKnowsLocalhost) {
  const auto addresses = addresses_of("localhost");
  ASSERT_TRUE(addresses) << addresses.error().message;
  EXPECT_THAT(*addresses, ElementsAre("127.0.0.1"));
  EXPECT_FALSE(addresses_of("nowhere.invalid"));
}

}  // namespace
}  // namespace graspd::client

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "graspd/service/config.hpp"
#include "graspd/service/endpoint.hpp"

namespace graspd::service {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kReference =
    std::filesystem::path(GRASPD_SOURCE_DIR) / "deploy/server.yaml";

class ConfigTest : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    std::string folder = ::testing::TempDir() + "config_XXXXXX";
    folder_ = mkdtemp(folder.data());
    std::ofstream(folder_ / "server.yaml") << text;
    return folder_ / "server.yaml";
  }
  std::string refusal(const std::string& text) {
    const auto config = read_config(write(text));
    EXPECT_FALSE(config) << text;
    return config ? "" : config.error().message;
  }
  ~ConfigTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// The settings of the reference file: lines "#key: value", indented by twos.
std::string uncommented(const std::string& reference) {
  static const std::regex setting(R"(#((?:  )*[a-z0-9_]+:.*))");
  std::istringstream lines(reference);
  std::string text;
  std::string line;
  std::smatch match;
  while (std::getline(lines, line)) {
    if (std::regex_match(line, match, setting)) text += match[1].str() + "\n";
  }
  return text;
}

/// With the parts folder relative again, so that files in different folders can be compared.
std::string comparable(ServerConfig config, const std::filesystem::path& folder) {
  config.parts = config.parts.lexically_relative(folder);
  return to_yaml(config);
}

std::vector<std::string> keys_of(const std::string& yaml) {
  static const std::regex key(R"(^ *([a-z0-9_]+):)");
  std::istringstream lines(yaml);
  std::vector<std::string> keys;
  std::string line;
  std::smatch match;
  while (std::getline(lines, line)) {
    if (std::regex_search(line, match, key)) keys.push_back(match[1]);
  }
  return keys;
}

TEST_F(ConfigTest, TheReferenceFileIsTheDefaults) {
  const auto config = read_config(kReference);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(comparable(*config, kReference.parent_path()), to_yaml(ServerConfig{}));
}

TEST_F(ConfigTest, TheReferenceFileDocumentsEveryKeyWithItsDefault) {
  const std::string settings = uncommented(text_of(kReference));
  EXPECT_EQ(keys_of(settings), keys_of(to_yaml(ServerConfig{})));
  const auto config = read_config(write(settings));
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(comparable(*config, folder_), to_yaml(ServerConfig{}));
}

TEST_F(ConfigTest, WhatIsWrittenReadsBackTheSame) {
  ServerConfig config;
  config.data_endpoint = "tcp://0.0.0.0:7000";
  config.insecure = true;
  config.parts = "/somewhere/with \"quotes\" and: colons";
  config.workers_n = 5;
  config.log_level = LogLevel::kOff;
  config.flight_recorder = {"/somewhere/flights", FlightsKept::kAll, 7, 9};
  config.http_endpoint = "tcp://0.0.0.0:9464";
  config.http_expose = true;
  config.perception.segmentation.method = Segmentation::kEuclidean;
  config.perception.segmentation.eps_m = 0.1 / 3;
  config.perception.grs.order = GraspOrder::kAscending;
  config.perception.grasp.k4 = -0.25;
  const auto again = read_config(write(to_yaml(config)));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(to_yaml(*again), to_yaml(config));
}

TEST_F(ConfigTest, AnEmptyFileIsTheDefaults) {
  const auto config = read_config(write(""));
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(comparable(*config, folder_), to_yaml(ServerConfig{}));
}

TEST_F(ConfigTest, PartsAreRelativeToTheFile) {
  const auto file = write("parts: ../parts");
  EXPECT_EQ(read_config(file)->parts, folder_ / "../parts");
}

TEST_F(ConfigTest, KeysAreRelativeToTheFile) {
  const auto config = read_config(write("key_file: keys/server.key\nallowed_cells: /etc/cells\n"));
  EXPECT_EQ(config->key_file, folder_ / "keys/server.key");
  EXPECT_EQ(config->allowed_cells, "/etc/cells");
}

TEST_F(ConfigTest, NamesEveryFaultWithItsLine) {
  const std::string message = refusal(
      "workers_n: many\n"
      "worker_count: 3\n"
      "perception:\n"
      "  segmentation:\n"
      "    eps_m: 5\n"
      "    method: kmeans\n"
      "  colour: red\n");
  EXPECT_THAT(message, HasSubstr("server.yaml:1: 'workers_n' must be"));
  EXPECT_THAT(message, HasSubstr("server.yaml:2: unknown key 'worker_count'"));
  EXPECT_THAT(message, HasSubstr("server.yaml:5: eps_m: 5 is outside"));
  EXPECT_THAT(message, HasSubstr("server.yaml:6: 'kmeans' is no segmentation"));
  EXPECT_THAT(message, HasSubstr("server.yaml:7: unknown key 'colour'"));
}

TEST_F(ConfigTest, AFileThatIsNotThereIsNamed) {
  const auto config = read_config("/nowhere/server.yaml");
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error().message, HasSubstr("/nowhere/server.yaml"));
}

/// Valid, and with nothing said but who may come in.
ServerConfig with_keys() {
  ServerConfig config;
  config.key_file = "server.key";
  config.allowed_cells = "allowed_cells";
  return config;
}

TEST(ConfigRules, WithoutKeysThisMachineAloneMayAskAndOnlyWhereThatIsSaid) {
  for (const char* endpoint : {"tcp://127.0.0.1:5555", "tcp://127.0.1.9:0", "tcp://localhost:*",
                               "tcp://[::1]:5555", "ipc:///run/graspd/data"}) {
    ServerConfig config;
    config.data_endpoint = endpoint;
    const auto refused = validate(config);
    ASSERT_FALSE(refused) << endpoint;
    EXPECT_THAT(refused.error().message, HasSubstr("key_file and allowed_cells are missing"));
    EXPECT_THAT(refused.error().message, HasSubstr("insecure: true"));
    config.insecure = true;
    EXPECT_TRUE(validate(config)) << endpoint;
  }
  for (const char* endpoint :
       {"tcp://0.0.0.0:5555", "tcp://*:5555", "tcp://eth0:5555", "tcp://192.168.1.7:5555",
        "tcp://example.org:5555", "tcp://127.0.example.org:5555"}) {
    ServerConfig config;
    config.control_endpoint = endpoint;
    config.insecure = true;
    const auto refused = validate(config);
    ASSERT_FALSE(refused) << endpoint;
    EXPECT_THAT(refused.error().message, HasSubstr("insecure: true"));
    EXPECT_THAT(refused.error().message, HasSubstr("control_endpoint"));
    config = with_keys();
    config.control_endpoint = endpoint;
    EXPECT_TRUE(validate(config)) << endpoint;
  }
}

TEST(ConfigRules, KeysAreBothThereAndNotBesideInsecure) {
  ServerConfig config = with_keys();
  EXPECT_TRUE(validate(config));
  config.insecure = true;
  EXPECT_THAT(validate(config).error().message, HasSubstr("one of the two"));
  config = with_keys();
  config.key_file.clear();
  EXPECT_THAT(validate(config).error().message, HasSubstr("key_file is missing"));
  config = with_keys();
  config.allowed_cells.clear();
  EXPECT_THAT(validate(config).error().message, HasSubstr("allowed_cells is missing"));
}

TEST(ConfigRules, EndpointsThatAreNone) {
  for (const char* endpoint :
       {"", "127.0.0.1:5555", "tcp://127.0.0.1", "tcp://:5555", "tcp://127.0.0.1:70000",
        "tcp://127.0.0.1:port", "udp://1.2.3.4:5", "ipc://"}) {
    EXPECT_FALSE(parse_endpoint(endpoint)) << endpoint;
  }
}

TEST(ConfigRules, HttpListensOnTcpAndBeyondThisMachineOnlyWhereThatIsSaid) {
  ServerConfig config = with_keys();
  config.http_endpoint = "ipc:///run/graspd/http";
  EXPECT_THAT(validate(config).error().message, HasSubstr("HTTP needs tcp://HOST:PORT"));
  config.http_endpoint = "tcp://0.0.0.0:9464";
  EXPECT_THAT(validate(config).error().message, HasSubstr("expose: true"));
  config.http_expose = true;
  EXPECT_TRUE(validate(config));
}

TEST(ConfigRules, NumbersOutOfRange) {
  ServerConfig config = with_keys();
  config.workers_n = 257;
  EXPECT_FALSE(validate(config));
  config = with_keys();
  config.worker_memory_limit_mib = 64;
  EXPECT_FALSE(validate(config));
  config.worker_memory_limit_mib = 0;
  EXPECT_TRUE(validate(config));
  config.worker_time_limit_ms = 1;
  EXPECT_FALSE(validate(config));
}

TEST(ConfigHash, ChangesWithEveryThingThatChangesAnswersAndWithNothingElse) {
  perception::Parameters parameters;
  const std::string hash = config_hash(parameters);
  EXPECT_EQ(hash.size(), 16u);
  EXPECT_EQ(config_hash(parameters), hash);
  parameters.grasp.k4 = -0.5000000001;
  EXPECT_NE(config_hash(parameters), hash);
  parameters = {};
  parameters.grs.p_system = PSystem::kCount;
  EXPECT_NE(config_hash(parameters), hash);
}

}  // namespace
}  // namespace graspd::service

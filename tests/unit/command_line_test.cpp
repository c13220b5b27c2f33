#include <gmock/gmock.h>

#include <stdexcept>
#include <vector>

#include "graspd/command_line/run_program.hpp"

namespace graspd {
namespace {

using ::testing::HasSubstr;

/// What a program gives whose `work` subcommand does this.
int exit_code(std::vector<std::string> words, const std::function<void()>& work) {
  words.insert(words.begin(), "/usr/bin/program");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  return run_program("program", static_cast<int>(pointers.size()), pointers.data(),
                     [&](CLI::App& app) {
                       app.require_subcommand(1);
                       app.add_subcommand("work")->callback(work);
                     });
}

class RunProgram : public ::testing::Test {
 protected:
  RunProgram() { ::testing::internal::CaptureStderr(); }
  static std::string said() { return ::testing::internal::GetCapturedStderr(); }
};

TEST_F(RunProgram, RunsWhatTheWordsName) {
  int calls_n = 0;
  EXPECT_EQ(exit_code({"work"}, [&] { ++calls_n; }), kExitDone);
  EXPECT_EQ(calls_n, 1);
  EXPECT_EQ(said(), "");
}

TEST_F(RunProgram, EndsWithTheCodeOfTheSubcommand) {
  EXPECT_EQ(exit_code({"work"}, [] { throw CLI::RuntimeError(4); }), 4);
  EXPECT_EQ(said(), "") << "the subcommand has said it";
}

TEST_F(RunProgram, RefusesWrongWords) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{}, {"play"}, {"work", "--hard"}}) {
    EXPECT_EQ(exit_code(words, [] { FAIL() << "ran all the same"; }), kExitWrongInput);
  }
  EXPECT_THAT(said(), HasSubstr("--hard"));
}

TEST_F(RunProgram, SaysWhatWasWrongWithAnArgument) {
  EXPECT_EQ(exit_code({"work"}, [] { throw std::invalid_argument("tcp:/x is no endpoint"); }),
            kExitWrongInput);
  EXPECT_EQ(said(), "program: INVALID_ARGUMENT: tcp:/x is no endpoint\n");
}

TEST_F(RunProgram, SaysWhyItFailed) {
  EXPECT_EQ(exit_code({"work"}, [] { throw std::runtime_error("the disk is full"); }), kExitFailed);
  EXPECT_EQ(said(), "program: the disk is full\n");
}

}  // namespace
}  // namespace graspd

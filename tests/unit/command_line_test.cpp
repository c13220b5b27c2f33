#include <fcntl.h>
#include <gmock/gmock.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "graspd/command_line/completions.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/manual.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"

namespace graspd {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// What a program gives whose `work` subcommand does this.
int exit_code(std::vector<std::string> words, const std::function<void()>& work) {
  words.insert(words.begin(), "/usr/bin/program");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  return run_program("program", static_cast<int>(pointers.size()), pointers.data(),
                     [&](CLI::App& app) {
                       app.require_subcommand(1);
                       CLI::App* command = app.add_subcommand("work");
                       command->add_flag("--gently");
                       command->callback(work);
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

TEST_F(RunProgram, SaysWhatAWordWithATypoWasMeantToBe) {
  EXPECT_EQ(exit_code({"wrok"}, [] {}), kExitWrongInput);
  EXPECT_EQ(exit_code({"work", "--gentyl"}, [] {}), kExitWrongInput);
  EXPECT_THAT(said(),
              AllOf(HasSubstr("'wrok' is not known; is 'work' meant?"),
                    HasSubstr("is '--gently' meant?"), HasSubstr("'program work --help' says")));
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

/// A program with two commands for people and one that is not.
class HelpTest : public ::testing::Test {
 protected:
  HelpTest() {
    app.description("Mends things.");
    CLI::App* part = app.add_subcommand("part", "work on parts");
    CLI::App* check = part->add_subcommand("check", "look at one");
    check->add_option("FILE", file, "its mesh")->required();
    check->add_option("--unit", unit, "of length")->check(CLI::IsMember({"m", "mm"}));
    check->add_option("--server", server, "whom to ask")->type_name("tcp://HOST:PORT");
    check->add_option("--threads", threads_n)->check(CLI::Range(1, 8))->capture_default_str();
    set_help(*check, "One.\n\nkeys:\n  -a: 'b'\n.end",
             {"mend part check a.stl \\\n  --unit mm", "mend part check b.stl"});
    app.add_subcommand("worker")->group("");
  }

  CLI::App app{"", "mend"};
  std::string file, unit, server;
  int threads_n = 2;
};

TEST_F(HelpTest, ExamplesAndNotesComeBackAsTheyWereGiven) {
  const std::vector<Command> commands = commands_of(app);
  ASSERT_EQ(commands.size(), 3U) << "the worker is not for people";
  EXPECT_EQ(commands.back().path, "mend part check");
  EXPECT_EQ(notes_of(*commands.back().app), "One.\n\nkeys:\n  -a: 'b'\n.end");
  EXPECT_THAT(examples_of(*commands.back().app),
              ElementsAre("mend part check a.stl \\\n  --unit mm", "mend part check b.stl"));
  EXPECT_THAT(examples_of(app), IsEmpty());
}

TEST_F(HelpTest, LongNotesAreWrappedAndStayTheSameWords) {
  std::string words = "word";
  for (int i = 0; i < 60; ++i) words += " word";
  set_help(app, words, {});
  std::string wrapped = notes_of(app);
  EXPECT_LT(wrapped.find('\n'), 90U);
  std::replace(wrapped.begin(), wrapped.end(), '\n', ' ');
  EXPECT_EQ(wrapped, words);
}

TEST_F(HelpTest, OptionsAreSplitIntoValueChoicesAndText) {
  const auto options = options_of(*commands_of(app).back().app);
  ASSERT_EQ(options.size(), 5U) << "--help and four";
  EXPECT_EQ(options[1].value, "FILE");
  EXPECT_THAT(options[1].flags, IsEmpty());
  EXPECT_THAT(options[2].choices, ElementsAre("m", "mm"));
  EXPECT_EQ(options[3].value, "tcp://HOST:PORT");
  EXPECT_EQ(options[4].text, "INT in [1 - 8]; default: 2");
}

TEST_F(HelpTest, TheManualPageHasEveryCommandAndEscapesWhatTroffWouldTakeForItsOwn) {
  EXPECT_THAT(man_page(app),
              AllOf(HasSubstr(".SS part check\n"), HasSubstr("mend \\- mends things\n"),
                    HasSubstr("\\fB\\-\\-unit\\fR"), HasSubstr("\n  \\-a: 'b'\n.EE\n"),
                    HasSubstr("\n\\&.end\n"), HasSubstr("a.stl \\e\n"), Not(HasSubstr("worker"))));
}

TEST_F(HelpTest, EveryShellIsOfferedCommandsOptionsAndChoices) {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    EXPECT_THAT(completions(app, shell), AllOf(HasSubstr("check"), HasSubstr("unit"),
                                               HasSubstr("m mm"), Not(HasSubstr("worker"))))
        << shell;
  }
  EXPECT_THROW(completions(app, "cmd"), std::invalid_argument);
}

/// A terminal, and what is written to it.
class ProgressTest : public ::testing::Test {
 protected:
  ProgressTest() : terminal_fd_(posix_openpt(O_RDWR | O_NOCTTY)) {
    grantpt(terminal_fd_);
    unlockpt(terminal_fd_);
    terminal = std::fopen(ptsname(terminal_fd_), "w");
    setenv("TERM", "xterm", 1);
    unsetenv("NO_COLOR");
  }
  ~ProgressTest() override {
    if (terminal != nullptr) std::fclose(terminal);
    close(terminal_fd_);
  }
  /// All of it; nothing is written afterwards.
  std::string shown() {
    std::fclose(terminal);
    terminal = nullptr;
    std::string text;
    std::array<char, 256> piece;
    for (ssize_t n = 0; (n = read(terminal_fd_, piece.data(), piece.size())) > 0;) {
      text.append(piece.data(), static_cast<std::size_t>(n));
    }
    return text;
  }

  std::FILE* terminal;

 private:
  int terminal_fd_;
};

TEST_F(ProgressTest, OnATerminalTheLineSaysHowFarItIsAndGoesAway) {
  {
    Progress progress("evaluating", 2, terminal);
    progress.step();
    progress.hide();
    progress.step();
  }
  const std::string text = shown();
  EXPECT_THAT(text, AllOf(HasSubstr("evaluating "), HasSubstr("0/2"), HasSubstr("2/2, 0 s left"),
                          HasSubstr("\033[32m")));
  EXPECT_TRUE(text.ends_with("\r\033[K")) << text;
}

TEST_F(ProgressTest, NoColorIsHonoured) {
  setenv("NO_COLOR", "1", 1);
  EXPECT_FALSE(wants_colour(terminal));
  { const Progress progress("evaluating", 2, terminal); }
  EXPECT_THAT(shown(), AllOf(HasSubstr("0/2"), Not(HasSubstr("\033[32m"))));
}

TEST_F(ProgressTest, WhereNoTerminalIsNothingIsWritten) {
  std::FILE* file = std::tmpfile();
  {
    Progress progress("evaluating", 2, file);
    progress.step();
  }
  EXPECT_EQ(std::ftell(file), 0);
  EXPECT_FALSE(wants_colour(file));
  std::fclose(file);
  setenv("TERM", "dumb", 1);
  EXPECT_FALSE(wants_colour(terminal));
}

}  // namespace
}  // namespace graspd

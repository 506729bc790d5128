// The list of commands and its users.
#include <gmock/gmock.h>

#include <iostream>
#include <set>
#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/cli/run_program.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "program.hpp"

namespace wheeltap::apps {
namespace {

using testing::HasSubstr;

TEST(Commands, EveryOneIsInHelpManualAndCompletion) {
  const Workspace where;
  const std::string help = wheeltap(where, "--help").out;
  const std::string manual = wheeltap(where, "man").out;
  const std::string completion = wheeltap(where, "completion bash").out;
  std::set<std::string> names;
  for (const Command& command : commands()) {
    EXPECT_TRUE(names.insert(command.name).second) << command.name << " is there twice";
    EXPECT_THAT(help, HasSubstr("  " + command.name + " ")) << command.name;
    EXPECT_THAT(help, HasSubstr(command.summary.substr(0, 20))) << command.name;
    EXPECT_THAT(manual, HasSubstr(command.name));
    EXPECT_THAT(completion, HasSubstr(command.name));
  }
}

TEST(Commands, EachKindOfCaseWithASchemaIsRunByOneOfThem) {
  const std::vector<std::string> listed = case_kinds();
  const std::set<std::string> kinds(listed.begin(), listed.end());
  EXPECT_EQ(kinds.size(), listed.size()) << "a kind is there twice";
  EXPECT_THAT(kinds_with_schema(), testing::ElementsAreArray(kinds));
}

TEST(Commands, TheOneOfACaseIsFoundByItsKind) {
  const auto command_of = [](const char* text) {
    return command_of_kind({.path = "case.json", .json = Json::parse(text)});
  };
  ASSERT_NE(command_of(R"({"kind": "update"})"), nullptr);
  EXPECT_EQ(command_of(R"({"kind": "update"})")->name, "update");
  EXPECT_TRUE(command_of(R"({"kind": "update"})")->make_run);
  EXPECT_FALSE(command_of(R"({"kind": "modal"})")->make_run) << "nothing is sampled";
  for (const char* other :
       {R"({"kind": "modes"})", R"({"kind": ""})", R"({"kind": 1})", "{}", "[]"})
    EXPECT_EQ(command_of(other), nullptr) << other;
}

/// Standard output of `wheeltap WORDS` with these commands, and its exit code.
std::pair<std::string, int> run_with(const std::vector<Command>& list,
                                     std::vector<std::string> words) {
  words.insert(words.begin(), "wheeltap");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  testing::internal::CaptureStdout();
  const int code = run_program(list, static_cast<int>(arguments.size()), arguments.data());
  return {testing::internal::GetCapturedStdout(), code};
}

TEST(Commands, ANewOneInTheListIsInHelpManualAndCompletionAndRuns) {
  std::vector<Command> list = commands();
  list.push_back({.name = "greet",
                  .summary = "says good morning to a case",
                  .add_options =
                      [](CommandOptions& options) {
                        options.add_case();
                        options.add_seed("seed of the greeting");
                      },
                  .run =
                      [](const Invocation& asked) {
                        std::cout << "good morning, " << asked.common.case_path.string() << " "
                                  << asked.common.seed.value_or(0) << "\n";
                      }});
  const auto out = [&](const std::vector<std::string>& words) {
    const auto [text, code] = run_with(list, words);
    EXPECT_EQ(code, 0) << words[0];
    return text;
  };
  EXPECT_EQ(out({"greet", "beam.json", "--seed", "7"}), "good morning, beam.json 7\n");
  for (const std::string& text : {out({"--help"}), out({"man"}), out({"completion", "zsh"})}) {
    EXPECT_THAT(text, HasSubstr("greet"));
    EXPECT_THAT(text, HasSubstr("says good morning to a case"));
  }
  EXPECT_THAT(out({"greet", "--help"}), HasSubstr("of the greeting"));
  EXPECT_THAT(out({"completion", "bash"}), HasSubstr("--set --seed' values=' --set --seed ' ;;"));
}

TEST(Commands, AFailureOfANewOneEndsWithItsExitCode) {
  const std::vector<Command> list = {
      {.name = "fail",
       .summary = "fails",
       .add_options = [](CommandOptions&) {},
       .run = [](const Invocation&) { throw Failure(Exit::bad_input, "beam.json: too long"); }}};
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_with(list, {"fail"}).second, 65);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "wheeltap: beam.json: too long\n");
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_with(list, {"greet"}).second, 64) << "not in this list";
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("there is no command \"greet\""));
}

}  // namespace
}  // namespace wheeltap::apps

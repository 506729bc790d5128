// The list of commands, and what reads it.
#include <gmock/gmock.h>

#include <set>
#include <string>

#include "apps/commands/command_list.hpp"
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

TEST(Commands, EachKindOfCaseIsRunByOneOfThem) {
  std::set<std::string> kinds;
  for (const Command& command : commands())
    if (!command.case_kind.empty()) {
      EXPECT_TRUE(kinds.insert(command.case_kind).second) << command.case_kind;
    }
  EXPECT_EQ(kinds, (std::set<std::string>{"damage", "modal", "monitor", "sid", "update"}));
}

}  // namespace
}  // namespace wheeltap::apps

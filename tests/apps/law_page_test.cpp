// The page on force laws: generated from the laws, with a case for each that parses and has the
// law.
#include "apps/report/law_page.hpp"

#include <gmock/gmock.h>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/commands/init_command.hpp"
#include "apps/law_words.hpp"
#include "apps/report/law_figure.hpp"
#include "program.hpp"
#include "sid_cases.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(LawPage, TellsOfEveryLawAndCoefficient) {
  const std::string page = laws_page(), keys = describe_keys("sid");
  for (const auto& info : dynamics::law_infos()) {
    EXPECT_THAT(page, HasSubstr("\n## " + std::string(info.name) + "\n\n`" +
                                std::string(info.formula) + "`\n"));
    for (int i = 0; i < info.size(); ++i) {
      const auto& c = info.coefficients[static_cast<std::size_t>(i)];
      EXPECT_THAT(page, HasSubstr("| `" + std::string(c.name) + "` | " + std::string(c.symbol) +
                                  " | " + std::string(c.unit) + " | "));
      // The starter's list of keys and the schema come from the same description.
      EXPECT_THAT(keys, HasSubstr("| `models[].links[]." + std::string(info.name) + "." +
                                  std::string(c.name) + "` | "));
    }
  }
}

// The example has the law of the page, with every required coefficient unknown.
TEST(LawPage, EveryExampleParsesAndHasItsLaw) {
  const Workspace where;
  for (const auto& info : dynamics::law_infos()) {
    const auto parsed = parse_sid(where, json::parse(law_example(info))).sid;
    ASSERT_EQ(parsed.models.size(), 2U) << info.name;
    EXPECT_TRUE(parsed.models[0].chain.links[0].laws.empty());
    const dynamics::Law& law = parsed.models[1].chain.links[0].laws.at(0);
    EXPECT_EQ(dynamics::law_infos()[static_cast<std::size_t>(law.kind)].name, info.name);
    for (int i = 0; i < info.size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      EXPECT_EQ(law.coefficients[at].is_constant(), !info.coefficients[at].required());
    }
  }
}

TEST(LawPage, NumbersAreWrittenAsPeopleWriteThem) {
  for (const auto& [x, text] : std::initializer_list<std::pair<double, const char*>>{
           {1e7, "1e7"}, {0.004, "0.004"}, {60000, "60000"}, {1e-5, "1e-05"}, {3, "3"}}) {
    EXPECT_EQ(json::parse(plain_number(x)).get<double>(), x);
    EXPECT_EQ(plain_number(x), text);
  }
}

TEST(LawPage, FiguresShowBothSidesAndTheRateWhereItMatters) {
  const auto figure = [](std::string_view name) {
    return law_figure(*std::ranges::find(dynamics::law_infos(), name, &dynamics::LawInfo::name));
  };
  EXPECT_THAT(figure("contact"), HasSubstr(">closing<"));
  EXPECT_THAT(figure("cubic"), testing::Not(HasSubstr("rate")));
  EXPECT_THAT(figure("bouc_wen"), testing::Not(HasSubstr("rate")));
  EXPECT_THAT(figure("coulomb"), HasSubstr("rate"));
  EXPECT_THAT(figure("quadratic_damping"), HasSubstr("rate"));
}

TEST(LawsCommand, PrintsOneLawOrItsExample) {
  const Workspace where;
  const Outcome one = wheeltap(where, "laws coulomb");
  EXPECT_EQ(one.exit_code, 0);
  EXPECT_TRUE(one.out.starts_with("## coulomb\n")) << one.out;
  EXPECT_EQ(json::parse(wheeltap(where, "laws coulomb --example").out)["kind"], "sid");
  const Outcome unknown = wheeltap(where, "laws colomb");
  EXPECT_EQ(unknown.exit_code, 64);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean \"coulomb\"? (there are: quadratic"));
  EXPECT_EQ(wheeltap(where, "laws --example").exit_code, 64);
}

}  // namespace
}  // namespace wheeltap::apps

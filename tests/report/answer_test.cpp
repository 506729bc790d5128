// The sentence at the top of a report, for every kind of finding.
#include "apps/report/answer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace wheeltap::apps {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

Report row(double low, double middle, double high) {
  return {{"mean", middle}, {"sd", 0.1}, {"q2.5", low}, {"q50", middle}, {"q97.5", high}};
}

Report damage_run(std::vector<double> probabilities) {
  Report models = Report::array();
  for (std::size_t n = 0; n < probabilities.size(); ++n) {
    models.push_back({{"name", std::to_string(n) + (n == 1 ? " damage" : " damages")},
                      {"probability", probabilities[n]}});
  }
  const Report one = {{"location[1]", row(0.082, 0.095, 0.108)},
                      {"reduction[1]", row(0.15, 0.28, 0.44)}};
  Report two = one;
  two["location[2]"] = row(0.41, 0.425, 0.44);
  two["reduction[2]"] = row(0.55, 0.6, 0.64);
  return {{"wheeltap", {{"command", "damage"}, {"case", Report::object()}}},
          {"models", models},
          {"parameters", {{"1 damage", one}, {"2 damages", two}}},
          {"damage", {{"folded", {{"1 damage", one}, {"2 damages", two}}}}},
          {"beam", {{"length", 1.0}}},
          {"diagnostics", {{"converged", true}}}};
}

TEST(Answer, NoDamage) {
  const Answer a = answer(damage_run({0.93, 0.05, 0.02}));
  EXPECT_EQ(a.headline, "Most likely no damage (93 %).");
  EXPECT_THAT(a.detail, HasSubstr("at all has a probability of 7 %"));
  EXPECT_THAT(a.detail, Not(HasSubstr("0.095")));
  EXPECT_THAT(a.caution, IsEmpty());
}

TEST(Answer, AProbabilityOfTheEvidenceIsCalledThat) {
  Report run = damage_run({0.75, 0.25, 0.0});
  run["models"][0]["basis"] = "evidence";
  run["models"][1]["basis"] = "draws";
  EXPECT_EQ(answer(run).headline, "Most likely no damage (75 %, by its evidence).");
}

TEST(Answer, OneDamageWithItsInterval) {
  const Answer a = answer(damage_run({0.0, 0.75, 0.25}));
  EXPECT_EQ(a.headline, "Most likely one damage (75 %).");
  EXPECT_EQ(a.detail,
            "Near 0.095 m (95 % interval 0.082 to 0.108 m), stiffness reduced by 28 % (15 to 44 "
            "%).");
}

TEST(Answer, NearCertaintyIsNotCalledLikely) {
  EXPECT_EQ(answer(damage_run({0.0, 0.98, 0.02})).headline, "One damage (98 %).");
}

TEST(Answer, SeveralDamages) {
  const Answer a = answer(damage_run({0.0, 0.1, 0.9}));
  EXPECT_EQ(a.headline, "Most likely two damages (90 %).");
  EXPECT_THAT(a.detail, StartsWith("(1) near 0.095 m"));
  EXPECT_THAT(a.detail, HasSubstr("; (2) near 0.425 m"));
}

TEST(Answer, UndecidedCountNamesAllThatCount) {
  const Answer a = answer(damage_run({0.02, 0.52, 0.46}));
  EXPECT_EQ(a.headline, "Undecided: the data allow one damage (52 %) or two damages (46 %).");
  EXPECT_THAT(a.detail, StartsWith("If one damage: "));
}

TEST(Answer, MirrorImagesAreBothNamed) {
  Report run = damage_run({0.0, 0.75, 0.25});
  run["diagnostics"]["symmetry"] = {{"mirror_symmetric", true}};
  EXPECT_THAT(answer(run).detail, HasSubstr("or its mirror image 0.905 m"));
  EXPECT_THAT(answer(run).detail, HasSubstr("cannot tell a place from its mirror image"));
}

TEST(Answer, MidspanIsItsOwnMirrorImage) {
  Report run = damage_run({0.0, 0.9, 0.1});
  run["diagnostics"]["symmetry"] = {{"mirror_symmetric", true}};
  run["damage"]["folded"]["1 damage"]["location[1]"] = row(0.49, 0.499, 0.5);
  EXPECT_THAT(answer(run).detail, Not(HasSubstr("mirror image 0.5")));
}

TEST(Answer, WideLocationIsNotCalledLocated) {
  Report run = damage_run({0.0, 0.9, 0.1});
  run["parameters"]["1 damage"]["location[1]"] = row(0.1, 0.4, 0.8);
  EXPECT_THAT(answer(run).detail, StartsWith("Not located: anywhere from 0.100 to 0.800 m"));
}

TEST(Answer, NotConvergedComesFirst) {
  Report run = damage_run({0.0, 0.75, 0.25});
  run["diagnostics"]["converged"] = false;
  const Answer a = answer(run);
  EXPECT_THAT(a.caution, HasSubstr("do not trust these numbers yet"));
  EXPECT_EQ(a.headline, "So far: Most likely one damage (75 %).");
}

TEST(Answer, SupportsHaveTheirOwnWords) {
  Report run = damage_run({0.0, 1.0});
  run["models"][0]["name"] = "0 supports";
  run["models"][1]["name"] = "1 support";
  run["parameters"] = {{"1 support", {{"location[1]", row(0.07, 0.079, 0.087)}}}};
  const Answer a = answer(run);
  EXPECT_EQ(a.headline, "One support (> 99.9 %).");
  EXPECT_EQ(a.detail, "Near 0.079 m (95 % interval 0.070 to 0.087 m).");
}

TEST(Answer, TwoKindsInOneModel) {
  Report run = damage_run({0.1, 0.9});
  run["models"][1]["name"] = "2 damages, 1 support";
  run["parameters"] = Report::object();
  EXPECT_EQ(answer(run).headline, "Most likely two damages and one support (90 %).");
}

TEST(Answer, EquationOfMotion) {
  Report run = {
      {"wheeltap", {{"command", "sid"}, {"case", Report::object()}}},
      {"models",
       {{{"name", "linear"}, {"probability", 0.18}}, {{"name", "duffing"}, {"probability", 0.82}}}},
      {"parameters", {{"duffing", {{"k", row(47.6, 51.4, 55.2)}}}}},
      {"diagnostics", {{"converged", true}}}};
  const Answer a = answer(run);
  EXPECT_EQ(a.headline, "Most likely “duffing” (82 %).");
  EXPECT_EQ(a.detail, "With 95 % intervals: k = 51.4 (47.6 to 55.2).");
}

TEST(Answer, SweepSaysWhereTheChoiceChanges) {
  const auto at = [](double value, double p) {
    return Report{{"value", value},
                  {"converged", value < 300},
                  {"models",
                   {{{"name", "linear"}, {"probability", 1.0 - p}},
                    {{"name", "duffing"}, {"probability", p}}}}};
  };
  const Report run = {
      {"sweep",
       {{"path", "/record/samples/1"}, {"rows", {at(100, 0.3), at(200, 0.4), at(300, 0.8)}}}}};
  const Answer a = answer(run);
  EXPECT_EQ(a.headline,
            "Most probable over /record/samples/1: “linear” from 100.0 to 200.0 and “duffing” at "
            "300.0.");
  EXPECT_THAT(a.caution, StartsWith("1 of 3 runs have not converged"));
}

}  // namespace
}  // namespace wheeltap::apps

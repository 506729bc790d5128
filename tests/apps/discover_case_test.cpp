// Cases that discover the terms of a link.
#include <gmock/gmock.h>

#include "apps/results/sid_terminal.hpp"
#include "apps/results/terminal.hpp"
#include "sid_cases.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

// The linear model of the small case with candidate terms; simulated with the cubic term.
json discovery(json terms) {
  json c = small_sid_case();
  c["models"].erase(1);
  c["parameters"].erase("k3");
  c["discover"] = {{"links", {{0, 1}}}, {"terms", std::move(terms)}};
  c["truth"]["model"] = "linear + cubic";
  c["truth"]["parameters"] = {{"k", 50}, {"cubic", 1000}};
  return c;
}

std::string refusal(const json& c) {
  const Workspace where;
  try {
    static_cast<void>(parse_sid(where, c));
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), Exit::bad_input) << failure.what();
    EXPECT_EQ(std::string(failure.what()).find('\n'), std::string::npos);
    return failure.what();
  }
  return "not refused";
}

std::vector<std::string> names(const SidCase& c) {
  std::vector<std::string> out;
  for (const auto& p : c.parameters) out.push_back(p.name);
  return out;
}

TEST(DiscoverCase, EverySubsetOfTheTermsCompetes) {
  const Workspace where;
  const SidCase c =
      parse_sid(where, discovery({"cubic", "coulomb", {{"contact", {{"side", "closing"}}}}})).sid;
  ASSERT_EQ(c.models.size(), 8U);
  EXPECT_EQ(c.models.back().name, "linear + cubic + coulomb + contact closing");
  EXPECT_THAT(names(c), testing::ElementsAre("k", "cubic", "coulomb force",
                                             "contact stiffness closing", "contact gap closing"));
  ASSERT_TRUE(c.discovery);
  EXPECT_EQ(c.discovery->inclusion, 0.5);
  // Priors scaled by the record: friction is positive, and no placeholder is left.
  const LinkMotion& m = c.discovery->motions.at(0);
  EXPECT_DOUBLE_EQ(c.parameters[1].prior.sd(), m.tension / std::pow(m.extension, 3));
  EXPECT_EQ(c.parameters[2].prior.lower(), 0.0);
  EXPECT_DOUBLE_EQ(c.parameters[4].prior.upper(), m.closing);
}

TEST(DiscoverCase, ParametersOfTheCaseOverrideTheDefaults) {
  const Workspace where;
  json c = discovery({"cubic"});
  c["parameters"]["cubic"] = {{"normal", {500, 100}}};
  c["discover"]["inclusion"] = 0.2;
  const SidCase parsed = parse_sid(where, c).sid;
  EXPECT_EQ(parsed.parameters.size(), 2U);
  EXPECT_DOUBLE_EQ(parsed.parameters[0].prior.mean(), 500.0);  // in the order of names
  EXPECT_DOUBLE_EQ(parsed.models[1].weight, 0.2);
}

TEST(DiscoverCase, WhatIsKnownOfATermIsGivenWithIt) {
  const Workspace where;
  json c = discovery({{{"contact", {{"gap", 0.01}, {"stiffness", "ks"}}}},
                      {{"coulomb", {{"velocity", 0.02}}}},
                      {{"cubic", 1000}}});
  c["parameters"]["ks"] = {{"log_uniform", {1, 1e4}}};
  c["truth"]["parameters"].erase("cubic");  // 1000, as in the term
  const SidCase parsed = parse_sid(where, c).sid;
  const auto& terms = parsed.discovery->terms;
  EXPECT_DOUBLE_EQ(terms[0].law.coefficients[1].value, 0.01);
  EXPECT_TRUE(terms[0].by_default.empty());
  EXPECT_DOUBLE_EQ(terms[1].law.coefficients[1].value, 0.02);
  EXPECT_EQ(terms[1].by_default.size(), 1U);
  EXPECT_DOUBLE_EQ(terms[2].law.coefficients[0].value, 1000.0);
}

TEST(DiscoverCase, OnSeveralLinksTermsAreNamedAfterThem) {
  const Workspace where;
  json c = discovery({"cubic"});
  c["models"][0]["masses"] = {0.5, 0.5};
  c["models"][0]["links"].push_back({{"between", {1, 2}}, {"stiffness", "k"}});
  c["discover"].erase("links");
  c["truth"]["model"] = "linear + cubic 1-2";
  c["truth"]["parameters"] = {{"k", 50}, {"cubic 1-2", 1000}};
  const SidCase parsed = parse_sid(where, c).sid;
  EXPECT_EQ(parsed.models.back().name, "linear + cubic 0-1 + cubic 1-2");
  EXPECT_THAT(names(parsed), testing::ElementsAre("k", "cubic 0-1", "cubic 1-2"));
}

TEST(DiscoverCase, FaultsAreRefusedWhereTheyStand) {
  EXPECT_THAT(refusal(discovery({"cubic", "friction"})),
              AllOf(HasSubstr("/discover/terms/1: \"friction\""), HasSubstr("coulomb")));
  EXPECT_THAT(refusal(discovery({"cubic", "cubic"})),
              AllOf(HasSubstr("/discover/terms/1"), HasSubstr("listed twice")));
  EXPECT_THAT(refusal(discovery({{{"cubic", {{"gap", 1}}}}})),
              HasSubstr("/discover/terms/0/cubic/gap"));
  EXPECT_THAT(refusal(discovery({{{"contact", {{"gap", -1}}}}})),
              AllOf(HasSubstr("/discover/terms/0/contact/gap"), HasSubstr("at least 0")));
  EXPECT_THAT(refusal(discovery({{{"contact", {{"side", "both"}}}}})),
              HasSubstr("/discover/terms/0/contact/side"));
  json c = discovery({"cubic"});
  c["models"].push_back(c["models"][0]);
  c["models"][1]["name"] = "other";
  EXPECT_THAT(refusal(c), AllOf(HasSubstr("/models"), HasSubstr("one model")));
  c = discovery({"cubic"});
  c["models"][0]["links"][0]["cubic"] = 3.0;
  EXPECT_THAT(refusal(c), HasSubstr("already has this force law"));
  c = discovery({"cubic"});
  c["discover"]["links"] = {{0, 2}};
  EXPECT_THAT(refusal(c), HasSubstr("/discover/links/0"));
  c = discovery({"cubic"});
  c["discover"]["inclusion"] = 1.0;
  EXPECT_THAT(refusal(c), HasSubstr("/discover/inclusion"));
  json many = json::array();
  for (int i = 0; i < 11; ++i) many.push_back("cubic");
  EXPECT_THAT(refusal(discovery(many)), AllOf(HasSubstr("/discover/terms"), HasSubstr("11")));
  EXPECT_THAT(refusal(discovery({{{"bouc_wen", {{"beta", "b"}}}}})), HasSubstr("no parameter"));
}

// A coefficient missing in the truth would silently remove its term.
TEST(DiscoverCase, TheTruthMustGiveTheCoefficientsOfItsTerms) {
  json c = discovery({"cubic"});
  c["truth"]["parameters"].erase("cubic");
  EXPECT_THAT(refusal(c), AllOf(HasSubstr("/truth/parameters/cubic"), HasSubstr("is missing")));
}

// The terminal lists only the most probable of hundreds of models.
TEST(DiscoverCase, OfManyModelsAFewArePrinted) {
  std::vector<ModelFinding> models;
  for (int m = 0; m < 256; ++m) {
    ModelFinding& model = models.emplace_back();
    model.name = "model " + std::to_string(m);
    model.standing.visited = 4;
    model.standing.probability = m == 200 ? 0.745 : 0.001;
  }
  std::ostringstream text;
  print_models(Page{text, false}, models);
  EXPECT_THAT(text.str(), AllOf(HasSubstr("model 200"), HasSubstr("and 251 other models")));
  EXPECT_LT(std::ranges::count(text.str(), '\n'), 12);
}

}  // namespace
}  // namespace wheeltap::apps

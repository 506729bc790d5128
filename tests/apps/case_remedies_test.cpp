#include "apps/cases/syntax/case_remedies.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "program.hpp"
#include "structure_cases.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

// Fault: the advised prior ended at an open bound, and was refused too.
TEST(CaseRemedies, AdvisedPriorsAreWithinTheBounds) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const std::pair<double, double> bounds[] = {{0.0, std::nextafter(1.0, 0.0)},
                                              {0.0, std::nextafter(1.7, 0.0)},
                                              {-kInf, std::nextafter(1.0, 0.0)},
                                              {std::nextafter(0.0, 1.0), kInf},
                                              {-1.0, kInf},
                                              {0.0, 0.1 + 0.2},
                                              {0.0, 110.0},
                                              {-kInf, 1.0 / 3.0},
                                              {-1e-3, 1e-3}};
  const char* const priors[] = {R"({"uniform": [0, 1]})",
                                R"({"uniform": [-3, 400]})",
                                R"({"normal": [0.3, 0.2]})",
                                R"({"normal": [-900, 0.2]})",
                                R"({"half_normal": 0.2})",
                                R"({"student_t": [4, 0.1, 3]})",
                                R"({"truncated_normal": [0.4, 0.1, -2, 2000]})",
                                R"({"beta": [2, 5]})",
                                R"({"beta": [2, 5], "on": [-3, 400]})",
                                R"({"log_uniform": [1e-4, 1e4]})",
                                R"({"log_normal": [0, 1]})",
                                R"({"gamma": [2, 3]})",
                                R"({"table": {"x": [-3, 0, 400], "density": [0, 1, 0]}})"};
  int advised = 0;
  for (const auto& [lower, upper] : bounds)
    for (const char* const text : priors) {
      CaseFile file{.path = "case.json", .json = {{"prior", Json::parse(text)}}};
      const Pointer where("/prior");
      const std::string advice = kept_within(file, where, lower, upper);
      if (advice.empty()) continue;
      ++advised;
      const std::string start = "; write ";
      ASSERT_TRUE(advice.starts_with(start)) << advice;
      file.json[where] = Json::parse(advice.substr(start.size()));
      const inference::Prior prior = parse_prior(file, where);
      EXPECT_GE(prior.lower(), lower) << text << advice;
      EXPECT_LE(prior.upper(), upper) << text << advice;
      EXPECT_EQ(kept_within(file, where, lower, upper), "");
    }
  EXPECT_GT(advised, 60);
}

std::string damage_complaint(const std::string& reduction) {
  const Workspace where;
  json c = small_case();
  c["damage"]["reduction"] = json::parse(reduction);
  const Outcome ran = wheeltap(where, "modes " + where.write_json("c.json", c).string());
  return ran.exit_code == 65 ? ran.err : "";
}

TEST(CaseRemedies, PriorsOfAReductionEndBelowOne) {
  const auto expect = [](const std::string& given, const std::string& advised) {
    EXPECT_THAT(damage_complaint(given), HasSubstr("; write " + advised));
    EXPECT_EQ(damage_complaint(advised), "");
  };
  expect(R"({"uniform": [0, 1]})", R"({"uniform": [0, 0.999]})");
  expect(R"({"half_normal": 0.2})", R"({"truncated_normal": [0, 0.2, 0, 0.999]})");
  expect(R"({"normal": [0.3, 0.2]})", R"({"truncated_normal": [0.3, 0.2, 0, 0.999]})");
  expect(R"({"beta": [2, 5]})", R"({"beta": [2, 5], "on": [0, 0.999]})");
}

// Fault: a number out of range was advised to be written as text, which was refused too.
TEST(CaseRemedies, NumbersOutOfRangeAreNotAdvisedAsText) {
  const Workspace where;
  const auto said = [&](const char* at, const json& value) {
    json c = portal_frame();
    c[json::json_pointer(at)] = value;
    const Outcome ran = wheeltap(where, "modes " + where.write_json("c.json", c).string());
    EXPECT_EQ(ran.exit_code, 65) << at;
    return ran.err;
  };
  const std::string steel = "/structure/materials/steel/", post = "/structure/sections/post/";
  for (const auto& [at, value] :
       std::vector<std::pair<std::string, json>>{{"/structure/springs/0/stiffness", -1e6},
                                                 {"/structure/masses/0/mass", -2.0},
                                                 {steel + "density", -7850.0},
                                                 {steel + "young", -1.0},
                                                 {steel + "poisson", 0.5},
                                                 {post + "width", 0.0},
                                                 {"/structure/members/1/ends/B/rotation", -1e4}}) {
    const std::string text = said(at.c_str(), value);
    EXPECT_THAT(text, HasSubstr(at)) << text;
    EXPECT_THAT(text, HasSubstr("must be")) << text;
    EXPECT_THAT(text, Not(HasSubstr("write \""))) << text;
  }
  EXPECT_THAT(said((steel + "young").c_str(), true), Not(HasSubstr("write 1")));
  json column = small_case();
  column["data"] = {{"file", 3}, {"cov", 0.01}};
  EXPECT_THAT(wheeltap(where, "modes " + where.write_json("c.json", column).string()).err,
              HasSubstr("write \"3\""));
}

TEST(CaseRemedies, ALengthThatIsNotANumberIsNotNull) {
  const Workspace where;
  std::string text = small_case().dump();
  text.replace(text.find("\"length\":") + 9, 1, "NaN,\"x\":");
  const Outcome ran = wheeltap(where, "modes " + where.write("c.json", text).string());
  EXPECT_EQ(ran.exit_code, 65);
  EXPECT_THAT(ran.err, HasSubstr("JSON has no NaN"));
  EXPECT_THAT(ran.err, Not(HasSubstr("write null")));
}

}  // namespace
}  // namespace wheeltap::apps

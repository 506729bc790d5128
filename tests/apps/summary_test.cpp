#include "apps/results/summary.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>

#include "base/random.hpp"
#include "program.hpp"
#include "structure_cases.hpp"

namespace wheeltap::apps::summary_test {

using namespace identification;

namespace {

using inference::ChainsOf;
using inference::Posterior;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

const inference::ModelSpace& coin_space() {
  static const auto space = inference::ModelSpace::of_components(
      {}, {{"damage", "damages", {{"location", inference::Uniform{0.0, 1.0}}}}},
      {{{0}, 0.5}, {{1}, 0.5}});
  return space;
}

// Independent draws: model 1 has probability p; its parameter is uniform on [low, high] in chain c.
Posterior made_up(double p, int draws, double shift_of_last_chain = 0.0, double p_of_last = -1.0) {
  Posterior posterior;
  posterior.space = std::make_shared<const inference::ModelSpace>(coin_space());
  posterior.dimension = 1;
  posterior.draws = draws;
  posterior.likelihood_evaluations = 1;
  for (std::uint64_t c = 0; c < 4; ++c) {
    base::Random random(5, c, 0, base::Purpose::test);
    inference::Chain chain;
    const double mine = c == 3 && p_of_last >= 0.0 ? p_of_last : p;
    for (int i = 0; i < draws; ++i) {
      const bool one = random.uniform() < mine;
      chain.model.push_back(one ? 1 : 0);
      chain.theta.push_back(one ? random.uniform() + (c == 3 ? shift_of_last_chain : 0.0)
                                : std::nan(""));
      chain.log_prior.push_back(0.0);
      chain.log_likelihood.push_back(random.normal() + (c == 3 ? shift_of_last_chain : 0.0));
    }
    posterior.chains.push_back(chain);
  }
  return posterior;
}

Findings found_in(const Posterior& posterior) {
  return run_findings(posterior, inference::judge(posterior), 1);
}

Report judged(const Posterior& posterior) {
  Findings findings = found_in(posterior);
  findings.remarks = {
      remark::PeculiarWindow{{{"force", 9.0, 2.0}, {"displacement", 7.0, 2.0}}},
      remark::ColouredResiduals{.model = "m", .channels = {{"a", 4, -0.58, 0.02, 0.0}}}};
  findings.fit_verdict.why = {misfit::BeyondNoise{1e-9, {1, 2, 3}, false}};
  return diagnostics(findings, warnings(findings, {}));
}

TEST(Summary, ModelTableOfIndependentDraws) {
  const Posterior posterior = made_up(0.3, 2000);
  const Report table = model_table(found_in(posterior));
  const double mcse = std::sqrt(0.3 * 0.7 / 8000.0);
  EXPECT_EQ(table[1]["name"], "1 damage");
  EXPECT_EQ(table[1]["prior"], 0.5);
  EXPECT_NEAR(table[1]["probability"].get<double>(), 0.3, 4.5 * mcse);
  EXPECT_NEAR(table[1]["mcse"].get<double>() / mcse, 1.0, 0.2);
  EXPECT_EQ(table[1]["visited"], 4);
  EXPECT_EQ(table[1]["basis"], "draws");
  EXPECT_TRUE(table[1]["log_evidence"].is_null());
  EXPECT_EQ(table[1].value("told", ""), "");
}

inference::ModelFindings found(double log_evidence) {
  const inference::Evidence none{.log_evidence = std::nan(""), .standard_error = std::nan("")};
  return {.climbs = 200,
          .modes = {},
          .annealed = none,
          .sampled = {.log_evidence = log_evidence, .standard_error = 0.1},
          .bridged = none};
}

TEST(Summary, OfANeverVisitedModelItsEvidenceSpeaks) {
  Posterior posterior = made_up(0.0, 1000);
  posterior.jumps_proposed = {{0, 12345}, {0, 0}};
  posterior.jumps_accepted = {{0, 0}, {0, 0}};
  posterior.found = {found(-10.0), found(-12.0)};
  const Report table = model_table(found_in(posterior));
  const double p = std::exp(-2.0) / (1.0 + std::exp(-2.0));
  EXPECT_NEAR(table[1]["probability"].get<double>(), p, 1e-12);
  EXPECT_NEAR(table[1]["mcse"].get<double>(), p * (1.0 - p) * std::hypot(0.1, 0.1), 1e-12);
  EXPECT_EQ(table[1]["basis"], "evidence");
  EXPECT_EQ(table[1]["visited"], 0);
  EXPECT_EQ(table[1]["entered"], 0);
  EXPECT_EQ(table[1]["log_evidence"], -12.0);
  EXPECT_EQ(table[1].value("told", ""),
            "no jump accepted in 12 345 proposals; its evidence implies P ≈ 0.119 ± 0.01");
  Posterior entered = posterior;
  entered.jumps_accepted[0][1] = 1;
  EXPECT_EQ(model_table(found_in(entered))[1].value("told", ""),
            "jump accepted once in 12 345 proposals, but no draw kept; its evidence implies "
            "P ≈ 0.119 ± 0.01");
  Posterior passed_over = posterior;
  passed_over.jumps_proposed = {{0, 0}, {0, 0}};
  passed_over.found[1] = {};
  passed_over.found[1].passed_over = true;
  EXPECT_EQ(model_table(found_in(passed_over))[1].value("told", ""),
            "not evaluated: the models with one term fewer or more are improbable");
  EXPECT_TRUE(model_table(found_in(passed_over))[1]["log_evidence"].is_null());
  Posterior hopeless = posterior;
  hopeless.found[1] = found(-2000.0);  // was "P ≈ 0 ± 0"
  EXPECT_EQ(model_table(found_in(hopeless))[1].value("told", ""),
            "no jump accepted in 12 345 proposals; its evidence implies P < 1e-300");
  EXPECT_FALSE(parameter_tables(found_in(posterior)).contains("1 damage"));
  const Report d = judged(posterior);
  EXPECT_FALSE(d["converged"]);
  EXPECT_THAT(d["warnings"][0].get<std::string>(), HasSubstr("'1 damage' has no draws"));
  EXPECT_EQ(d["warnings"][0], d["not_established"][0]);
  // Then the misfit; then remarks by severity, with similar remarks merged.
  ASSERT_EQ(d["warnings"].size(), d["not_established"].size() + 3);
  const std::size_t misfit = d["not_established"].size();
  EXPECT_THAT(
      d["warnings"][misfit].get<std::string>(),
      HasSubstr("No number of damages explains the frequencies within the stated noise "
                "(predictive p 1e-9) (frequencies with errors above 3 sd: modes 1 to 3). Check"));
  EXPECT_THAT(d["warnings"][misfit + 1].get<std::string>(),
              HasSubstr("\"a\" (2 % of the response, correlation -0.58 at lag 4, p < 1e-15)"));
  EXPECT_THAT(
      d["warnings"][misfit + 2].get<std::string>(),
      HasSubstr("in the spectra of \"force\" by 9 dB (random variability alone gives 2 dB) and "
                "\"displacement\" by 7 dB"));
  EXPECT_NEAR(d["resolution"].get<double>(), 1.0 - std::pow(0.01, 1.0 / 200.0), 1e-12);
  EXPECT_EQ(d["resolution_words"],
            "posterior modes with a basin of attraction below 2.3 % of the prior probability may "
            "have been missed");
  EXPECT_TRUE(d["resolution_width"].is_null());
}

// Searches miss modes that are narrower than the distance of the evaluated points.
TEST(Summary, SaysBelowWhichWidthModesMayHaveBeenMissed) {
  Posterior posterior = made_up(0.5, 1000);
  posterior.found = {found(-10.0), found(-12.0)};
  for (auto& model : posterior.found) {
    model.climbs = 200;
    model.spacing = 0.3;
  }
  const Report d = judged(posterior);
  EXPECT_EQ(d["resolution_width"], 0.3);
  EXPECT_EQ(
      d["resolution_words"],
      "posterior modes with a basin of attraction below 2.3 % of the prior probability may have "
      "been missed. This limit increases as 1 / width for posterior modes narrower than 0.3 "
      "standard deviations of the prior; posterior modes narrower than 0.007 standard deviations "
      "may have been missed, whatever their basin");
}

TEST(Summary, WithoutEvidenceNothingIsSaidOfIt) {
  const Posterior posterior = made_up(0.0, 1000);
  const Report table = model_table(found_in(posterior));
  EXPECT_TRUE(table[1]["mcse"].is_null());
  EXPECT_EQ(table[1].value("told", ""), "no jump proposed; its evidence is not known");
  const Report d = judged(posterior);
  EXPECT_FALSE(d["converged"]);
  EXPECT_EQ(d["resolution_words"], "");
}

// Models are sampled equally often, but the damage has odds of 1 : 99.
TEST(Summary, AveragesOverModelsUseTheWeightsOfBalancedDraws) {
  Posterior posterior = made_up(0.5, 2000);
  posterior.log_weight = {std::log(0.99), std::log(0.01)};
  const auto weights = model_weights(posterior);
  EXPECT_NEAR(weights[0] / weights[1], 99.0, 1e-9);
  const ChainsOf count = all_draws(
      posterior, [&](auto c, auto i) { return static_cast<double>(posterior.chains[c].model[i]); });
  const Report s = apps::json(marginal(count, draw_weights(posterior)));
  EXPECT_NEAR(s["mean"].get<double>(), 0.01, 0.01 * 4.5 * 2.0 / std::sqrt(8000.0));
  EXPECT_EQ(s["q97.5"], 0.0);
  EXPECT_NEAR(s["mean"].get<double>(),
              model_table(found_in(posterior))[1]["probability"].get<double>(), 1e-12);
}

TEST(Summary, EqualWeightsChangeNothing) {
  base::Random random(3, 0, 0, base::Purpose::test);
  ChainsOf draws(1);
  for (int i = 0; i < 1001; ++i) draws[0].push_back(random.normal());
  const Report plain = apps::json(marginal(draws));
  const Report weighted = apps::json(marginal(draws, {std::vector<double>(1001, 0.7)}));
  for (const char* key : {"mean", "sd", "q2.5", "q50", "q97.5", "mode"}) {
    EXPECT_NEAR(plain[key].get<double>(), weighted[key].get<double>(), 1e-12) << key;
  }
}

// The evidence of the second model fails, as for TMCMC without enough stages.
struct Failing final : inference::Likelihood {
  double log_likelihood(int model, std::span<const double>) override {
    return model == 1 ? std::nan("") : 0.0;
  }
};

TEST(Summary, AFailingEvidenceCostsItsRowAndNotTheRun) {
  const inference::Problem problem{.space = coin_space(),
                                   .likelihood = [] { return std::make_unique<Failing>(); }};
  const auto list = identification::compute_evidence(problem, {EvidenceMethod::tmcmc}, 1, 1);
  ASSERT_EQ(list[0].evidences.size(), 2U);
  EXPECT_TRUE(std::isnan(list[0].evidences[1].log_evidence));
  Findings findings = found_in(made_up(0.5, 1000));
  conclude(findings, coin_space(), list);
  const Report report = evidence_report(findings);
  EXPECT_NEAR(report["tmcmc"][0]["log_evidence"].get<double>(), 0.0, 1e-9);
  EXPECT_TRUE(report["tmcmc"][1]["log_evidence"].is_null());
  EXPECT_TRUE(report["tmcmc"][1]["probability"].is_null());
  ASSERT_EQ(findings.remarks.size(), 2U) << "the second: the location is nearly its prior";
  EXPECT_THAT(sentence(findings.remarks[0], {}), HasSubstr("Evidence of 1 damage by tmcmc failed"));
}

// Holds for every kind of run: fault, sid runs lacked this warning.
TEST(Summary, ImpossibleLikelihoodsAreToldOfAnyRun) {
  Posterior posterior = made_up(0.5, 1000);
  posterior.impossible = 12;
  posterior.likelihood_evaluations = 34567;
  Findings findings = found_in(posterior);
  conclude(findings, coin_space(), {});
  ASSERT_EQ(findings.remarks.size(), 2U);
  EXPECT_THAT(
      sentence(findings.remarks[0], {}),
      HasSubstr("The posterior nearly equals the prior: the data contain little information "
                "about location[1] under \"1 damage\""));
  EXPECT_THAT(sentence(findings.remarks[1], {}), HasSubstr("at 12 of 34 567 parameter vectors"));
}

// Fault: 64 subsets of terms gave the same warning four times.
TEST(Summary, ModelsThatAreAlikeAreToldOfTogether) {
  remark::NearlyPrior nearly{.parameters = {{"a", "gap", 0.97}, {"b", "c", 0.96}}};
  EXPECT_THAT(sentence(nearly, {}),
              HasSubstr("about gap under \"a\" (overlap 97 %) and c under \"b\" (overlap 96 %)."));
  nearly.parameters.push_back({"b", "gap", 0.98});
  EXPECT_THAT(sentence(nearly, {}), HasSubstr("gap under \"a\" and \"b\" (overlap 97 % to 98 %)"));
  nearly.parameters.push_back({std::string(60, 'x'), "gap", 0.98});
  EXPECT_THAT(sentence(nearly, {}), HasSubstr("gap under 3 models (overlap 97 % to 98 %)"));

  remark::UncertainSpread uncertain{.parameters = {{"a", "gap", 0.28}}};
  EXPECT_THAT(sentence(uncertain, {}),
              HasSubstr("standard deviation of gap under \"a\" (Monte Carlo error 28 %)."));
  for (int i = 0; i < 7; ++i) uncertain.parameters.push_back({"a", "c", 0.2});
  EXPECT_THAT(sentence(uncertain, {}), HasSubstr("and 2 more."));

  remark::ColouredResiduals coloured{.model = "m", .channels = {{"a", 4, -0.58, 0.02, 0.0}}};
  EXPECT_THAT(sentence(coloured, {}), Not(HasSubstr("similar")));
  coloured.others = {"n"};
  EXPECT_THAT(sentence(coloured, {}), EndsWith("Under \"n\", the residuals are similar."));
  coloured.others = {"n", "o"};
  EXPECT_THAT(sentence(coloured, {}), EndsWith("Under 2 other models, the residuals are similar."));
}

TEST(Summary, ParameterSummary) {
  const Posterior posterior = made_up(0.5, 4000);
  const Report s = parameter_tables(found_in(posterior))["1 damage"]["location[1]"];
  const double n = 8000.0;
  EXPECT_NEAR(s["mean"].get<double>(), 0.5, 4.5 * std::sqrt(1.0 / 12.0 / n));
  EXPECT_NEAR(s["sd"].get<double>(), std::sqrt(1.0 / 12.0), 0.01);
  EXPECT_NEAR(s["q2.5"].get<double>(), 0.025, 0.01);
  EXPECT_NEAR(s["q97.5"].get<double>(), 0.975, 0.01);
  EXPECT_GT(s["ess_bulk"], 0.7 * n);
  EXPECT_LT(s["rhat"], 1.01);
}

TEST(Summary, ModeIsTheFullestBin) {
  base::Random random(3, 0, 0, base::Purpose::test);
  std::vector<double> draws;
  for (int i = 0; i < 20000; ++i) draws.push_back(std::exp(0.5 * random.normal()));
  // ln x ~ N(0, ½²): the mode is exp(-1/4).
  EXPECT_NEAR(marginal({draws}).mode, std::exp(-0.25), 0.1);
}

TEST(Summary, QuantilesAreLinearBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0, 4.0}, 0.5), 2.0);
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0, 4.0}, 0.75), 3.0);
}

TEST(Summary, GoodChainsConverge) {
  const Report d = judged(made_up(0.3, 2000));
  EXPECT_TRUE(d["converged"]);
  EXPECT_TRUE(d["not_established"].empty());
  EXPECT_EQ(d["warnings"].size(), 3U) << "those of judged() alone";
  EXPECT_GT(d["round_trips"], 500);
}

TEST(Summary, ChainsThatDisagreeAboutTheCountDoNot) {
  const Report d = judged(made_up(0.3, 2000, 0.0, 0.6));
  EXPECT_FALSE(d["converged"]);
  EXPECT_THAT(d["warnings"][0].get<std::string>(), HasSubstr("R-hat of number of damages"));
}

TEST(Summary, ChainsThatDisagreeAboutThePosteriorDoNot) {
  const Report d = judged(made_up(0.3, 2000, 2.0));
  EXPECT_FALSE(d["converged"]);
  EXPECT_THAT(d["warnings"][0].get<std::string>(), HasSubstr("R-hat of log posterior"));
}

TEST(Summary, ShortChainsDoNot) {
  const Report d = judged(made_up(0.3, 60));
  EXPECT_FALSE(d["converged"]);
}

// With all draws in one model, the other model must still be known to be improbable.
TEST(Summary, ADominantModelIsJudgedByTheEvidenceOfTheOthers) {
  Posterior posterior = made_up(1.0, 2000);
  EXPECT_FALSE(judged(posterior)["converged"]);
  posterior.found = {found(-30.0), found(-10.0)};
  EXPECT_TRUE(judged(posterior)["converged"]);
  posterior.found = {found(-12.0), found(-10.0)};
  EXPECT_FALSE(judged(posterior)["converged"]);
}

TEST(Summary, NumbersForPeople) {
  EXPECT_EQ(percent(0.749), "74.9 %");
  EXPECT_EQ(percent(0.0312), "3.1 %");
  EXPECT_EQ(percent(1.0), "> 99.9 %");
  EXPECT_EQ(percent(0.0), "< 0.1 %");
  EXPECT_EQ(probability_is(0.9999), "P > 99.9 %");
  EXPECT_EQ(rounded_count(80491.0), "80500");
  EXPECT_EQ(rounded_count(412.3), "412");
  EXPECT_EQ(resolved(464992.4, 10.2), "464992");
  EXPECT_EQ(resolved(49.99871, 0.02), "49.999");
  EXPECT_EQ(resolved(1022.8, 187.0), "1023");
  EXPECT_EQ(resolved(9.9949e-5, 4e-8), "9.9949e-5");
  EXPECT_EQ(resolved(28.3, 29.0), "28.3");
  EXPECT_EQ(significant(350.0, 2), "350");  // seconds: was "3.5e+02"
  EXPECT_EQ(significant(3.5e7, 2), "3.5e7");
  EXPECT_EQ(p_value(0.0), "p < 1e-15");  // was "p 0"
}

// Fault: a warning named the location on the line of all nodes, which no result contains.
TEST(Summary, WarningsNameTheNodeOfAJoint) {
  const Workspace where;
  nlohmann::json frame = portal_frame();
  for (const char* key : {"baseline", "parameters"}) frame.erase(key);
  frame["structure"]["materials"]["steel"]["young"] = 210e9;
  frame["data"] = {{"cov", 0.5}, {"modes", 2}};
  frame["damage"] = frame["damage"][1];
  frame["damage"]["truth"] = {{{"node", "B"}, {"reduction", 0.3}}};
  const Outcome ran = wheeltap(where, "damage " + where.write_json("f.json", frame).string() +
                                          " -o " + (where / "f").string() + " --quick --threads 1");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const auto summary = nlohmann::json::parse(read_all(where / "f/summary.json"));
  const std::string warnings = summary["diagnostics"]["warnings"].dump();
  EXPECT_THAT(warnings, HasSubstr("node[1]"));
  EXPECT_THAT(warnings, Not(HasSubstr("location[1]")));
}

}  // namespace
}  // namespace wheeltap::apps::summary_test

#include "identification/sid/findings/term_findings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "base/eigen_solvers.hpp"
#include "identification/sid/findings/sid_findings.hpp"
#include "identification/sid/sid_discovery.hpp"
#include "inference/evidence/importance_sampling.hpp"
#include "inference/search/mode_search.hpp"
#include "inference/statistics/standard_normal.hpp"
#include "sid_cases.hpp"

namespace wheeltap::identification {
namespace {

using dynamics::Coefficient;

// A Duffing oscillator, 120 samples, with three optional terms: the cubic term exists, and the
// friction is too weak to be certain.
SidCase duffing_asked_about(double inclusion, double noise = 0.05) {
  SidCase c = small_sid_case();
  c.models[0].noise = {noise};
  c.truth->noise = {noise};
  c.models.resize(1);
  c.parameters = {{"k", inference::Uniform{0.0, 100.0}}};
  c.discovery.emplace();
  c.discovery->inclusion = inclusion;
  const dynamics::Link& link = c.models.front().chain.links.front();
  for (const std::string name : {"cubic", "quadratic", "quadratic_damping"}) {
    const Coefficient p = c.parameter(name, inference::Normal{0.0, 1.0});
    SidTerm term{.link = 0, .law = dynamics::make_law(name, std::vector<Coefficient>{p})};
    term.name = term_name(term.law, link, false);
    term.by_default = {0};
    c.discovery->terms.push_back(std::move(term));
  }
  add_subsets(c);
  for (SidModel& model : c.models) model.parameters = c.parameters_of(model);
  c.truth->model = 5;  // cubic and quadratic_damping
  c.truth->theta = {50.0, 1000.0, 0.0, 0.12};
  c.truth->samples = 120;
  SidCase out = simulated(c);
  set_term_priors(out);
  return out;
}

SidFindings found_terms(const SidCase& c, bool prior_only = false) {
  inference::Options engine;
  engine.warmup = 4000;
  engine.draws = 4000;
  engine.prior_only = prior_only;
  const SidRun run = run_sid(c, {.engine = engine});
  return sid_findings(run, predict(*run.problem, run.posterior));
}

// ln Z of every subset separately: importance sampling from the prior and from normals about the
// modes of many climbs. (Annealing each from its prior agrees, with a hundred times the calls,
// mostly of diverging trajectories.)
std::vector<inference::Evidence> evidence_of_all(const inference::Problem& problem) {
  std::vector<inference::Evidence> out;
  for (int m = 0; m < problem.space.size(); ++m) {
    const auto d = static_cast<Eigen::Index>(problem.space[m].dimension);
    const auto found = inference::search_modes(problem, m, {.seed = 11, .climbs = 100});
    std::vector<inference::NormalMixture::Component> components = {
        {0.1, Eigen::VectorXd::Zero(d), Eigen::MatrixXd::Identity(d, d)}};
    // Also wider normals: if a non-negative coefficient may be zero, its posterior has the prior's
    // tail.
    for (const inference::Mode& mode : found.modes) {
      for (const double wider : {1.5, 6.0, 24.0, 96.0}) {
        components.push_back({std::exp(mode.log_mass - found.modes.front().log_mass),
                              Eigen::Map<const Eigen::VectorXd>(mode.z.data(), d),
                              Eigen::LLT<Eigen::MatrixXd>(wider * mode.covariance).matrixL()});
      }
    }
    const auto sampled = inference::importance_sampling(
        problem, m, inference::NormalMixture(components), {.seed = 11, .draws = 20000});
    EXPECT_LT(sampled.pareto_k, 0.7) << problem.space[m].name;
    EXPECT_LT(sampled.evidence.standard_error, 0.05) << problem.space[m].name;
    out.push_back(sampled.evidence);
  }
  return out;
}

TEST(TermFindings, InclusionAgreesWithTheEvidencesOfAllSubsets) {
  const SidCase c = duffing_asked_about(0.4, 0.04);
  const SidFindings f = found_terms(c);
  const auto problem = make_sid_problem(c);
  const std::vector<inference::Evidence> evidence = evidence_of_all(problem->problem);
  double all = -HUGE_VAL;
  std::vector<double> log_mass;
  for (std::size_t m = 0; m < evidence.size(); ++m) {
    log_mass.push_back(evidence[m].log_evidence + std::log(c.models[m].weight));
    all = inference::log_sum_exp(all, log_mass.back());
  }
  ASSERT_EQ(f.discovery.terms.size(), 3U);
  double least_decided = 1.0;
  for (std::size_t t = 0; t < 3; ++t) {
    double want = 0.0, variance = 0.0;
    const auto in = [&](std::size_t m) {
      return std::ranges::count(c.models[m].terms, static_cast<int>(t)) > 0 ? 1.0 : 0.0;
    };
    const auto p = [&](std::size_t m) { return std::exp(log_mass[m] - all); };
    for (std::size_t m = 0; m < evidence.size(); ++m) want += in(m)*p(m);
    for (std::size_t m = 0; m < evidence.size(); ++m) {  // ∂P/∂ ln Z_m = P_m (1[in] - P)
      variance += std::pow(p(m) * (in(m)-want) * evidence[m].standard_error, 2.0);
    }
    const TermFinding& term = f.discovery.terms[t];
    EXPECT_NEAR(term.inclusion, want, 4.5 * std::hypot(term.mcse, std::sqrt(variance)) + 1e-4)
        << term.label;
    std::printf("  %-18s P(in) %.4f +- %.4f, of all evidences %.4f +- %.4f\n", term.label.c_str(),
                term.inclusion, term.mcse, want, std::sqrt(variance));
    EXPECT_EQ(term.prior, 0.4);
    least_decided = std::min(least_decided, std::abs(want - 0.5));
  }
  EXPECT_LT(least_decided, 0.49);  // otherwise the test has no power
  EXPECT_TRUE(f.discovery.terms[0].is_in()) << f.discovery.terms[0].inclusion;
  ASSERT_EQ(f.discovery.terms[0].parameters.size(), 1U);
  const Marginal& cubic = f.discovery.terms[0].parameters[0].estimate;
  EXPECT_NEAR(cubic.mean, 1000.0, 4.0 * cubic.sd);
}

// Regression: climbs whose first differences were as wide as a prior did not leave the mode of the
// model without the term, although the model with it had another mode.
TEST(TermFindings, FindsATermFromTheModeOfTheModelWithoutIt) {
  const auto sid = make_sid_problem(duffing_asked_about(0.4, 0.04));
  const inference::Problem& problem = sid->problem;
  constexpr int kCubic = 1, kBoth = 4;
  ASSERT_EQ(problem.space[kBoth].name, "linear + cubic + quadratic");
  std::vector<double> start =
      inference::search_modes(problem, kCubic, {.seed = 3, .climbs = 30}).modes.front().z;
  start.push_back(0.0);
  inference::ModeSearch found;
  inference::extend_search(problem, kBoth, {.seed = 3, .starts = {start}, .fine = true}, found);
  const auto all = inference::search_modes(problem, kBoth, {.seed = 3, .climbs = 30});
  ASSERT_FALSE(found.modes.empty());
  EXPECT_GT(found.modes.front().log_mass, all.modes.front().log_mass - 0.5);
}

TEST(TermFindings, WithoutTheLikelihoodInclusionIsThePrior) {
  const SidFindings f = found_terms(duffing_asked_about(0.3), true);
  for (const TermFinding& term : f.discovery.terms) {
    EXPECT_NEAR(term.inclusion, 0.3, 4.5 * term.mcse) << term.label;
    EXPECT_LT(term.mcse, 0.03);
  }
}

// The averaged law contains the true one, and the force-state map scatters about it.
TEST(TermFindings, TheAveragedLawContainsTheTrueOne) {
  const SidFindings f = found_terms(duffing_asked_about(0.5, 0.002));
  ASSERT_EQ(f.discovery.laws.size(), 1U);
  const LinkLaw& law = f.discovery.laws.front();
  ASSERT_EQ(law.at_rest.extension.size(), law.at_rest.q50.size());
  int held = 0;
  for (std::size_t i = 0; i < law.at_rest.extension.size(); ++i) {
    const double e = law.at_rest.extension[i], truth = 50.0 * e + 1000.0 * e * e * e;
    held += truth >= law.at_rest.q2_5[i] && truth <= law.at_rest.q97_5[i] ? 1 : 0;
  }
  EXPECT_GT(held, 20);  // of 41 correlated points of one curve
  ASSERT_FALSE(law.map.empty());
  double squares = 0.0, misses = 0.0;
  for (const LinkLaw::Point& p : law.map) {
    squares += p.tension * p.tension;
    misses += std::pow(p.tension - (50.0 * p.extension + 1000.0 * std::pow(p.extension, 3)), 2);
  }
  EXPECT_LT(misses, 0.1 * squares);  // noise amplified by differences, and the damping force
}

}  // namespace
}  // namespace wheeltap::identification

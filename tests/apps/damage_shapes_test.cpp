// Damage from frequencies and mode shapes.
#include <gmock/gmock.h>

#include <cmath>

#include "apps/cases/damage_case.hpp"
#include "base/eigen_solvers.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "program.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using nlohmann::json;
using testing::HasSubstr;

/// The published beam A (science.md) with few elements and five sensors at arbitrary positions.
json beam_a(int seed) {
  json c = small_case();
  c["beam"]["elements"] = 40;
  c["data"] = {
      {"cov", 0.001}, {"modes", 5}, {"shape_sd", 0.01}, {"seed", seed}, {"sensors", json::array()}};
  for (const double x : {0.11, 0.27, 0.45, 0.62, 0.88}) c["data"]["sensors"].push_back({{"at", x}});
  c["damage"]["count"] = {{"min", 0}, {"max", 1}, {"prior", "uniform"}};
  c["damage"]["truth"] = {{{"location", 0.212}, {"reduction", 0.5}}};
  return c;
}

struct Parsed {
  DamageCaseFile file;
  std::unique_ptr<const DamageProblem> problem;
};
Parsed parsed_case(const json& c) {
  const Workspace where;
  Parsed out{.file = parse_damage_case(read_case(where.write_json("c.json", c))),
             .problem = nullptr};
  out.problem = explained(out.file, [&] { return make_damage_problem(out.file.damage, {}); });
  return out;
}

// The reanalysis agrees with the full solution of the damaged structure.
TEST(DamageShapes, TheLikelihoodIsThatOfTheDamagedModes) {
  const Parsed p = parsed_case(beam_a(1));
  ASSERT_TRUE(p.problem->by_modes());
  const ModalLikelihood& of_modes = p.problem->modes().of(0);
  EXPECT_EQ(of_modes.measured(), 5 + 5 * 4);
  EXPECT_FALSE(p.problem->symmetric) << "shapes tell the sides apart";
  EXPECT_EQ(p.problem->problem.reflections.size(), 1U) << "but both sides are tried";
  const auto likelihood = p.problem->problem.likelihood();
  for (const double x : {0.05, 0.212, 0.788}) {
    DamageCase damaged = p.file.damage;
    damaged.kinds[0].truth = {{.location = x, .severity = 0.4}};
    const fem::StructureModes full = fem::structure_modes(true_structure(damaged), 8);
    fem::ParametricModes::Modes modes;
    modes.eigenvalues = full.eigenvalues;
    modes.shapes.resize(5, 8);
    for (Eigen::Index s = 0; s < 5; ++s)
      for (Eigen::Index m = 0; m < 8; ++m)
        modes.shapes(s, m) = p.file.damage.modal()->sensors[static_cast<std::size_t>(s)].motion.of(
            full.shapes.col(m));
    const double expected = of_modes.score(modes, {}).log_likelihood;
    const double found = likelihood->log_likelihood(1, std::vector<double>{x, 0.4});
    EXPECT_NEAR(found, expected, 1e-5 * std::abs(expected)) << x;
  }
}

// Frequencies alone give probability 1/2 to each side.
TEST(DamageShapes, TellLeftFromRight) {
  for (const int seed : {1, 2, 3}) {
    const Parsed p = parsed_case(beam_a(seed));
    inference::Options options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.warmup = 1500;
    options.draws = 1500;
    options.threads = 2;
    const inference::Posterior posterior = inference::reversible_jump(p.problem->problem, options);
    double left = 0.0, all = 0.0;
    for (const auto& chain : posterior.chains)
      for (std::size_t i = 0; i < chain.model.size(); ++i) {
        if (chain.model[i] != 1) continue;
        all += 1.0;
        left += chain.theta[i * static_cast<std::size_t>(posterior.dimension)] < 0.5;
      }
    EXPECT_GT(left / all, 0.95) << seed;
  }
}

TEST(DamageShapes, RunsAndSaysHowItFits) {
  const Workspace where;
  json c = beam_a(1);
  c["data"]["shape_sd"] = {{"log_uniform", {1e-3, 0.1}}};
  c["damage"]["truth"] = {{"defects", c["damage"]["truth"]}, {"shape_sd", 0.01}};
  const Outcome ran =
      wheeltap(where, "damage " + where.write_json("c.json", c).string() + " -o " +
                          (where / "out").string() + " --quiet --warmup 500 --draws 500");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json summary = json::parse(read_all(where / "out/summary.json"));
  EXPECT_TRUE(summary["parameters"]["1 damage"].contains("shape_sd"));
  const double p = summary["data"]["posterior_predictive_p"].get<double>();
  EXPECT_GT(p, 0.005);
  EXPECT_LT(p, 0.995);
}

// A simulated case is complete: it contains the shapes and runs without changes.
TEST(DamageShapes, SimulatedCasesHoldThem) {
  const Workspace where;
  const std::string made = (where / "made.json").string();
  const std::string simulate =
      "simulate " + where.write_json("c.json", beam_a(1)).string() + " -o ";
  ASSERT_EQ(wheeltap(where, simulate + made).exit_code, 0);
  const json data = json::parse(read_all(made))["data"];
  ASSERT_EQ(data["shapes"].size(), 5U);
  EXPECT_EQ(data["shapes"][0].size(), 5U);
  EXPECT_EQ(data["shape_sd"], 0.01);
  EXPECT_EQ(wheeltap(where, "damage " + made + " --dry-run").exit_code, 0);
  EXPECT_EQ(wheeltap(where, simulate + (where / "made.csv").string()).exit_code, 64);
}

// Correlated errors of two frequencies give more information on their difference.
TEST(DamageShapes, CovariancesOfFrequencies) {
  json c = small_case();
  c["data"].erase("cov");
  c["data"]["frequencies"] = {13.8, 55.3};
  c["data"]["covariance"] = {{0.02, 0.039}, {0.039, 0.08}};
  const Parsed p = parsed_case(c);
  const auto likelihood = p.problem->problem.likelihood();
  const double found = likelihood->log_likelihood(1, std::vector<double>{0.3, 0.2});
  const auto f = elastic_frequencies(p.file.damage.beam, {.damages = {{0.3, 0.2}}}, 2);
  const Eigen::Vector2d r(13.8 - f[0], 55.3 - f[1]);
  Eigen::Matrix2d s;
  s << 0.02, 0.039, 0.039, 0.08;
  const double expected = -0.5 * r.dot(s.inverse() * r) - 0.5 * std::log(s.determinant()) -
                          std::log(2.0 * 3.14159265358979323846);
  EXPECT_NEAR(found, expected, 1e-6 * std::abs(expected));
}

TEST(DamageShapes, Refusals) {
  const Workspace where;
  const auto refused = [&](const json& c, const std::string& words) {
    const Outcome outcome =
        wheeltap(where, "damage " + where.write_json("c.json", c).string() + " --dry-run");
    EXPECT_EQ(outcome.exit_code, 65) << words << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  json c = beam_a(1);
  c["data"]["sensors"][2]["at"] = 1.2;
  refused(c, "/data/sensors/2/at");
  c = beam_a(1);
  c["data"]["frequencies"] = {13.8, 55.3};
  c["data"].erase("modes");
  c["data"]["shapes"] = {{1, 2, 3, 4, 5}, {1, 2, 3}};
  refused(c, "/data/shapes/1");
  c["data"]["shapes"] = {{1, 2, 3, 4, 5}, {0, 0, 0, 0, 0}};
  refused(c, "/data/shapes/1");
  c["data"]["shapes"] = {{1, 2, 3, 4, 5}, {1, 2, 3, 4, 5}};
  c["data"].erase("shape_sd");
  refused(c, "/data/shape_sd");
  c["data"]["shape_sd"] = 0.0;
  refused(c, "/data/shape_sd");
  c = small_case();
  c["data"] = {{"frequencies", {13.8, 55.3}}, {"covariance", {{0.02, 0.05}, {0.05, 0.08}}}};
  refused(c, "/data/covariance");
  c = beam_a(1);
  c["predictor"] = json::parse(R"({"sites": [2, 5, 9], "multipliers": [0.4, 1.0]})");
  refused(c, "/predictor");
}

}  // namespace
}  // namespace wheeltap::apps

// Posterior of one damage by quadrature, with the ten published sites and data simulated by the FE
// model. Ignoring the emulator error gives wrong intervals; including it gives the nominal
// coverage.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "apps/cases/damage_case.hpp"
#include "base/random.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "program.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

constexpr int kCases = 200;
constexpr int kReductions = 60;

struct Misses {
  int location = 0, reduction = 0;
};

// Number of truths from the prior outside the central 95 % intervals.
Misses misses(const std::string& predictor, const char* supports, int modes) {
  Json input = small_case();
  input["beam"]["elements"] = 100;
  input["beam"]["supports"] = supports;
  input["data"] = {{"frequencies", std::vector<double>(static_cast<std::size_t>(modes), 1.0)},
                   {"cov", 0.001}};
  input["damage"]["count"] = {{"min", 1}, {"max", 1}};
  input["damage"]["location"] = {{"uniform", {0.04, 0.95}}};
  input["predictor"] = Json::parse(predictor);
  const Workspace where;
  const auto problem = make_damage_problem(
      parse_damage_case(read_case(where.write_json("c.json", input))).damage, {});
  const fem::Beam& beam = problem->damage_case.beam;
  // Emulator predictions on a grid: constant within an element, midpoint rule in the reduction.
  StructuralPredictor exact(*problem), emulator(*problem, *problem->emulated);
  const auto n_modes = static_cast<std::size_t>(modes);
  std::vector<std::vector<double>> f, variance;
  for (int e = 4; e < 95; ++e) {
    for (int j = 0; j < kReductions; ++j) {
      const std::vector<double> x = {beam.element_midpoint(e), (j + 0.5) / kReductions * 0.6};
      Prediction emulated{.frequencies_hz = std::vector<double>(n_modes)};
      EXPECT_TRUE(emulator.predict(0, x, ForwardModel::Quantity::frequencies, emulated));
      f.push_back(emulated.frequencies_hz);
      variance.push_back(emulated.error_variance);
    }
  }
  std::vector<double> data(n_modes), log_l(f.size());
  Misses out;
  for (int n = 0; n < kCases; ++n) {
    base::Random random(11, 0, static_cast<std::uint64_t>(n), base::Purpose::test);
    const double location = 0.04 + 0.91 * random.uniform();
    const double reduction = 0.6 * random.uniform();
    exact.solve(0, std::vector<double>{location, reduction}, data);
    for (double& y : data) y *= 1.0 + 0.001 * random.normal();
    for (std::size_t at = 0; at < f.size(); ++at) {
      log_l[at] = 0.0;
      for (std::size_t i = 0; i < n_modes; ++i) {
        const double total = std::pow(0.001 * data[i], 2) + variance[at][i];
        log_l[at] -= 0.5 * (std::pow(data[i] - f[at][i], 2) / total + std::log(total));
      }
    }
    const double top = *std::ranges::max_element(log_l);
    double sum = 0.0, left = 0.0, below = 0.0;
    for (std::size_t i = 0; i < log_l.size(); ++i) {
      const double w = std::exp(log_l[i] - top);
      const auto share = [](double truth, double low, double width) {
        return std::clamp((truth - low) / width, 0.0, 1.0);
      };
      sum += w;
      left += w * share(location, 0.04 + 0.01 * static_cast<double>(i / kReductions), 0.01);
      below += w * share(reduction, 0.01 * static_cast<double>(i % kReductions), 0.01);
    }
    const auto outside = [&](double part) { return part < 0.025 * sum || part > 0.975 * sum; };
    out.location += outside(left) ? 1 : 0;
    out.reduction += outside(below) ? 1 : 0;
  }
  return out;
}

const std::string kSites = R"({"sites": [5, 15, 25, 35, 45, 55, 65, 75, 85, 95],
                               "multipliers": [0.4, 0.6, 0.8, 1.0])";

// For 200 intervals at 95 %, 21 misses have probability 0.001, and 3 or fewer have 0.01.
TEST(EmulatorCoverage, IntervalsCoverAtTheStatedRate) {
  for (const char* supports : {"simply-supported", "cantilever"}) {
    for (const int modes : {10, 20}) {
      const Misses m = misses(kSites + "}", supports, modes);
      EXPECT_LE(m.location, 20) << supports << ", " << modes << " modes";
      EXPECT_LE(m.reduction, 20) << supports << ", " << modes << " modes";
      RecordProperty(std::string(supports) + "_" + std::to_string(modes),
                     std::to_string(m.location) + " " + std::to_string(m.reduction));
    }
  }
}

TEST(EmulatorCoverage, TrustingTheEmulatorBlindlyIsWrong) {
  const Misses m = misses(kSites + R"(, "emulator_error": false})", "simply-supported", 20);
  EXPECT_GT(m.location, 60);
  EXPECT_GT(m.reduction, 60);
  RecordProperty("blind", std::to_string(m.location) + " " + std::to_string(m.reduction));
  const Misses one_sided = misses(kSites + R"(, "symmetrise": false})", "simply-supported", 20);
  EXPECT_GT(one_sided.location, 25) << "mirror images count as different";
  RecordProperty("one_sided", std::to_string(one_sided.location));
}

}  // namespace
}  // namespace wheeltap::apps

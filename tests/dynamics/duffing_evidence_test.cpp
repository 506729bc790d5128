// Linear against Duffing of ../shared/validation/sdof: the log evidences by quadrature over this
// integrator's likelihood.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "dynamics/simulate.hpp"

namespace {

using namespace wheeltap::dynamics;

/// log ∫ exp(f) by the midpoint rule over a box of cells, f evaluated in one batch.
double log_integral(const std::vector<double>& log_values, double cell) {
  const double top = *std::max_element(log_values.begin(), log_values.end());
  double sum = 0.0;
  for (double value : log_values) sum += std::exp(value - top);
  return top + std::log(sum * cell);
}

TEST(DuffingEvidence, MatchesTheValidationFile) {
  const std::filesystem::path folder =
      std::filesystem::path(WHEELTAP_SHARED_DIR) / "validation/sdof";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  std::ifstream file(folder / "duffing_300.csv");
  std::string line;
  std::getline(file, line);
  std::vector<double> force, displacement;
  double t, f, y;
  char comma;
  while (file >> t >> comma >> f >> comma >> y) {
    force.push_back(f);
    displacement.push_back(y);
  }
  ASSERT_EQ(force.size(), 300U);

  const Coefficient k = Coefficient::of_parameter(0), k3 = Coefficient::of_parameter(1);
  const Chain chain{
      .masses = {0.5},
      .links = {{.stiffness = k, .damping = 0.1, .laws = {make_law<laws::Cubic>({k3})}}}};
  const Misfit misfit(
      Simulator(chain, {.sample_rate_hz = 100.0, .forces = {{.mass = 1, .signal = {force}}}},
                {{.mass = 1}}, {}, {.substeps = 1}),
      {{displacement}});
  const auto log_likelihoods = [&](const std::vector<double>& thetas) {
    std::vector<double> values(thetas.size() / 2);
    misfit.sums_of_squares(thetas, static_cast<int>(values.size()), values);
    const double sigma = 0.05;
    for (double& value : values)
      value = -0.5 * value / (sigma * sigma) -
              300.0 * std::log(sigma * std::sqrt(2.0 * std::numbers::pi));
    return values;
  };
  std::vector<double> linear, duffing;
  for (int i = 0; i < 4000; ++i) linear.insert(linear.end(), {100.0 * (i + 0.5) / 4000, 0.0});
  EXPECT_NEAR(log_integral(log_likelihoods(linear), 1.0 / 4000), 474.7867324475682, 1e-6);
  const int m =
      250;  // k in [40, 62], k3 in [0, 2500]: 6 standard deviations about the mode and more
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j)
      duffing.insert(duffing.end(), {40.0 + 22.0 * (i + 0.5) / m, 2500.0 * (j + 0.5) / m});
  const double cell = 22.0 / m / 100.0 * (2500.0 / m) / 1e4;
  EXPECT_NEAR(log_integral(log_likelihoods(duffing), cell), 476.2582026048405, 1e-4);
}

}  // namespace

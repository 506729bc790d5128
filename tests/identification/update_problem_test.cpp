// Posteriors compared with quadrature that uses neither the engine nor its likelihood.
#include "identification/structural/updating/update_problem.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/eigen_solvers.hpp"
#include "identification/structural/updating/update_findings.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "tests/identification/modal_cases.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// Frequencies and shapes of the two-storey chain in closed form: λ² m₁m₂ - λ (m₁k₂ + m₂(k₁ + k₂))
/// + k₁k₂ = 0.
struct TwoStoreys {
  double m1 = 2.0, m2 = 1.0;
  [[nodiscard]] std::array<double, 2> eigenvalues(double k1, double k2) const {
    const double b = m1 * k2 + m2 * (k1 + k2), root = std::sqrt(b * b - 4.0 * m1 * m2 * k1 * k2);
    return {(b - root) / (2.0 * m1 * m2), (b + root) / (2.0 * m1 * m2)};
  }
  /// Motion of the second floor relative to the first.
  [[nodiscard]] double ratio(double k1, double k2, double lambda) const {
    return (k1 + k2 - lambda * m1) / k2;
  }
};

struct Moments {
  Vector2d mean = Vector2d::Zero();
  Matrix2d covariance = Matrix2d::Zero();
};

/// Midpoint rule over the box of the uniform priors, refined around the posterior.
template <class LogDensity>
Moments quadrature(const LogDensity& log_density, int steps) {
  Eigen::Vector4d box(500.0, 3000.0, 300.0, 2500.0);
  Moments out;
  for (int pass = 0; pass < 4; ++pass) {
    double most = -1e300, sum = 0.0;
    const double h1 = (box[1] - box[0]) / steps, h2 = (box[3] - box[2]) / steps;
    const auto at = [&](int i, int j) {
      return Vector2d(box[0] + (i + 0.5) * h1, box[2] + (j + 0.5) * h2);
    };
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < steps; ++j) most = std::max(most, log_density(at(i, j)[0], at(i, j)[1]));
    Vector2d mean = Vector2d::Zero();
    Matrix2d second = Matrix2d::Zero();
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < steps; ++j) {
        const Vector2d k = at(i, j);
        const double p = std::exp(log_density(k[0], k[1]) - most);
        sum += p;
        mean += p * k;
        second += p * k * k.transpose();
      }
    out.mean = mean / sum;
    out.covariance = second / sum - out.mean * out.mean.transpose();
    // All modes remain inside: twelve sd, within the priors.
    for (int d = 0; d < 2; ++d) {
      const double sd = std::sqrt(out.covariance(d, d)) + (d == 0 ? h1 : h2);
      box[2 * d] = std::max(box[2 * d], out.mean[d] - 12.0 * sd);
      box[2 * d + 1] = std::min(box[2 * d + 1], out.mean[d] + 12.0 * sd);
    }
  }
  return out;
}

struct Outcome {
  std::unique_ptr<const UpdateProblem> problem;
  inference::Posterior posterior;
  UpdateFindings findings;
};

Outcome run(UpdateCase update_case, std::uint64_t seed = 1) {
  Outcome out{
      .problem = make_update_problem(std::move(update_case)), .posterior = {}, .findings = {}};
  out.posterior =
      inference::reversible_jump(out.problem->problem, {.seed = seed, .chains = 4, .draws = 10000});
  out.findings = update_findings(*out.problem, out.posterior, {}, seed);
  return out;
}

/// Means, standard deviations and the correlation, each within five Monte Carlo errors.
void expect_moments(const Outcome& run, const Moments& exact) {
  const auto first = run.posterior.draws_of("k1", 0), second = run.posterior.draws_of("k2", 0);
  const auto moment = [&](auto value) {
    inference::ChainsOf draws = first;
    for (std::size_t c = 0; c < draws.size(); ++c)
      for (std::size_t i = 0; i < draws[c].size(); ++i)
        draws[c][i] = value(Vector2d(Vector2d(first[c][i], second[c][i]) - exact.mean));
    return draws;
  };
  const auto near = [&](const auto& draws, double expected, const char* what) {
    EXPECT_NEAR(inference::mean(draws), expected, 5.0 * inference::mcse_mean(draws)) << what;
  };
  for (int d = 0; d < 2; ++d) {
    near(moment([d](const Vector2d& k) { return k[d]; }), 0.0, "mean");
    near(moment([d](const Vector2d& k) { return k[d] * k[d]; }), exact.covariance(d, d),
         "variance");
  }
  near(moment([](const Vector2d& k) { return k[0] * k[1]; }), exact.covariance(0, 1), "covariance");
}

TEST(UpdateProblem, TwoStoreysFromFrequenciesAloneAgreeWithQuadrature) {
  const UpdateCase update_case = modal::two_storeys(0.01, 0.0);
  const ModalData data = update_case.data;
  const TwoStoreys chain;
  const auto log_density = [&](double k1, double k2) {
    const auto lambda = chain.eigenvalues(k1, k2);
    double sum = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      const double f = std::sqrt(lambda[i]) / (2.0 * std::numbers::pi);
      sum -= 0.5 * std::pow((data.frequencies_hz[i] - f) / (0.01 * data.frequencies_hz[i]), 2);
    }
    return sum;
  };
  // Two frequencies correspond to two chains, stiff below or stiff above.
  expect_moments(run(update_case), quadrature(log_density, 800));
}

TEST(UpdateProblem, TwoStoreysWithShapesAgreeWithQuadrature) {
  const UpdateCase update_case = modal::two_storeys(0.01, 0.05);
  const ModalData data = update_case.data;
  const TwoStoreys chain;
  const auto log_density = [&](double k1, double k2) {
    const auto lambda = chain.eigenvalues(k1, k2);
    double sum = 0.0;
    for (Eigen::Index i = 0; i < 2; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double f = std::sqrt(lambda[at]) / (2.0 * std::numbers::pi);
      sum -= 0.5 * std::pow((data.frequencies_hz[at] - f) / (0.01 * data.frequencies_hz[at]), 2);
      // For two entries, only the angle between them counts, by its sine.
      const Vector2d computed(1.0, chain.ratio(k1, k2, lambda[at]));
      Vector2d measured = data.shapes.row(i).transpose();
      measured /= measured.cwiseAbs().maxCoeff();
      const double across = measured[0] * computed[1] - measured[1] * computed[0];
      sum -= 0.5 * across * across / computed.squaredNorm() / (0.05 * 0.05);
    }
    return sum;
  };
  const Outcome found = run(update_case);
  expect_moments(found, quadrature(log_density, 800));
  EXPECT_TRUE(found.findings.fit.ok());
  for (const ModeFinding& mode : found.findings.modes) {
    EXPECT_EQ(mode.computed, mode.mode);
    EXPECT_GT(mode.mac.q50, 0.98);
  }
}

// A parameter without effect on any mode keeps its prior, and is named.
TEST(UpdateProblem, NamesAParameterWithoutInformationInTheData) {
  UpdateCase update_case{
      .title = "three in a row",
      .structure = modal::chain({2.0, 1.0, 1e-4}, {inference::LogUniform{500.0, 3000.0},
                                                   inference::LogUniform{300.0, 2500.0},
                                                   inference::LogUniform{1e5, 4e5}})};
  update_case.simulation = ModalSimulation{
      .parameters = {1400.0, 900.0, 2e5}, .modes = 2, .cov = 0.005, .shape_sd = 0.0};
  simulate(update_case, 1);
  const Outcome found = run(std::move(update_case));
  ASSERT_EQ(found.findings.contractions.size(), 3u);
  EXPECT_FALSE(found.findings.contractions[0].at_prior());
  EXPECT_TRUE(found.findings.contractions[2].at_prior())
      << found.findings.contractions[2].contraction;
  ASSERT_EQ(found.findings.untouched.size(), 1u);
  EXPECT_EQ(found.findings.untouched[0].weights[0].first, "k3");
}

// One shape entry of mode 2 is wrong: the mode must be named.
TEST(UpdateProblem, NamesAModeThatDoesNotFit) {
  UpdateCase update_case = modal::two_storeys(0.01, 0.02);
  update_case.data.shapes(1, 0) = 2.5;
  const Outcome found = run(std::move(update_case));
  EXPECT_FALSE(found.findings.fit.ok());
  ASSERT_FALSE(found.findings.fit.off.empty());
  EXPECT_EQ(found.findings.fit.off.back(), 2);
}

/// Four storeys, all modes at all floors.
UpdateCase four_storeys() {
  const inference::Prior prior = inference::LogUniform{300.0, 3000.0};
  UpdateCase out{.title = "four storeys",
                 .structure = modal::chain({2.0, 1.5, 1.2, 1.0}, {prior, prior, prior, prior})};
  out.data.sensors = modal::at_masses({1, 2, 3, 4});
  out.simulation = ModalSimulation{
      .parameters = {1400.0, 900.0, 1100.0, 800.0}, .modes = 4, .cov = 0.005, .shape_sd = 0.02};
  simulate(out, 4);
  return out;
}

/// The modes with these numbers, from 0, in this order; -1 for a spurious mode.
UpdateCase with_modes(const UpdateCase& from, const std::vector<int>& order) {
  UpdateCase out = from;
  const auto n = static_cast<Eigen::Index>(order.size());
  ModalData& data = out.data;
  data.frequencies_hz.clear();
  data.shapes.resize(n, 4);
  data.shape_covariances.clear();
  std::vector<double> sds;
  for (Eigen::Index i = 0; i < n; ++i) {
    const int mode = order[static_cast<std::size_t>(i)];
    const double f = mode < 0 ? 6.0 : from.data.frequencies_hz[static_cast<std::size_t>(mode)];
    data.frequencies_hz.push_back(f);
    sds.push_back(0.005 * f);
    data.shapes.row(i) = mode < 0 ? Eigen::RowVector4d(1.0, 0.3, 0.7, 0.9)
                                  : Eigen::RowVector4d(from.data.shapes.row(mode));
    data.shape_covariances.push_back(from.data.shape_covariances[0]);
  }
  data.covariance = modal::diagonal(sds);
  out.simulation.reset();
  return out;
}

/// Means and standard deviations of all stiffnesses agree within five Monte Carlo errors.
void expect_same(const Outcome& a, const Outcome& b, const char* what) {
  for (const char* k : {"k1", "k2", "k3", "k4"}) {
    const auto first = a.posterior.draws_of(k, 0), second = b.posterior.draws_of(k, 0);
    const double middle = inference::mean(first);
    const auto squares = [&](inference::ChainsOf draws) {
      for (auto& chain : draws)
        for (double& x : chain) x = (x - middle) * (x - middle);
      return draws;
    };
    const auto near = [&](const inference::ChainsOf& p, const inference::ChainsOf& q) {
      EXPECT_NEAR(inference::mean(p), inference::mean(q),
                  5.0 * std::hypot(inference::mcse_mean(p), inference::mcse_mean(q)))
          << what << ", " << k;
    };
    near(first, second);
    near(squares(first), squares(second));
  }
}

TEST(UpdateProblem, ThePosteriorDoesNotDependOnTheOrderOfModes) {
  const UpdateCase all = four_storeys();
  expect_same(run(with_modes(all, {0, 1, 2, 3})), run(with_modes(all, {2, 0, 3, 1}), 2), "swapped");
}

// Effect of a spurious mode if it may be spurious, and the finding if it may not.
TEST(UpdateProblem, ASpuriousModeHasNoEffectOrIsNamed) {
  const UpdateCase all = four_storeys();
  const Outcome without = run(with_modes(all, {0, 2, 3}));
  UpdateCase spoilt = with_modes(all, {0, -1, 2, 3});
  UpdateCase more = with_modes(all, {0, 1, -1, 2, 3});  // more than the structure has
  more.data.doubt = 0.05;
  EXPECT_NO_THROW((void)make_update_problem(more));
  const Outcome trusted = run(spoilt, 2);
  EXPECT_FALSE(trusted.findings.fit.ok());
  EXPECT_NE(std::ranges::find(trusted.findings.fit.off, 2), trusted.findings.fit.off.end());
  spoilt.data.doubt = 0.05;
  const Outcome doubted = run(spoilt, 3);
  expect_same(without, doubted, "doubted");
  EXPECT_TRUE(doubted.findings.fit.ok());
  EXPECT_GT(doubted.findings.modes[1].spurious, 0.99);
  for (const std::size_t real : {0u, 2u, 3u})
    EXPECT_LT(doubted.findings.modes[real].spurious, 0.01);
  EXPECT_TRUE(std::ranges::any_of(doubted.findings.remarks, [](const Remark& remark) {
    const auto* mode = std::get_if<remark::SpuriousMode>(&remark);
    return mode != nullptr && mode->mode == 2;
  }));
}

TEST(UpdateProblem, RejectsACaseWithoutUnknowns) {
  UpdateCase update_case = modal::two_storeys(0.01, 0.0);
  auto known = std::make_shared<StructureModel>(*update_case.structure);
  known->parameters.clear();
  known->setters.clear();
  update_case.structure = known;
  EXPECT_THROW(make_update_problem(update_case), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::identification

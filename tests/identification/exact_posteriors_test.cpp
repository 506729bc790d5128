// Posteriors of small structures compared with sums over grids that use neither the engine nor the
// likelihoods: damage with an unknown stiffness, four storeys with shapes, a symmetric beam with
// shapes.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "fem/beam/modal_analysis.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/defects/reduction.hpp"
#include "identification/structural/defects/storey.hpp"
#include "identification/structural/updating/update_findings.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "tests/identification/modal_cases.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Modes of masses in a row, the first joined to the ground, by a dense solver.
struct ChainModes {
  VectorXd frequencies_hz;
  MatrixXd shapes;
};
ChainModes modes_of(const std::vector<double>& masses, const std::vector<double>& stiffness) {
  const auto n = static_cast<Index>(masses.size());
  MatrixXd k = MatrixXd::Zero(n, n), m = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    m(i, i) = masses[static_cast<std::size_t>(i)];
    const double s = stiffness[static_cast<std::size_t>(i)];
    k(i, i) += s;
    if (i == 0) continue;
    k(i - 1, i - 1) += s;
    k(i, i - 1) -= s;
    k(i - 1, i) -= s;
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(k, m);
  return {solver.eigenvalues().cwiseSqrt() / kTwoPi, solver.eigenvectors()};
}

double misfit(const std::vector<double>& observed, const VectorXd& computed, double cov) {
  double sum = 0.0;
  for (std::size_t i = 0; i < observed.size(); ++i)
    sum += std::pow((observed[i] - computed[static_cast<Index>(i)]) / (cov * observed[i]), 2);
  return sum;
}

/// χ² of a shape of any scale with equal scatter of its entries (Watson); largest entry of ψ 1.
double misfit(const VectorXd& psi, const VectorXd& phi, double sd) {
  const VectorXd p = psi / psi.cwiseAbs().maxCoeff();
  return (p.squaredNorm() - std::pow(p.dot(phi), 2) / phi.squaredNorm()) / (sd * sd);
}

ModalData frequencies(std::vector<double> f, double cov) {
  ModalData out{.frequencies_hz = std::move(f)};
  std::vector<double> sd;
  for (const double x : out.frequencies_hz) sd.push_back(cov * x);
  out.covariance = modal::diagonal(sd);
  return out;
}

// ---- a soft storey with an unknown stiffness ---------------------------------------------------

TEST(ExactPosteriors, ASoftStoreyWithAnUnknownStiffness) {
  constexpr double kCov = 0.02, kMost = 0.9;
  const inference::Prior stiffness = inference::LogNormal{std::log(1300.0), 0.3};
  const std::vector<double> masses = {2.0, 1.0};
  const VectorXd truth_healthy = modes_of(masses, {1400.0, 900.0}).frequencies_hz;
  const VectorXd truth = modes_of(masses, {1400.0 * 0.9, 900.0}).frequencies_hz;
  const std::vector<double> healthy = {truth_healthy[0] * 1.01, truth_healthy[1] * 0.99};
  const std::vector<double> damaged = {truth[0] * 0.995, truth[1] * 1.012};

  auto model = std::make_shared<StructureModel>();
  model->nominal = fem::LumpedChain{
      .masses = masses, .links = {{"storey 1", {0, 1}, 1300.0}, {"storey 2", {1, 2}, 900.0}}};
  model->parameters = {{"k", stiffness}};
  model->setters = {
      [](AnyStructure& s, double x) { std::get<fem::LumpedChain>(s).links[0].stiffness = x; }};
  auto states = std::make_shared<ObservedStates>();
  states->model = model;
  states->unknown = {0};
  states->list.push_back({.name = "healthy", .data = frequencies(healthy, kCov)});
  states->list.push_back({.name = "damaged", .data = frequencies(damaged, kCov), .damaged = true});
  SiteLine line = SiteLine::of_points({0, 1}, {"storey 1", "storey 2"});
  DefectKind storey{.type = &defects::kStorey,
                    .name = "storey",
                    .plural = "storeys",
                    .max_count = 1,
                    .location = inference::Uniform{0.0, line.length()},
                    .severity = inference::Prior(inference::Uniform{0.0, kMost})};
  storey.line = std::move(line);
  DamageCase damage_case;
  damage_case.structure = model;
  damage_case.measured = MeasuredModes(states, states->joined());
  damage_case.kinds = {storey};
  damage_case.data.frequencies_hz = damage_case.modal()->frequencies_hz;
  for (Index i = 0; i < 4; ++i)
    damage_case.data.sd_hz.push_back(std::sqrt(damage_case.modal()->covariance(i, i)));

  // Grid over z of the stiffness and the reduction of either storey.
  constexpr int kStiffnesses = 300, kReductions = 300;
  double evidence[2] = {}, by_storey[2] = {}, sum = 0.0, sum_k = 0.0, sum_k2 = 0.0;
  for (int a = 0; a < kStiffnesses; ++a) {
    const double z = -6.0 + 12.0 * (a + 0.5) / kStiffnesses;
    const double k = stiffness.from_standard_normal(z), prior = std::exp(-0.5 * z * z);
    const double first = misfit(healthy, modes_of(masses, {k, 900.0}).frequencies_hz, kCov);
    const auto add = [&](int count, double weight, double k1, double k2) {
      const double part =
          prior * weight *
          std::exp(-0.5 *
                   (first + misfit(damaged, modes_of(masses, {k1, k2}).frequencies_hz, kCov)));
      evidence[count] += part;
      sum += part;
      sum_k += part * k;
      sum_k2 += part * k * k;
      return part;
    };
    add(0, 1.0, k, 900.0);
    for (int b = 0; b < kReductions; ++b) {
      const double q = 1.0 - kMost * (b + 0.5) / kReductions;
      by_storey[0] += add(1, 0.5 / kReductions, k * q, 900.0);
      by_storey[1] += add(1, 0.5 / kReductions, k, 900.0 * q);
    }
  }
  const auto problem = make_damage_problem(damage_case, {});
  const auto posterior = inference::reversible_jump(problem->problem, {.seed = 2});
  const DamageFindings found = damage_findings(*problem, posterior, {}, 2);
  EXPECT_TRUE(found.sampling.verdict.converged);
  for (const ModelFinding& m : found.models)
    EXPECT_NEAR(m.probability(), evidence[m.counts[0]] / sum, 4.0 * m.standing.mcse + 1e-4)
        << m.name;
  for (std::size_t link = 0; link < 2; ++link)
    EXPECT_NEAR(found.kinds[0].expected[link], by_storey[link] / sum, 0.015) << link;
  const Marginal& k = found.baseline->marginals[0];
  const double mean = sum_k / sum, sd = std::sqrt(sum_k2 / sum - mean * mean);
  EXPECT_NEAR(k.mean, mean, 0.05 * sd);
  EXPECT_NEAR(k.sd, sd, 0.04 * sd);
  EXPECT_GT(found.baseline->contractions[0].contraction, 0.5);
  std::printf("  P(1 storey) %.4f of %.4f, k %.1f ± %.1f of %.1f ± %.1f\n",
              found.models[1].probability(), evidence[1] / sum, k.mean, k.sd, mean, sd);
}

// ---- four storeys, two unknowns ----------------------------------------------------------------

TEST(ExactPosteriors, FourStoreysWithTwoUnknowns) {
  constexpr double kCov = 0.01, kSd = 0.03;
  const std::vector<double> masses = {5.0, 5.0, 5.0, 4.0};
  auto model = std::make_shared<StructureModel>();
  fem::LumpedChain chain{.masses = masses, .links = {}};
  for (int i = 0; i < 4; ++i)
    chain.links.push_back({"storey " + std::to_string(i + 1), {i, i + 1}, 2000.0});
  model->nominal = chain;
  for (int half = 0; half < 2; ++half) {
    model->parameters.push_back({half == 0 ? "lower" : "upper", inference::Uniform{800.0, 4000.0}});
    model->setters.emplace_back([half](AnyStructure& s, double x) {
      for (int i = 0; i < 2; ++i)
        std::get<fem::LumpedChain>(s).links[static_cast<std::size_t>(2 * half + i)].stiffness = x;
    });
  }
  const ChainModes truth = modes_of(masses, {2200.0, 2200.0, 1500.0, 1500.0});
  UpdateCase update_case{.title = "four storeys", .structure = model};
  ModalData& data = update_case.data;
  data = frequencies({truth.frequencies_hz[0] * 1.008, truth.frequencies_hz[1] * 0.993}, kCov);
  data.sensors = modal::at_masses({1, 2, 3});
  data.shapes.resize(2, 3);
  for (Index i = 0; i < 2; ++i) {
    data.shapes.row(i) = truth.shapes.col(i).head(3).transpose();
    data.shapes.row(i) /= data.shapes.row(i).cwiseAbs().maxCoeff();
    data.shapes(i, (i + 1) % 3) += 0.02;
  }
  data.shape_covariances.assign(2, kSd * kSd * MatrixXd::Identity(3, 3));

  constexpr int kPoints = 250;
  double sum = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  for (int a = 0; a < kPoints; ++a)
    for (int b = 0; b < kPoints; ++b) {
      const Eigen::Vector2d k(800.0 + 3200.0 * (a + 0.5) / kPoints,
                              800.0 + 3200.0 * (b + 0.5) / kPoints);
      const ChainModes modes = modes_of(masses, {k[0], k[0], k[1], k[1]});
      double chi = misfit(data.frequencies_hz, modes.frequencies_hz, kCov);
      for (Index i = 0; i < 2; ++i)
        chi += misfit(VectorXd(data.shapes.row(i).transpose()),
                      VectorXd(modes.shapes.col(i).head(3)), kSd);
      const double p = std::exp(-0.5 * chi);
      sum += p;
      mean += p * k;
      square += p * k * k.transpose();
    }
  mean /= sum;
  const Eigen::Matrix2d covariance = square / sum - mean * mean.transpose();
  const auto problem = make_update_problem(std::move(update_case));
  const auto posterior =
      inference::reversible_jump(problem->problem, {.seed = 1, .chains = 4, .draws = 10000});
  const auto lower = posterior.draws_of("lower", 0), upper = posterior.draws_of("upper", 0);
  const auto near = [&](const inference::ChainsOf& draws, double expected, const char* what) {
    EXPECT_NEAR(inference::mean(draws), expected, 5.0 * inference::mcse_mean(draws)) << what;
  };
  near(lower, mean[0], "lower");
  near(upper, mean[1], "upper");
  inference::ChainsOf products = lower, squares = lower;
  for (std::size_t c = 0; c < lower.size(); ++c)
    for (std::size_t i = 0; i < lower[c].size(); ++i) {
      squares[c][i] = std::pow(lower[c][i] - mean[0], 2);
      products[c][i] = (lower[c][i] - mean[0]) * (upper[c][i] - mean[1]);
    }
  near(squares, covariance(0, 0), "variance");
  near(products, covariance(0, 1), "covariance");
}

// ---- a symmetric beam, with shapes -------------------------------------------------------------

TEST(ExactPosteriors, ASymmetricBeamWithShapes) {
  constexpr double kCov = 0.002, kSd = 0.03, kMost = 0.6;
  constexpr int kElements = 20, kModes = 3;
  const std::vector<int> nodes = {3, 8, 14};
  DamageCase damage_case;
  damage_case.beam = {
      .length = 1.0,
      .elements = kElements,
      .supports = fem::named_supports("simply-supported", 1.0),
      .material = {.young = 70e9, .poisson = 0.3, .density = 2700.0},
      .section = {.area = 1.5e-4, .second_moment = 4.5e-10, .shear_coefficient = 5.0 / 6.0}};
  const auto modes_with = [&](double x, double r) {
    fem::Defects defects;
    if (r > 0.0) defects.damages = {{x, r}};
    return fem::modal_analysis(damage_case.beam, defects, {.modes = kModes});
  };
  const auto at_sensors = [&](const fem::Modes& modes, Index mode) {
    VectorXd out(static_cast<Index>(nodes.size()));
    for (std::size_t s = 0; s < nodes.size(); ++s)
      out[static_cast<Index>(s)] = modes.shapes(2 * nodes[s], mode);
    return out;
  };
  const fem::Modes truth = modes_with(0.275, 0.1);
  ModalData data = frequencies({truth.frequencies_hz[0] * 1.001, truth.frequencies_hz[1] * 0.9985,
                                truth.frequencies_hz[2] * 1.0012},
                               kCov);
  const fem::Mesh mesh(fem::as_structure(damage_case.beam));
  for (const int node : nodes)
    data.sensors.push_back({std::to_string(node), mesh.motion(0, node * 0.05, fem::Direction::y)});
  data.shapes.resize(kModes, 3);
  for (Index i = 0; i < kModes; ++i) {
    const VectorXd shape = at_sensors(truth, i);
    data.shapes.row(i) = shape.transpose() / shape.cwiseAbs().maxCoeff();
    data.shapes(i, (i + 2) % 3) += 0.015;
  }
  data.shape_covariances.assign(kModes, kSd * kSd * MatrixXd::Identity(3, 3));

  const auto log_likelihood = [&](double x, double r) {
    const fem::Modes modes = modes_with(x, r);
    double chi = misfit(data.frequencies_hz, modes.frequencies_hz, kCov);
    for (Index i = 0; i < kModes; ++i)
      chi += misfit(VectorXd(data.shapes.row(i).transpose()), at_sensors(modes, i), kSd);
    return -0.5 * chi;
  };
  constexpr int kReductions = 120;
  const double reference = log_likelihood(0.275, 0.1);
  const double none = std::exp(log_likelihood(0.5, 0.0) - reference);
  double one = 0.0, left = 0.0;
  std::vector<double> expected(kElements);
  for (int e = 0; e < kElements; ++e)
    for (int b = 0; b < kReductions; ++b) {
      const double part =
          std::exp(log_likelihood((e + 0.5) / kElements, kMost * (b + 0.5) / kReductions) -
                   reference) /
          kElements / kReductions;
      one += part;
      if (e < kElements / 2) left += part;
      expected[static_cast<std::size_t>(e)] += part;
    }
  const double sum = none + one;

  DefectKind kind{.type = &defects::kReduction,
                  .name = "damage",
                  .plural = "damages",
                  .max_count = 1,
                  .location = inference::Uniform{0.0, 1.0},
                  .severity = inference::Prior(inference::Uniform{0.0, kMost})};
  damage_case.kinds = {kind};
  damage_case.measured.set_modal(data);
  damage_case.data.frequencies_hz = data.frequencies_hz;
  for (Index i = 0; i < kModes; ++i)
    damage_case.data.sd_hz.push_back(std::sqrt(data.covariance(i, i)));
  const auto problem = make_damage_problem(damage_case, {});
  const auto posterior = inference::reversible_jump(problem->problem, {.seed = 5});
  const DamageFindings found = damage_findings(*problem, posterior, {}, 5);
  EXPECT_TRUE(found.sampling.verdict.converged);
  EXPECT_NEAR(found.models[1].probability(), one / sum, 4.0 * found.models[1].standing.mcse + 1e-4);
  double found_left = 0.0;
  for (std::size_t e = 0; e < kElements; ++e) {
    EXPECT_NEAR(found.kinds[0].expected[e], expected[e] / sum, 0.015) << e;
    if (e < kElements / 2) found_left += found.kinds[0].expected[e];
  }
  EXPECT_NEAR(found_left, left / sum, 0.02);
  std::printf("  P(1 damage) %.4f of %.4f, on the left %.4f of %.4f\n",
              found.models[1].probability(), one / sum, found_left, left / sum);
}

}  // namespace
}  // namespace wheeltap::identification

// Model updating of measured structures of ../shared/data/updating-structures. Skipped if the data
// are absent.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numbers>

#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/structure_family.hpp"
#include "identification/structural/updating/update_findings.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "io/matlab/sparse_matrix.hpp"
#include "tests/identification/modal_cases.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

const std::filesystem::path kData =
    std::filesystem::path(WHEELTAP_SHARED_DIR) / "data/updating-structures";
constexpr double kNewtonsPerMetre = 175.127;  // per lbf/in

#define SKIP_WITHOUT_DATA() \
  if (!std::filesystem::exists(kData)) GTEST_SKIP() << kData << " does not exist"

UpdateFindings updated(UpdateCase update_case) {
  const auto problem = make_update_problem(std::move(update_case));
  const auto posterior =
      inference::reversible_jump(problem->problem, {.seed = 1, .chains = 4, .draws = 10000});
  return update_findings(*problem, posterior, {}, 1);
}

void report(const UpdateFindings& found) {
  for (const auto& p : found.models[0].parameters)
    std::printf("  %-12s %.5g ± %.2g\n", p.unknown.label.c_str(), p.estimate.mean, p.estimate.sd);
  std::printf("  p %.2g, of the best draw %.2g\n", found.fit.p, found.fit.best_p);
  for (const PredictedMode& p : found.predictions)
    std::printf("  mode %d: %.4f to %.4f Hz, measured %.4f\n", p.mode, p.low_hz, p.high_hz,
                p.measured_hz.value_or(0.0));
}

/// Modes 1 and 2 of the laboratory frame at floors 1 to 3; 3 and 4 held out.
UpdateCase four_storeys(double cov, double shape_sd) {
  const double mass = 12.060 * 0.45359237;
  const inference::Prior stiffness = inference::LogNormal{std::log(10.0 * kNewtonsPerMetre), 0.4};
  UpdateCase out{.title = "four storeys",
                 .structure = modal::chain(std::vector<double>(4, mass),
                                           std::vector<inference::Prior>(4, stiffness))};
  out.data.frequencies_hz = {0.88289843, 2.7477378};
  out.data.covariance = modal::diagonal({cov * 0.88289843, cov * 2.7477378});
  out.data.sensors = modal::at_masses({1, 2, 3});
  out.data.shapes.resize(2, 3);
  out.data.shapes << -0.3781281, -0.71911183, -0.96369155, -1.0, -0.7201735, 0.26340767;
  out.data.shape_covariances.assign(2, shape_sd * shape_sd * MatrixXd::Identity(3, 3));
  out.data.predict = 2;
  out.data.held_out_hz = {4.2997645, 5.5294743};
  return out;
}

TEST(UpdatingMeasured, FourStoreysPredictTheHeldOutModesOrAreFlagged) {
  SKIP_WITHOUT_DATA();
  for (const double cov : {0.01, 0.002}) {
    const UpdateFindings found = updated(four_storeys(cov, 0.02));
    report(found);
    ASSERT_EQ(found.predictions.size(), 2u);
    const bool inside = !found.predictions[0].misses() && !found.predictions[1].misses();
    EXPECT_TRUE(inside || !found.fit.ok()) << "a wrong band must be flagged";
    EXPECT_TRUE(found.sampling.verdict.converged);
  }
}

/// A shear chain with nominal proportions, whose stiffness and mass are scaled by thirds.
UpdateCase eighteen_storeys() {
  const std::vector<double> stiffness = {1155, 1092, 1073, 1028, 1028, 990, 963, 938, 876,
                                         840,  824,  788,  712,  660,  619, 562, 491, 363};
  fem::LumpedChain chain;
  for (int i = 0; i < 18; ++i) {
    chain.masses.push_back((i < 11 ? 208e3 : i < 17 ? 206e3 : 202e3) / 9.8);
    chain.links.push_back({.name = "storey " + std::to_string(i + 1),
                           .between = {i, i + 1},
                           .stiffness = 1e5 * stiffness[static_cast<std::size_t>(i)]});
  }
  auto model = std::make_shared<StructureModel>();
  model->nominal = chain;
  for (int part = 0; part < 3; ++part) {
    model->parameters.push_back(
        {"storeys " + std::to_string(6 * part + 1), inference::LogNormal{0.0, 0.4}});
    model->setters.emplace_back([chain, part](AnyStructure& s, double x) {
      for (int i = 6 * part; i < 6 * part + 6; ++i) {
        const auto at = static_cast<std::size_t>(i);
        std::get<fem::LumpedChain>(s).links[at].stiffness = x * chain.links[at].stiffness;
      }
    });
  }
  UpdateCase out{.title = "eighteen storeys", .structure = model};
  out.data.sensors = modal::at_masses({3, 6, 9, 12, 15, 18});
  out.data.frequencies_hz = {0.86517642, 2.6868326, 4.849104};
  out.data.shapes.resize(3, 6);
  out.data.shapes << 0.19734211, 0.39201274, 0.57866593, 0.75191915, 0.90246834, 1.0, -0.6084212,
      -0.89503499, -0.7511404, -0.22071769, 0.50537524, 1.0, 0.90395832, 0.62024159, -0.46043073,
      -0.96783845, -0.04978843, 1.0;
  return out;
}

void keep_modes(ModalData& data, int modes, double cov, double shape_sd) {
  data.frequencies_hz.resize(static_cast<std::size_t>(modes));
  std::vector<double> sds;
  for (const double f : data.frequencies_hz) sds.push_back(cov * f);
  data.covariance = modal::diagonal(sds);
  data.shapes = data.shapes.topRows(modes).eval();
  data.shape_covariances.assign(static_cast<std::size_t>(modes),
                                shape_sd * shape_sd * MatrixXd::Identity(6, 6));
}

TEST(UpdatingMeasured, AShearChainOfEighteenStoreysIsFlagged) {
  SKIP_WITHOUT_DATA();
  UpdateCase two = eighteen_storeys();
  keep_modes(two.data, 2, 0.005, 0.03);
  two.data.predict = 1;
  two.data.held_out_hz = {4.849104};
  const UpdateFindings held_out = updated(two);
  report(held_out);
  EXPECT_LT(held_out.predictions[0].frequency_hz.q50, 4.4) << "a shear chain is too soft";
  EXPECT_FALSE(held_out.fit.ok());
  UpdateCase three = eighteen_storeys();
  keep_modes(three.data, 3, 0.005, 0.03);
  const UpdateFindings all = updated(three);
  report(all);
  EXPECT_FALSE(all.fit.ok()) << "it cannot fit all three";
}

TEST(UpdatingMeasured, AnInferredDiscrepancyWidensTheBandOfEighteenStoreys) {
  SKIP_WITHOUT_DATA();
  UpdateCase update_case = eighteen_storeys();
  keep_modes(update_case.data, 2, 0.005, 0.03);
  update_case.data.predict = 1;
  update_case.data.held_out_hz = {4.849104};
  update_case.data.discrepancy.prior = inference::LogUniform{1e-3, 0.5};
  update_case.data.shape_discrepancy.prior = inference::LogUniform{1e-3, 0.5};
  const UpdateFindings found = updated(update_case);
  report(found);
  const PredictedMode& p = found.predictions[0];
  EXPECT_TRUE(!p.misses() || p.useless() || !found.fit.ok());
}

// ---- the pedestrian bridge --------------------------------------------------------------------

std::shared_ptr<const StructureModel> bridge() {
  const auto path = kData / "pedestrian_bridge_matrices.mat";
  fem::MatrixStructure s;
  s.mass = io::read_sparse_matrix(path, "M0");
  auto model = std::make_shared<StructureModel>();
  const auto add = [&](const std::string& name, double lower, double upper) {
    const std::size_t index = s.parts.size();
    s.parts.push_back({.name = name, .stiffness = io::read_sparse_matrix(path, name)});
    const inference::Prior prior = inference::Uniform{lower, upper};
    s.parts.back().change = prior.from_standard_normal(0.0);
    model->parameters.push_back({name, prior});
    model->setters.emplace_back([index](AnyStructure& any, double x) {
      std::get<fem::MatrixStructure>(any).parts[index].change = x;
    });
  };
  add("K_Frame", -0.1, 0.1);
  add("K_Truss", -0.1, 0.1);
  for (int i = 1; i <= 11; ++i) add("K_Conc" + std::to_string(i), -0.2, 0.4);
  for (const char* spring : {"K_y1", "K_z1", "K_y2", "K_z2"}) add(spring, -0.999, 10.0);
  model->nominal = std::move(s);
  return model;
}

/// A thousandth of the bridge's smallest scatter.
constexpr double kTolerance = 9e-6;

/// 100 points, or the number in WHEELTAP_RANDOM_POINTS (2000: some minutes).
int random_points() {
  const char* text = std::getenv("WHEELTAP_RANDOM_POINTS");
  return text != nullptr ? std::atoi(text) : 100;
}

TEST(UpdatingMeasured, TheBridgesModesAreWithinTheirBounds) {
  SKIP_WITHOUT_DATA();
  const auto model = bridge();
  auto training = prior_draws(*model, 200);
  const auto structure =
      std::make_shared<const fem::ParametricStructure>(family_of(model), training);
  EXPECT_EQ(structure->form(), fem::ParametricStructure::Form::affine);
  std::vector<fem::SparseRow> motions;
  for (int i = 0; i < structure->nominal().size(); i += 20)
    motions.push_back({.dofs = {i}, .coefficients = {1.0}});
  const auto began = std::chrono::steady_clock::now();
  const fem::ParametricModes reduced(
      structure, training,
      {.modes = 5, .motions = motions, .tolerance = kTolerance, .shape_tolerance = 1e-2});
  const std::chrono::duration<double> trained = std::chrono::steady_clock::now() - began;
  const auto& t = reduced.training();
  auto workspace = reduced.make_workspace();
  fem::ParametricModes::Modes found;
  double error = 0.0, bound = 0.0, shape = 0.0, full_seconds = 0.0, seconds = 0.0;
  int uncertified = 0;
  // Points outside the training set.
  const auto points = prior_draws(*model, 200 + random_points());
  for (std::size_t i = 200; i < points.size(); ++i) {
    const auto start = std::chrono::steady_clock::now();
    reduced.solve(points[i], workspace, found);
    const auto middle = std::chrono::steady_clock::now();
    const auto full = fem::structure_modes(structure->assemble(points[i]), 5);
    full_seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - middle).count();
    seconds += std::chrono::duration<double>(middle - start).count();
    uncertified += !full.certified;
    for (Index m = 0; m < 5; ++m) {
      const double e = std::abs(found.eigenvalues[m] / full.eigenvalues[m] - 1.0);
      EXPECT_LE(e, found.bounds[m] + 1e-9);
      error = std::max(error, e);
      bound = std::max(bound, found.bounds[m]);
      Eigen::VectorXd truth(static_cast<Index>(motions.size()));
      for (Index s = 0; s < truth.size(); ++s)
        truth[s] = motions[static_cast<std::size_t>(s)].of(full.shapes.col(m));
      const Eigen::VectorXd ours = found.shapes.col(m);
      shape =
          std::max(shape, std::min((ours - truth).norm(), (ours + truth).norm()) / truth.norm());
    }
  }
  const double n = random_points();
  std::printf(
      "  basis %d of %d degrees of freedom from %d solves in %.1f s; %d points: largest error %.1e "
      "(bound %.1e), of shapes %.1e; %.3f ms a point (full %.1f ms), %ld in full\n",
      t.basis, static_cast<int>(structure->nominal().size()), t.solved, trained.count(),
      random_points(), error, bound, shape, 1e3 * seconds / n, 1e3 * full_seconds / n,
      workspace.solved_in_full());
  EXPECT_EQ(t.miscounted, 0);
  EXPECT_EQ(uncertified, 0);
  EXPECT_LE(bound, kTolerance);
  // The training ends when its 200 points are within the tolerance; some new points are not and
  // need a full solution each. For one in 25, 8 or more of 100 have a probability of .05.
  EXPECT_LE(workspace.solved_in_full(), 2.0 / 25 * random_points());
  // The nominal model of the source.
  reduced.solve(std::vector<double>(17, 0.0), workspace, found);
  const std::vector<double> nominal = {4.6596, 4.8750, 6.6540, 9.9009, 11.3806};
  for (Index m = 0; m < 5; ++m)
    EXPECT_NEAR(std::sqrt(found.eigenvalues[m]) / (2.0 * std::numbers::pi),
                nominal[static_cast<std::size_t>(m)], 6e-5);
}

}  // namespace
}  // namespace wheeltap::identification

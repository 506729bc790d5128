#include "identification/structural/likelihood/stiffness_errors.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/likelihood/states_likelihood.hpp"
#include "tests/identification/modal_cases.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Modes = fem::ParametricModes::Modes;

double log_normal(const VectorXd& r, const MatrixXd& c) {
  const Eigen::LLT<MatrixXd> llt(c);
  return -0.5 * llt.matrixL().solve(r).squaredNorm() -
         MatrixXd(llt.matrixL()).diagonal().array().log().sum() -
         0.5 * static_cast<double>(r.size()) * std::log(kTwoPi);
}

TEST(StiffnessErrors, IntegratedIsTheJointNormalDensity) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto matrix = [&](Index rows, Index columns) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  const MatrixXd x = matrix(9, 4);
  const VectorXd r = matrix(9, 1);
  StiffnessErrors errors(4);
  errors.add(x.topRows(5), r.head(5));
  errors.add(x.bottomRows(4), r.tail(4));
  const double sigma = 0.3;
  const MatrixXd c = MatrixXd::Identity(9, 9) + sigma * sigma * x * x.transpose();
  const auto gain = errors.integrated(sigma);
  EXPECT_NEAR(gain.log_density, log_normal(r, c) - log_normal(r, MatrixXd::Identity(9, 9)), 1e-12);
  EXPECT_NEAR(gain.chi_square, r.squaredNorm() - r.dot(c.inverse() * r), 1e-12);
}

// A sampler may propose any value: an overflowing error is impossible, not an exception.
TEST(StiffnessErrors, AnOverflowingErrorIsImpossible) {
  StiffnessErrors errors(2);
  errors.add(MatrixXd::Constant(3, 2, 1.0), VectorXd::Constant(3, 1.0));
  for (const double sigma : {1e155, 1e300})
    EXPECT_EQ(errors.integrated(sigma).log_density, -std::numeric_limits<double>::infinity());
}

// Quarters of members and the spring at the foot hold all of the energy.
TEST(StiffnessPieces, HoldTheEnergyForAnyMesh) {
  std::vector<double> coarse;
  for (const int elements : {8, 16}) {
    const fem::Mesh mesh(modal::portal(elements));
    const fem::Discretisation& d = mesh.discretisation();
    const StiffnessPieces pieces(d, &mesh);
    ASSERT_EQ(pieces.count(), 13);
    const auto modes = fem::structure_modes(d, 4);
    const auto energies = pieces.energies(d, modes.shapes);
    MatrixXd sum = MatrixXd::Zero(4, 4);
    for (const MatrixXd& energy : energies) sum += energy;
    EXPECT_LT((sum - MatrixXd(modes.eigenvalues.asDiagonal())).norm(), 1e-8 * modes.eigenvalues[3]);
    for (std::size_t p = 0; p < energies.size(); ++p) {
      const double share = energies[p](1, 1) / modes.eigenvalues[1];
      if (elements == 8)
        coarse.push_back(share);
      else
        EXPECT_NEAR(share, coarse[p], 1e-3) << p;
    }
  }
}

// Regression: with ten elements, the quarters of a member had 2, 3, 2 and 3 elements, so that
// mirror images had different likelihoods.
TEST(StiffnessPieces, AreQuartersForAnyMesh) {
  for (const int elements : {6, 10, 17}) {
    const fem::Mesh mesh(modal::portal(elements));
    const fem::Discretisation& d = mesh.discretisation();
    const auto modes = fem::structure_modes(d, 1);
    const auto energies = StiffnessPieces(d, &mesh).energies(d, modes.shapes);
    const fem::Mesh fine(modal::portal(4 * elements));
    const StiffnessPieces of_fine(fine.discretisation(), &fine);
    const auto fine_modes = fem::structure_modes(fine.discretisation(), 1);
    const auto expected = of_fine.energies(fine.discretisation(), fine_modes.shapes);
    for (std::size_t p = 0; p < energies.size(); ++p)
      EXPECT_NEAR(energies[p](0, 0) / modes.eigenvalues[0],
                  expected[p](0, 0) / fine_modes.eigenvalues[0], 0.03)
          << elements << " elements, part " << p;
  }
}

// A loss with error u leaves q + u q (1 - q) of a strain instead of q.
TEST(StiffnessPieces, LossesAreTheEffectOfTheirErrors) {
  const fem::Mesh mesh(modal::portal(8));
  const fem::Discretisation& d = mesh.discretisation();
  const StiffnessPieces pieces(d, &mesh);
  const auto modes = fem::structure_modes(d, 3);
  const int strain = mesh.elements()[5].strains[static_cast<int>(fem::ElementStrain::bending_z)];
  ASSERT_GE(strain, 0);
  const double q = 0.6, u = 1e-5;
  const auto left = [&](double remaining) {
    return fem::StructureChange{
        .softenings = {{.direction = {{strain, 1.0}}, .remaining = remaining}}};
  };
  const auto energies = [&](double remaining) {
    return pieces.energies(fem::changed(d, left(remaining)), modes.shapes);
  };
  const auto losses = pieces.losses(d, left(q), modes.shapes);
  const auto before = energies(q), after = energies(q + u * q * (1.0 - q));
  for (std::size_t p = 0; p < losses.size(); ++p)
    EXPECT_LT(((after[p] - before[p]) / u - losses[p]).norm(), 1e-6 * modes.eigenvalues[2]) << p;
  EXPECT_GT(losses[2].norm(), 1e-3 * modes.eigenvalues[0]);  // loss of the sixth of eight elements
}

// Healthy and damaged states with shapes at all floors, of a chain slightly different from the
// model `kModel`.
const std::vector<double> kModel = {1000.0, 1100.0, 900.0};

ObservedStates two_states(double sigma) {
  ObservedStates out{.model = modal::three_storeys(), .unknown = {0, 1, 2}};
  for (const bool damaged : {false, true}) {
    const fem::LumpedChain chain{
        .masses = {1.0, 1.2, 0.8},
        .links = {
            {"1", {0, 1}, 1004.0}, {"2", {1, 2}, damaged ? 980.0 : 1094.0}, {"3", {2, 3}, 903.0}}};
    const auto modes = fem::structure_modes(fem::discretise(chain), 3);
    ModalData data{.frequencies_hz = {modes.frequencies_hz.begin(), modes.frequencies_hz.end()}};
    std::vector<double> sd;
    for (const double f : data.frequencies_hz) sd.push_back(0.002 * f);
    data.covariance = modal::diagonal(sd);
    data.sensors = modal::at_masses({1, 2, 3});
    data.shapes = modes.shapes.transpose();
    for (Index m = 0; m < 3; ++m) data.shapes.row(m) /= data.shapes.row(m).cwiseAbs().maxCoeff();
    data.shapes(0, 0) += 0.002;
    data.shapes(2, 1) -= 0.003;
    data.shape_covariances.assign(3, modal::diagonal({0.01, 0.01, 0.01}));
    data.discrepancy.value = 0.001;
    data.stiffness_discrepancy.value = sigma;
    out.list.push_back(
        {.name = damaged ? "damaged" : "healthy", .data = std::move(data), .damaged = damaged});
  }
  return out;
}

// The density with errors of links integrated out, compared with quadrature over structures with
// these errors; they agree to second order.
TEST(StatesLikelihood, IntegratesStiffnessErrorsOut) {
  const double sigma = 0.004;
  const std::vector<double>& x = kModel;
  const std::vector<PlacedDefect> soft = {{.kind = 0, .location = 1.5, .severity = 0.1}};
  const auto with = std::make_shared<ObservedStates>(two_states(sigma));
  const auto without = std::make_shared<ObservedStates>(two_states(0.0));
  const StatesLikelihood likelihood(with, {modal::soft_storey()}),
      exact(without, {modal::soft_storey()});
  std::vector<Modes> modes;
  auto workspace = likelihood.make_workspace();
  ASSERT_TRUE(likelihood.solve(x, soft, workspace, modes));
  const ModalNoise noise{.discrepancy = 0.001, .stiffness_discrepancy = sigma};
  const double integrated = likelihood.score(modes, noise).log_likelihood;
  // Five-point Gauss-Hermite rule: exact to the ninth degree.
  const std::array<double, 5> at = {-2.85697001387280, -1.35562617997427, 0.0, 1.35562617997427,
                                    2.85697001387280};
  const std::array<double, 5> weight = {0.0112574113277207, 0.222075922005613, 0.533333333333333,
                                        0.222075922005613, 0.0112574113277207};
  auto other = exact.make_workspace();
  double sum = 0.0, nominal = 0.0;
  for (std::size_t n = 0; n < 625; ++n) {
    const std::array<std::size_t, 4> i = {n % 5, n / 5 % 5, n / 25 % 5, n / 125};
    std::vector<double> wrong = x;
    for (std::size_t p = 0; p < 3; ++p) wrong[p] *= 1.0 + sigma * at[i[p]];
    // The error of the remaining stiffness is the product of the lost and the remaining share.
    std::vector<PlacedDefect> lost = soft;
    lost[0].severity -= sigma * at[i[3]] * lost[0].severity * (1.0 - lost[0].severity);
    ASSERT_TRUE(exact.solve(wrong, lost, other, modes));
    const double ln = exact.score(modes, {.discrepancy = 0.001}).log_likelihood;
    double w = 1.0;
    for (const std::size_t k : i) w *= weight[k];
    sum += w * std::exp(ln - integrated);
    if (n == 312) nominal = ln;
  }
  EXPECT_NEAR(std::log(sum), 0.0, 0.02);
  EXPECT_GT(std::abs(nominal - integrated), 0.2);  // otherwise the test has no power
}

// ln p of a mode given the others: that of all minus that of the others.
TEST(StatesLikelihood, AModeGivenTheOthersWithStiffnessErrors) {
  const double sigma = 0.05;
  const std::vector<double>& x = kModel;
  const std::vector<PlacedDefect> soft = {{.kind = 0, .location = 1.5, .severity = 0.3}};
  const auto all = std::make_shared<ObservedStates>(two_states(sigma));
  const auto fewer = std::make_shared<ObservedStates>(two_states(sigma));
  ModalData& damaged = fewer->list[1].data;
  damaged.frequencies_hz[1] = std::numeric_limits<double>::quiet_NaN();
  damaged.shapes.row(1).setConstant(std::numeric_limits<double>::quiet_NaN());
  const ModalNoise noise{.discrepancy = 0.001, .stiffness_discrepancy = sigma};
  const auto scored = [&](const std::shared_ptr<ObservedStates>& states, Eigen::VectorXd* single) {
    const StatesLikelihood likelihood(states, {modal::soft_storey()});
    auto workspace = likelihood.make_workspace();
    std::vector<Modes> modes;
    EXPECT_TRUE(likelihood.solve(x, soft, workspace, modes));
    const auto score = likelihood.score(modes, noise);
    if (single) *single = likelihood.single_mode_densities(modes, noise, score);
    return score.log_likelihood;
  };
  VectorXd single;
  const double whole = scored(all, &single);
  ASSERT_EQ(single.size(), 6);
  EXPECT_NEAR(single[4], whole - scored(fewer, nullptr), 1e-9);
}

}  // namespace
}  // namespace wheeltap::identification

#include "identification/structural/likelihood/states_likelihood.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/defects/floor_mass.hpp"
#include "identification/structural/defects/reduction.hpp"
#include "identification/structural/defects/support.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "tests/identification/cases.hpp"
#include "tests/identification/modal_cases.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Modes = fem::ParametricModes::Modes;

ModalData frequencies_of_states(std::vector<double> f, double cov) {
  ModalData out{.frequencies_hz = std::move(f)};
  std::vector<double> sd;
  for (const double x : out.frequencies_hz) sd.push_back(cov * (std::isnan(x) ? 0.0 : x));
  out.covariance = modal::diagonal(sd);
  return out;
}

ObservedStates healthy_and_damaged() {
  ObservedStates out{.model = modal::three_storeys(), .unknown = {0, 1, 2}};
  out.list.push_back({.name = "healthy", .data = frequencies_of_states({2.2, 6.3, 8.6}, 0.01)});
  out.list.push_back(
      {.name = "damaged", .data = frequencies_of_states({2.0, 6.2, 8.5}, 0.01), .damaged = true});
  return out;
}

/// Frequencies [Hz] of the chain by the full solution.
std::vector<double> full(fem::LumpedChain chain) {
  const auto found =
      fem::structure_modes(fem::discretise(chain), static_cast<int>(chain.masses.size()));
  return {found.frequencies_hz.begin(), found.frequencies_hz.end()};
}

fem::LumpedChain chain_of(double k1, double k2, double k3, std::vector<double> masses) {
  return {.masses = std::move(masses),
          .links = {{"1", {0, 1}, k1}, {"2", {1, 2}, k2}, {"3", {2, 3}, k3}}};
}

double log_normal_of(const std::vector<double>& observed, const std::vector<double>& computed,
                     double cov) {
  double sum = 0.0;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    const double sd = cov * observed[i], r = (observed[i] - computed[i]) / sd;
    sum -= 0.5 * r * r + std::log(sd * std::sqrt(kTwoPi));
  }
  return sum;
}

TEST(StatesLikelihood, IsTheSumOfItsStates) {
  auto states = std::make_shared<ObservedStates>(healthy_and_damaged());
  const StatesLikelihood likelihood(states, {modal::soft_storey()});
  const std::vector<double> x = {900.0, 1100.0, 1050.0};
  std::vector<Modes> modes;
  StatesLikelihood::Workspace workspace = likelihood.make_workspace();
  ASSERT_TRUE(
      likelihood.solve(x, {{.kind = 0, .location = 1.5, .severity = 0.3}}, workspace, modes));
  const auto score = likelihood.score(modes, {});
  const std::vector<double> masses = {1.0, 1.2, 0.8};
  const double expected =
      log_normal_of({2.2, 6.3, 8.6}, full(chain_of(900.0, 1100.0, 1050.0, masses)), 0.01) +
      log_normal_of({2.0, 6.2, 8.5}, full(chain_of(900.0, 770.0, 1050.0, masses)), 0.01);
  EXPECT_NEAR(score.log_likelihood, expected, 1e-8 * std::abs(expected));
  EXPECT_EQ(score.freedoms, 6);
  EXPECT_EQ(likelihood.place(4).state, 1);
  EXPECT_EQ(likelihood.place(4).mode, 1);
}

// A workspace caches the last solution; results equal those of a new workspace to the bit.
TEST(StatesLikelihood, AUsedWorkspaceChangesNothing) {
  auto states = std::make_shared<ObservedStates>(healthy_and_damaged());
  const StatesLikelihood likelihood(states, {modal::soft_storey()});
  const std::vector<PlacedDefect> none, soft = {{.kind = 0, .location = 1.5, .severity = 0.3}},
                                        softer = {{.kind = 0, .location = 0.5, .severity = 0.6}};
  const std::vector<double> a = {900.0, 1100.0, 1050.0}, b = {905.0, 1100.0, 1050.0},
                            impossible = {-900.0, 1100.0, 1050.0};
  StatesLikelihood::Workspace used = likelihood.make_workspace();
  const std::pair<const std::vector<double>*, const std::vector<PlacedDefect>*> path[] = {
      {&a, &soft}, {&a, &none},   {&a, &softer},          {&b, &none}, {&b, &soft},
      {&a, &soft}, {&a, &softer}, {&impossible, &softer}, {&a, &soft}, {&a, &none}};
  for (const auto& [x, defects] : path) {
    std::vector<Modes> modes, expected;
    StatesLikelihood::Workspace fresh = likelihood.make_workspace();
    const bool possible = likelihood.solve(*x, *defects, fresh, expected);
    EXPECT_EQ(possible, x != &impossible);
    ASSERT_EQ(likelihood.solve(*x, *defects, used, modes), possible);
    for (std::size_t i = 0; possible && i < 2; ++i)
      EXPECT_EQ(modes[i].eigenvalues, expected[i].eigenvalues);
  }
}

// Masses and temperature of a state affect only that state.
TEST(StatesLikelihood, MassesAndTemperatures) {
  auto states = std::make_shared<ObservedStates>(healthy_and_damaged());
  states->list[1].damaged = false;
  states->list[1].masses = {{.motion = {.dofs = {2}, .coefficients = {1.0}}, .mass = 0.5}};
  states->list[1].temperature = 12.0;
  states->per_kelvin = inference::Normal{-3e-4, 2e-4};
  const StatesLikelihood likelihood(states, {});
  const std::vector<double> x = {900.0, 1100.0, 1050.0, -1e-3};
  std::vector<Modes> modes;
  StatesLikelihood::Workspace workspace = likelihood.make_workspace();
  ASSERT_TRUE(likelihood.solve(x, {}, workspace, modes));
  const auto plain = full(chain_of(900.0, 1100.0, 1050.0, {1.0, 1.2, 0.8}));
  const auto heavy = full(chain_of(900.0, 1100.0, 1050.0, {1.0, 1.2, 1.3}));
  for (Index i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_NEAR(std::sqrt(modes[0].eigenvalues[i]) / kTwoPi, plain[at], 1e-9 * plain[at]);
    EXPECT_NEAR(std::sqrt(modes[1].eigenvalues[i]) / kTwoPi, heavy[at] * std::sqrt(1.0 - 0.012),
                1e-9 * heavy[at]);
  }
}

// Coefficients specified by the states are not unknowns.
TEST(StatesLikelihood, KnownCoefficients) {
  auto states = std::make_shared<ObservedStates>(healthy_and_damaged());
  states->unknown = {0, 2};
  states->known = {1};
  states->list[0].known = {1200.0};
  states->list[1].known = {600.0};
  EXPECT_EQ(states->parameters().size(), 2U);
  const StatesLikelihood likelihood(states, {modal::soft_storey()});
  std::vector<Modes> modes;
  StatesLikelihood::Workspace workspace = likelihood.make_workspace();
  ASSERT_TRUE(likelihood.solve(std::vector<double>{900.0, 1050.0}, {}, workspace, modes));
  const auto second = full(chain_of(900.0, 600.0, 1050.0, {1.0, 1.2, 0.8}));
  EXPECT_NEAR(std::sqrt(modes[1].eigenvalues[0]) / kTwoPi, second[0], 1e-9);
}

// A model error that is a factor per mode is the same in all states: with a large discrepancy only
// ratios have an effect.
TEST(StatesLikelihood, ADiscrepancyIsCommonToAllStates) {
  const auto f = full(chain_of(1000.0, 1000.0, 1000.0, {1.0, 1.2, 0.8}));
  const auto at = [&](double factor, double only_damaged, double discrepancy) {
    auto states = std::make_shared<ObservedStates>(healthy_and_damaged());
    states->list[0].data = frequencies_of_states({f[0] * factor, f[1], f[2]}, 0.001);
    states->list[1].data = frequencies_of_states({f[0] * factor * only_damaged, f[1], f[2]}, 0.001);
    const StatesLikelihood likelihood(states, {modal::soft_storey()});
    std::vector<Modes> modes;
    StatesLikelihood::Workspace workspace = likelihood.make_workspace();
    EXPECT_TRUE(
        likelihood.solve(std::vector<double>{1000.0, 1000.0, 1000.0}, {}, workspace, modes));
    return likelihood.score(modes, {.discrepancy = discrepancy}).chi_square;
  };
  EXPECT_GT(at(1.05, 1.0, 0.0), 1000.0);
  EXPECT_NEAR(at(1.05, 1.0, 1.0), at(1.0, 1.0, 1.0), 0.1);
  EXPECT_GT(at(1.0, 0.99, 1.0), at(1.0, 1.0, 1.0) + 30.0) << "a change is not a model error";
}

// The joint density from the explicit covariance.
TEST(StatesLikelihood, TheCommonDiscrepancyHasItsNormaliser) {
  auto states = std::make_shared<ObservedStates>(healthy_and_damaged());
  const StatesLikelihood likelihood(states, {modal::soft_storey()});
  std::vector<Modes> modes;
  StatesLikelihood::Workspace workspace = likelihood.make_workspace();
  ASSERT_TRUE(likelihood.solve(std::vector<double>{1000.0, 1100.0, 900.0}, {}, workspace, modes));
  const double delta = 0.02;
  const auto score = likelihood.score(modes, {.discrepancy = delta});
  Eigen::VectorXd f(6), r(6);
  f << 2.2, 6.3, 8.6, 2.0, 6.2, 8.5;
  MatrixXd c = MatrixXd::Zero(6, 6);
  for (Index i = 0; i < 6; ++i) {
    r[i] = f[i] - score.matches[static_cast<std::size_t>(i)].frequency_hz;
    for (Index j = 0; j < 6; ++j)
      if (i % 3 == j % 3) c(i, j) = delta * delta * f[i] * f[j];
    c(i, i) += 1e-4 * f[i] * f[i];
  }
  const double expected =
      -0.5 * r.dot(c.inverse() * r) - 0.5 * std::log(c.determinant()) - 3.0 * std::log(kTwoPi);
  EXPECT_NEAR(score.log_likelihood, expected, 1e-8 * std::abs(expected));
}

// The joint density from the explicit covariance.
TEST(StatesLikelihood, MixedModesChangeTheEffectOfDamage) {
  auto states = std::make_shared<ObservedStates>(healthy_and_damaged());
  states->list.push_back(
      {.name = "worse", .data = frequencies_of_states({1.9, 6.1, 8.3}, 0.01), .damaged = true});
  const StatesLikelihood likelihood(states, {modal::soft_storey()});
  std::vector<Modes> modes;
  StatesLikelihood::Workspace workspace = likelihood.make_workspace();
  ASSERT_TRUE(likelihood.solve(std::vector<double>{1000.0, 1100.0, 900.0},
                               {{.kind = 0, .location = 1.5, .severity = 0.3}}, workspace, modes));
  const auto before = full(chain_of(1000.0, 1100.0, 900.0, {1.0, 1.2, 0.8}));
  const auto after = full(chain_of(1000.0, 770.0, 900.0, {1.0, 1.2, 0.8}));
  const auto lambda = [](double f) { return kTwoPi * kTwoPi * f * f; };
  const double delta = 0.02, kappa = 0.7;
  const auto score = likelihood.score(modes, {.discrepancy = delta, .mixing = kappa});
  Eigen::VectorXd f(9), r(9);
  f << 2.2, 6.3, 8.6, 2.0, 6.2, 8.5, 1.9, 6.1, 8.3;
  MatrixXd c = MatrixXd::Zero(9, 9);
  for (Index i = 0; i < 9; ++i) {
    const auto mode = static_cast<std::size_t>(i % 3);
    r[i] = f[i] - (i < 3 ? before[mode] : after[mode]);
    for (Index j = 0; j < 9; ++j)
      if (i % 3 == j % 3) c(i, j) = delta * delta * f[i] * f[j];
    c(i, i) += 1e-4 * f[i] * f[i];
  }
  for (const auto& [j, k] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
    const auto a = static_cast<std::size_t>(j), b = static_cast<std::size_t>(k);
    const double first = lambda(before[a]), second = lambda(before[b]);
    const double tau = 2.0 * kappa * delta * std::sqrt(first * second) / (second - first);
    const double cross = std::sqrt((first - lambda(after[a])) * (second - lambda(after[b])));
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(9);
    for (const Index state : {1, 2}) {
      moved[3 * state + j] = 2.0 * tau * cross / (2.0 * kTwoPi * kTwoPi * after[a]);
      moved[3 * state + k] = -2.0 * tau * cross / (2.0 * kTwoPi * kTwoPi * after[b]);
    }
    c += moved * moved.transpose();
  }
  const double expected =
      -0.5 * r.dot(c.inverse() * r) - 0.5 * std::log(c.determinant()) - 4.5 * std::log(kTwoPi);
  EXPECT_NEAR(score.log_likelihood, expected, 1e-8 * std::abs(expected));
}

// For chains with stiffnesses drawn about the model's, the mixing of shapes and the effect of a
// soft storey scatter as stated, within the validity of first order and of a random matrix.
TEST(StatesLikelihood, MixingIsTheEffectOfARandomStiffnessError) {
  const std::vector<double> masses = {1.0, 1.2, 0.8};
  const MatrixXd mass = modal::diagonal({1.0, std::sqrt(1.2), std::sqrt(0.8)});
  const auto stiffness = [&](double k1, double k2, double k3) {
    return MatrixXd(fem::discretise(chain_of(k1, k2, k3, masses)).stiffness);
  };
  const MatrixXd sound = stiffness(1000.0, 1100.0, 900.0), soft = stiffness(1000.0, 1045.0, 900.0);
  const auto solve = [&](const MatrixXd& k) {
    return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(k, mass);
  };
  const auto model = solve(sound), damaged = solve(soft);
  const MatrixXd phi = model.eigenvectors();
  const Eigen::VectorXd lambda = model.eigenvalues();
  const ModalNoise noise{.discrepancy = 0.01, .mixing = std::sqrt(0.5)};
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  MatrixXd mixed = MatrixXd::Zero(3, 3), changed = MatrixXd::Zero(3, 3);
  constexpr int kDraws = 4000;
  for (int draw = 0; draw < kDraws; ++draw) {
    MatrixXd g(3, 3);  // 2δ on the diagonal, κ times that off the diagonal
    for (Index i = 0; i < 3; ++i)
      for (Index j = 0; j <= i; ++j)
        g(i, j) = g(j, i) = 2.0 * noise.discrepancy * (i == j ? 1.0 : noise.mixing) *
                            std::sqrt(lambda[i] * lambda[j]) * normal(random);
    const MatrixXd error = mass * phi * g * phi.transpose() * mass;
    const auto true_sound = solve(sound + error), true_soft = solve(soft + error);
    const MatrixXd shares = phi.transpose() * mass * true_sound.eigenvectors();
    Eigen::VectorXd off(3);
    for (Index j = 0; j < 3; ++j) {
      for (Index k = 0; k < 3; ++k)
        mixed(j, k) += std::pow(shares(k, j) / shares(j, j), 2) / kDraws;
      off[j] = (true_soft.eigenvalues()[j] - true_sound.eigenvalues()[j]) -
               (damaged.eigenvalues()[j] - lambda[j]);
    }
    changed += off * off.transpose() / kDraws;
  }
  MatrixXd expected = MatrixXd::Zero(3, 3);
  for (Index j = 0; j < 3; ++j)
    for (Index k = 0; k < 3; ++k) {
      if (k == j) continue;
      const double tau = mixing_sd(noise, lambda[j], lambda[k]);
      // 5 % for the scatter of 4000 draws, and for second order.
      EXPECT_NEAR(std::sqrt(mixed(j, k)), tau, 0.07 * tau) << j << k;
      const double cross = 4.0 * tau * tau * (lambda[j] - damaged.eigenvalues()[j]) *
                           (lambda[k] - damaged.eigenvalues()[k]);
      expected(j, j) += cross;
      expected(j, k) -= cross;
    }
  EXPECT_LT((changed - expected).norm(), 0.12 * expected.norm()) << changed << "\n" << expected;
}

// If an inaccurate model finds damage, the findings report the trusted assumption.
TEST(StatesLikelihood, ReportsChangesTakenForExact) {
  const std::vector<double> masses = {1.0, 1.2, 0.8};
  for (const double mixing : {0.0, 0.7}) {
    auto states = std::make_shared<ObservedStates>(healthy_and_damaged());
    states->list[0].data =
        frequencies_of_states(full(chain_of(1020.0, 1000.0, 990.0, masses)), 0.002);
    states->list[1].data =
        frequencies_of_states(full(chain_of(1020.0, 600.0, 990.0, masses)), 0.002);
    for (ObservedState& s : states->list) {
      s.data.discrepancy.value = 0.01;
      s.data.mixing.value = mixing;
    }
    DamageCase damage_case;
    damage_case.structure = states->model;
    damage_case.measured = MeasuredModes(states, states->joined());
    damage_case.kinds = {modal::soft_storey()};
    damage_case.data.frequencies_hz = damage_case.modal()->frequencies_hz;
    for (Index i = 0; i < 6; ++i)
      damage_case.data.sd_hz.push_back(std::sqrt(damage_case.modal()->covariance(i, i)));
    const auto problem = make_damage_problem(damage_case, {});
    const auto posterior = inference::reversible_jump(
        problem->problem, {.chains = 2, .warmup = 500, .draws = 500, .searches = 16});
    const DamageFindings found = damage_findings(*problem, posterior, {}, 1);
    EXPECT_EQ(std::ranges::any_of(found.remarks,
                                  [](const Remark& r) {
                                    return std::holds_alternative<remark::ChangesTakenForExact>(r);
                                  }),
              mixing == 0.0);
  }
}

// Regression: a change of temperature counted as damage that mixes modes.
TEST(StatesLikelihood, ATemperatureMixesNoModes) {
  const auto states = std::make_shared<ObservedStates>(healthy_and_damaged());
  const StatesLikelihood likelihood(states, {modal::soft_storey()});
  std::vector<Modes> modes;
  StatesLikelihood::Workspace workspace = likelihood.make_workspace();
  ASSERT_TRUE(likelihood.solve(std::vector{1000.0, 1000.0, 1000.0}, {}, workspace, modes));
  modes[1].eigenvalues *= 1.02;
  const auto covariance = [&](double mixing) {
    const ModalNoise noise{.discrepancy = 0.01, .mixing = mixing};
    std::vector<int> with;
    return likelihood.frequency_covariance(modes, noise, likelihood.score(modes, noise), with);
  };
  EXPECT_NE(covariance(0.7), covariance(0.0)) << "a damage that lowers all eigenvalues alike";
  modes[1].stiffer = 1.02;
  EXPECT_LT((covariance(0.7) - covariance(0.0)).norm(), 1e-12 * covariance(0.0).norm());
}

// States with other specified coefficients have independent model errors.
TEST(StatesLikelihood, StatesWithOtherCoefficientsHaveIndependentErrors) {
  auto states = std::make_shared<ObservedStates>(healthy_and_damaged());
  states->unknown = {0, 2};
  states->known = {1};
  states->list[0].known = {1000.0};
  states->list[1].known = {1001.0};
  const StatesLikelihood likelihood(states, {modal::soft_storey()});
  std::vector<Modes> modes;
  StatesLikelihood::Workspace workspace = likelihood.make_workspace();
  ASSERT_TRUE(likelihood.solve(std::vector<double>{1000.0, 900.0}, {}, workspace, modes));
  const ModalNoise noise{.discrepancy = 0.02};
  const double apart = likelihood.of(0).score(modes[0], noise).log_likelihood +
                       likelihood.of(1).score(modes[1], noise).log_likelihood;
  EXPECT_NEAR(likelihood.score(modes, noise).log_likelihood, apart, 1e-9 * std::abs(apart));
}

// A frame too large for dense solutions, with E and a spring unknown, and a crack: compared with
// full solutions.
TEST(StatesLikelihood, ModesOfAFrameAgreeWithFullSolutions) {
  const fem::Structure s = modal::portal(10);
  auto model = std::make_shared<StructureModel>();
  model->nominal = s;
  model->parameters = {{"E", inference::LogNormal{std::log(210e9), 0.1}},
                       {"foot", inference::LogNormal{std::log(1e6), 1.0}}};
  model->setters = {[](AnyStructure& any, double x) {
                      for (auto& m : std::get<fem::Structure>(any).members)
                        m.pieces[0].material.young = x;
                    },
                    [](AnyStructure& any, double x) {
                      std::get<fem::Structure>(any).supports[1].stiffness[5] = x;
                    }};
  const fem::Mesh mesh(s);
  SiteLine line = SiteLine::of_members(mesh, {0, 1, 2});
  DefectKind kind{.type = &defects::kReduction,
                  .name = "damage",
                  .plural = "damages",
                  .max_count = 1,
                  .location = inference::Uniform{0.0, line.length()},
                  .severity = inference::Prior(inference::Uniform{0.0, 0.9})};
  kind.line = std::move(line);
  auto states = std::make_shared<ObservedStates>();
  states->model = model;
  states->unknown = {0, 1};
  states->list.push_back(
      {.name = "healthy", .data = frequencies_of_states({5.0, 20.0, 30.0, 40.0}, 0.01)});
  states->list.push_back({.name = "damaged",
                          .data = frequencies_of_states({5.0, 20.0, 30.0, 40.0}, 0.01),
                          .damaged = true});
  const StatesLikelihood likelihood(states, {kind});
  EXPECT_TRUE(likelihood.by_reanalysis());
  const auto check = likelihood.check(40);
  EXPECT_EQ(check.points, 40);
  EXPECT_EQ(check.missed, 0);
  EXPECT_LT(check.largest_error, 1e-9);
  std::printf("  %.1e, %.3f ms a likelihood\n", check.largest_error,
              1e3 * check.seconds_a_solution);
}

// The modulus and density of a beam, with damages and supports whose stiffness they do not scale:
// compared with full solutions, as a beam and as a structure.
TEST(StatesLikelihood, MaterialOfABeamAgreesWithFullSolutions) {
  DamageCase damage_case = small_beam(2);
  damage_case.kinds.push_back({.type = &defects::kSupport,
                               .name = "support",
                               .plural = "supports",
                               .max_count = 1,
                               .location = inference::Uniform{0.0, 1.0},
                               .severity = inference::Prior(inference::LogNormal{7.0, 2.0})});
  complete(damage_case);
  auto model = std::make_shared<StructureModel>();
  model->nominal = fem::as_structure(damage_case.beam);
  model->parameters = {{"E", inference::LogNormal{std::log(70e9), 0.1}},
                       {"density", inference::Uniform{2500.0, 2900.0}}};
  const auto of_material = [](double fem::Material::*member) {
    return [member](AnyStructure& any, double x) {
      for (auto& m : std::get<fem::Structure>(any).members)
        for (auto& piece : m.pieces) piece.material.*member = x;
    };
  };
  model->setters = {of_material(&fem::Material::young), of_material(&fem::Material::density)};
  auto states = std::make_shared<ObservedStates>();
  states->model = model;
  states->unknown = {0, 1};
  const std::vector<double>& f = damage_case.data.frequencies_hz;
  states->list.push_back({.name = "healthy", .data = frequencies_of_states(f, 0.01)});
  states->list.push_back(
      {.name = "damaged", .data = frequencies_of_states(f, 0.01), .damaged = true});
  for (const fem::Beam* beam :
       {damage_case.intact_beam(), static_cast<const fem::Beam*>(nullptr)}) {
    const StatesLikelihood likelihood(states, damage_case.kinds, beam);
    EXPECT_TRUE(likelihood.by_reanalysis());
    const auto check = likelihood.check(40);
    EXPECT_EQ(check.points, 40);
    EXPECT_EQ(check.missed, 0);
    EXPECT_LT(check.largest_error, 1e-9);
    std::printf("  %.1e, %.4f ms a likelihood\n", check.largest_error,
                1e3 * check.seconds_a_solution);
  }
}

TEST(StatesLikelihood, RejectsMoreModesThanThereAre) {
  auto states = std::make_shared<ObservedStates>(healthy_and_damaged());
  states->list[0].data = frequencies_of_states({1.0, 2.0, 3.0, 4.0}, 0.01);
  EXPECT_THROW(StatesLikelihood(states, {modal::soft_storey()}), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::identification

#include "fem/beam/reanalysis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "../emulator/allocation_count.hpp"
#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "beams.hpp"
#include "fem/beam/assembly.hpp"
#include "fem/beam/modal_analysis.hpp"
#include "refusal.hpp"

namespace wheeltap::fem {
namespace {

constexpr int kModes = 20;

/// WHEELTAP_LONG_TESTS=1 uses all random sets; otherwise a share of them.
int sets(int full, int quick) {
  const char* chosen = std::getenv("WHEELTAP_LONG_TESTS");
  return chosen != nullptr && std::string_view(chosen) == "1" ? full : quick;
}

std::vector<Beam> beams() {
  std::vector<Beam> all;
  for (const auto name : kNamedSupports) all.push_back(slender_beam(name));
  Beam springs = slender_beam("free-free");
  springs.supports = {{.at = 0.1, .stiffness = 2e4},
                      {.at = 0.633, .stiffness = {}},
                      {.at = 1.0, .deflection = false, .rotation = true, .stiffness = 50.0}};
  all.push_back(springs);
  Beam off_node = slender_beam("cantilever");
  off_node.supports.push_back({.at = 0.7123, .stiffness = {}});
  all.push_back(off_node);
  Beam thick = thick_beam("simply-supported", 0.2, 100);
  all.push_back(thick);
  return all;
}

enum class Kind { kDamages, kSupports, kBoth };

/// Random defects with many difficult cases: mirror places, one element twice, mid-span and third
/// points (nodes of modes), almost no remaining stiffness, tiny reductions.
Defects draw(std::mt19937_64& generator, int most, Kind kind) {
  std::uniform_real_distribution<double> uniform;
  const auto chance = [&](double p) { return uniform(generator) < p; };
  Defects defects;
  const int count = 1 + static_cast<int>(uniform(generator) * most);
  for (int i = 0; i < count; ++i) {
    double at = uniform(generator);
    if (chance(0.1)) at = std::vector{0.0, 0.25, 1.0 / 3.0, 0.5, 1.0}[generator() % 5];
    if (!defects.damages.empty() && chance(0.15)) at = 1.0 - defects.damages.front().location;
    if (!defects.damages.empty() && chance(0.1)) at = defects.damages.back().location;
    if (kind == Kind::kDamages || (kind == Kind::kBoth && chance(0.6))) {
      double reduction = 0.95 * uniform(generator);
      if (chance(0.1)) reduction = 0.95;
      if (chance(0.1)) reduction = std::pow(10.0, -12.0 * uniform(generator));
      if (chance(0.03)) reduction = 0.0;
      defects.damages.push_back({at, reduction});
    } else {
      SpringSupport support{.location = at, .rotation = chance(0.3)};
      if (chance(0.5)) support.stiffness = std::pow(10.0, 1.0 + 7.0 * uniform(generator));
      defects.supports.push_back(support);
    }
  }
  return defects;
}

std::string describe_beam(const Defects& defects) {
  std::ostringstream out;
  out.precision(17);
  for (const Damage& d : defects.damages)
    out << " damage(" << d.location << ", " << d.reduction << ")";
  for (const SpringSupport& s : defects.supports)
    out << " support(" << s.location << ", " << s.stiffness << (s.rotation ? ", θ)" : ", w)");
  return out.str();
}

std::vector<double> reanalysed_beam(const Reanalysis& reanalysis, Reanalysis::Workspace& workspace,
                                    const Defects& defects, int modes = kModes) {
  std::vector<double> f(static_cast<std::size_t>(modes));
  reanalysis.frequencies_hz(defects.damages, defects.supports, workspace, f);
  return f;
}

/// Solves M φ = μ (K - σ M) φ densely by the reduction to a standard problem in the given
/// precision.
template <class Real>
std::vector<double> dense_frequencies(const Beam& beam, const Defects& defects, Real sigma) {
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  const Assembly<Real> a = assemble<Real>(beam, defects);
  const Matrix m(a.mass), k = Matrix(a.stiffness) - sigma * m;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(m, k, Eigen::EigenvaluesOnly);
  std::vector<double> f;
  for (Eigen::Index i = 0; i < kModes; ++i) {
    const Real lambda = 1 / solver.eigenvalues()[m.rows() - 1 - i] + sigma;
    f.push_back(static_cast<double>(std::sqrt(std::max(lambda, Real{0})) / Real{kTwoPi}));
  }
  return f;
}

/// Rigid-body modes are exactly zero; the rounding of the eigensolver there is no reference.
double largest_error(const std::vector<double>& f, const std::vector<double>& reference,
                     const Defects& defects, const Beam& beam) {
  const auto rigid = static_cast<std::size_t>(rigid_body_freedom(beam, defects.supports));
  double worst = 0.0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (i < rigid)
      EXPECT_EQ(f[i], 0.0);
    else if (const double error = std::abs(f[i] / reference[i] - 1.0); !(error <= worst))
      worst = error;
  }
  return worst;
}

class Reanalyses : public testing::TestWithParam<std::tuple<Kind, int>> {};

TEST_P(Reanalyses, EqualTheFullEigensolution) {
  const auto [kind, most] = GetParam();
  std::mt19937_64 generator(static_cast<unsigned>(most) * 10 + static_cast<unsigned>(kind));
  const std::vector<Beam> all = beams();
  const int each =
      sets(most == 4 ? 2000 : 10000, most == 4 ? 72 : 144) / (3 * static_cast<int>(all.size()));
  double worst = 0.0;
  for (const Beam& beam : all) {
    const Reanalysis reanalysis(beam, kModes);
    Reanalysis::Workspace workspace = reanalysis.make_workspace();
    for (int i = 0; i <= each; ++i) {
      const Defects defects = draw(generator, most, kind);
      const Modes full = modal_analysis(beam, defects, {.modes = kModes, .dense = most == 4});
      ASSERT_TRUE(full.certified);
      const std::vector<double> expected(full.frequencies_hz.begin(), full.frequencies_hz.end());
      const double error =
          largest_error(reanalysed_beam(reanalysis, workspace, defects), expected, defects, beam);
      ASSERT_LT(error, 2e-7) << describe_beam(defects);
      worst = std::max(worst, error);
    }
  }
  RecordProperty("largest_relative_error", std::to_string(worst * 1e12) + "e-12");
  std::printf("%zu sets, largest relative error %.2e\n",
              all.size() * (static_cast<std::size_t>(each) + 1), worst);
}

INSTANTIATE_TEST_SUITE_P(Sets, Reanalyses,
                         testing::Combine(testing::Values(Kind::kDamages, Kind::kSupports,
                                                          Kind::kBoth),
                                          testing::Values(4, 6)));

TEST(Reanalysis, EqualsTheLongDoubleEigensolution) {
  std::mt19937_64 generator(11);
  const std::vector<Beam> all = beams();
  const int each = sets(300, 16) / static_cast<int>(all.size());
  double worst = 0.0, worst_double = 0.0;
  for (const Beam& beam : all) {
    const Reanalysis reanalysis(beam, kModes);
    Reanalysis::Workspace workspace = reanalysis.make_workspace();
    for (int i = 0; i <= each; ++i) {
      const Defects defects = draw(generator, 4, static_cast<Kind>(i % 3));
      const std::vector<double> expected = dense_frequencies<long double>(beam, defects, -1e2L);
      const std::vector<double> f = reanalysed_beam(reanalysis, workspace, defects);
      const double error = largest_error(f, expected, defects, beam);
      ASSERT_LT(error, 5e-8) << describe_beam(defects);
      worst = std::max(worst, error);
      worst_double =
          std::max(worst_double,
                   largest_error(f, dense_frequencies<double>(beam, defects, -1e2), defects, beam));
    }
  }
  EXPECT_LT(worst_double, 2e-7);
  std::printf("%zu sets, largest relative error %.2e; a plain double eigensolve is off by %.2e\n",
              all.size() * (static_cast<std::size_t>(each) + 1), worst, worst_double);
}

TEST(Reanalysis, FindsBothOfEqualFrequencies) {
  // A clamp in the middle of a clamped beam makes two equal halves.
  const Beam beam = slender_beam("clamped-clamped");
  const Reanalysis reanalysis(beam, kModes);
  Reanalysis::Workspace workspace = reanalysis.make_workspace();
  Defects defects{.damages = {},
                  .supports = {{.location = 0.5}, {.location = 0.5, .rotation = true}}};
  for (const double reduction : {0.0, 1e-9, 1e-6, 1e-3}) {
    if (reduction > 0.0)
      defects.damages = {{0.2, reduction}};  // the frequencies of the halves differ slightly
    const std::vector<double> f = reanalysed_beam(reanalysis, workspace, defects);
    const Modes full = modal_analysis(beam, defects, {.modes = kModes});
    for (std::size_t i = 0; i < f.size(); ++i)
      EXPECT_NEAR(f[i] / full.frequencies_hz[static_cast<Eigen::Index>(i)], 1.0, 1e-11)
          << reduction << " mode " << i;
    for (std::size_t i = 0; i < f.size(); i += 2)
      EXPECT_NEAR(f[i + 1] / f[i], 1.0, reduction + 1e-11);
  }
}

TEST(Reanalysis, WithoutDefectsEqualsTheIntactModes) {
  const Reanalysis reanalysis(slender_beam(), kModes);
  Reanalysis::Workspace workspace = reanalysis.make_workspace();
  const auto intact = reanalysis.intact_frequencies_hz();
  const std::vector<double> expected(intact.begin(), intact.end());
  EXPECT_EQ(reanalysed_beam(reanalysis, workspace, {}), expected);
  EXPECT_EQ(reanalysed_beam(reanalysis, workspace, {.damages = {{0.3, 0.0}}, .supports = {}}),
            expected);
  // A rigid support at a place that is already held.
  const std::vector<double> f =
      reanalysed_beam(reanalysis, workspace, {.damages = {}, .supports = {{.location = 1.0}}});
  for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(f[i] / expected[i], 1.0, 1e-14);
}

TEST(Reanalysis, ResultIsIndependentOfOrderAndEarlierCalls) {
  const Reanalysis reanalysis(slender_beam("clamped-pinned"), kModes);
  Reanalysis::Workspace used = reanalysis.make_workspace();
  std::mt19937_64 generator(5);
  for (int i = 0; i < 50; ++i) {
    Defects defects = draw(generator, 6, Kind::kDamages);
    Reanalysis::Workspace fresh = reanalysis.make_workspace();
    const std::vector<double> f = reanalysed_beam(reanalysis, fresh, defects);
    EXPECT_EQ(reanalysed_beam(reanalysis, used, defects), f);
    // Fewer modes of the same problem: bitwise equal, for any content of the other lanes.
    const std::vector<double> few = reanalysed_beam(reanalysis, used, defects, 7);
    EXPECT_TRUE(std::equal(few.begin(), few.end(), f.begin()));
  }
}

TEST(Reanalysis, DoesNotAllocateAfterTheWorkspaceHasGrown) {
  const Reanalysis reanalysis(slender_beam("cantilever"), kModes);
  Reanalysis::Workspace workspace = reanalysis.make_workspace();
  const Defects large{.damages = {{0.1, 0.5}, {0.4, 0.2}, {0.8, 0.9}},
                      .supports = {{.location = 0.6}, {.location = 0.9, .stiffness = 1e3}}};
  const Defects small{.damages = {{0.3, 0.5}}, .supports = {{.location = 0.7}}};
  std::vector<double> f(kModes);
  reanalysis.frequencies_hz(large.damages, large.supports, workspace, f);
  const long before = test::allocations();
  for (const Defects* d : {&small, &large})
    reanalysis.frequencies_hz(d->damages, d->supports, workspace, f);
  EXPECT_EQ(test::allocations(), before);
}

TEST(Reanalysis, MirrorImagesHaveEqualFrequencies) {
  const Reanalysis reanalysis(slender_beam(), kModes);
  Reanalysis::Workspace workspace = reanalysis.make_workspace();
  const auto a = reanalysed_beam(reanalysis, workspace,
                                 {.damages = {{0.123, 0.5}, {0.77, 0.3}}, .supports = {}});
  const auto b = reanalysed_beam(reanalysis, workspace,
                                 {.damages = {{0.877, 0.5}, {0.23 - 1e-6, 0.3}}, .supports = {}});
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i] / b[i], 1.0, 1e-12);
}

TEST(Reanalysis, SupportsCloseToEachOtherActAsAClamp) {
  // Two rigid rollers at a distance h hold the slope as h -> 0; their rows are nearly equal.
  const Beam beam = slender_beam("cantilever");
  const Reanalysis reanalysis(beam, 10);
  Reanalysis::Workspace workspace = reanalysis.make_workspace();
  for (const double gap : {1e-2, 1e-4, 1e-6}) {
    const Defects defects{.damages = {},
                          .supports = {{.location = 0.6123}, {.location = 0.6123 + gap}}};
    const std::vector<double> f = reanalysed_beam(reanalysis, workspace, defects, 10);
    const Modes full = modal_analysis(beam, defects, {.modes = 10});
    for (std::size_t i = 0; i < f.size(); ++i)
      EXPECT_NEAR(f[i] / full.frequencies_hz[static_cast<Eigen::Index>(i)], 1.0, 1e-8) << gap;
  }
}

TEST(Reanalysis, FindsAllModesOfSmallBeams) {
  for (const int elements : {1, 2, 3, 7}) {
    const Beam beam = slender_beam("clamped-pinned", elements);
    const int all = 2 * elements - 1;
    const Reanalysis reanalysis(beam, all);
    Reanalysis::Workspace workspace = reanalysis.make_workspace();
    const Defects defects{.damages = {{0.1, 0.6}, {0.9, 0.3}},
                          .supports = {{.location = 0.55, .stiffness = 1e5}}};
    const std::vector<double> f = reanalysed_beam(reanalysis, workspace, defects, all);
    const Modes full = modal_analysis(beam, defects, {.modes = all});
    for (std::size_t i = 0; i < f.size(); ++i)
      EXPECT_NEAR(f[i] / full.frequencies_hz[static_cast<Eigen::Index>(i)], 1.0, 1e-10) << elements;
  }
}

TEST(Reanalysis, SolvesForManySupports) {
  const Beam beam = slender_beam("cantilever");
  const Reanalysis reanalysis(beam, kModes);
  Reanalysis::Workspace workspace = reanalysis.make_workspace();
  Defects defects;
  for (int i = 1; i <= 12; ++i) defects.supports.push_back({.location = 0.0777 * i});
  const std::vector<double> f = reanalysed_beam(reanalysis, workspace, defects);
  const Modes full = modal_analysis(beam, defects, {.modes = kModes});
  for (std::size_t i = 0; i < f.size(); ++i)
    EXPECT_NEAR(f[i] / full.frequencies_hz[static_cast<Eigen::Index>(i)], 1.0, 1e-9) << i;
}

/// All outputs of `solve` for one set of defects.
struct Solution {
  std::vector<double> f, by_damage, by_element, shapes;
};

Solution solve(const Reanalysis& reanalysis, const Defects& defects, int modes,
               const std::vector<Reanalysis::Point>& points) {
  const auto n = static_cast<std::size_t>(modes);
  Solution s{
      .f = std::vector<double>(n),
      .by_damage = std::vector<double>(n * defects.damages.size()),
      .by_element = std::vector<double>(n * static_cast<std::size_t>(reanalysis.beam().elements)),
      .shapes = std::vector<double>(n * points.size())};
  Reanalysis::Workspace workspace = reanalysis.make_workspace();
  reanalysis.solve(defects.damages, defects.supports, workspace,
                   {.frequencies_hz = s.f,
                    .damage_gradients_hz = s.by_damage,
                    .element_gradients_hz = s.by_element,
                    .shapes = s.shapes,
                    .points = points});
  return s;
}

TEST(Reanalysis, GradientsEqualFiniteDifferences) {
  std::mt19937_64 generator(17);
  double worst = 0.0;
  for (const Beam& beam : beams()) {
    const Reanalysis reanalysis(beam, kModes);
    Reanalysis::Workspace workspace = reanalysis.make_workspace();
    for (int i = 0; i < sets(60, 6); ++i) {
      Defects defects = draw(generator, 4, i % 2 == 0 ? Kind::kDamages : Kind::kBoth);
      if (defects.damages.empty()) defects.damages.push_back({0.3, 0.2});
      for (Damage& d : defects.damages) d.reduction = std::clamp(d.reduction, 0.02, 0.9);
      const Solution s = solve(reanalysis, defects, kModes, {});
      EXPECT_EQ(s.f.size(), kModes);
      const auto compare = [&](const Defects& base, std::size_t d,
                               const std::vector<double>& gradient, std::size_t stride,
                               std::size_t column, bool one_sided) {
        // Richardson on differences: error O(h⁴), rounding 1e-13 / h.
        const double h = 1e-3 * (1.0 - base.damages[d].reduction);
        const auto at = [&](double r) {
          Defects moved = base;
          moved.damages[d].reduction = r;
          return reanalysed_beam(reanalysis, workspace, moved);
        };
        const double r = base.damages[d].reduction;
        std::vector<std::vector<double>> f;
        for (int k = one_sided ? 0 : -2; k <= (one_sided ? 4 : 2); ++k) f.push_back(at(r + k * h));
        const auto rigid = static_cast<std::size_t>(rigid_body_freedom(beam, base.supports));
        for (std::size_t mode = rigid; mode < kModes; ++mode) {
          const auto v = [&](std::size_t k) { return f[k][mode]; };
          const double expected =
              one_sided ? (-25 * v(0) + 48 * v(1) - 36 * v(2) + 16 * v(3) - 3 * v(4)) / (12 * h)
                        : (8 * (v(3) - v(1)) - (v(4) - v(0))) / (12 * h);
          const double error = std::abs(gradient[mode * stride + column] - expected) /
                               (s.f[mode] + std::abs(expected));
          EXPECT_LT(error, 1e-6) << describe_beam(base) << " mode " << mode;
          worst = std::max(worst, error);
        }
      };
      for (std::size_t d = 0; d < defects.damages.size(); ++d)
        compare(defects, d, s.by_damage, defects.damages.size(), d, false);
      for (const std::size_t element : {std::size_t{3}, std::size_t{50}, generator() % 100}) {
        Defects more = defects;
        more.damages.push_back({beam.element_midpoint(static_cast<int>(element)), 0.0});
        compare(more, more.damages.size() - 1, s.by_element, 100, element, true);
      }
    }
  }
  std::printf("largest error of a gradient, relative to the frequency: %.2e\n", worst);
}

TEST(Reanalysis, StiffnessGradientsEqualFiniteDifferences) {
  std::mt19937_64 generator(19);
  double worst = 0.0;
  for (const Beam& beam : beams()) {
    const Reanalysis reanalysis(beam, kModes);
    Reanalysis::Workspace workspace = reanalysis.make_workspace();
    for (int i = 0; i < sets(60, 6); ++i) {
      Defects defects = draw(generator, 4, i % 2 == 0 ? Kind::kSupports : Kind::kBoth);
      defects.supports.push_back({.location = 0.37, .stiffness = 1e4, .rotation = i % 3 == 0});
      const std::size_t count = defects.supports.size();
      std::vector<double> f(kModes), gradients(kModes * count);
      reanalysis.solve(defects.damages, defects.supports, workspace,
                       {.frequencies_hz = f,
                        .damage_gradients_hz = {},
                        .element_gradients_hz = {},
                        .shapes = {},
                        .points = {},
                        .support_gradients_hz = gradients});
      EXPECT_EQ(f, reanalysed_beam(reanalysis, workspace, defects));
      const auto rigid = static_cast<std::size_t>(rigid_body_freedom(beam, defects.supports));
      for (std::size_t s = 0; s < count; ++s) {
        const double k = defects.supports[s].stiffness;
        if (std::isinf(k)) {
          for (std::size_t mode = 0; mode < kModes; ++mode)
            EXPECT_EQ(gradients[mode * count + s], 0.0);
          continue;
        }
        std::vector<std::vector<double>> at;  // f(k (1 + j h)), j = -2 … 2, without 0
        const double h = 1e-2;
        for (const double j : {-2.0, -1.0, 1.0, 2.0}) {
          Defects moved = defects;
          moved.supports[s].stiffness = k * (1.0 + j * h);
          at.push_back(reanalysed_beam(reanalysis, workspace, moved));
        }
        for (std::size_t mode = rigid; mode < kModes; ++mode) {
          // ∂f/∂ln k, by Richardson extrapolation of differences.
          const double expected =
              (8 * (at[2][mode] - at[1][mode]) - (at[3][mode] - at[0][mode])) / (12 * h);
          const double error =
              std::abs(k * gradients[mode * count + s] - expected) / (f[mode] + std::abs(expected));
          EXPECT_LT(error, 1e-6) << describe_beam(defects) << " mode " << mode;
          worst = std::max(worst, error);
        }
      }
    }
  }
  std::printf("largest error of a gradient, relative to the frequency: %.2e\n", worst);
}

TEST(Reanalysis, LocationSlopesEqualDifferencesOfFullSolutions) {
  const Beam beam = slender_beam("clamped-pinned", 20);
  const Reanalysis reanalysis(beam, 6);
  Reanalysis::Workspace workspace = reanalysis.make_workspace();
  const Defects defects{.damages = {{0.01, 0.3}, {0.43, 0.5}, {1.0, 0.2}},
                        .supports = {{.location = 0.61, .stiffness = 1e4}, {.location = 0.83}}};
  std::vector<double> by_damage(6 * 3), by_support(6 * 2);
  reanalysis.location_slopes(defects.damages, defects.supports, workspace,
                             {.modes = 6, .damages_hz_m = by_damage, .supports_hz_m = by_support});
  const auto full = [&](const Defects& d) { return modal_analysis(beam, d, {.modes = 6}); };
  const std::vector<std::pair<double, double>> neighbours = {
      {0.025, 0.075}, {0.375, 0.475}, {0.925, 0.975}};
  for (std::size_t d = 0; d < 3; ++d) {
    Defects low = defects, high = defects;
    low.damages[d].location = neighbours[d].first;
    high.damages[d].location = neighbours[d].second;
    const Eigen::VectorXd expected = (full(high).frequencies_hz - full(low).frequencies_hz) /
                                     (neighbours[d].second - neighbours[d].first);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(by_damage[3 * i + d], expected[static_cast<Eigen::Index>(i)],
                  1e-5 * expected.cwiseAbs().maxCoeff());
  }
  for (std::size_t s = 0; s < 2; ++s) {
    constexpr double kStep = 2e-3;  // Richardson extrapolation of differences of the full solution
    std::vector<Eigen::VectorXd> f;
    for (const double j : {-2.0, -1.0, 1.0, 2.0}) {
      Defects moved = defects;
      moved.supports[s].location += j * kStep;
      f.push_back(full(moved).frequencies_hz);
    }
    const Eigen::VectorXd expected = (8 * (f[2] - f[1]) - (f[3] - f[0])) / (12 * kStep);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(by_support[2 * i + s], expected[static_cast<Eigen::Index>(i)],
                  1e-4 * expected.cwiseAbs().maxCoeff());
  }
}

TEST(Reanalysis, ShapesEqualThoseOfTheFullSolution) {
  std::mt19937_64 generator(23);
  double worst = 0.0;
  for (const Beam& beam : beams()) {
    const Reanalysis reanalysis(beam, kModes);
    std::vector<Reanalysis::Point> points;
    for (int node = 0; node <= 100; node += 4) points.push_back({.at = node / 100.0});
    points.push_back({.at = 0.5, .rotation = true});
    for (int i = 0; i < sets(60, 8); ++i) {
      const Defects defects = draw(generator, i % 2 == 0 ? 3 : 6, static_cast<Kind>(i % 3));
      const Solution s = solve(reanalysis, defects, kModes, points);
      const Modes full = modal_analysis(beam, defects, {.modes = kModes});
      for (Eigen::Index mode = full.rigid_body_modes; mode < kModes; ++mode) {
        // Between close modes, a shape is determined only to rounding over the gap.
        double gap = 1.0;
        for (const Eigen::Index next : {mode - 1, mode + 1})
          if (next >= 0 && next < kModes)
            gap = std::min(gap, std::abs(full.eigenvalues[next] / full.eigenvalues[mode] - 1.0));
        Eigen::VectorXd expected(static_cast<Eigen::Index>(points.size()));
        for (std::size_t p = 0; p + 1 < points.size(); ++p)
          expected[static_cast<Eigen::Index>(p)] =
              full.shapes(8 * static_cast<Eigen::Index>(p), mode);
        expected[expected.size() - 1] = full.shapes(101, mode);
        Eigen::Map<const Eigen::VectorXd> shape(s.shapes.data() + mode * expected.size(),
                                                expected.size());
        const double error =
            std::min((shape - expected).norm(), (shape + expected).norm()) / expected.norm();
        EXPECT_LT(error * std::min(1.0, 10.0 * gap), 1e-7)
            << describe_beam(defects) << " mode " << mode;
        if (gap > 0.1) worst = std::max(worst, error);
      }
    }
  }
  std::printf("largest relative error of a shape: %.2e\n", worst);
}

// Regression: the lowest frequency is closer to both rigid motions than to the intact one. These do
// not feel the damage, but determined its shape.
TEST(Reanalysis, FindsShapesOfANearlySeveredFreeBeam) {
  const Beam beam = slender_beam("free-free");
  const Reanalysis reanalysis(beam, 6);
  std::vector<Reanalysis::Point> points;
  for (int node = 0; node <= 100; node += 4) points.push_back({.at = node / 100.0});
  for (const double reduction : {0.9, 0.99, 0.9999}) {
    const Defects defects{.damages = {{0.4, reduction}}, .supports = {}};
    const Solution s = solve(reanalysis, defects, 6, points);
    const Modes full = modal_analysis(beam, defects, {.modes = 6});
    for (Eigen::Index mode = 2; mode < 6; ++mode) {
      Eigen::VectorXd expected(static_cast<Eigen::Index>(points.size()));
      for (Eigen::Index p = 0; p < expected.size(); ++p) expected[p] = full.shapes(8 * p, mode);
      const Eigen::Map<const Eigen::VectorXd> shape(s.shapes.data() + mode * expected.size(),
                                                    expected.size());
      EXPECT_LT(std::min((shape - expected).norm(), (shape + expected).norm()),
                1e-7 * expected.norm())
          << reduction << ", mode " << mode;
    }
  }
}

TEST(Reanalysis, ShapesOfRigidBodyModesAreRigid) {
  const Beam beam = slender_beam("free-free");
  const Reanalysis reanalysis(beam, 4);
  const std::vector<Reanalysis::Point> points = {{0.0}, {0.5}, {1.0}, {0.2, true}};
  const Solution s =
      solve(reanalysis, {.damages = {{0.4, 0.5}}, .supports = {{.location = 0.25}}}, 4, points);
  EXPECT_EQ(s.f[0], 0.0);
  EXPECT_GT(s.f[1], 1.0);
  // A rotation about x = 0.25: w = θ (x - 0.25); by sign convention the far end is positive.
  const double theta = s.shapes[3];
  EXPECT_GT(theta, 0.0);
  for (std::size_t p = 0; p < 3; ++p)
    EXPECT_NEAR(s.shapes[p], theta * (points[p].at - 0.25), 1e-9 * theta);
  EXPECT_EQ(s.by_damage[0], 0.0);
}

TEST(Reanalysis, RejectsMisuse) {
  const Beam beam = slender_beam();
  expect_refusal([&] { (void)Reanalysis(beam, 203); }, {"modes = 203", "200"});
  expect_refusal([&] { (void)Reanalysis(beam, 0); }, {"modes = 0"});
  const Reanalysis reanalysis(beam, 5);
  Reanalysis::Workspace workspace = reanalysis.make_workspace();
  const auto call = [&](const Defects& defects, std::size_t modes) {
    std::vector<double> f(modes);
    reanalysis.frequencies_hz(defects.damages, defects.supports, workspace, f);
  };
  expect_refusal([&] { call({}, 6); }, {"6", "at most 5"});
  expect_refusal(
      [&] {
        call({.damages = {{1.1, 0.5}}, .supports = {}}, 5);
      },
      {"damage.location", "1.1"});
  expect_refusal(
      [&] {
        call({.damages = {{0.1, 1.0}}, .supports = {}}, 5);
      },
      {"damage.reduction", "1"});
  expect_refusal([&] { call({.damages = {}, .supports = {{.location = NAN}}}, 5); },
                 {"support.location", "nan"});
  expect_refusal(
      [&] { call({.damages = {}, .supports = {{.location = 0.5, .stiffness = -1.0}}}, 5); },
      {"support.stiffness", "-1"});
  std::vector<double> f(5), wrong(7);
  const std::vector<Damage> damages = {{0.2, 0.1}};
  expect_refusal(
      [&] {
        reanalysis.solve(damages, {}, workspace,
                         {.frequencies_hz = f,
                          .damage_gradients_hz = wrong,
                          .element_gradients_hz = {},
                          .shapes = {},
                          .points = {}});
      },
      {"damage_gradients_hz", "7", "5"});
  expect_refusal(
      [&] {
        reanalysis.location_slopes(damages, {}, workspace,
                                   {.modes = 5, .damages_hz_m = wrong, .supports_hz_m = {}});
      },
      {"damages_hz_m", "7", "5"});
}

}  // namespace
}  // namespace wheeltap::fem

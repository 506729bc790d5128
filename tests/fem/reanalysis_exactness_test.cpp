// Regression tests for errors found in use, each compared with the reference in 113 bits.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "beams.hpp"
#include "fem/beam/modal_analysis.hpp"
#include "fem/beam/reanalysis.hpp"
#include "quad_reference.hpp"

namespace wheeltap::fem {
namespace {

/// The largest error of the elastic frequencies.
double worst_error(const Beam& beam, const Defects& defects, const std::vector<double>& f,
                   int rigid = 0) {
  QuadReference reference(beam, defects);
  double worst = 0.0;
  for (int i = rigid; i < static_cast<int>(f.size()); ++i) {
    const double value = f[static_cast<std::size_t>(i)];
    worst = std::max(worst, std::isfinite(value) ? reference.error(i, value) : 1.0);
  }
  return worst;
}

std::vector<double> reanalysed(const Reanalysis& reanalysis, const Defects& defects, int modes) {
  Reanalysis::Workspace workspace = reanalysis.make_workspace();
  std::vector<double> f(static_cast<std::size_t>(modes));
  reanalysis.frequencies_hz(defects.damages, defects.supports, workspace, f);
  return f;
}

double reanalysis_error(const Beam& beam, const Defects& defects, int modes, int rigid = 0) {
  return worst_error(beam, defects, reanalysed(Reanalysis(beam, modes), defects, modes), rigid);
}

double modal_error(const Beam& beam, const Defects& defects, int modes, int rigid = 0) {
  const Modes result = modal_analysis(beam, defects, {.modes = modes});
  EXPECT_TRUE(result.certified);
  return worst_error(beam, defects, {result.frequencies_hz.begin(), result.frequencies_hz.end()},
                     rigid);
}

TEST(ReanalysisExactness, SingleRequestedFrequency) {
  // The sum held no mode above it, so its first step was always accepted: error 2.6e-2.
  for (const int elements : {10, 100})
    for (const auto supports : {"simply-supported", "cantilever", "clamped-pinned"})
      for (const double at : {0.07, 0.33, 0.51}) {
        const Defects defects{.damages = {{at, 0.999}}, .supports = {}};
        EXPECT_LT(reanalysis_error(slender_beam(supports, elements), defects, 1), 1e-11)
            << supports << ", " << elements << " elements, damaged at " << at;
      }
}

TEST(ReanalysisExactness, RootsFoundAfterABisection) {
  // The first step after a bisection was accepted by the second-order estimate alone.
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> uniform;
  const Beam beam = slender_beam("clamped-pinned", 40);
  const Reanalysis reanalysis(beam, 12);
  double worst = 0.0;
  for (int set = 0; set < 300; ++set) {
    Defects defects;
    for (int i = 0; i < 6; ++i)
      defects.damages.push_back(
          {uniform(generator), 1.0 - std::pow(10.0, -3.0 * uniform(generator))});
    worst = std::max(worst, worst_error(beam, defects, reanalysed(reanalysis, defects, 12)));
  }
  EXPECT_LT(worst, 1e-11);
}

TEST(ReanalysisExactness, ElementWithAlmostNoStiffness) {
  // 1 - (1 - Π (1 - r)) had lost its digits: errors of 6e-8 at 1e-9, factors of 10 at 1e-12.
  for (const auto supports : kNamedSupports)
    for (const int times : {2, 3, 4, 6}) {
      const Beam beam = slender_beam(supports, 20);
      Defects defects;
      for (int i = 0; i < times; ++i) defects.damages.push_back({0.33, 0.999});
      const int rigid = supports == "free-free" ? 2 : 0;
      EXPECT_LT(reanalysis_error(beam, defects, 8, rigid), 1e-11) << supports << " 1e-3^" << times;
      if (times < 5) {  // 106 bits do not certify λ_max / λ of 1e28
        EXPECT_LT(modal_error(beam, defects, 8, rigid), 1e-11) << supports << " 1e-3^" << times;
      }
    }
}

TEST(ReanalysisExactness, ThickOverhangingBeam) {
  // The static part was summed over modes whose rounding a damage divided by 1 - r: error 3e-6.
  struct {
    double height;
    int elements;
    double left, right, at;
  } const cases[] = {{0.2, 60, 0.31, 0.85, 0.05},
                     {0.5, 150, 0.1, 0.85, 0.4},
                     {1.0, 150, 0.2, 0.6, 0.4},
                     {1.0, 100, 0.31, 0.85, 0.05}};
  for (const auto& c : cases) {
    Beam beam = thick_beam("free-free", c.height, c.elements);
    beam.supports = {{.at = c.left, .stiffness = {}}, {.at = c.right, .stiffness = {}}};
    const Defects defects{.damages = {{c.at, 0.9999}}, .supports = {}};
    EXPECT_LT(reanalysis_error(beam, defects, 10), 1e-11) << c.height << " damaged at " << c.at;
  }
}

TEST(ReanalysisExactness, BeamOnElasticSupports) {
  // As above; in addition modes of soft springs had an error of λ_max / λ_j in the last bit:
  // 6.8e-6.
  Beam beam = slender_beam("free-free", 100);
  for (const double softer : {1.0, 1e-4, 1e-8}) {
    beam.supports = {{.at = 0.1, .stiffness = 2e4 * softer},
                     {.at = 0.6, .stiffness = 7e3 * softer},
                     {.at = 0.9, .rotation = true, .stiffness = 30.0 * softer}};
    for (const double reduction : {0.999, 0.99999}) {
      const Defects defects{.damages = {{0.41, reduction}, {0.77, 0.5}}, .supports = {}};
      EXPECT_LT(reanalysis_error(beam, defects, 10), 1e-11) << softer << ", r " << reduction;
    }
  }
}

TEST(ReanalysisExactness, SupportsAddedToABeamOnSoftSprings) {
  // Rounding of nearly rigid modes exceeded the beam's own compliance at the supports.
  Beam beam = slender_beam("free-free", 20);
  beam.supports = {{.at = 0.49, .stiffness = 1e-3}, {.at = 0.78, .stiffness = 1e-6}};
  const Defects defects{.damages = {{0.42, 0.999}, {0.61, 0.997}, {0.9, 0.8}},
                        .supports = {{.location = 0.86, .rotation = true},
                                     {.location = 0.52, .stiffness = 500.0},
                                     {.location = 0.68, .rotation = true}}};
  EXPECT_LT(reanalysis_error(beam, defects, 8), 1e-10);
}

TEST(ReanalysisExactness, ThreeSpringsOnOneElement) {
  // The only mode was raised above the artificial one, or its bracket was infinite.
  const Beam one = slender_beam("clamped-pinned", 1);
  for (const double k : {1e3, 1e5, 1e7}) {
    const Defects defects{.damages = {},
                          .supports = {{.location = 0.3, .stiffness = k},
                                       {.location = 0.5, .stiffness = 2.0 * k},
                                       {.location = 0.8, .stiffness = k, .rotation = true}}};
    EXPECT_LT(reanalysis_error(one, defects, 1), 1e-10) << k;
    const Beam free = slender_beam("free-free", 1);
    EXPECT_LT(reanalysis_error(free, defects, 4), 1e-10) << k;
  }
  // Rigid supports and springs that raise the last mode above all intact ones.
  const Defects mixed{.damages = {{0.2, 0.6}},
                      .supports = {{.location = 0.5}, {.location = 0.8, .stiffness = 1e4}}};
  EXPECT_LT(reanalysis_error(slender_beam("clamped-pinned", 2), mixed, 2), 1e-11);
}

TEST(ReanalysisExactness, BeamOfOneMillimetre) {
  // Spectra accepts 1 / (λ - σ) < 4e-11 as converged: modes had errors of 7.5e-3, but were
  // certified.
  for (const double length : {1e-3, 1e3})
    for (const auto supports : {"cantilever", "free-free", "clamped-clamped"}) {
      Beam beam = slender_beam(supports, length < 1.0 ? 100 : 30);
      beam.length = length;
      beam.supports = named_supports(supports, length);
      beam.section = section(Rectangle{.width = 0.025 * length, .height = 0.006 * length}, 0.3);
      const int rigid = beam.supports.empty() ? 2 : 0;
      const Defects defects{.damages = {{0.3 * length, 0.4}}, .supports = {}};
      EXPECT_LT(modal_error(beam, {}, 10, rigid), 1e-12) << length;
      EXPECT_LT(reanalysis_error(beam, defects, 12, rigid), 1e-11) << length;
    }
}

TEST(ReanalysisExactness, SmallMeshesWithAnEigenvalueAtABisectionPoint) {
  // "mode 0 did not converge": the end of the bracket was the eigenvalue.
  Beam beam = slender_beam("free-free", 1);
  beam.supports = {{.at = 0.0, .stiffness = {}},
                   {.at = 1.0, .deflection = true, .rotation = true, .stiffness = {}}};
  EXPECT_LT(reanalysis_error(beam, {}, 1), 1e-12);
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform;
  for (int i = 0; i < 200; ++i) {
    Beam other = slender_beam("free-free", 1 + i % 2);
    other.supports = {{.at = 0.0, .stiffness = {}},
                      {.at = i % 3 == 0 ? 1.0 : 0.1 + 0.9 * uniform(generator),
                       .rotation = i % 4 < 2,
                       .stiffness = {}}};
    const Defects defects{.damages = {{0.4, 0.5}}, .supports = {}};
    EXPECT_LT(reanalysis_error(other, defects, 1), 1e-11) << i;
  }
}

}  // namespace
}  // namespace wheeltap::fem

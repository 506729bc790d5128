#include "fem/beam/modal_analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <ostream>
#include <random>

#include "base/eigen_solvers.hpp"
#include "beams.hpp"
#include "fem/beam/assembly.hpp"
#include "refusal.hpp"

namespace wheeltap::fem {
namespace {

Eigen::VectorXd frequencies(const Beam& beam, int modes, const Defects& defects = {}) {
  const Modes result = modal_analysis(beam, defects, {.modes = modes});
  EXPECT_TRUE(result.certified) << result.solver;
  return result.frequencies_hz;
}

/// Exact frequencies of a simply supported Timoshenko beam: sin(n π x / L) turns the equations into
/// ρI/(κGA)·ρA p² - [ρA + n̂² (ρI + ρA EI/(κGA))] p + EI n̂⁴ = 0, n̂ = n π / L, p = ω².
double exact_simply_supported(const Beam& b, int n) {
  const double k2 = std::pow(n * std::numbers::pi / b.length, 2);
  const double ei = b.material.young * b.section.second_moment;
  const double ks = b.section.shear_coefficient * b.material.shear_modulus() * b.section.area;
  const double ra = b.material.density * b.section.area,
               ri = b.material.density * b.section.second_moment;
  const double a = ri * ra / ks, h = ra + k2 * (ri + ra * ei / ks), c = ei * k2 * k2;
  return std::sqrt(2.0 * c / (h + std::sqrt(h * h - 4.0 * a * c))) / (2.0 * std::numbers::pi);
}

TEST(ModalAnalysis, SlenderSimplySupportedBeamMatchesTheClosedForm) {
  const Beam beam = slender_beam();
  const Eigen::VectorXd f = frequencies(beam, 20);
  // The closed form, evaluated by hand.
  EXPECT_NEAR(exact_simply_supported(beam, 1), 13.852289, 5e-7);
  EXPECT_NEAR(exact_simply_supported(beam, 5), 345.809086, 5e-7);
  EXPECT_NEAR(exact_simply_supported(beam, 20), 5413.701909, 5e-7);
  EXPECT_NEAR(f[0] / exact_simply_supported(beam, 1) - 1.0, 5e-9, 5e-9);
  EXPECT_NEAR(f[9] / exact_simply_supported(beam, 10) - 1.0, 4.3e-5, 1e-6);
  EXPECT_NEAR(f[19] / exact_simply_supported(beam, 20) - 1.0, 6.6e-4, 1e-5);
}

/// Ω = ω L² √(ρA/EI), ν 0.3, κ 5/6 (roots of the frequency equations).
struct ThickCase {
  std::string_view supports;
  double height;
  double omega[4];
};

void PrintTo(const ThickCase& c, std::ostream* out) {
  *out << c.supports << ", h/L " << c.height;
}

const ThickCase kThickCases[] = {
    {"cantilever", 0.1, {3.48835495, 20.90691544, 54.98837972, 99.74715764}},
    {"simply-supported", 0.1, {9.70747723, 37.09615885, 78.15473629, 128.66600382}},
    {"clamped-clamped", 0.1, {20.97225073, 53.74676573, 97.14296399, 147.5096099}},
    {"free-free", 0.1, {21.6084854, 56.20782384, 102.52558482, 156.44094331}},
    {"cantilever", 0.2, {3.40978315, 18.36370309, 43.70908209, 72.56700926}},
    {"simply-supported", 0.2, {9.27403971, 32.16650095, 61.4580633, 93.25941831}},
    {"clamped-clamped", 0.2, {17.99468441, 41.18993024, 68.64648062, 98.0837178}},
    {"free-free", 0.2, {19.79875484, 46.27497183, 76.96318341, 108.35548071}},
};

class ThickBeams : public testing::TestWithParam<ThickCase> {
 protected:
  Eigen::Vector4d omega(int elements) const {
    const Beam beam = thick_beam(GetParam().supports, GetParam().height, elements);
    const int rigid = GetParam().supports == "free-free" ? 2 : 0;
    return frequencies(beam, 4 + rigid).tail<4>() * 2.0 * std::numbers::pi *
           std::sqrt(beam.material.density * beam.section.area /
                     (beam.material.young * beam.section.second_moment));
  }
};

TEST_P(ThickBeams, ConvergeToTheExactFrequenciesAtSecondOrder) {
  const Eigen::Vector4d exact = Eigen::Map<const Eigen::Vector4d>(GetParam().omega);
  const Eigen::Array4d coarse = omega(100) - exact, middle = omega(200) - exact,
                       fine = omega(400) - exact;
  EXPECT_LT((fine / exact.array()).abs().maxCoeff(), 3e-5);
  // The published values have eight decimals: 5e-9 of rounding.
  for (int i = 0; i < 4; ++i) {
    const double allowed = 0.01 + 3.0 * 5e-9 / std::abs(fine[i]);
    EXPECT_NEAR(std::log2(coarse[i] / middle[i]), 2.0, allowed) << "mode " << i + 1;
    EXPECT_NEAR(std::log2(middle[i] / fine[i]), 2.0, allowed) << "mode " << i + 1;
  }
  const Eigen::Array4d extrapolated = (4.0 * fine - middle) / 3.0;
  for (int i = 0; i < 4; ++i) EXPECT_LT(std::abs(extrapolated[i]), 1e-8 * exact[i] + 5e-9) << i;
}

INSTANTIATE_TEST_SUITE_P(Published, ThickBeams, testing::ValuesIn(kThickCases));

TEST(ModalAnalysis, NafemsFv5FlexuralModes) {
  // NAFEMS FV5, deep simply supported beam: 10 m × 2 m × 2 m.
  Beam beam{.length = 10.0,
            .elements = 400,
            .supports = named_supports("simply-supported", 10.0),
            .material = {.young = 200e9, .poisson = 0.3, .density = 8000.0},
            .section = section(Rectangle{.width = 2.0, .height = 2.0}, 0.3)};
  const Eigen::VectorXd f = frequencies(beam, 3);
  EXPECT_NEAR(f[0], 42.6449, 1e-4 * 42.6449);
  EXPECT_NEAR(f[1], 148.149, 1e-4 * 148.149);
  EXPECT_NEAR(f[2], 283.468, 1e-4 * 283.468);
}

TEST(ModalAnalysis, RigidBodyModesAreExactlyZero) {
  const Modes free = modal_analysis(slender_beam("free-free"), {}, {.modes = 5});
  EXPECT_EQ(free.rigid_body_modes, 2);
  EXPECT_EQ(free.frequencies_hz[0], 0.0);
  EXPECT_EQ(free.frequencies_hz[1], 0.0);
  // β L = 4.730 of the Euler-Bernoulli beam; shear lowers it a little.
  EXPECT_NEAR(free.frequencies_hz[2] / 31.4, 1.0, 1e-3);
  Beam pinned = slender_beam("free-free");
  pinned.supports = {{.at = 0.3, .stiffness = {}}};
  const Modes swinging = modal_analysis(pinned, {}, {.modes = 3});
  EXPECT_EQ(swinging.rigid_body_modes, 1);
  EXPECT_EQ(swinging.frequencies_hz[0], 0.0);
  EXPECT_GT(swinging.frequencies_hz[1], 1.0);
}

TEST(ModalAnalysis, HasSmallResidualsAndOrthonormalShapes) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform;
  for (const auto name : kNamedSupports) {
    const Beam beam = slender_beam(name);
    const Defects defects{.damages = {{uniform(generator), 0.9}, {uniform(generator), 0.5}},
                          .supports = {{.location = uniform(generator), .stiffness = 3e3}}};
    const Modes modes = modal_analysis(beam, defects, {.modes = 12});
    EXPECT_TRUE(modes.certified);
    EXPECT_EQ(modes.solver, "spectra");
    const Assembly<double> a = assemble<double>(beam, defects);
    const Eigen::MatrixXd t(a.free_to_all);
    const Eigen::MatrixXd q = t.colPivHouseholderQr().solve(modes.shapes);
    EXPECT_LT((q.transpose() * (a.mass * q) - Eigen::MatrixXd::Identity(12, 12)).norm(), 1e-9);
    for (int i = modes.rigid_body_modes; i < 12; ++i) {
      // ‖Kφ - λMφ‖ in the norm of M⁻¹ bounds the eigenvalue's error; K rounds at λ_max ε.
      const Eigen::VectorXd r = a.stiffness * q.col(i) - modes.eigenvalues[i] * (a.mass * q.col(i));
      EXPECT_LT(r.norm(), 1e-9 * (a.stiffness * q.col(i)).norm() +
                              1e-11 * a.stiffness.norm() * q.col(i).norm());
    }
    for (int i = 0; i < 12; ++i) {
      const Eigen::VectorXd w = modes.shapes.col(i)(Eigen::seq(0, Eigen::last, 2));
      EXPECT_GT(w.maxCoeff(), (1.0 - 1e-5) * w.cwiseAbs().maxCoeff());
    }
  }
}

TEST(ModalAnalysis, DenseAndSparseAgree) {
  for (const auto name : kNamedSupports) {
    const Beam beam = slender_beam(name);
    const Modes sparse = modal_analysis(beam, {}, {.modes = 25});
    const Modes dense = modal_analysis(beam, {}, {.modes = 25, .dense = true});
    EXPECT_EQ(sparse.solver, "spectra");
    EXPECT_EQ(dense.solver, "dense (requested)");
    EXPECT_TRUE(dense.certified);
    for (int i = 0; i < 25; ++i)
      EXPECT_NEAR(sparse.frequencies_hz[i], dense.frequencies_hz[i],
                  1e-12 * dense.frequencies_hz[i]);
    const Eigen::Index elastic = 25 - sparse.rigid_body_modes;
    EXPECT_LT((sparse.shapes - dense.shapes).rightCols(elastic).norm(), 1e-6 * dense.shapes.norm());
  }
}

TEST(ModalAnalysis, FindsAllModesOfTheMesh) {
  const Modes all = modal_analysis(slender_beam("simply-supported", 10), {}, {.modes = 20});
  EXPECT_TRUE(all.certified);
  EXPECT_EQ(all.solver, "dense (most modes of the mesh are requested)");
}

TEST(ModalAnalysis, StiffSpringsConvergeToRigidSupports) {
  Beam rigid = slender_beam("cantilever");
  rigid.supports.push_back({.at = 0.7234, .stiffness = {}});
  Beam spring = rigid;
  const Eigen::VectorXd limit = frequencies(rigid, 5);
  double last = 1.0;
  // First order in 1/k.
  for (const double k : {1e8, 1e9, 1e10}) {
    spring.supports.back().stiffness = k;
    const double error = (1.0 - frequencies(spring, 5).array() / limit.array()).maxCoeff();
    EXPECT_GT(error, 0.0);
    EXPECT_LT(error, 0.11 * last);
    last = error;
  }
  EXPECT_LT(last, 1e-5);
}

TEST(ModalAnalysis, SupportsBetweenNodesEqualThoseAtNodesOfAFinerMesh) {
  // 0.725 is in the middle of an element of 100, and on a node of 200.
  const double at = 0.725;
  const auto with_roller = [at](int elements) {
    Beam beam = slender_beam("cantilever", elements);
    beam.supports.push_back({.at = at, .stiffness = {}});
    return frequencies(beam, 3);
  };
  const Eigen::ArrayXd coarse = with_roller(100), fine = with_roller(200);
  // The jump of the shear force at the roller is inside an element of the coarse mesh: first order.
  EXPECT_LT((coarse / fine - 1.0).abs().maxCoeff(), 1e-4);
}

TEST(ModalAnalysis, MirrorImagesHaveEqualFrequencies) {
  const Beam beam = slender_beam("clamped-clamped");
  const Defects defects{.damages = {{0.123, 0.4}, {0.4, 0.2}}, .supports = {}};
  // 0.4 is the left end of element 40; its mirror image is the right end of element 59.
  const Defects mirrored{.damages = {{0.877, 0.4}, {0.595, 0.2}}, .supports = {}};
  const Eigen::VectorXd a = frequencies(beam, 10, defects), b = frequencies(beam, 10, mirrored);
  EXPECT_LT((a - b).cwiseQuotient(a).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ModalAnalysis, RejectsMoreModesThanDegreesOfFreedom) {
  expect_refusal(
      [] { (void)modal_analysis(slender_beam("simply-supported", 10), {}, {.modes = 21}); },
      {"modes = 21", "20"});
  expect_refusal([] { (void)modal_analysis(slender_beam(), {}, {.modes = 0}); }, {"modes = 0"});
  expect_refusal(
      [] {
        (void)modal_analysis(slender_beam(), {.damages = {{2.0, 0.1}}, .supports = {}},
                             {.modes = 1});
      },
      {"damage.location = 2"});
}

}  // namespace
}  // namespace wheeltap::fem

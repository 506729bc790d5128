#include "fem/sections/section_analysis.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

#include "base/constants.hpp"
#include "fem/sections/section.hpp"
#include "fem/sections/section_mesh.hpp"
#include "refusal.hpp"
#include "sections.hpp"

namespace wheeltap::fem {
namespace {

/// The accuracy of the default options for every property.
constexpr double kPromise = 1e-3;

SectionAnalysis analyse(const Outline& outline, double poisson = 0.3, int least_levels = 2) {
  const Outline good = checked(outline);
  return analyse_section(section_mesh(good), good.regions,
                         {.reference_poisson = poisson, .least_levels = least_levels});
}

SectionProperties properties(const Ring& outer, double poisson,
                             const std::vector<Ring>& holes = {}) {
  const SectionAnalysis a = analyse(of_one(outer, poisson, holes), poisson);
  EXPECT_TRUE(a.converged);
  return a.properties;
}

void expect_close(double value, double expected, double tolerance, const char* what) {
  EXPECT_NEAR(value / expected, 1.0, tolerance) << what << ": " << value << " for " << expected;
}

/// J of a rectangle a × b (Timoshenko & Goodier, Theory of Elasticity, article 109), a <= b.
double rectangle_torsion(double a, double b) {
  double sum = 0.0;
  for (int n = 1; n < 200; n += 2) sum += std::tanh(n * kPi * b / (2.0 * a)) / std::pow(n, 5);
  return a * a * a * b / 3.0 * (1.0 - 192.0 * a / (std::pow(kPi, 5) * b) * sum);
}

/// J of a circle and its α by energy.
double circle_flexibility(double nu) {
  return (7.0 + 14.0 * nu + 8.0 * nu * nu) / (6.0 * (1.0 + nu) * (1.0 + nu));
}

TEST(SectionAnalysis, RectangleDependsOnPoisson) {
  const Ring r = rectangle(0, 0, 2, 1);
  const double expected[][2] = {{0.0, 1.2}, {0.3, 1.27479}, {0.5, 1.35605}};
  for (const auto& [nu, alpha] : expected) {
    const SectionProperties p = properties(r, nu);
    expect_close(p.shear_flexibility.zz, alpha, 1e-5, "along the short side");
    expect_close(p.torsion_constant, rectangle_torsion(1, 2), 2e-5, "J");
    EXPECT_NEAR(p.shear_flexibility.yz, 0.0, 1e-6);
  }
  expect_close(properties(r, 0.3).shear_flexibility.yy, 1.20056, 1e-5, "along the long side");
}

TEST(SectionAnalysis, SquareAndCircle) {
  const SectionProperties square = properties(rectangle(-1, -1, 1, 1), 0.3);
  expect_close(square.shear_flexibility.yy, 1.2074, 2e-5, "square");
  expect_close(square.torsion_constant, 16 * 0.140577, 1e-5, "square J");
  for (const double nu : {0.0, 0.3, 0.5}) {
    const SectionProperties disc = properties(circle({1, 2}, 1.5), nu);
    expect_close(disc.shear_flexibility.yy, circle_flexibility(nu), 2e-5, "circle");
    expect_close(disc.shear_flexibility.zz, circle_flexibility(nu), 2e-5, "circle");
    expect_close(disc.torsion_constant, 0.5 * kPi * std::pow(1.5, 4), 1e-6, "circle J");
    expect_close(disc.area, kPi * 2.25, 1e-12, "area");
  }
  EXPECT_NEAR(circle_flexibility(0.3), 1.175542, 5e-7);
}

TEST(SectionAnalysis, EllipseAndTriangle) {
  const double a = 2.0, b = 1.0;
  Ring ellipse = circle({0, 0}, 1.0, 360);
  for (auto& p : ellipse) p.x() *= a / b;
  const SectionProperties e = properties(ellipse, 0.3);
  expect_close(e.torsion_constant, kPi * a * a * a * b * b * b / (a * a + b * b), 1e-4, "J");
  // ω = -(a² - b²)/(a² + b²) y z, so Γ = that squared times ∫ y² z² = π a³ b³ / 24.
  const double slope = (a * a - b * b) / (a * a + b * b);
  expect_close(e.warping_constant, slope * slope * kPi * std::pow(a * b, 3) / 24.0, 2e-4, "Γ");
  for (const double h : {1.0, 0.02}) {
    const double side = 2.0 * h / std::sqrt(3.0);
    const SectionProperties t = properties({{0, 0}, {side, 0}, {0.5 * side, h}}, 0.3);
    expect_close(t.torsion_constant, std::pow(h, 4) / (15.0 * std::sqrt(3.0)), 1e-5, "J");
    EXPECT_NEAR(t.shear_centre.norm(), 0.0, 1e-6 * h);
  }
}

TEST(SectionAnalysis, TubeAndBox) {
  const double ro = 1.0, ri = 0.7;
  const SectionProperties tube = properties(circle({0, 0}, ro), 0.3, {circle({0, 0}, ri)});
  expect_close(tube.torsion_constant, 0.5 * kPi * (std::pow(ro, 4) - std::pow(ri, 4)), 1e-5, "J");
  // Bredt's J = 4 A² t / s of a thin box, to the share of its thickness.
  const double t = 0.002;
  const SectionProperties box =
      properties(rectangle(0, 0, 2 + t, 1 + t), 0.3, {rectangle(t, t, 2, 1)});
  expect_close(box.torsion_constant, 4.0 * 4.0 * t / 6.0, 1e-3, "J");
}

TEST(SectionAnalysis, Channel) {
  const double nu = 1.0 / 3.0;
  const SectionProperties p = properties(channel(8, 18, 1), nu);
  expect_close(p.shear_flexibility.yy, 3.4129, 5e-5, "along the flanges");
  expect_close(p.shear_flexibility.zz, 2.1548, 5e-5, "along the web");
  expect_close(p.torsion_constant, 11.2682, 5e-5, "J");
  expect_close(p.warping_constant, 12766, 5e-5, "Γ");
  // From the centroid to the web's centreline, and beyond.
  expect_close(-(p.shear_centre.x() + p.centroid.x() - 0.5), 2.8685, 5e-5, "centre");
  EXPECT_NEAR(p.shear_centre.y(), 0.0, 1e-6);
}

TEST(SectionAnalysis, Angle) {
  const SectionProperties p = properties(angle_section(10.5, 15.5, 1), 0.0);
  expect_close(p.torsion_constant, 8.1957, 5e-5, "J");
  expect_close(p.shear_flexibility.yy, 3.0627, 5e-5, "along the short leg");
  expect_close(p.shear_flexibility.zz, 1.8993, 5e-5, "along the long leg");
}

TEST(SectionAnalysis, SlitTubeAndArc) {
  for (const double slit : {9e-5, 1e-6}) {
    const SectionProperties p = properties(slit_tube(8, 1.25, slit, 256), 0.3);
    expect_close(p.torsion_constant, 32.224, 2e-4, "J");
    expect_close(p.warping_constant, 331644, 2e-4, "Γ");
  }
  const SectionProperties p = properties(curved_strip(16, 0.5, 0.0, 2.0 * kPi / 3.0, 128), 0.3);
  expect_close(p.torsion_constant, 1.3831, 2e-4, "J");
  expect_close(p.warping_constant, 1046.49, 2e-4, "Γ");
}

/// J of two bars a × 2c and b × 2c joined along 2c, of shear moduli g and h, by cosines along z:
/// Prandtl's φ = G (c² - z² + Σ f_n(y) cos k_n z), φ and ∂φ/∂y / G continuous at y = 0.
double joined_bars(double a, double g, double b, double h, double c) {
  double integral = 4.0 * c * c * c / 3.0 * (a * g + b * h);
  for (int n = 0; n < 400; ++n) {
    const double k = (2 * n + 1) * kPi / (2.0 * c), sign = n % 2 ? -1.0 : 1.0;
    const double p = 4.0 * sign / (c * k * k * k);
    const double slope = p *
                         (h * (1.0 - 1.0 / std::cosh(k * b)) - g * (1.0 - 1.0 / std::cosh(k * a))) /
                         (g * std::tanh(k * a) + h * std::tanh(k * b));  // f'(0) / k
    const double u = -p / std::cosh(k * a) + slope * std::tanh(k * a);
    const double v = -p / std::cosh(k * b) - slope * std::tanh(k * b);
    const double left = slope - u / std::sinh(k * a) - p / std::tanh(k * a);
    const double right = -slope - v / std::sinh(k * b) - p / std::tanh(k * b);
    integral += 2.0 * sign / k * (g * left + h * right) / k;
  }
  return 2.0 * integral;
}

TEST(SectionAnalysis, StripOfTwoMaterials) {
  EXPECT_NEAR(joined_bars(1, 1, 1, 1, 0.5) / rectangle_torsion(1, 2), 1.0, 1e-9);
  for (const double modulus : {0.1, 3.0, 50.0}) {
    const Outline strip{{{.outer = rectangle(0, 0, 1, 1)},
                         {.outer = rectangle(1, 0, 3, 1), .modulus = modulus, .density = 2.0}}};
    const SectionProperties p = analyse(strip).properties;
    expect_close(p.torsion_constant, joined_bars(1, 1, 2, modulus, 0.5), 2e-4, "J");
    expect_close(p.area, 1.0 + 2.0 * modulus, 1e-12, "E-weighted area");
    expect_close(p.geometric_area, 3.0, 1e-12, "area");
    expect_close(p.mass_per_length, 5.0, 1e-12, "mass");
    expect_close(p.centroid.x(), (0.5 + 4.0 * modulus) / (1.0 + 2.0 * modulus), 1e-12, "centroid");
  }
  // The shear modulus has the region's own ν.
  Outline strip{{{.outer = rectangle(0, 0, 1, 1), .poisson = 0.0},
                 {.outer = rectangle(1, 0, 3, 1), .modulus = 2.0, .poisson = 0.5}}};
  expect_close(analyse(strip, 0.0).properties.torsion_constant,
               joined_bars(1, 1, 2, 2.0 / 1.5, 0.5), 2e-4, "J");
}

TEST(SectionAnalysis, RegionsOfOneMaterialActAsOne) {
  const SectionProperties whole = properties(rectangle(0, 0, 3, 1), 0.3);
  const Outline cut{{{.outer = rectangle(0, 0, 1, 1)}, {.outer = rectangle(1, 0, 3, 1)}}};
  const SectionProperties parts = analyse(cut).properties;
  expect_close(parts.torsion_constant, whole.torsion_constant, kPromise, "J");
  expect_close(parts.shear_flexibility.zz, whole.shear_flexibility.zz, kPromise, "α");
}

TEST(SectionAnalysis, StiffnessesAreProportionalToTheModulus) {
  const SectionProperties p = properties(channel(8, 18, 1), 0.3);
  const SectionProperties q = analyse({{{.outer = channel(8, 18, 1), .modulus = 2.5}}}).properties;
  expect_close(q.area, 2.5 * p.area, 1e-12, "A");
  expect_close(q.second_moments.yy, 2.5 * p.second_moments.yy, 1e-12, "I");
  expect_close(q.torsion_constant, 2.5 * p.torsion_constant, 1e-9, "J");
  expect_close(q.warping_constant, 2.5 * p.warping_constant, 1e-9, "Γ");
  expect_close(q.shear_flexibility.yy, p.shear_flexibility.yy, 1e-9, "α");
  expect_close(q.shear_centre.x(), p.shear_centre.x(), 1e-9, "centre");
}

TEST(SectionAnalysis, WithZeroPoissonRatioShearIsTheSumOfLayers) {
  // Jourawski's formula is exact for ν = 0 in a rectangle, at any orientation of two of them.
  const Outline layers{{{.outer = rectangle(0, 0, 1, 1), .poisson = 0.0},
                        {.outer = rectangle(0, 1, 1, 3), .modulus = 4.0, .poisson = 0.0}}};
  const SectionProperties p = analyse(layers, 0.0).properties;
  // τ b = (V / I) ∫ e z from the top; energy ∫ τ² / (2 G), in units of E_ref.
  const double zc = (0.5 + 8.0 * 2.0) / 9.0, inertia = p.second_moments.yy;
  double energy = 0.0;
  const int n = 3000;
  double flow = 0.0;
  for (int i = 0; i < n; ++i) {
    const double dz = 3.0 / n, z = (i + 0.5) * dz, e = z < 1.0 ? 1.0 : 4.0;
    const double middle = flow - 0.5 * e * (z - zc) * dz;
    flow -= e * (z - zc) * dz;
    energy += middle * middle / (inertia * inertia) / e * dz;
  }
  expect_close(p.shear_flexibility.zz, 9.0 * energy, 2e-4, "α");
}

Ring moved(const Ring& ring, double angle, double scale, const Eigen::Vector2d& by) {
  Ring result;
  const double c = std::cos(angle), s = std::sin(angle);
  for (const auto& p : ring)
    result.emplace_back(scale * Eigen::Vector2d(c * p.x() - s * p.y(), s * p.x() + c * p.y()) + by);
  return result;
}

TEST(SectionAnalysis, IsInvariantUnderTranslationAndRotation) {
  const Ring ring = {{0, 0}, {5, 0}, {5, 0.7}, {1, 0.9}, {1.3, 4}, {2, 6}, {0, 5.5}};
  const SectionProperties p = properties(ring, 0.3);
  const double angle = 0.7, k = 0.01;
  const SectionProperties q = properties(moved(ring, angle, k, {3.0, -2.0}), 0.3);
  expect_close(q.torsion_constant, std::pow(k, 4) * p.torsion_constant, kPromise, "J");
  expect_close(q.warping_constant, std::pow(k, 6) * p.warping_constant, kPromise, "Γ");
  const Eigen::Rotation2Dd turn(angle);
  EXPECT_LT((q.shear_centre - k * (turn * p.shear_centre)).norm(), k * 1e-3);
  EXPECT_LT((q.centroid - (k * (turn * p.centroid) + Eigen::Vector2d(3, -2))).norm(), 1e-12);
  // α transforms as a tensor.
  const auto tensor = [](const ShearFlexibility& a) {
    return (Eigen::Matrix2d() << a.yy, a.yz, a.yz, a.zz).finished();
  };
  const Eigen::Matrix2d r = turn.toRotationMatrix();
  const Eigen::Matrix2d expected = r * tensor(p.shear_flexibility) * r.transpose();
  EXPECT_LT((tensor(q.shear_flexibility) - expected).norm(), kPromise * expected.norm());
  const PrincipalAxes a = principal_axes(p.second_moments), b = principal_axes(q.second_moments);
  expect_close(b.largest, std::pow(k, 4) * a.largest, 1e-9, "I");
  expect_close(b.smallest, std::pow(k, 4) * a.smallest, 1e-9, "I");
  EXPECT_NEAR(std::remainder(b.angle - a.angle - angle, kPi), 0.0, 1e-9);
}

TEST(SectionAnalysis, PrincipalAxesOfATurnedRectangle) {
  for (const double angle : {0.0, 0.4, -1.2, kPi / 2}) {
    const SectionProperties p = properties(moved(rectangle(-1, -2, 1, 2), angle, 1, {5, 5}), 0.3);
    const PrincipalAxes axes = principal_axes(p.second_moments);
    expect_close(axes.largest, 2.0 * 64.0 / 12.0, 1e-12, "I");
    expect_close(axes.smallest, 4.0 * 8.0 / 12.0, 1e-12, "I");
    EXPECT_NEAR(std::remainder(axes.angle - angle, kPi), 0.0, 1e-9);
  }
}

TEST(SectionAnalysis, CentresOfSymmetryAndOfThinWalls) {
  // The shear centre of an angle with thin legs is where these meet.
  const double t = 0.02;
  const SectionProperties p = properties(angle_section(1, 1.5, t), 0.0);
  EXPECT_LT((p.centroid + p.shear_centre - Eigen::Vector2d(t / 2, t / 2)).norm(), t);
  const SectionProperties i = properties({{0, 0},
                                          {4, 0},
                                          {4, 0.3},
                                          {2.1, 0.3},
                                          {2.1, 5.7},
                                          {4, 5.7},
                                          {4, 6},
                                          {0, 6},
                                          {0, 5.7},
                                          {1.9, 5.7},
                                          {1.9, 0.3},
                                          {0, 0.3}},
                                         0.3);
  EXPECT_LT(i.shear_centre.norm(), 1e-4);
  // Thin walls: Γ = I_flange h² / 2 each.
  expect_close(i.warping_constant, 0.3 * 64.0 / 12.0 * 5.7 * 5.7 / 2.0, 0.01, "Γ");
}

TEST(SectionAnalysis, ShearCentreOfAHalfDisc) {
  // From the circle's centre 8 a (3 + 4 ν) / (15 π (1 + ν)) without rotation there, minus the
  // contribution of a torque ν V y_c / (E I) · G J without rotation at the centroid y_c (Timoshenko
  // & Goodier, article 127: 0.548 a - 0.037 a at ν = 0.3). Trefftz's centre is that of ν = 0.
  Ring half = arc({0, -1}, {0, 1}, kPi, 512);
  half.emplace_back(0, 1);
  for (const double nu : {0.0, 0.3, 0.5}) {
    const auto centre = [](double poisson) {
      const double torsion_constant = kPi / 2.0 - 4.0 / kPi, inertia = kPi / 8.0;
      return (8.0 * (3.0 + 4.0 * poisson) / (15.0 * kPi) -
              poisson * torsion_constant / (2.0 * inertia) * 4.0 / (3.0 * kPi)) /
             (1.0 + poisson);
    };
    const SectionProperties p = properties(half, nu);
    expect_close(p.centroid.x(), 4.0 / (3.0 * kPi), 1e-5, "centroid");
    expect_close(p.centroid.x() + p.shear_centre.x(), centre(nu), 1e-4, "shear centre");
    expect_close(p.centroid.x() + p.trefftz_centre.x(), centre(0.0), 1e-4, "Trefftz's");
  }
}

TEST(SectionAnalysis, ConvergesAtFullOrderDespiteCorners) {
  // With and without re-entrant corners: h⁴, because the refinement is graded.
  for (const Ring& ring : {rectangle(0, 0, 2, 1), channel(8, 18, 1)}) {
    const SectionAnalysis a = analyse(of_one(ring, 0.3), 0.3, 5);
    const auto j = [&](std::size_t i) { return a.levels[i].properties.torsion_constant; };
    const double order = std::log2((j(2) - j(3)) / (j(3) - j(4)));
    EXPECT_GT(order, 3.0);
    // J converges from above, because the strain energy of an approximate warping is too large.
    for (std::size_t i = 0; i < 4; ++i) EXPECT_GT(j(i), j(i + 1));
  }
}

TEST(SectionAnalysis, ErrorEstimatesBoundTheErrors) {
  for (const Ring& ring : {channel(8, 18, 1), angle_section(10.5, 15.5, 1)}) {
    const SectionAnalysis quick = analyse(of_one(ring, 0.3)),
                          fine = analyse(of_one(ring, 0.3), 0.3, 6);
    ASSERT_GT(fine.levels.size(), quick.levels.size());
    const SectionProperties &p = quick.properties, &q = fine.properties;
    const auto off = [](double a, double b) { return std::abs(a / b - 1.0); };
    EXPECT_LE(off(p.torsion_constant, q.torsion_constant), quick.errors.torsion_constant);
    EXPECT_LE(off(p.warping_constant, q.warping_constant), quick.errors.warping_constant);
    EXPECT_LE(off(p.shear_flexibility.zz, q.shear_flexibility.zz), quick.errors.shear_flexibility);
  }
  // Without a second mesh there is no error estimate.
  const Outline outline = of_one(channel(8, 18, 1), 0.3);
  const SectionAnalysis one =
      analyse_section(section_mesh(outline), outline.regions, {.most_nodes = 100});
  EXPECT_FALSE(one.converged);
  EXPECT_TRUE(std::isinf(one.errors.largest()));
}

TEST(SectionAnalysis, RejectsMisuse) {
  const Outline outline = of_one(rectangle(0, 0, 1, 1), 0.3);
  const TriangleMesh mesh = section_mesh(outline);
  expect_refusal([&] { (void)section_properties(mesh, {}, 0.3); }, {"regions", "0"});
  expect_refusal([&] { (void)section_properties({}, outline.regions, 0.3); }, {"no triangles"});
  expect_refusal([&] { (void)analyse_section(mesh, outline.regions, {.tolerance = 0}); },
                 {"tolerance", "positive"});
  expect_refusal([&] { (void)analyse_section(mesh, outline.regions, {.least_levels = 1}); },
                 {"least_levels", "1", "2"});
  expect_refusal([&] { (void)analyse_section(mesh, outline.regions, {.reference_poisson = 0.7}); },
                 {"reference_poisson", "0.7", "0.5"});
}

// Regression: corners closer than rounding gave NaN, a torsion constant 2.5 % off after 53 s, or no
// factorisation.
TEST(SectionAnalysis, NearlyRepeatedCornersChangeNothing) {
  const SectionProperties right = properties(rectangle(0, 0, 0.1, 0.2), 0.3);
  for (const double gap : {1e-17, 1e-15, 1e-14, 1e-12, 1e-10, 3e-10, 1e-9, 1e-8, 1e-6}) {
    const Ring ring = {{0, 0}, {0.1, 0}, {0.1, 0.2}, {gap, 0.2}, {0, 0.2}};
    const SectionProperties p = properties(ring, 0.3);
    expect_close(p.torsion_constant, right.torsion_constant, 1e-4, "J");
    expect_close(p.shear_flexibility.zz, right.shear_flexibility.zz, 1e-4, "α");
  }
}

TEST(SectionAnalysis, QuarterDiscWithRoundedCornersIsAccepted) {
  const auto quarter = [](double last_y) {
    Ring ring = {{0, 0}};
    for (int i = 0; i <= 8; ++i)
      ring.emplace_back(0.1 * std::cos(i * kPi / 16), 0.1 * std::sin(i * kPi / 16));
    ring.back().x() = last_y;
    if (last_y != 0.0) ring.emplace_back(0.0, 0.1);
    return ring;
  };
  const SectionProperties right = properties(quarter(0.0), 0.3);
  for (const double rounding : {6.123233995736766e-18, -6e-18, 1e-16, -1e-16}) {
    const SectionProperties p = properties(quarter(rounding), 0.3);
    expect_close(p.torsion_constant, right.torsion_constant, 1e-5, "J");
    expect_close(p.shear_centre.x(), right.shear_centre.x(), 1e-3, "centre");
  }
}

TEST(SectionAnalysis, RegionsWhoseCornersDifferByRoundingAreJoined) {
  const auto halves = [](double gap) {
    Outline outline;
    outline.regions.push_back({.outer = rectangle(0, 0, 0.05, 0.2)});
    outline.regions.push_back(
        {.outer = {{0.05 + gap, 0}, {0.1, 0}, {0.1, 0.2}, {0.05 + gap, 0.2}, {0.05, 0.2 - gap}}});
    return outline;
  };
  const double right = properties(rectangle(0, 0, 0.1, 0.2), 0.3).torsion_constant;
  for (const double gap : {1e-17, 1e-15, 1e-12, 1e-10}) {
    const Outline outline = checked(halves(gap));
    const SectionAnalysis a = analyse_section(section_mesh(outline), outline.regions);
    EXPECT_TRUE(a.converged) << gap;
    expect_close(a.properties.torsion_constant, right, 1e-4, "J");
  }
}

TEST(SectionAnalysis, StopsEarlyIfItWouldNotConverge) {
  const Outline outline = checked(of_one(channel(8, 18, 1), 0.3));
  const SectionAnalysis a =
      analyse_section(section_mesh(outline), outline.regions, {.tolerance = 1e-13});
  EXPECT_FALSE(a.converged);
  EXPECT_TRUE(a.finite());
  EXPECT_LE(a.levels.size(), 3U);
}

}  // namespace
}  // namespace wheeltap::fem

#include "fem/structures/defects/crack.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace wheeltap::fem {
namespace {

/// Gauss-Legendre on [-1, 1], five points.
constexpr std::array<double, 5> kAt = {-0.9061798459386640, -0.5384693101056831, 0.0,
                                       0.5384693101056831, 0.9061798459386640};
constexpr std::array<double, 5> kWeight = {0.2369268850561891, 0.4786286704993665,
                                           0.5688888888888889, 0.4786286704993665,
                                           0.2369268850561891};
constexpr int kPanels = 32;

double tada_factor(double s) {
  const double angle = 0.5 * std::numbers::pi * s;
  const double root = angle > 0.0 ? std::sqrt(std::tan(angle) / angle) : 1.0;
  return root * (0.923 + 0.199 * std::pow(1.0 - std::sin(angle), 4)) / std::cos(angle);
}

/// Integrates over panels in u = -ln(1 - s), because F² is smooth in u near s = 1.
double tada(double depth_ratio) {
  const double end = -std::log1p(-depth_ratio), half = 0.5 * end / kPanels;
  double sum = 0.0;
  for (int panel = 0; panel < kPanels; ++panel)
    for (std::size_t i = 0; i < kAt.size(); ++i) {
      const double u = half * (2 * panel + 1 + kAt[i]), s = -std::expm1(-u);
      const double f = tada_factor(s);
      sum += kWeight[i] * half * s * f * f * std::exp(-u);
    }
  return sum;
}

double ostachowicz_krawczuk(double s) {
  constexpr std::array<double, 7> c = {0.6384, -1.035, 3.7201, -5.1773, 7.553, -7.332, 2.4909};
  double sum = 0.0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * s + c[i];
  return sum * s * s;
}

constexpr std::array<CrackLaw, 3> kLaws = {{
    {"tada",
     "Tada, Paris & Irwin, The Stress Analysis of Cracks Handbook, part II, 2.13-2.14; plane "
     "stress",
     tada},
    {"tada-plane-strain",
     "Tada, Paris & Irwin, The Stress Analysis of Cracks Handbook, part II, 2.13-2.14; plane "
     "strain",
     tada, true},
    {"ostachowicz-krawczuk",
     "Ostachowicz & Krawczuk 1991, Journal of Sound and Vibration 150:191, one-sided crack",
     ostachowicz_krawczuk},
}};

}  // namespace

std::span<const CrackLaw> crack_laws() {
  return kLaws;
}

const CrackLaw* find_crack_law(std::string_view name) {
  for (const CrackLaw& law : kLaws)
    if (law.name == name) return &law;
  return nullptr;
}

double crack_compliance(const CrackLaw& law, double depth_ratio, double height,
                        double bending_stiffness, double poisson) {
  if (!(depth_ratio >= 0.0 && depth_ratio < 1.0))
    throw std::invalid_argument("crack depth a/h = " + std::to_string(depth_ratio) +
                                ": must be in [0, 1)");
  if (!(height > 0.0))
    throw std::invalid_argument("section depth = " + std::to_string(height) +
                                ": a crack needs a section with a known height");
  const double plane = law.plane_strain ? 1.0 - poisson * poisson : 1.0;
  return plane * 6.0 * std::numbers::pi * height / bending_stiffness * law.integral(depth_ratio);
}

}  // namespace wheeltap::fem

#include "dynamics/law_cycle.hpp"

#include <cmath>
#include <numbers>

namespace wheeltap::dynamics {
namespace {

template <class L>
std::vector<CyclePoint> follow(const Law& law, const Cycle& cycle) {
  constexpr int kSteps = 20;
  double c[kMaxLawCoefficients];
  for (std::size_t i = 0; i < kMaxLawCoefficients; ++i) c[i] = law.coefficients[i].value;
  // One-sided laws define T_open for opening. For closing, T(e, ė) = -T_open(-e, -ė).
  const double side = L::kInfo.one_sided && law.side == Side::closing ? -1.0 : 1.0;
  const double omega = 2.0 * std::numbers::pi / cycle.period;
  const auto extension = [&](double t) { return side * cycle.amplitude * std::sin(omega * t); };
  const auto rate = [&](double t) { return side * cycle.amplitude * omega * std::cos(omega * t); };
  const int intervals = cycle.points - 1;
  const double h = cycle.period / (intervals * kSteps);
  double zeta = 0.0;
  std::vector<CyclePoint> out;
  for (int i = 0; i <= (cycle.before + 1) * intervals; ++i) {
    const double t = i * kSteps * h, e = extension(t), v = rate(t);
    double tension = 0.0;
    if constexpr (L::kInfo.memory) {
      tension = L::tension(c, e, v, zeta);
      const auto slope = [&](double at, double z) {
        return L::memory_rate(c, extension(at), rate(at), z);
      };
      for (int s = 0; s < kSteps; ++s) {
        const double at = t + s * h;
        const double k1 = slope(at, zeta), k2 = slope(at + h / 2, zeta + h / 2 * k1),
                     k3 = slope(at + h / 2, zeta + h / 2 * k2), k4 = slope(at + h, zeta + h * k3);
        zeta += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      }
    } else {
      tension = L::tension(c, e, v);
    }
    if (i >= cycle.before * intervals) out.push_back({side * e, side * v, side * tension});
  }
  return out;
}

}  // namespace

std::vector<CyclePoint> law_cycle(const Law& law, const Cycle& cycle) {
  std::vector<CyclePoint> out;
  LawList::visit(law.kind, [&]<class L>(L) { out = follow<L>(law, cycle); });
  return out;
}

}  // namespace wheeltap::dynamics

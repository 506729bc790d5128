#include "dynamics/link_tension.hpp"

namespace wheeltap::dynamics {

double tension(const Link& link, std::span<const double> theta, double e, double rate) {
  double sum = link.stiffness.at(theta) * e + link.damping.at(theta) * rate;
  for (const Law& law : link.laws) {
    LawList::visit(law.kind, [&]<class L>(L) {
      if constexpr (!L::kInfo.memory) {
        double c[kMaxLawCoefficients];
        for (std::size_t i = 0; i < kMaxLawCoefficients; ++i) c[i] = law.coefficients[i].at(theta);
        // One-sided laws define T_open for opening. For closing, T(e, ė) = -T_open(-e, -ė).
        const double side = L::kInfo.one_sided && law.side == Side::closing ? -1.0 : 1.0;
        sum += side * L::tension(c, side * e, side * rate);
      }
    });
  }
  return sum;
}

double resting_tension(const Link& link, std::span<const double> theta, double e) {
  return tension(link, theta, e, 0.0);
}

}  // namespace wheeltap::dynamics

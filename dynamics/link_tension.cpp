#include "dynamics/link_tension.hpp"

namespace wheeltap::dynamics {

double resting_tension(const Link& link, std::span<const double> theta, double e) {
  double tension = link.stiffness.at(theta) * e;
  for (const Law& law : link.laws) {
    LawList::visit(law.kind, [&]<class L>(L) {
      if constexpr (!L::kInfo.memory) {
        double c[kMaxLawCoefficients];
        for (std::size_t i = 0; i < kMaxLawCoefficients; ++i) c[i] = law.coefficients[i].at(theta);
        // A one-sided law is written for opening: closing is T(e) = -T_open(-e).
        const double side = L::kInfo.one_sided && law.side == Side::closing ? -1.0 : 1.0;
        tension += side * L::tension(c, side * e, 0.0);
      }
    });
  }
  return tension;
}

}  // namespace wheeltap::dynamics

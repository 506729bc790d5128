#include "fem/structures/modes/tridiagonal.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

namespace wheeltap::fem {

using Eigen::Index;
using Eigen::VectorXd;

bool last_components(VectorXd diagonal, const VectorXd& below, VectorXd& values, VectorXd& last) {
  constexpr int kMostSteps = 60;
  const Index n = diagonal.size();
  VectorXd z = VectorXd::Unit(n, n - 1), e = VectorXd::Zero(n);
  e.head(n - 1) = below;
  for (Index l = 0; l < n; ++l) {
    for (int step = 0;; ++step) {
      Index m = l;
      while (m + 1 < n && std::abs(e[m]) > std::numeric_limits<double>::epsilon() *
                                               (std::abs(diagonal[m]) + std::abs(diagonal[m + 1])))
        ++m;
      if (m == l) break;
      if (step == kMostSteps) return false;
      double g = (diagonal[l + 1] - diagonal[l]) / (2.0 * e[l]);
      g = diagonal[m] - diagonal[l] + e[l] / (g + std::copysign(std::hypot(g, 1.0), g));
      double s = 1.0, c = 1.0, p = 0.0, r = 1.0;
      Index i = m;
      while (i-- > l) {
        const double f = s * e[i], b = c * e[i];
        r = std::sqrt(f * f + g * g);
        e[i + 1] = r;
        if (r == 0.0) {
          diagonal[i + 1] -= p;
          e[m] = 0.0;
          break;
        }
        s = f / r;
        c = g / r;
        g = diagonal[i + 1] - p;
        const double t = (diagonal[i] - g) * s + 2.0 * c * b;
        p = s * t;
        diagonal[i + 1] = g + p;
        g = c * t - b;
        const double moved = z[i + 1];
        z[i + 1] = s * z[i] + c * moved;
        z[i] = c * z[i] - s * moved;
      }
      if (r == 0.0) continue;
      diagonal[l] -= p;
      e[l] = g;
      e[m] = 0.0;
    }
  }
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::stable_sort(order, {}, [&](Index i) { return diagonal[i]; });
  values = diagonal(order);
  last = z(order);
  return true;
}

}  // namespace wheeltap::fem

#include "fem/window.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/index.hpp"

namespace wheeltap::fem::detail {
namespace {

/// The Chebyshev series represents the modes above kFarRatio · cap.
constexpr double kFarRatio = 3.0;
/// Relative truncation error of the Chebyshev series.
constexpr double kSeriesError = 1e-17;

}  // namespace

/// 1/(ξ - x) = (1 + 2 Σ_p ρ^-p T_p(x)) / √(ξ² - 1), ρ = ξ + √(ξ² - 1), for |x| <= 1 < ξ, gives the
/// series of κ_j e_j e_jᵀ / λ = c_j c_jᵀ / (λ_j (λ_j - λ)).
Window::Window(const std::vector<double>& eigenvalues, int modes, int highest_root) {
  if (highest_root + 2 >= modes) {
    near = std::max(modes, 2);
    cap = std::numeric_limits<double>::infinity();
    return;
  }
  cap = eigenvalues[index(highest_root)];
  near = highest_root + 2;
  while (near < modes && eigenvalues[index(near)] < kFarRatio * cap) ++near;
  const int far = modes - near;
  if (far == 0) return;
  const auto ratio = [&](int j) {
    const double xi = 2.0 * eigenvalues[index(near + j)] / cap - 1.0;
    return std::pair{xi, std::sqrt(xi * xi - 1.0)};
  };
  const auto [xi0, root0] = ratio(0);
  terms = 2 + static_cast<int>(-std::log(kSeriesError) / std::log(xi0 + root0));
  series.resize(index(terms) * index(far));
  series_end.assign(index(terms), 0);
  for (int j = 0; j < far; ++j) {
    const auto [xi, root] = ratio(j);
    double weight = 2.0 / cap / root;
    for (int p = 0; p < terms; ++p) {
      series[index(p) * index(far) + index(j)] = weight / eigenvalues[index(near + j)];
      if (weight * cap > kSeriesError) series_end[index(p)] = j + 1;
      weight *= (p == 0 ? 2.0 : 1.0) / (xi + root);
    }
  }
}

}  // namespace wheeltap::fem::detail

// Selection of the intact modes that the secular function sums directly; a series represents the
// other modes. Internal.
#pragma once

#include <vector>

namespace wheeltap::fem::detail {

/// A range of λ, with the near modes and the series for the computation of S in this range
/// (`Secular`).
struct Window {
  int near = 0;
  int terms = 0;
  double cap = 0.0;
  std::vector<double> series;   // terms × (modes - near)
  std::vector<int> series_end;  // per term: index from which modes are negligible

  Window(const std::vector<double>& eigenvalues, int modes, int highest_root);
};

}  // namespace wheeltap::fem::detail

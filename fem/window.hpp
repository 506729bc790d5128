// Selection of the intact modes that the secular function sums directly; a series represents the
// other modes. Internal.
#pragma once

#include <vector>

namespace wheeltap::fem::detail {

/// A range 0 <= λ <= cap for the computation of S (`Secular`). In this range, S is the sum over the
/// lowest `near` modes plus a series that represents the other modes.
struct Window {
  int near = 0;
  int terms = 0;
  double cap = 0.0;
  std::vector<double> series;   // terms × (modes - near)
  std::vector<int> series_end;  // per term: index from which modes are negligible

  Window(const std::vector<double>& eigenvalues, int modes, int highest_root);
};

}  // namespace wheeltap::fem::detail

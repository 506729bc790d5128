// Which intact modes the secular function sums one by one, and which by a series. Internal.
#pragma once

#include <vector>

namespace wheeltap::fem::detail {

/// The range of λ and how S is summed over it (`Secular`).
struct Window {
  int near = 0;
  int terms = 0;
  double cap = 0.0;
  std::vector<double> series;   // terms × (modes - near)
  std::vector<int> series_end;  // per term: modes beyond do not matter

  Window(const std::vector<double>& eigenvalues, int modes, int highest_root);
};

}  // namespace wheeltap::fem::detail

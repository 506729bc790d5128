// The time-stepping loops; a SIMD vector holds several parameter sets. Each kernel_*.cpp includes
// this file and first defines
//   WHEELTAP_KERNEL        its own namespace, so that no two instruction sets share a symbol,
//   WHEELTAP_KERNEL_TABLE  the name of its table of functions (base/simd.hpp),
//   WHEELTAP_LANES         the number of doubles in a vector.
// The compiler does not contract operations to fused multiply-adds, so the results are bitwise
// equal for every SIMD width.
#pragma once

#include "dynamics/kernel.hpp"
#include "dynamics/kernel/exact.hpp"
#include "dynamics/kernel/paced_runge_kutta.hpp"
#include "dynamics/kernel/piecewise.hpp"
#include "dynamics/kernel/runge_kutta.hpp"
#include "dynamics/kernel/series.hpp"
#include "dynamics/laws.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

/// For N = 0, the number of masses is arbitrary.
template <int N>
void run_runge_kutta(const Task& task) {
  if (task.paced || task.frictions > 0)
    PacedRungeKutta<N>(task).run();
  else if (N == 0 || !task.serial)
    RungeKutta<N, false, AnyLaw>(task).run();
  else if (task.only_law == LawList::index_of<laws::Cubic>())
    RungeKutta<N, true, laws::Cubic>(task).run();
  else
    RungeKutta<N, true, AnyLaw>(task).run();
}

inline void runge_kutta(const Task& task) {
  switch (task.masses) {
    case 1:
      return run_runge_kutta<1>(task);
    case 2:
      return run_runge_kutta<2>(task);
    case 3:
      return run_runge_kutta<3>(task);
    default:
      return run_runge_kutta<0>(task);
  }
}

inline void exact(const Task& task) {
  switch (task.masses) {
    case 1:
      return Exact<1>(task).run();
    case 2:
      return Exact<2>(task).run();
    case 3:
      return Exact<3>(task).run();
    default:
      return Exact<0>(task).run();
  }
}

template <int N>
void run_piecewise(const Task& task) {
  if (task.serial)
    Piecewise<N, true>(task).run();
  else
    Piecewise<N, false>(task).run();
}

template <int N>
void run_series(const Task& task) {
  if (task.serial)
    Series<N, true>(task).run();
  else
    Series<N, false>(task).run();
}

inline void series(const Task& task) {
  switch (task.masses) {
    case 1:
      return run_series<1>(task);
    case 2:
      return run_series<2>(task);
    case 3:
      return run_series<3>(task);
    default:
      return Series<0, false>(task).run();
  }
}

inline void piecewise(const Task& task) {
  switch (task.masses) {
    case 1:
      return run_piecewise<1>(task);
    case 2:
      return run_piecewise<2>(task);
    case 3:
      return run_piecewise<3>(task);
    default:
      return Piecewise<0, false>(task).run();
  }
}

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL

namespace wheeltap::dynamics::kernel {
const Kernel WHEELTAP_KERNEL_TABLE{.lanes = WHEELTAP_LANES,
                                   .runge_kutta = WHEELTAP_KERNEL::runge_kutta,
                                   .exact = WHEELTAP_KERNEL::exact,
                                   .piecewise = WHEELTAP_KERNEL::piecewise,
                                   .series = WHEELTAP_KERNEL::series};
}  // namespace wheeltap::dynamics::kernel

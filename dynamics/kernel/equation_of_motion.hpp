// Forces on the masses of a chain, for all integrators except the exact solution. Part of
// kernel_impl.hpp, which describes the compilation.
#pragma once

#include <type_traits>

#include "dynamics/kernel/vectors.hpp"
#include "dynamics/kernel/watch.hpp"
#include "dynamics/laws.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

/// Calls visit(i, link, stiffness, threshold, side) for every force law that acts as a spring
/// beyond a threshold; i = 0, 1, … is the index among these laws.
template <class Visitor>
WHEELTAP_INLINE void for_each_threshold(const Task& task, Visitor visit) {
  int i = 0;
  for (int l = 0; l < task.links; ++l) {
    const LinkTerm& link = task.link[l];
    for (int j = link.law_begin; j < link.law_end; ++j) {
      const V* c = vectors(task.coefficients) + task.law[j].slot;
      LawList::visit(task.law[j].kind, [&](auto law) {
        using Law = decltype(law);
        if constexpr (kPiecewiseLinear<Law>)
          visit(i++, link, c[0], Law::threshold(c), c[Law::kInfo.size()]);
      });
    }
  }
}

struct AnyLaw {};

/// The equation of motion z̈ = drive + M⁻¹ pull, with drive = F / m - ÿ_base. `pull` is the sum of
/// the link tensions on a mass. friction.hpp adds exact friction.
///
/// N is the number of masses; for N = 0, task.masses gives the number. kSerial is true if link i
/// joins masses i and i + 1. If all force laws of the chain have the same type, OnlyLaw is this
/// type, so that the type is known at compile time. For different types, OnlyLaw is AnyLaw.
template <int N, bool kSerial, class OnlyLaw>
class EquationOfMotion {
 public:
  static constexpr int M = (N > 0 ? N : kMaxMasses) + 1;

  explicit EquationOfMotion(const Task& task)
      : task_(task), c_(vectors(task.coefficients)), masses_(N > 0 ? N : task.masses) {
    const int n = masses();
    inverse_mass_[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) inverse_mass_[i] = 1.0 / c_[i - 1];
  }

  [[nodiscard]] WHEELTAP_INLINE int masses() const { return N > 0 ? N : masses_; }
  [[nodiscard]] WHEELTAP_INLINE V inverse_mass(int i) const { return inverse_mass_[i]; }

  /// Computes drive[i] = F_i / m_i - ÿ_base at a sample.
  WHEELTAP_INLINE void excite(std::int64_t sample, V* drive) const {
    const int n = masses();
    V force[M], base{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) force[i] = V{};
    for (int j = 0; j < task_.drives; ++j) {
      const DriveTerm& term = task_.drive[j];
      const V value = c_[term.slot] * term.samples[sample] + c_[term.slot + 1];
      if (term.mass == 0)
        base += value;
      else
        force[term.mass] += value;
    }
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) drive[i] = force[i] * inverse_mass_[i] - base;
  }

  /// Computes the accelerations of a chain without internal states and without exact friction.
  WHEELTAP_INLINE void accelerations(std::int64_t sample, const V* y, const V* v, V* a) const {
    const int n = masses();
    V pull[M];
    excite(sample, a);
    forces(y, v, nullptr, pull, nullptr);
    a[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) a[i] += inverse_mass_[i] * pull[i];
  }

  /// Computes the sum of the tensions on every mass, and the rates of the internal states of the
  /// force laws.
  WHEELTAP_INLINE void forces(const V* y, const V* v, const V* q, V* pull, V* q_rate) const {
    const int n = masses();
    pull[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) pull[i] = V{};
    const int links = kSerial && N > 0 ? N : task_.links;
    WHEELTAP_UNROLL
    for (int l = 0; l < links; ++l) {
      const LinkTerm& link = task_.link[l];
      const int from = kSerial ? l : link.a, to = kSerial ? l + 1 : link.b;
      const V e = y[to] - y[from], rate = v[to] - v[from];
      V tension = c_[link.slot] * e;
      for (int j = link.law_begin; j < link.law_end; ++j)
        tension += apply(task_.law[j], e, rate, q, q_rate);
      // The damping force is added last, because the velocity of a Runge-Kutta stage is computed
      // last.
      tension += c_[link.slot + 1] * rate;
      pull[from] += tension;
      pull[to] -= tension;
    }
  }

  WHEELTAP_INLINE V apply(const LawTerm& term, V e, V rate, const V* q, V* q_rate) const {
    if constexpr (std::is_same_v<OnlyLaw, AnyLaw>) {
      V tension{};
      LawList::visit(
          term.kind, [&](auto law) __attribute__((always_inline)) {
            tension = apply(law, term, e, rate, q, q_rate);
          });
      return tension;
    } else {
      return apply(OnlyLaw{}, term, e, rate, q, q_rate);
    }
  }

  template <class Law>
  WHEELTAP_INLINE V apply(Law, const LawTerm& term, V e, V rate, const V* q, V* q_rate) const {
    const V* c = c_ + term.slot;
    if constexpr (Law::kInfo.memory) {
      static_assert(!Law::kInfo.one_sided && Law::kInfo.paced,
                    "only PacedRungeKutta integrates internal states of laws, and only those of "
                    "two-sided laws");
      q_rate[term.memory] = Law::memory_rate(c, e, rate, q[term.memory]);
      return Law::tension(c, e, rate, q[term.memory]);
    } else if constexpr (Law::kInfo.one_sided) {
      const V side = c[Law::kInfo.size()];
      return side * Law::tension(c, side * e, side * rate);
    } else if constexpr (kFriction<Law>) {
      return term.dry < 0 ? Law::tension(c, e, rate) : V{};
    } else {
      return Law::tension(c, e, rate);
    }
  }

  WHEELTAP_INLINE void emit(Output& output, std::int64_t sample, const V* y, const V* v,
                            const V* a) const {
    const int n = masses();
    V motion[3][M];  // a copy, so that y, v and a can stay in registers
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      motion[0][i] = y[i];
      motion[1][i] = v[i];
      motion[2][i] = a[i];
    }
    for (int i = 0; i < task_.sensors; ++i)
      output.take(sample, i, motion[task_.sensor[i].quantity][task_.sensor[i].mass]);
  }

 private:
  const Task& task_;
  const V* c_;
  int masses_;
  V inverse_mass_[M];
};

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL

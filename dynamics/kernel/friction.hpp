// Exact dry friction: stick and slip of links, and the tensions of sticking links. Part of
// kernel_impl.hpp, which describes the compilation.
#pragma once

#include "dynamics/kernel/vectors.hpp"
#include "dynamics/laws.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

/// Exact dry friction of links. Between two events, every link with friction either slips, T = ±F,
/// or sticks. The tension of a sticking link is the Lagrange multiplier of ė = 0. ë₀ denotes the
/// accelerations of the extensions without friction, and B contains the signs of the displacements
/// in the extensions (-1 at a, +1 at b). Then
///
///   ë = ë₀ - G T,   G = B M⁻¹ Bᵀ,   so that   G_ss T_s = ë₀_s - G_sg T_g
///
/// for the sticking links s and the slipping links g. For the links with ė = 0, the stick-slip
/// state follows from the tensions T, which satisfy
///
///   |T| < F, ë = 0   or   T = F, ë >= 0   or   T = -F, ë <= 0
///
/// (Glocker 2001, Set-Valued Force Laws, chapter 5). The solution T is unique if G is positive
/// definite. The solver repeatedly changes the state of the first link that violates its condition,
/// until all links satisfy their conditions. This least-index pivoting ends after finitely many
/// changes (Murty 1974; for bounds on both sides Júdice & Pires 1992). In a closed loop of sticking
/// links, G is singular and the tensions are not unique. The links with the lowest indices then
/// carry the force.
///
/// Links between the same two masses stick and slip together. The result of a SIMD lane does not
/// depend on the other lanes.
template <int N>
class Friction {
 public:
  static constexpr int M = (N > 0 ? N : kMaxMasses) + 1;

  /// All accelerations are multiplied by `unit`, the square of the unit of time [s²].
  Friction(const Task& task, double unit) : size_(task.frictions) {
    if (size_ == 0) return;
    const V* c = vectors(task.coefficients);
    inverse_[0] = V{};
    for (int i = 1; i <= task.masses; ++i) inverse_[i] = unit / c[i - 1];
    for (int f = 0; f < size_; ++f) force_[f] = state_[f] = V{};
    for (int l = 0; l < task.links; ++l) {
      const LinkTerm& link = task.link[l];
      for (int j = link.law_begin; j < link.law_end; ++j) {
        const LawTerm& term = task.law[j];
        if (term.dry < 0) continue;
        a_[term.dry] = link.a;
        b_[term.dry] = link.b;
        LawList::visit(term.kind, [&](auto law) {
          if constexpr (kFriction<decltype(law)>)
            force_[term.dry] += decltype(law)::friction(c + term.slot);
        });
      }
    }
    for (int f = 0; f < size_; ++f)
      for (int g = 0; g < size_; ++g)
        delassus_[f][g] = inverse_[b_[f]] * ((b_[f] == b_[g]) - (b_[f] == a_[g])) +
                          inverse_[a_[f]] * ((a_[f] == a_[g]) - (a_[f] == b_[g]));
    factor();
  }

  [[nodiscard]] WHEELTAP_INLINE int size() const { return size_; }
  /// Returns the state of link f in each lane: 1 if the link slips and opens, -1 if it slips and
  /// closes, 0 if it sticks.
  [[nodiscard]] WHEELTAP_INLINE V state(int f) const { return state_[f]; }
  [[nodiscard]] WHEELTAP_INLINE V force(int f) const { return force_[f]; }
  /// Returns the magnitude of ∂ë/∂T for the extension e and the tension T of link f.
  [[nodiscard]] WHEELTAP_INLINE V compliance(int f) const { return delassus_[f][f]; }
  /// True if any link sticks in any lane.
  [[nodiscard]] WHEELTAP_INLINE bool sticking() const { return sticking_; }
  /// Returns the difference of a quantity between the two ends of link f, for example ė from the
  /// velocities.
  [[nodiscard]] WHEELTAP_INLINE V across(int f, const V* x) const { return x[b_[f]] - x[a_[f]]; }

  /// Computes the friction tensions from `acceleration`, which excludes friction, then adds the
  /// effect of the tensions to `acceleration`. If `slipping` is false (for higher terms of a
  /// series), slipping links have no tension.
  WHEELTAP_INLINE void pull(bool slipping, V* acceleration, V* tension) const {
    for (int f = 0; f < size_; ++f) {
      tension[f] = slipping ? state_[f] * force_[f] : V{};
      if (slipping) push(f, tension[f], acceleration);
    }
    if (!sticking_) return;
    V holding[kMaxFrictions] = {};
    for (int f = 0; f < size_; ++f) holding[f] = across(f, acceleration);
    solve(holding);
    for (int f = 0; f < size_; ++f) {
      tension[f] = state_[f] == 0.0 ? holding[f] : tension[f];
      push(f, holding[f], acceleration);
    }
  }

  /// Determines the stick-slip states from the velocities `v` and from the accelerations `free`,
  /// which do not include friction. A link with ė = 0 sticks if a tension |T| < F can keep it at
  /// rest.
  void start(V* v, const V* free) {
    V at_rest[kMaxFrictions] = {};
    for (int f = 0; f < size_; ++f) {
      const V rate = across(f, v);
      state_[f] = rate > 0.0 ? V{} + 1.0 : rate < 0.0 ? V{} - 1.0 : V{};
      at_rest[f] = rate == 0.0 ? V{} + 1.0 : V{};
    }
    settle(at_rest, v, free);
  }

  /// Changes the state of link f from slip to stick in the lanes with `stop` > 0.
  WHEELTAP_INLINE void stop(int f, V stop) { state_[f] = stop > 0.0 ? V{} : state_[f]; }
  /// Changes the state of link f to slip in the direction `side` (±1), in lanes with nonzero
  /// `side`. Does not update the factorisation.
  WHEELTAP_INLINE void break_away(int f, V side) { state_[f] = side == 0.0 ? state_[f] : side; }

  /// Determines whether the links `at_rest` stick or slip, from the accelerations `free` without
  /// friction. Also sets the rates of extension of sticking links in `v` to zero.
  void settle(const V* at_rest, V* v, const V* free) {
    V acceleration[M], tension[kMaxFrictions];
    const int ends = highest_end();
    for (int change = 0; change < kMostChanges; ++change) {
      factor();
      for (int i = 0; i <= ends; ++i) acceleration[i] = free[i];
      pull(true, acceleration, tension);
      V open = V{} + 1.0, changed{};
      for (int f = 0; f < size_; ++f) {
        const V limit = (1.0 + kTolerance) * force_[f];
        const V growth = state_[f] * across(f, acceleration);
        const V broken = tension[f] > limit ? V{} + 1.0 : tension[f] < -limit ? V{} - 1.0 : V{};
        const V noise = kTolerance * delassus_[f][f] * force_[f];
        const V held = growth < -noise ? V{} : state_[f];
        const V wanted = state_[f] == 0.0 ? broken : held;
        const V differs = at_rest[f] * open * (wanted == state_[f] ? V{} : V{} + 1.0);
        state_[f] = differs > 0.0 ? wanted : state_[f];
        open = differs > 0.0 ? V{} : open;
        changed = lanes::max(changed, differs);
      }
      if (!any(changed)) break;
    }
    factor();
    V impulse[kMaxFrictions] = {};
    for (int f = 0; f < size_; ++f) impulse[f] = at_rest[f] > 0.0 ? across(f, v) : V{};
    solve(impulse);
    for (int f = 0; f < size_; ++f) push(f, impulse[f], v);
  }

  /// Factorises G_ss, the part of G for the sticking links, for use by `pull`.
  void factor() {
    sticking_ = false;
    for (int f = 0; f < size_; ++f) {
      sticking_ = sticking_ || !all(state_[f]);
      V pivot = state_[f] == 0.0 ? delassus_[f][f] : V{};
      for (int k = 0; k < f; ++k) pivot -= lower_[f][k] * lower_[f][k] * pivot_[k];
      // `usable` is 0 for a slipping link, and for a sticking link whose extension rate follows
      // from the extension rates of other links.
      const V usable = pivot > kSingular * delassus_[f][f] ? V{} + 1.0 : V{};
      pivot_[f] = usable > 0.0 ? pivot : V{};
      reciprocal_[f] = usable > 0.0 ? 1.0 / pivot : V{};
      for (int i = f + 1; i < size_; ++i) {
        V sum = state_[i] == 0.0 ? delassus_[i][f] : V{};
        for (int k = 0; k < f; ++k) sum -= lower_[i][k] * lower_[f][k] * pivot_[k];
        lower_[i][f] = state_[i] == 0.0 ? sum * reciprocal_[f] : V{};
      }
    }
  }

 private:
  static constexpr int kMostChanges = 64;
  /// Relative tolerance of the stick-slip conditions on tensions and accelerations.
  static constexpr double kTolerance = 1e-10;
  static constexpr double kSingular = 1e-12;

  [[nodiscard]] int highest_end() const {
    int highest = 0;
    for (int f = 0; f < size_; ++f) {
      highest = a_[f] > highest ? a_[f] : highest;
      highest = b_[f] > highest ? b_[f] : highest;
    }
    return highest;
  }

  WHEELTAP_INLINE void push(int f, V tension, V* x) const {
    x[a_[f]] += inverse_[a_[f]] * tension;
    x[b_[f]] -= inverse_[b_[f]] * tension;
  }

  /// Replaces x by G_ss⁻¹ x, with G_ss = L D Lᵀ; the entries of slipping links become 0.
  WHEELTAP_INLINE void solve(V* x) const {
    for (int i = 0; i < size_; ++i) {
      x[i] = state_[i] == 0.0 ? x[i] : V{};
      for (int k = 0; k < i; ++k) x[i] -= lower_[i][k] * x[k];
    }
    for (int i = size_ - 1; i >= 0; --i) {
      x[i] *= reciprocal_[i];
      for (int k = i + 1; k < size_; ++k) x[i] -= lower_[k][i] * x[k];
    }
  }

  int size_, a_[kMaxFrictions], b_[kMaxFrictions];
  bool sticking_ = false;
  V inverse_[M];
  V force_[kMaxFrictions], state_[kMaxFrictions];
  V delassus_[kMaxFrictions][kMaxFrictions];  ///< G
  V lower_[kMaxFrictions][kMaxFrictions], pivot_[kMaxFrictions], reciprocal_[kMaxFrictions];
};

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL

// Exact solution of linear chains. Part of kernel_impl.hpp, which describes the compilation.
#pragma once

#include "dynamics/kernel/equation_of_motion.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

/// The exact solution of a linear chain. With the state x = (z, h ż) and inputs u that are linear
/// within a time step h,
///
///   x⁺ = Φ x + Γ₀ u + Γ₁ u⁺,  Φ = e^A, Γ₁ = φ₂(A) B, Γ₀ = φ₁(A) B - Γ₁,
///   A = [0 1; -h² M⁻¹K  -h M⁻¹C],  φ₁(A) = Σ Aᵏ/(k+1)!,  φ₂(A) = Σ Aᵏ/(k+2)!
///
/// (first-order hold; Van Loan 1978 gives the integrals). The loop computes w = x - Γ₁ u by the
/// recursion w⁺ = Φ w + (Φ Γ₁ + Γ₀) u, which needs only one product with u per time step.
template <int N>
class Exact {
 public:
  /// If `thresholds` is true, a constant input of 1 follows the other inputs; this input represents
  /// the constant forces of springs with a threshold other than e = 0.
  explicit Exact(const Task& task, bool thresholds = false)
      : task_(task),
        c_(vectors(task.coefficients)),
        free_(vectors(task.scratch)),
        masses_(N > 0 ? N : task.masses),
        inputs_(task.drives + (thresholds ? 1 : 0)) {
    const int n = order(), j = inputs_;
    transition_ = take(n * n);
    phi2_ = take(n * n);
    product_ = take(n * n);
    lower_ = take(masses() * n);
    input_ = take(masses() * j);
    gamma0_ = take(n * j);
    gamma1_ = take(n * j);
    gain_ = take(n * j);
    shifted_ = take(n * j);
    rows_ = take(task.sensors * n);
    feed_ = take(task.sensors * j);
    u_ = take(j);
    state_ = take(n);
  }

  void run() {
    discretise(0);
    observe();
    propagate();
  }

 protected:
  static constexpr int kOrder = N > 0 ? 2 * N : 2 * kMaxMasses;
  [[nodiscard]] WHEELTAP_INLINE int masses() const { return N > 0 ? N : masses_; }
  [[nodiscard]] WHEELTAP_INLINE int order() const { return 2 * masses(); }

  V* take(int size) {
    V* block = free_;
    free_ += size;
    return block;
  }

  /// Assembles the lower half of the rows of A and B; the unit of time is the time step. Each force
  /// law whose bit in `regime` is set acts as a spring T = k e - side · k · threshold.
  void assemble(unsigned regime) {
    const int m = masses(), n = order();
    const double h = task_.step, h2 = h * h;
    for (int i = 0; i < m * n; ++i) lower_[i] = V{};
    const auto add = [&](int row, int column, V k, V c) {
      lower_[row * n + column] -= k;
      lower_[row * n + m + column] -= c;
    };
    for (int l = 0; l < task_.links; ++l) {
      const LinkTerm& link = task_.link[l];
      const int a = link.a - 1, b = link.b - 1;
      const V k = h2 * c_[link.slot], c = h * c_[link.slot + 1];
      if (a >= 0) add(a, a, k, c);
      if (b >= 0) add(b, b, k, c);
      if (a >= 0 && b >= 0) {
        add(a, b, -k, -c);
        add(b, a, -k, -c);
      }
    }
    for (int i = 0; i < m * inputs_; ++i) input_[i] = V{};
    for_each_threshold(task_, [&](int j, const LinkTerm& link, V stiffness, V threshold, V side) {
      if ((regime >> j & 1U) == 0) return;
      const int a = link.a - 1, b = link.b - 1, last = inputs_ - 1;
      const V k = h2 * stiffness, force = side * k * threshold;
      if (a >= 0) add(a, a, k, V{});
      if (b >= 0) add(b, b, k, V{});
      if (a >= 0 && b >= 0) {
        add(a, b, -k, V{});
        add(b, a, -k, V{});
      }
      if (a >= 0) input_[a * inputs_ + last] -= force;
      if (b >= 0) input_[b * inputs_ + last] += force;
    });
    for (int i = 0; i < m; ++i) {
      for (int j = 0; j < n; ++j) lower_[i * n + j] /= c_[i];
      for (int j = 0; j < inputs_; ++j) input_[i * inputs_ + j] /= c_[i];
      for (int j = 0; j < task_.drives; ++j) {
        const int mass = task_.drive[j].mass;
        input_[i * inputs_ + j] = mass == 0 ? V{} - h2 : mass == i + 1 ? h2 / c_[i] : V{};
      }
    }
  }

  /// Computes y = factor · A x for matrices x and y of n × columns. Multiplication by the upper
  /// half of A only copies the lower rows of x.
  void multiply_a(double factor, const V* x, V* y, int columns) const {
    const int m = masses(), n = order();
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < columns; ++j) {
        y[i * columns + j] = factor * x[(m + i) * columns + j];
        V sum{};
        for (int k = 0; k < n; ++k) sum += lower_[i * n + k] * x[k * columns + j];
        y[(m + i) * columns + j] = factor * sum;
      }
  }

  /// Computes y = Φ x.
  void multiply_transition(const V* x, V* y, int columns) const {
    const int n = order();
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < columns; ++j) {
        V sum{};
        for (int k = 0; k < n; ++k) sum += transition_[i * n + k] * x[k * columns + j];
        y[i * columns + j] = sum;
      }
  }

  /// Computes Φ, φ₁ and φ₂ by Taylor polynomials at A/2ˢ, whose norm is at most 1/2 (remainder
  /// 3e-18), and then s doublings: Φ(2A) = Φ², φ₁(2A) = (Φ + 1) φ₁ / 2, φ₂(2A) = (Φ φ₂ + φ₁ + φ₂) /
  /// 4.
  void discretise(unsigned regime) {
    assemble(regime);
    const int m = masses(), n = order(), j = inputs_;
    constexpr int kDegree = 13;
    double factor = 1.0;
    for (int s = 0; s < task_.halvings; ++s) factor *= 0.5;
    double coefficient = 1.0;  // 1 / (degree + 2)!
    for (int k = 2; k <= kDegree + 2; ++k) coefficient /= k;
    for (int i = 0; i < n * n; ++i) phi2_[i] = V{};
    for (int i = 0; i < n; ++i) phi2_[i * n + i] = V{} + coefficient;
    for (int k = kDegree; k > 0; --k) {
      coefficient *= k + 2;
      multiply_a(factor, phi2_, product_, n);
      for (int i = 0; i < n * n; ++i) phi2_[i] = product_[i];
      for (int i = 0; i < n; ++i) phi2_[i * n + i] += coefficient;
    }
    multiply_a(factor, phi2_, product_, n);  // φ₁ = A φ₂ + 1
    for (int i = 0; i < n; ++i) product_[i * n + i] += 1.0;
    multiply_a(factor, product_, transition_, n);  // Φ = A φ₁ + 1
    for (int i = 0; i < n; ++i) transition_[i * n + i] += 1.0;

    // gamma1 = φ₂ B and gain = φ₁ B, with the upper half of B zero. The multiplication by
    // `factor` converts B to the time step after the halvings.
    for (int i = 0; i < n; ++i)
      for (int c = 0; c < j; ++c) {
        V first{}, second{};
        for (int k = 0; k < m; ++k) {
          first += product_[i * n + m + k] * input_[k * j + c];
          second += phi2_[i * n + m + k] * input_[k * j + c];
        }
        gain_[i * j + c] = factor * first;
        gamma1_[i * j + c] = factor * second;
      }
    for (int s = 0; s < task_.halvings; ++s) {
      multiply_transition(gamma1_, gamma0_, j);
      multiply_transition(gain_, shifted_, j);
      for (int i = 0; i < n * j; ++i) {
        gamma1_[i] = 0.5 * (gamma0_[i] + gain_[i] + gamma1_[i]);
        gain_[i] = shifted_[i] + gain_[i];
      }
      multiply_transition(transition_, product_, n);
      for (int i = 0; i < n * n; ++i) transition_[i] = product_[i];
    }
    for (int i = 0; i < n * j; ++i) gamma0_[i] = gain_[i] - gamma1_[i];
    multiply_transition(gamma1_, gain_, j);
    for (int i = 0; i < n * j; ++i) gain_[i] += gamma0_[i];
  }

  /// Computes the output matrices of the sensors. The signal of sensor i is rows · w + feed · u.
  /// For sensors other than accelerometers, `rows` has one nonzero entry.
  void observe() {
    const int m = masses(), n = order(), j = inputs_;
    const double h = task_.step;
    for (int i = 0; i < task_.sensors; ++i) {
      const int mass = task_.sensor[i].mass - 1, quantity = task_.sensor[i].quantity;
      if (quantity == 2) {
        for (int k = 0; k < n; ++k) rows_[i * n + k] = lower_[mass * n + k] / (h * h);
        for (int c = 0; c < j; ++c) {
          V sum = input_[mass * j + c] / (h * h);
          for (int k = 0; k < n; ++k) sum += rows_[i * n + k] * gamma1_[k * j + c];
          feed_[i * j + c] = sum;
        }
      } else {
        const int row = quantity == 1 ? m + mass : mass;
        const double unit = quantity == 1 ? 1.0 / h : 1.0;
        rows_[i * n] = V{} + unit;
        for (int c = 0; c < j; ++c) feed_[i * j + c] = unit * gamma1_[row * j + c];
      }
    }
  }

  WHEELTAP_INLINE void excite(std::int64_t sample) {
    for (int j = 0; j < task_.drives; ++j) {
      const DriveTerm& term = task_.drive[j];
      u_[j] = c_[term.slot] * term.samples[sample] + c_[term.slot + 1];
    }
  }

  WHEELTAP_INLINE void emit(Output& output, std::int64_t sample) const {
    const int m = masses(), n = order();
    for (int i = 0; i < task_.sensors; ++i) {
      const SensorTerm& s = task_.sensor[i];
      V motion{};
      if (s.quantity == 2) {
        WHEELTAP_UNROLL
        for (int k = 0; k < n; ++k) motion += rows_[i * n + k] * state_[k];
      } else {
        motion = rows_[i * n] * state_[s.quantity == 1 ? m + s.mass - 1 : s.mass - 1];
      }
      for (int c = 0; c < inputs_; ++c) motion += feed_[i * inputs_ + c] * u_[c];
      output.take(sample, i, motion);
    }
  }

  void propagate() {
    const int m = masses(), n = order();
    V w[kOrder], next[kOrder];
    excite(0);
    WHEELTAP_UNROLL
    for (int i = 0; i < n; ++i) {
      w[i] = c_[task_.initial_slot + i] * (i < m ? 1.0 : task_.step);
      for (int j = 0; j < inputs_; ++j) w[i] -= gamma1_[i * inputs_ + j] * u_[j];
    }
    Output output(task_);
    Watch watch(task_);
    for (std::int64_t sample = 0;; ++sample) {
      if (output.due(sample)) {
        WHEELTAP_UNROLL
        for (int i = 0; i < n; ++i) state_[i] = w[i];
        emit(output, sample);
      }
      if (sample + 1 == task_.samples) break;
      WHEELTAP_UNROLL
      for (int i = 0; i < n; ++i) {
        V sum{};
        WHEELTAP_UNROLL
        for (int k = 0; k < n; ++k) sum += transition_[i * n + k] * w[k];
        for (int j = 0; j < inputs_; ++j) sum += gain_[i * inputs_ + j] * u_[j];
        next[i] = sum;
      }
      WHEELTAP_UNROLL
      for (int i = 0; i < n; ++i) w[i] = next[i];
      WHEELTAP_UNROLL
      for (int i = 0; i < m; ++i) watch.check(w[i]);
      if (watch.over(sample, output)) break;
      excite(sample + 1);
    }
    WHEELTAP_UNROLL
    for (int i = 0; i < n; ++i) watch.check_last(w[i]);
    watch.finish();
  }

  const Task& task_;
  const V* c_;
  V* free_;  ///< unused part of the scratch memory
  int masses_, inputs_;
  V *transition_, *phi2_, *product_, *lower_, *input_;
  V *gamma0_, *gamma1_, *gain_, *shifted_, *rows_, *feed_, *u_, *state_;
};

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL

// Exact solution between the switching times of force laws. Part of kernel_impl.hpp, which
// describes the compilation.
#pragma once

#include "dynamics/kernel/exact.hpp"
#include "dynamics/kernel/series.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

/// Integrates chains whose force laws are all springs active beyond a threshold. A chain with such
/// springs is linear between two switches. A sample interval without a switch uses the exact
/// solution of the current regime. An interval with a switch uses Taylor series. A switch is
/// detected if e - threshold has changed its sign at the end of the interval, or if the tangents of
/// e at both ends cross the threshold. If the sample interval is long relative to the shortest
/// natural period, all intervals use Taylor series.
template <int N, bool kSerial>
class Piecewise : private Exact<N> {
 public:
  explicit Piecewise(const Task& task) : Exact<N>(task, true), series_(task) {
    const int n = order(), j = task.drives;
    for (unsigned r = 0; r <= 1U << task.laws; ++r)
      tables_[r] = {this->take(n * n), this->take(n * j), this->take(n * j), this->take(n), false};
    next_u_ = this->take(j);
  }

  void run() {
    const int m = this->masses(), n = order(), laws = task().laws, inputs = task().drives;
    const double h = task().step;
    V x[kOrder], next[kOrder];
    WHEELTAP_UNROLL
    for (int i = 0; i < n; ++i) x[i] = this->c_[task().initial_slot + i] * (i < m ? 1.0 : h);
    start(x);
    const Table* table = choose();
    Output output(task());
    Watch watch(task());
    this->excite(0);
    for (std::int64_t sample = 0;; ++sample) {
      if (output.due(sample)) show(output, sample, x);
      if (sample + 1 == task().samples) break;
      for (int j = 0; j < inputs; ++j) next_u_[j] = this->u_[j];
      this->excite(sample + 1);
      WHEELTAP_UNROLL
      for (int i = 0; i < n; ++i) {
        V sum = table->constant[i];
        for (int j = 0; j < inputs; ++j)
          sum += table->gamma0[i * inputs + j] * next_u_[j] +
                 table->gamma1[i * inputs + j] * this->u_[j];
        WHEELTAP_UNROLL
        for (int k = 0; k < n; ++k) sum += table->transition[i * n + k] * x[k];
        next[i] = sum;
      }
      V switched = V{} + (task().substeps > kFewPieces ? 1.0 : 0.0);
      for (int i = 0; i < laws; ++i) {
        const Threshold& t = series_.threshold(i);
        const V sign = series_.sign(i);
        const V before = sign * level(t, x), rise = sign * rate(t, x);
        const V after = sign * level(t, next), fall = sign * rate(t, next);
        const V tangents = lanes::max(before + rise, after - fall);
        switched = after < 0.0 ? V{} + 1.0 : tangents < 0.0 ? V{} + 1.0 : switched;
      }
      if (any(switched) && step(sample, x, switched, next)) table = choose();
      WHEELTAP_UNROLL
      for (int i = 0; i < n; ++i) x[i] = next[i];
      WHEELTAP_UNROLL
      for (int i = 0; i < m; ++i) watch.check(x[i]);
      if (watch.over(sample, output)) break;
    }
    WHEELTAP_UNROLL
    for (int i = 0; i < n; ++i) watch.check_last(x[i]);
    watch.finish();
  }

 private:
  using Threshold = Series<N, kSerial>::Threshold;
  static constexpr int kOrder = Exact<N>::kOrder;
  static constexpr int M = Series<N, kSerial>::M;
  static constexpr int kFewPieces = 2;
  struct Table {
    V *transition, *gamma0, *gamma1, *constant;
    bool ready;
  };

  [[nodiscard]] WHEELTAP_INLINE int order() const { return 2 * this->masses(); }
  [[nodiscard]] WHEELTAP_INLINE const Task& task() const { return this->task_; }

  /// `level` computes side · e - threshold; `rate` computes its increase per time step.
  WHEELTAP_INLINE V level(const Threshold& t, const V* x) const {
    return t.side * (end(t.b, x) - end(t.a, x)) - t.threshold;
  }
  WHEELTAP_INLINE V rate(const Threshold& t, const V* x) const {
    return t.side * (end(t.b, x + this->masses()) - end(t.a, x + this->masses()));
  }
  WHEELTAP_INLINE static V end(int mass, const V* x) { return mass == 0 ? V{} : x[mass - 1]; }

  /// Returns the table of the exact solution in the current regime of `series_`. If lanes are in
  /// different regimes, the result combines the tables of these regimes lane by lane.
  [[gnu::noinline]] const Table* choose() {
    unsigned regime[WHEELTAP_LANES];
    bool same = true;
    for (int lane = 0; lane < WHEELTAP_LANES; ++lane) {
      regime[lane] = 0;
      for (int i = 0; i < task().laws; ++i)
        if (series_.sign(i)[lane] > 0.0) regime[lane] |= 1U << i;
      same = same && regime[lane] == regime[0];
      prepare(tables_[regime[lane]], regime[lane]);
    }
    if (same) return &tables_[regime[0]];
    const int n = order(), j = task().drives;
    Table& mixed = tables_[1U << task().laws];
    const auto weave = [&](V* Table::*field, int size) {
      for (int lane = 0; lane < WHEELTAP_LANES; ++lane) {
        const V* from = tables_[regime[lane]].*field;
        for (int i = 0; i < size; ++i) (mixed.*field)[i][lane] = from[i][lane];
      }
    };
    weave(&Table::transition, n * n);
    weave(&Table::gamma0, n * j);
    weave(&Table::gamma1, n * j);
    weave(&Table::constant, n);
    return &mixed;
  }

  void prepare(Table& table, unsigned regime) {
    if (table.ready) return;
    table.ready = true;
    this->discretise(regime);
    const int n = order(), j = task().drives;
    for (int i = 0; i < n * n; ++i) table.transition[i] = this->transition_[i];
    for (int i = 0; i < n; ++i) {
      for (int c = 0; c < j; ++c) {
        table.gamma0[i * j + c] = this->gamma0_[i * (j + 1) + c];
        table.gamma1[i * j + c] = this->gamma1_[i * (j + 1) + c];
      }
      table.constant[i] = this->gamma0_[i * (j + 1) + j] + this->gamma1_[i * (j + 1) + j];
    }
  }

  void start(const V* x) {
    V y[M], v[M];
    unpack(x, y, v);
    series_.start(y);
  }

  /// Advances the state by one sample; the lanes of `switched` use Taylor series. Returns true if
  /// the regime of any lane has changed at the end of the step.
  [[gnu::noinline]] bool step(std::int64_t sample, const V* x, V switched, V* next) {
    const int m = this->masses(), laws = task().laws;
    V y[M], v[M], now[M], then[M], before[kMaxThresholds];
    unpack(x, y, v);
    for (int i = 0; i < laws; ++i) before[i] = series_.sign(i);
    series_.excite(sample, now);
    series_.excite(sample + 1, then);
    series_.advance(y, v, now, then, switched);
    bool changed = false;
    for (int i = 0; i < laws; ++i) changed = changed || !all(before[i] + series_.sign(i));
    for (int i = 0; i < m; ++i) {
      next[i] = switched > 0.0 ? y[i + 1] : next[i];
      next[m + i] = switched > 0.0 ? v[i + 1] : next[m + i];
    }
    return changed;
  }

  WHEELTAP_INLINE void unpack(const V* x, V* y, V* v) const {
    const int m = this->masses();
    y[0] = v[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 0; i < m; ++i) {
      y[i + 1] = x[i];
      v[i + 1] = x[m + i];
    }
  }

  WHEELTAP_INLINE void show(Output& output, std::int64_t sample, const V* x) const {
    V y[M], v[M];
    unpack(x, y, v);
    series_.show(output, sample, y, v);
  }

  Series<N, kSerial> series_;
  Table tables_[(1U << kMaxThresholds) + 1];
  V* next_u_;
};

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL

// The loops of sparse_kernel.hpp. Each source file that includes this header is compiled for one
// instruction set, for a SIMD width of WHEELTAP_SPARSE_WIDTH doubles. All versions compute four
// lanes in the same way, and the compiler contracts no operations to fused multiply-adds. The
// results are therefore bitwise equal on every processor.

#include <cstring>

#include "fem/structures/modes/sparse_kernel.hpp"

namespace wheeltap::fem::detail {
namespace {

constexpr std::size_t kWide = 4;
constexpr std::size_t kParts = kWide / WHEELTAP_SPARSE_WIDTH;

using Vec = double __attribute__((vector_size(WHEELTAP_SPARSE_WIDTH * sizeof(double)), may_alias));

struct Lanes {
  Vec part[kParts];
  Lanes& operator+=(const Lanes& other) {
    for (std::size_t i = 0; i < kParts; ++i) part[i] += other.part[i];
    return *this;
  }
  Lanes& operator-=(const Lanes& other) {
    for (std::size_t i = 0; i < kParts; ++i) part[i] -= other.part[i];
    return *this;
  }
  Lanes& operator*=(const Lanes& other) {
    for (std::size_t i = 0; i < kParts; ++i) part[i] *= other.part[i];
    return *this;
  }
  Lanes& operator/=(const Lanes& other) {
    for (std::size_t i = 0; i < kParts; ++i) part[i] /= other.part[i];
    return *this;
  }
  friend Lanes operator*(Lanes a, const Lanes& b) { return a *= b; }
  friend Lanes operator/(Lanes a, const Lanes& b) { return a /= b; }
  friend Lanes operator-(Lanes a, const Lanes& b) { return a -= b; }
  [[nodiscard]] double sum() const {
    double lane[kWide];
    std::memcpy(lane, part, sizeof lane);
    return (lane[0] + lane[1]) + (lane[2] + lane[3]);
  }
};

inline Lanes load(const double* from) {
  Lanes out;
  std::memcpy(out.part, from, sizeof out.part);
  return out;
}
inline Lanes equal(double value) {
  const double lane[kWide] = {value, value, value, value};
  return load(lane);
}
inline void store(double* to, const Lanes& value) {
  std::memcpy(to, value.part, sizeof value.part);
}

/// Computes e[k W + w] -= Σ_c other_c[k W + w] l_c[w] for k < length, in the order of c.
template <std::size_t W, std::size_t G>
inline void subtract(double* e, const double* const* other, const double (*l)[W],
                     std::size_t length) {
  std::size_t k = 0;
  if constexpr (W == kWide) {
    for (; k < length; ++k) {
      Lanes sum = load(e + k * W);
      for (std::size_t c = 0; c < G; ++c) sum -= load(other[c] + k * W) * load(l[c]);
      store(e + k * W, sum);
    }
  } else {
    for (; k + kWide <= length; k += kWide) {
      Lanes sum = load(e + k);
      for (std::size_t c = 0; c < G; ++c) sum -= load(other[c] + k) * equal(l[c][0]);
      store(e + k, sum);
    }
    for (; k < length; ++k) {
      double sum = e[k];
      for (std::size_t c = 0; c < G; ++c) sum -= other[c][k] * l[c][0];
      e[k] = sum;
    }
  }
}

/// Divides the entry a (`at`) of column j by the pivot, and stores the quotient in `at` and `l`.
/// Subtracts the product of a and the quotient from the pivot of `row`.
template <std::size_t W>
inline void eliminate(double* diagonal, double* at, std::size_t j, std::size_t row, double* l) {
  for (std::size_t w = 0; w < W; ++w) {
    l[w] = at[w] / diagonal[j * W + w];
    diagonal[row * W + w] -= l[w] * at[w];
    at[w] = l[w];
  }
}

/// Eliminates the G columns of a group from all later columns. Products are subtracted from each
/// entry in ascending order of columns, so that the result does not depend on the division of the
/// columns into groups.
template <std::size_t W, std::size_t G>
void eliminate_group(const SparsePattern& pattern, const ColumnGroup& group, double* diagonal,
                     double* lower) {
  const std::size_t j = group.first, below = group.below;
  double l[G][W];
  const double* other[G];
  for (std::size_t c = 0; c < G; ++c) {
    double* at = lower + pattern.start[j + c] * W;
    for (std::size_t later = c + 1; later < G; ++later, at += W) {
      eliminate<W>(diagonal, at, j + c, j + later, l[0]);
      other[0] = at + W;
      subtract<W, 1>(lower + pattern.start[j + later] * W, other, l, G - 1 - later + below);
    }
  }
  const Run* run = group.targets;
  for (std::size_t b = 0; b < below; ++b) {
    for (std::size_t c = 0; c < G; ++c) {
      double* const at = lower + (pattern.start[j + c] + (G - 1 - c) + b) * W;
      eliminate<W>(diagonal, at, j + c, group.rows[b], l[c]);
      other[c] = at + W;
    }
    for (std::size_t left = below - 1 - b; left > 0; ++run) {
      subtract<W, G>(lower + std::size_t{run->first} * W, other, l, run->length);
      for (std::size_t c = 0; c < G; ++c) other[c] += run->length * W;
      left -= run->length;
    }
  }
}

template <std::size_t G>
struct Columns {
  static constexpr std::size_t value = G;
};

/// Calls body(group, Columns<G>) for a group of G columns.
template <class Body>
inline void with_columns(const ColumnGroup& group, Body&& body) {
  switch (group.columns) {
    case 1:
      body(group, Columns<1>());
      break;
    case 2:
      body(group, Columns<2>());
      break;
    case 3:
      body(group, Columns<3>());
      break;
    default:
      body(group, Columns<kMostColumns>());
      break;
  }
}

template <std::size_t W>
void factorise(const SparsePattern& pattern, double* diagonal, double* lower) {
  for (std::size_t i = 0; i < pattern.groups; ++i)
    with_columns(pattern.group[i], [&](const ColumnGroup& group, auto columns) {
      eliminate_group<W, decltype(columns)::value>(pattern, group, diagonal, lower);
    });
}

/// The steps of the solution of L z = b and Lᵀ x = z in the columns of a group, for one right-hand
/// side. At every vector width, the second step adds four partial sums and a remainder.
template <std::size_t G>
void forward(const SparsePattern& pattern, const ColumnGroup& group, const double* lower,
             double* x) {
  const std::size_t j = group.first;
  double by[G][1];
  const double* other[G];
  for (std::size_t c = 0; c < G; ++c) {
    const double* const at = lower + pattern.start[j + c];
    by[c][0] = x[j + c];
    for (std::size_t later = c + 1; later < G; ++later)
      x[j + later] -= at[later - c - 1] * by[c][0];
    other[c] = at + (G - 1 - c);
  }
  const Run* run = group.row_runs;
  for (std::size_t left = group.below; left > 0; ++run) {
    subtract<1, G>(x + run->first, other, by, run->length);
    for (std::size_t c = 0; c < G; ++c) other[c] += run->length;
    left -= run->length;
  }
}

template <std::size_t G>
void backward(const SparsePattern& pattern, const ColumnGroup& group, const double* lower,
              double* x) {
  const std::size_t j = group.first;
  const double* other[G];
  Lanes part[G] = {};
  double rest[G] = {};
  for (std::size_t c = 0; c < G; ++c) other[c] = lower + pattern.start[j + c] + (G - 1 - c);
  const Run* run = group.row_runs;
  for (std::size_t left = group.below; left > 0; ++run) {
    const double* const from = x + run->first;
    std::size_t k = 0;
    for (; k + kWide <= run->length; k += kWide) {
      const Lanes known = load(from + k);
      for (std::size_t c = 0; c < G; ++c) part[c] += load(other[c] + k) * known;
    }
    for (; k < run->length; ++k)
      for (std::size_t c = 0; c < G; ++c) rest[c] += other[c][k] * from[k];
    for (std::size_t c = 0; c < G; ++c) other[c] += run->length;
    left -= run->length;
  }
  for (std::size_t c = G; c-- > 0;) {
    const double* const at = lower + pattern.start[j + c];
    double sum = rest[c] + part[c].sum();
    for (std::size_t later = c + 1; later < G; ++later) sum += at[later - c - 1] * x[j + later];
    x[j + c] -= sum;
  }
}

void solve(const SparsePattern& pattern, const double* diagonal, const double* lower, double* x) {
  for (std::size_t i = 0; i < pattern.groups; ++i)
    with_columns(pattern.group[i], [&](const ColumnGroup& group, auto columns) {
      forward<decltype(columns)::value>(pattern, group, lower, x);
    });
  for (std::size_t i = 0; i < pattern.size; ++i) x[i] /= diagonal[i];
  for (std::size_t i = pattern.groups; i-- > 0;)
    with_columns(pattern.group[i], [&](const ColumnGroup& group, auto columns) {
      backward<decltype(columns)::value>(pattern, group, lower, x);
    });
}

/// Calls body(entry, row) for the entries of column j of a group.
template <class Body>
inline void each_entry(const SparsePattern& pattern, const ColumnGroup& group, std::size_t j,
                       Body&& body) {
  std::size_t entry = pattern.start[j];
  for (std::size_t row = j + 1; row < group.first + group.columns; ++row) body(entry++, row);
  for (std::size_t b = 0; b < group.below; ++b) body(entry++, std::size_t{group.rows[b]});
}

/// Solves for four right-hand sides together. `at(i)` returns the entry i of `lower` or
/// `diagonal` in each lane.
template <class Entry, class Pivot>
inline void solve_lanes(const SparsePattern& pattern, Entry&& at, Pivot&& pivot, double* x) {
  for (std::size_t i = 0; i < pattern.groups; ++i) {
    const ColumnGroup& group = pattern.group[i];
    for (std::size_t j = group.first; j < group.first + group.columns; ++j) {
      const Lanes by = load(x + j * kWide);
      each_entry(pattern, group, j, [&](std::size_t entry, std::size_t row) {
        store(x + row * kWide, load(x + row * kWide) - at(entry) * by);
      });
    }
  }
  for (std::size_t i = pattern.groups; i-- > 0;) {
    const ColumnGroup& group = pattern.group[i];
    for (std::size_t j = group.first + group.columns; j-- > group.first;) {
      Lanes sum = load(x + j * kWide) / pivot(j);
      each_entry(pattern, group, j, [&](std::size_t entry, std::size_t row) {
        sum -= at(entry) * load(x + row * kWide);
      });
      store(x + j * kWide, sum);
    }
  }
}

void solve_several4(const SparsePattern& pattern, const double* diagonal, const double* lower,
                    double* x) {
  solve_lanes(
      pattern, [&](std::size_t i) { return equal(lower[i]); },
      [&](std::size_t j) { return equal(diagonal[j]); }, x);
}

void solve4(const SparsePattern& pattern, const double* diagonal, const double* lower, double* x) {
  solve_lanes(
      pattern, [&](std::size_t i) { return load(lower + i * kWide); },
      [&](std::size_t j) { return load(diagonal + j * kWide); }, x);
}

}  // namespace

extern const SparseKernel WHEELTAP_SPARSE_KERNEL = {.name = WHEELTAP_SPARSE_NAME,
                                                    .factorise = factorise<1>,
                                                    .factorise4 = factorise<kWide>,
                                                    .solve = solve,
                                                    .solve_several4 = solve_several4,
                                                    .solve4 = solve4};

}  // namespace wheeltap::fem::detail

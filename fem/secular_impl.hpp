// The loops of secular.hpp for vectors of WHEELTAP_SECULAR_WIDTH doubles; each file that includes
// this is compiled for one instruction set. No operation depends on the width and none is
// contracted to a fused multiply-add, so every processor gives the same bits.

#include "fem/secular.hpp"

namespace wheeltap::fem::detail {
namespace {

constexpr int kWidth = WHEELTAP_SECULAR_WIDTH;

using Vec = double __attribute__((vector_size(kWidth * sizeof(double)), may_alias));
/// The same from any address.
using Unaligned =
    double __attribute__((vector_size(kWidth * sizeof(double)), aligned(8), may_alias));

/// Lanes first … first + kWidth - 1.
inline const Vec& at(const Pack& pack, int first) {
  return *reinterpret_cast<const Vec*>(pack.lane + first);
}
inline Vec& at(Pack& pack, int first) {
  return *reinterpret_cast<Vec*>(pack.lane + first);
}

inline const Unaligned& load(const double* from) {
  return *reinterpret_cast<const Unaligned*>(from);
}

/// Eight partial sums of a(j) b(j), whatever the width, then their sum in order.
inline double dot(const double* a, const double* b, int size) {
  constexpr int kParts = kLanes / kWidth;
  Vec part[kParts] = {};
  int j = 0;
  for (; j + kLanes <= size; j += kLanes)
    for (int i = 0; i < kParts; ++i) part[i] += load(a + j + i * kWidth) * load(b + j + i * kWidth);
  double sum = 0.0;
  for (; j < size; ++j) sum += a[j] * b[j];
  for (int i = 0; i < kParts; ++i)
    for (int l = 0; l < kWidth; ++l) sum += part[i][l];
  return sum;
}

/// out[t] = Σ_j weights[j] pairs[t][j] over rows first … last - 1.
inline void accumulate(const Secular& s, int lanes, const Pack* weights, int first, int last,
                       Pack* out) {
  for (int chunk = 0; chunk < s.chunks(); ++chunk) {
    const double* pair =
        s.pairs + (static_cast<std::ptrdiff_t>(chunk) * s.rows() + first) * kPairChunk;
    Vec sum0{}, sum1{}, sum2{}, sum3{}, sum4{};
    for (int j = first; j < last; ++j, pair += kPairChunk) {
      const Vec w = at(weights[j], lanes);
      sum0 += w * pair[0];
      sum1 += w * pair[1];
      sum2 += w * pair[2];
      sum3 += w * pair[3];
      sum4 += w * pair[4];
    }
    Pack* to = out + static_cast<std::ptrdiff_t>(chunk) * kPairChunk;
    at(to[0], lanes) = sum0;
    at(to[1], lanes) = sum1;
    at(to[2], lanes) = sum2;
    at(to[3], lanes) = sum3;
    at(to[4], lanes) = sum4;
  }
}

/// weights[j] = 1/(λ_j - λ), zero for the two poles left out, then T_p(x); slopes likewise dλ.
inline void weigh(const Secular& s, int lanes, const Vec& z, const int* lower_pole,
                  const SecularScratch& scratch) {
  Vec pole;
  for (int l = 0; l < kWidth; ++l) pole[l] = lower_pole[lanes + l];
  const Vec zero{};
  for (int j = 0; j < s.near; ++j) {
    const double index = j;
    const Vec inverse = 1.0 / (s.eigenvalues[j] - z);
    const Vec kept = (pole == index) | (pole == index - 1.0) ? zero : inverse;
    at(scratch.weights[j], lanes) = kept;
    at(scratch.slopes[j], lanes) = kept * kept;
  }
  if (s.terms == 0) return;
  // T_{p+1} = 2 x T_p - T_{p-1}; T_p' = p U_{p-1}.
  const double scale = 2.0 / s.cap;
  const Vec x = z * scale - 1.0;
  Vec t_last = zero + 1.0, t = x, u_last = zero, u = zero + 1.0;
  Pack* weights = scratch.weights + s.near;
  Pack* slopes = scratch.slopes + s.near;
  at(weights[0], lanes) = t_last;
  at(slopes[0], lanes) = zero;
  for (int p = 1; p < s.terms; ++p) {
    at(weights[p], lanes) = t;
    at(slopes[p], lanes) = u * (scale * p);
    const Vec t_next = 2.0 * x * t - t_last, u_next = 2.0 * x * u - u_last;
    t_last = t;
    t = t_next;
    u_last = u;
    u = u_next;
  }
}

inline void evaluate_lanes(const Secular& s, int lanes, const Pack& lambda, const int* lower_pole,
                           const SecularScratch& scratch, SecularSteps& steps) {
  const int m = s.columns;
  const Vec z = at(lambda, lanes);
  weigh(s, lanes, z, lower_pole, scratch);
  accumulate(s, lanes, scratch.weights, 0, s.rows(), scratch.matrix);
  if (s.terms > 0) accumulate(s, lanes, scratch.slopes, s.near, s.rows(), scratch.slope_matrix);

  // The two poles' columns, gathered; y = A⁻¹ c replaces them.
  Pack* y1 = scratch.forces;
  Pack* y2 = y1 + m;
  Pack* u1 = scratch.forward;
  Pack* u2 = u1 + m;
  Vec gap1, gap2;
  for (int l = 0; l < kWidth; ++l) {
    const int p = lower_pole[lanes + l];
    gap1[l] = s.eigenvalues[p] - lambda.lane[lanes + l];
    gap2[l] = s.eigenvalues[p + 1] - lambda.lane[lanes + l];
    for (int a = 0; a < m; ++a) {
      const double* c = s.c + static_cast<std::size_t>(a) * s.stride + p;
      y1[a].lane[lanes + l] = c[0];
      y2[a].lane[lanes + l] = c[1];
    }
  }

  // A = Γ⁻¹ - F, then A = L D Lᵀ in place (row a starts at a (a + 1) / 2, D inverted), and L u = c.
  const auto row = [&](int a) { return scratch.matrix + a * (a + 1) / 2; };
  const Vec zero{};
  Vec h11 = gap1, h12 = zero, h22 = gap2, negative = zero;
  for (int a = 0; a < m; ++a) {
    Pack* ra = row(a);
    Vec pivot = s.inverse_gamma[a] - at(ra[a], lanes);
    Vec c1 = at(y1[a], lanes), c2 = at(y2[a], lanes);
    for (int b = 0; b < a; ++b) {
      const Pack* rb = row(b);
      Vec entry = -at(ra[b], lanes);
      for (int c = 0; c < b; ++c) entry -= at(ra[c], lanes) * at(rb[c], lanes);
      at(ra[b], lanes) = entry;  // still scaled by D
    }
    for (int b = 0; b < a; ++b) {
      const Vec scaled = at(ra[b], lanes);
      const Vec l = scaled * at(row(b)[b], lanes);
      pivot -= scaled * l;
      at(ra[b], lanes) = l;
      c1 -= l * at(u1[b], lanes);
      c2 -= l * at(u2[b], lanes);
    }
    const Vec inverse = 1.0 / pivot;
    at(ra[a], lanes) = inverse;
    at(u1[a], lanes) = c1;
    at(u2[a], lanes) = c2;
    negative += pivot < zero ? zero + 1.0 : zero;
    h11 -= c1 * c1 * inverse;
    h12 -= c1 * c2 * inverse;
    h22 -= c2 * c2 * inverse;
  }
  for (int a = m; a-- > 0;) {
    const Vec inverse = at(row(a)[a], lanes);
    Vec first = at(u1[a], lanes) * inverse, second = at(u2[a], lanes) * inverse;
    for (int b = a + 1; b < m; ++b) {
      const Vec l = at(row(b)[a], lanes);
      first -= l * at(y1[b], lanes);
      second -= l * at(y2[b], lanes);
    }
    at(y1[a], lanes) = first;
    at(y2[a], lanes) = second;
  }

  // N = I + Yᵀ F' Y.
  Vec n11 = zero + 1.0, n12 = zero, n22 = zero + 1.0;
  for (int j = 0; j < s.near; ++j) {
    Vec first = zero, second = zero;
    for (int a = 0; a < m; ++a) {
      const double c = s.c[static_cast<std::size_t>(a) * s.stride + static_cast<std::size_t>(j)];
      first += c * at(y1[a], lanes);
      second += c * at(y2[a], lanes);
    }
    const Vec slope = at(scratch.slopes[j], lanes);
    n11 += slope * first * first;
    n12 += slope * first * second;
    n22 += slope * second * second;
  }
  if (s.terms > 0)
    for (int a = 0, t = 0; a < m; ++a) {
      Vec first = zero, second = zero;  // Σ_{b<a} F'_ab y_b
      for (int b = 0; b < a; ++b, ++t) {
        const Vec f = at(scratch.slope_matrix[t], lanes);
        first += f * at(y1[b], lanes);
        second += f * at(y2[b], lanes);
      }
      const Vec f = at(scratch.slope_matrix[t++], lanes);
      const Vec a1 = at(y1[a], lanes), a2 = at(y2[a], lanes);
      n11 += a1 * (2.0 * first + f * a1);
      n12 += a1 * (second + f * a2) + a2 * first;
      n22 += a2 * (2.0 * second + f * a2);
    }

  // Both d of H v = d N v, through N's Cholesky factor; the smaller one as determinant / larger, so
  // that it keeps its relative accuracy at convergence.
  const Vec r = n12 / n11;
  const Vec rest = n22 - n12 * r;
  const Vec b21 = h12 - r * h11, b22 = h22 - 2.0 * r * h12 + r * r * h11;
  const Vec g11 = h11 / n11, g22 = b22 / rest, g12_squared = b21 * b21 / (n11 * rest);
  const Vec mean = 0.5 * (g11 + g22), half = 0.5 * (g11 - g22);
  Vec root = half * half + g12_squared;
  for (int l = 0; l < kWidth; ++l) root[l] = __builtin_sqrt(root[l]);
  const Vec large = mean < zero ? mean - root : mean + root;
  const Vec determinant = g11 * g22 - g12_squared;
  const Vec small = large == zero ? zero : determinant / large;
  at(steps.low, lanes) = mean < zero ? large : small;
  at(steps.high, lanes) = mean < zero ? small : large;
  at(steps.negative, lanes) = negative;
  at(steps.h11, lanes) = h11;
  at(steps.h12, lanes) = h12;
  at(steps.h22, lanes) = h22;
  at(steps.n11, lanes) = n11;
  at(steps.n12, lanes) = n12;
  at(steps.n22, lanes) = n22;
}

void evaluate(const Secular& s, const Pack& lambda, const int (&lower_pole)[kLanes],
              const SecularScratch& scratch, SecularSteps& steps) {
  for (int lanes = 0; lanes < kLanes; lanes += kWidth)
    evaluate_lanes(s, lanes, lambda, lower_pole, scratch, steps);
}

void fill_pairs(const Secular& s, int modes, const double* series, const int* series_end,
                double* product, double* pairs) {
  const std::ptrdiff_t rows = s.rows();
  const int far = modes - s.near;
  int t = 0;
  for (int a = 0; a < s.columns; ++a)
    for (int b = 0; b <= a; ++b, ++t) {
      const double* ca = s.c + static_cast<std::size_t>(a) * s.stride;
      const double* cb = s.c + static_cast<std::size_t>(b) * s.stride;
      double* to = pairs + (t / kPairChunk) * rows * kPairChunk + t % kPairChunk;
      for (int j = 0; j < s.near; ++j) to[j * kPairChunk] = ca[j] * cb[j];
      to += static_cast<std::ptrdiff_t>(s.near) * kPairChunk;
      for (int j = 0; j < far; ++j) product[j] = ca[s.near + j] * cb[s.near + j];
      for (int p = 0; p < s.terms; ++p)
        to[p * kPairChunk] =
            dot(product, series + static_cast<std::ptrdiff_t>(p) * far, series_end[p]);
    }
  for (; t < s.chunks() * kPairChunk; ++t) {  // unused entries of the last chunk
    double* to = pairs + (t / kPairChunk) * rows * kPairChunk + t % kPairChunk;
    for (std::ptrdiff_t j = 0; j < rows; ++j) to[j * kPairChunk] = 0.0;
  }
}

void coordinates(const Secular& s, int modes, const double* eta, double lambda, int pole,
                 double* out) {
  for (int j = 0; j < modes; ++j) out[j] = 0.0;
  for (int a = 0; a < s.columns; ++a) {
    const double* c = s.c + static_cast<std::size_t>(a) * s.stride;
    for (int j = 0; j < modes; ++j) out[j] += eta[a] * c[j];
  }
  for (int j = 0; j < modes; ++j)
    if (j != pole && j != pole + 1) out[j] /= s.eigenvalues[j] - lambda;
}

void project(const double* rows, int count, std::size_t stride, const double* x, int size,
             double* out) {
  for (int r = 0; r < count; ++r)
    out[r] = dot(rows + static_cast<std::size_t>(r) * stride, x, size);
}

}  // namespace

extern const SecularKernel WHEELTAP_SECULAR_KERNEL = {.name = WHEELTAP_SECULAR_NAME,
                                                      .evaluate = evaluate,
                                                      .fill_pairs = fill_pairs,
                                                      .coordinates = coordinates,
                                                      .project = project};

}  // namespace wheeltap::fem::detail

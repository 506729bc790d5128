#include "fem/secular.hpp"

#include <algorithm>

// A portable build still uses the processor it runs on. Sanitizers cannot run under the resolver
// that this needs, and -march=native makes it pointless.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__AVX2__) && \
    !defined(WHEELTAP_SANITIZED)
#define WHEELTAP_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), flatten))
#else
#define WHEELTAP_CLONES
#endif

namespace wheeltap::fem::detail {
namespace {

/// A Pack as the compiler's vector type; wider than the machine's registers it is split.
using Vec = double __attribute__((vector_size(sizeof(Pack)), may_alias));

/// The same from any address.
using Unaligned = double __attribute__((vector_size(sizeof(Pack)), aligned(8), may_alias));

#define WHEELTAP_INLINE inline __attribute__((always_inline))

WHEELTAP_INLINE const Vec& vec(const Pack& pack) {
  return reinterpret_cast<const Vec&>(pack);
}
WHEELTAP_INLINE const Unaligned& load(const double* from) {
  return *reinterpret_cast<const Unaligned*>(from);
}
WHEELTAP_INLINE Vec& vec(Pack& pack) {
  return reinterpret_cast<Vec&>(pack);
}

/// out[t] = Σ_j weights[j] pairs[t][j] over rows first … last - 1.
WHEELTAP_INLINE void accumulate(const Secular& s, const Pack* weights, int first, int last,
                                Pack* out) {
  const int rows = s.near + s.terms;
  for (int chunk = 0; chunk < s.chunks(); ++chunk) {
    const double* pair = s.pairs + (static_cast<std::ptrdiff_t>(chunk) * rows + first) * kPairChunk;
    Vec sum0{}, sum1{}, sum2{}, sum3{}, sum4{};
    for (int j = first; j < last; ++j, pair += kPairChunk) {
      const Vec w = vec(weights[j]);
      sum0 += w * pair[0];
      sum1 += w * pair[1];
      sum2 += w * pair[2];
      sum3 += w * pair[3];
      sum4 += w * pair[4];
    }
    Pack* to = out + chunk * kPairChunk;
    vec(to[0]) = sum0;
    vec(to[1]) = sum1;
    vec(to[2]) = sum2;
    vec(to[3]) = sum3;
    vec(to[4]) = sum4;
  }
}

/// weights[j] = 1/(λ_j - λ), zero for the two poles left out, then T_p(x); slopes likewise dλ.
WHEELTAP_INLINE void weigh(const Secular& s, const Pack& lambda, const int (&lower_pole)[kLanes],
                           SecularScratch& scratch) {
  const Vec z = vec(lambda);
  Pack pole_pack;
  for (int l = 0; l < kLanes; ++l) pole_pack.lane[l] = lower_pole[l];
  const Vec pole = vec(pole_pack);
  const Vec zero{};
  for (int j = 0; j < s.near; ++j) {
    const double index = j;
    const Vec inverse = 1.0 / (s.eigenvalues[j] - z);
    const Vec kept = (pole == index) | (pole == index - 1.0) ? zero : inverse;
    vec(scratch.weights[static_cast<std::size_t>(j)]) = kept;
    vec(scratch.slopes[static_cast<std::size_t>(j)]) = kept * kept;
  }
  if (s.terms == 0) return;
  // T_{p+1} = 2 x T_p - T_{p-1}; T_p' = p U_{p-1}.
  const double scale = 2.0 / s.cap;
  const Vec x = z * scale - 1.0;
  Vec t_last = zero + 1.0, t = x, u_last = zero, u = zero + 1.0;
  Pack* weights = scratch.weights.data() + s.near;
  Pack* slopes = scratch.slopes.data() + s.near;
  vec(weights[0]) = t_last;
  vec(slopes[0]) = zero;
  for (int p = 1; p < s.terms; ++p) {
    vec(weights[p]) = t;
    vec(slopes[p]) = u * (scale * p);
    const Vec t_next = 2.0 * x * t - t_last, u_next = 2.0 * x * u - u_last;
    t_last = t;
    t = t_next;
    u_last = u;
    u = u_next;
  }
}

}  // namespace

void SecularScratch::reserve(int columns, int rows) {
  const auto m = static_cast<std::size_t>(columns);
  const std::size_t pairs = m * (m + 1) / 2 + kPairChunk;
  const auto grow = [](std::vector<Pack>& v, std::size_t n) {
    if (v.size() < n) v.resize(n);
  };
  grow(weights, static_cast<std::size_t>(rows));
  grow(slopes, static_cast<std::size_t>(rows));
  grow(matrix, pairs);
  grow(slope_matrix, pairs);
  grow(poles, 2 * m);
  grow(forward, 2 * m);
}

WHEELTAP_CLONES
void evaluate(const Secular& s, const Pack& lambda, const int (&lower_pole)[kLanes],
              SecularScratch& scratch, SecularSteps& steps) {
  const int m = s.columns;
  weigh(s, lambda, lower_pole, scratch);
  accumulate(s, scratch.weights.data(), 0, s.near + s.terms, scratch.matrix.data());
  if (s.terms > 0)
    accumulate(s, scratch.slopes.data(), s.near, s.near + s.terms, scratch.slope_matrix.data());

  // The two poles' columns, gathered; y = A⁻¹ c replaces them.
  Pack* y1 = scratch.poles.data();
  Pack* y2 = y1 + m;
  Pack* u1 = scratch.forward.data();
  Pack* u2 = u1 + m;
  Pack gap1, gap2;
  for (int l = 0; l < kLanes; ++l) {
    const int p = lower_pole[l];
    gap1.lane[l] = s.eigenvalues[p] - lambda.lane[l];
    gap2.lane[l] = s.eigenvalues[p + 1] - lambda.lane[l];
    for (int a = 0; a < m; ++a) {
      const double* c = s.c + static_cast<std::size_t>(a) * s.stride + p;
      y1[a].lane[l] = c[0];
      y2[a].lane[l] = c[1];
    }
  }

  // A = Γ⁻¹ - F, then A = L D Lᵀ in place (row a starts at a (a + 1) / 2), and L u = c.
  const auto row = [&](int a) { return scratch.matrix.data() + a * (a + 1) / 2; };
  const Vec zero{};
  Vec h11 = vec(gap1), h12 = zero, h22 = vec(gap2), negative = zero;
  for (int a = 0; a < m; ++a) {
    Pack* ra = row(a);
    Vec pivot = s.inverse_gamma[a] - vec(ra[a]);
    Vec c1 = vec(y1[a]), c2 = vec(y2[a]);
    for (int b = 0; b < a; ++b) {
      Vec entry = -vec(ra[b]);
      const Pack* rb = row(b);
      for (int c = 0; c < b; ++c) entry -= vec(ra[c]) * vec(rb[c]);  // still scaled by D
      vec(ra[b]) = entry;
    }
    for (int b = 0; b < a; ++b) {
      const Vec scaled = vec(ra[b]);
      const Vec l = scaled * vec(row(b)[b]);  // D is stored inverted
      pivot -= scaled * l;
      vec(ra[b]) = l;
      c1 -= l * vec(u1[b]);
      c2 -= l * vec(u2[b]);
    }
    const Vec inverse = 1.0 / pivot;
    vec(ra[a]) = inverse;
    vec(u1[a]) = c1;
    vec(u2[a]) = c2;
    negative += pivot < zero ? zero + 1.0 : zero;
    h11 -= c1 * c1 * inverse;
    h12 -= c1 * c2 * inverse;
    h22 -= c2 * c2 * inverse;
  }
  for (int a = m; a-- > 0;) {
    Vec first = vec(u1[a]) * vec(row(a)[a]), second = vec(u2[a]) * vec(row(a)[a]);
    for (int b = a + 1; b < m; ++b) {
      const Vec l = vec(row(b)[a]);
      first -= l * vec(y1[b]);
      second -= l * vec(y2[b]);
    }
    vec(y1[a]) = first;
    vec(y2[a]) = second;
  }

  // N = I + Yᵀ F' Y.
  Vec n11 = zero + 1.0, n12 = zero, n22 = zero + 1.0;
  for (int j = 0; j < s.near; ++j) {
    Vec first = zero, second = zero;
    for (int a = 0; a < m; ++a) {
      const double c = s.c[static_cast<std::size_t>(a) * s.stride + static_cast<std::size_t>(j)];
      first += c * vec(y1[a]);
      second += c * vec(y2[a]);
    }
    const Vec slope = vec(scratch.slopes[static_cast<std::size_t>(j)]);
    n11 += slope * first * first;
    n12 += slope * first * second;
    n22 += slope * second * second;
  }
  if (s.terms > 0)
    for (int a = 0, t = 0; a < m; ++a) {
      Vec first = zero, second = zero;  // Σ_{b<a} F'_ab y_b
      for (int b = 0; b < a; ++b, ++t) {
        const Vec f = vec(scratch.slope_matrix[static_cast<std::size_t>(t)]);
        first += f * vec(y1[b]);
        second += f * vec(y2[b]);
      }
      const Vec f = vec(scratch.slope_matrix[static_cast<std::size_t>(t++)]);
      const Vec a1 = vec(y1[a]), a2 = vec(y2[a]);
      n11 += a1 * (2.0 * first + f * a1);
      n12 += a1 * (second + f * a2) + a2 * first;
      n22 += a2 * (2.0 * second + f * a2);
    }

  // Both d of H v = d N v, through N's Cholesky factor; the smaller one as determinant / larger, so
  // that it keeps its relative accuracy at convergence.
  const Vec r = n12 / n11;
  const Vec g22_scale = n22 - n12 * r;
  const Vec b11 = h11, b21 = h12 - r * h11, b22 = h22 - 2.0 * r * h12 + r * r * h11;
  // Eigenvalues of [[b11/n11, b21/√(n11 g)], [·, b22/g]].
  const Vec g11 = b11 / n11, g22 = b22 / g22_scale, g12_squared = b21 * b21 / (n11 * g22_scale);
  const Vec mean = 0.5 * (g11 + g22), half = 0.5 * (g11 - g22);
  const Vec square = half * half + g12_squared;
  Pack root_pack;
  for (int l = 0; l < kLanes; ++l) root_pack.lane[l] = __builtin_sqrt(square[l]);
  const Vec root = vec(root_pack);
  const Vec large = mean < zero ? mean - root : mean + root;
  const Vec determinant = g11 * g22 - g12_squared;
  const Vec small = large == zero ? zero : determinant / large;
  vec(steps.low) = mean < zero ? large : small;
  vec(steps.high) = mean < zero ? small : large;
  vec(steps.negative) = negative;
  vec(steps.h11) = h11;
  vec(steps.h12) = h12;
  vec(steps.h22) = h22;
  vec(steps.n11) = n11;
  vec(steps.n12) = n12;
  vec(steps.n22) = n22;
}

WHEELTAP_CLONES
void coordinates(const Secular& s, int modes, const double* eta, double lambda, int pole,
                 double* out) {
  for (int j = 0; j < modes; ++j) out[j] = 0.0;
  for (int a = 0; a < s.columns; ++a) {
    const double* c = s.c + static_cast<std::size_t>(a) * s.stride;
    for (int j = 0; j < modes; ++j) out[j] += eta[a] * c[j];
  }
  const double at_poles[2] = {out[pole], out[pole + 1]};
  for (int j = 0; j < modes; ++j) out[j] /= s.eigenvalues[j] - lambda;
  out[pole] = at_poles[0];
  out[pole + 1] = at_poles[1];
}

WHEELTAP_CLONES
void project(const double* rows, int count, std::size_t stride, const double* x, int size,
             double* out) {
  for (int r = 0; r < count; ++r) {
    const double* row = rows + static_cast<std::size_t>(r) * stride;
    Vec sum0{}, sum1{};
    int j = 0;
    for (; j + 2 * kLanes <= size; j += 2 * kLanes) {
      sum0 += load(row + j) * load(x + j);
      sum1 += load(row + j + kLanes) * load(x + j + kLanes);
    }
    sum0 += sum1;
    double total = 0.0;
    for (; j < size; ++j) total += row[j] * x[j];
    for (int l = 0; l < kLanes; ++l) total += sum0[l];
    out[r] = total;
  }
}

WHEELTAP_CLONES
void fill_pairs(const Secular& s, int modes, const double* series, const int* series_end,
                double* product, double* pairs) {
  const std::ptrdiff_t rows = s.near + s.terms;
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
      for (int p = 0; p < s.terms; ++p) {
        const double* weight = series + static_cast<std::ptrdiff_t>(p) * far;
        Vec sum{};
        const int end = series_end[p];
        int j = 0;
        for (; j + kLanes <= end; j += kLanes) sum += load(product + j) * load(weight + j);
        double total = 0.0;
        for (; j < end; ++j) total += product[j] * weight[j];
        for (int l = 0; l < kLanes; ++l) total += sum[l];
        to[p * kPairChunk] = total;
      }
    }
  for (; t < s.chunks() * kPairChunk; ++t) {  // unused entries of the last chunk
    double* to = pairs + (t / kPairChunk) * rows * kPairChunk + t % kPairChunk;
    for (std::ptrdiff_t j = 0; j < rows; ++j) to[j * kPairChunk] = 0.0;
  }
}

}  // namespace wheeltap::fem::detail

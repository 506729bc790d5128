// The loops of secular.hpp for vectors of WHEELTAP_SECULAR_WIDTH doubles. Each source file that
// includes this header is compiled for one instruction set. No operation depends on the vector
// width, and the compiler contracts no operations to fused multiply-adds. The results are therefore
// bitwise equal on every processor.

#include <cstring>

#include "fem/secular.hpp"

namespace wheeltap::fem::detail {
namespace {

constexpr int kWidth = WHEELTAP_SECULAR_WIDTH;

using Vec = double __attribute__((vector_size(kWidth * sizeof(double)), may_alias));

/// Returns lanes first … first + kWidth - 1 of a pack.
inline const Vec& at(const Pack& pack, int first) {
  return *reinterpret_cast<const Vec*>(pack.lane + first);
}
inline Vec& at(Pack& pack, int first) {
  return *reinterpret_cast<Vec*>(pack.lane + first);
}

/// Loads kWidth numbers from an address of any alignment.
inline Vec load(const double* from) {
  Vec out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

/// Computes Σ_j a[j] b[j] as eight partial sums, whose order of operations does not depend on the
/// vector width. Then adds the partial sums in order.
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

/// Computes out[t] = Σ_j weights[j] pairs[t][j] over rows first … last - 1.
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

/// Computes weights[j] = κ_j, with zero for the two excluded poles, then λ T_p(x). Also computes
/// the slopes that SecularScratch describes.
inline void weigh(const Secular& s, int lanes, const Vec& z, const int* lower_pole,
                  const SecularScratch& scratch) {
  Vec pole{};
  for (int l = 0; l < kWidth; ++l) pole[l] = lower_pole[lanes + l];
  const Vec zero{};
  for (int j = 0; j < s.near; ++j) {
    const double index = j;
    const Vec inverse = 1.0 / (s.eigenvalues[j] - z);
    const Vec kept = (pole == index) | (pole == index - 1.0) ? zero : inverse;
    at(scratch.weights[j], lanes) = kept * (z + (s.scales[j] - s.eigenvalues[j]));
    at(scratch.slopes[j], lanes) = kept * kept;
  }
  for (int j = 0; j < s.negative; ++j) {
    at(scratch.weights[j], lanes) = -at(scratch.weights[j], lanes);
    at(scratch.slopes[j], lanes) = -at(scratch.slopes[j], lanes);
  }
  if (s.terms == 0) return;
  // T_{p+1} = 2 x T_p - T_{p-1}; T_p' = p U_{p-1}.
  const double scale = 2.0 / s.cap;
  const Vec x = z * scale - 1.0;
  Vec t_last = zero + 1.0, t = x, u_last = zero, u = zero + 1.0;
  Pack* weights = scratch.weights + s.near;
  Pack* slopes = scratch.slopes + s.near;
  at(weights[0], lanes) = z;
  at(slopes[0], lanes) = t_last;
  for (int p = 1; p < s.terms; ++p) {
    at(weights[p], lanes) = z * t;
    at(slopes[p], lanes) = t + z * u * (scale * p);
    const Vec t_next = 2.0 * x * t - t_last, u_next = 2.0 * x * u - u_last;
    t_last = t;
    t = t_next;
    u_last = u;
    u = u_next;
  }
}

/// The 2 × 2 matrices H and N, and B, the contribution to N of the modes other than the two poles.
struct Small {
  Vec h11, h12, h22, n11, n12, n22, b11, b12, b22;
  Vec root1, root2;    // √s of the poles
  Vec above1, above2;  // s_p - λ_p + λ
};

/// Computes the values of SecularSteps for the mode shape of one solution δ.
inline void shape(const Small& k, const Vec& delta, double residual_factor, bool low, Pack& step,
                  Pack& residual, Pack& v1, Pack& v2, Pack& a1, Pack& a2, int lanes) {
  const Vec zero{};
  const Vec r11 = k.h11 - delta * k.n11, r12 = k.h12 - delta * k.n12, r22 = k.h22 - delta * k.n22;
  const Vec m11 = r11 < zero ? -r11 : r11, m22 = r22 < zero ? -r22 : r22;
  Vec x = m11 < m22 ? r22 : -r12, y = m11 < m22 ? -r12 : r11;
  // At a double root, any two N-orthogonal vectors are valid.
  const auto none = (x == zero) & (y == zero);
  x = none ? (low ? zero + 1.0 : -k.n12) : x;
  y = none ? (low ? zero : k.n11) : y;
  const Vec hv1 = k.h11 * x + k.h12 * y, hv2 = k.h12 * x + k.h22 * y;
  const Vec g1 = k.above1 * hv1 / k.root1, g2 = k.above2 * hv2 / k.root2;
  const Vec p1 = k.root1 * x / k.above1 - hv1 / k.root1,
            p2 = k.root2 * y / k.above2 - hv2 / k.root2;
  const Vec inverse =
      1.0 / (p1 * p1 + p2 * p2 + (k.b11 * x * x + 2.0 * (k.b12 * x * y) + k.b22 * y * y));
  const Vec gain = (p1 * g1 + p2 * g2) * inverse;
  const Vec rest = (g1 * g1 + g2 * g2) * inverse * residual_factor - gain * gain;
  Vec size = inverse;
  for (int l = 0; l < kWidth; ++l) size[l] = __builtin_sqrt(size[l]);
  at(step, lanes) = gain;
  at(residual, lanes) = rest < zero ? zero : rest;
  at(v1, lanes) = x * size;
  at(v2, lanes) = y * size;
  at(a1, lanes) = p1 * size;
  at(a2, lanes) = p2 * size;
}

/// Returns row a of the lower triangle that contains A and, after the factorisation, its factors.
inline Pack* row_of(const SecularScratch& scratch, int a) {
  return scratch.matrix + a * (a + 1) / 2;
}

/// Gathers the columns e of the two poles into `forces`, and initialises H with the contribution of
/// the two poles.
inline void gather_poles(const Secular& s, int lanes, const Pack& lambda, const int* lower_pole,
                         const SecularScratch& scratch, Small& k) {
  const int m = s.columns;
  Pack* y1 = scratch.forces;
  Pack* y2 = y1 + m;
  Vec gap1, gap2;
  for (int l = 0; l < kWidth; ++l) {
    const int p = lower_pole[lanes + l];
    const double here = lambda.lane[lanes + l];
    gap1[l] = s.eigenvalues[p] - here;
    gap2[l] = s.eigenvalues[p + 1] - here;
    k.above1[l] = s.scales[p] - s.eigenvalues[p] + here;
    k.above2[l] = s.scales[p + 1] - s.eigenvalues[p + 1] + here;
    const double root1 = __builtin_sqrt(s.scales[p]), root2 = __builtin_sqrt(s.scales[p + 1]);
    k.root1[l] = root1;
    k.root2[l] = root2;
    const double inverse1 = 1.0 / root1, inverse2 = 1.0 / root2;
    for (int a = 0; a < m; ++a) {
      const double* c = s.c + static_cast<std::size_t>(a) * s.stride + p;
      y1[a].lane[lanes + l] = c[0] * inverse1;
      y2[a].lane[lanes + l] = c[1] * inverse2;
    }
  }
  k.h11 = gap1 / k.above1;
  k.h12 = Vec{};
  k.h22 = gap2 / k.above2;
}

/// Computes A = J - Σ κ e eᵀ, then the factors A = L D Lᵀ in place (with D⁻¹ stored), the solutions
/// u of L u = e, and H. Sums are kept in local variables because stores to `scratch` could alias k.
inline void factor_matrix(const Secular& s, int lanes, const SecularScratch& scratch, Small& k,
                          SecularSteps& steps) {
  const int m = s.columns;
  const Pack* y1 = scratch.forces;
  const Pack* y2 = y1 + m;
  Pack* u1 = scratch.forward;
  Pack* u2 = u1 + m;
  const Vec zero{};
  Vec h11 = k.h11, h12 = k.h12, h22 = k.h22;
  Vec negative = zero, smallest = zero + 1.0;
  for (int a = 0; a < m; ++a) {
    Pack* ra = row_of(scratch, a);
    const Vec diagonal = (a < s.supports ? -1.0 : 1.0) - at(ra[a], lanes);
    Vec pivot = diagonal;
    Vec c1 = at(y1[a], lanes), c2 = at(y2[a], lanes);
    for (int b = 0; b < a; ++b) {
      const Pack* rb = row_of(scratch, b);
      Vec entry = -at(ra[b], lanes);
      for (int c = 0; c < b; ++c) entry -= at(ra[c], lanes) * at(rb[c], lanes);
      at(ra[b], lanes) = entry;  // the entry is still scaled by D
    }
    for (int b = 0; b < a; ++b) {
      const Vec scaled = at(ra[b], lanes);
      const Vec l = scaled * at(row_of(scratch, b)[b], lanes);
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
    const Vec size = diagonal < zero ? 1.0 - diagonal : 1.0 + diagonal;
    const Vec left = (pivot < zero ? -pivot : pivot) / size;
    smallest = left < smallest ? left : smallest;
    h11 -= c1 * c1 * inverse;
    h12 -= c1 * c2 * inverse;
    h22 -= c2 * c2 * inverse;
  }
  k.h11 = h11;
  k.h12 = h12;
  k.h22 = h22;
  at(steps.negative, lanes) = negative;
  at(steps.smallest_pivot, lanes) = smallest;
}

/// Computes y = A⁻¹ e from D and u; y replaces e in `forces`.
inline void substitute_back(int m, int lanes, const SecularScratch& scratch) {
  Pack* y1 = scratch.forces;
  Pack* y2 = y1 + m;
  const Pack* u1 = scratch.forward;
  const Pack* u2 = u1 + m;
  for (int a = m; a-- > 0;) {
    const Vec inverse = at(row_of(scratch, a)[a], lanes);
    Vec first = at(u1[a], lanes) * inverse, second = at(u2[a], lanes) * inverse;
    for (int b = a + 1; b < m; ++b) {
      const Vec l = at(row_of(scratch, b)[a], lanes);
      first -= l * at(y1[b], lanes);
      second -= l * at(y2[b], lanes);
    }
    at(y1[a], lanes) = first;
    at(y2[a], lanes) = second;
  }
}

/// Computes B = -Yᵀ A' Y and N.
inline void differentiate(const Secular& s, int lanes, const SecularScratch& scratch, Small& k) {
  const int m = s.columns;
  const Pack* y1 = scratch.forces;
  const Pack* y2 = y1 + m;
  const Vec zero{};
  Vec b11 = zero, b12 = zero, b22 = zero;
  Vec m11 = zero, m12 = zero, m22 = zero;  // contribution to B of modes with negative sign
  for (int j = 0; j < s.near; ++j) {
    Vec first = zero, second = zero;
    for (int a = 0; a < m; ++a) {
      const double c = s.c[static_cast<std::size_t>(a) * s.stride + static_cast<std::size_t>(j)];
      first += c * at(y1[a], lanes);
      second += c * at(y2[a], lanes);
    }
    const Vec slope = at(scratch.slopes[j], lanes);
    b11 += slope * first * first;
    b12 += slope * first * second;
    b22 += slope * second * second;
    if (j >= s.negative) continue;
    m11 -= slope * first * first;
    m12 -= slope * first * second;
    m22 -= slope * second * second;
  }
  if (s.terms > 0)
    for (int a = 0, t = 0; a < m; ++a) {
      Vec first = zero, second = zero;  // Σ_{b<a} A'_ab y_b
      for (int b = 0; b < a; ++b, ++t) {
        const Vec f = at(scratch.slope_matrix[t], lanes);
        first += f * at(y1[b], lanes);
        second += f * at(y2[b], lanes);
      }
      const Vec f = at(scratch.slope_matrix[t++], lanes);
      const Vec a1 = at(y1[a], lanes), a2 = at(y2[a], lanes);
      b11 += a1 * (2.0 * first + f * a1);
      b12 += a1 * (second + f * a2) + a2 * first;
      b22 += a2 * (2.0 * second + f * a2);
    }
  k.b11 = b11;
  k.b12 = b12;
  k.b22 = b22;
  const Vec per1 = k.root1 / k.above1, per2 = k.root2 / k.above2;
  // N must be positive definite so that the values δ have the signs of the eigenvalues of H. At a
  // root, any positive definite N gives the correct v.
  k.n11 = per1 * per1 + (k.b11 + 2.0 * m11);
  k.n12 = k.b12 + 2.0 * m12;
  k.n22 = per2 * per2 + (k.b22 + 2.0 * m22);
}

/// Computes both generalised eigenvalues δ of H v = δ N v with the Cholesky factor of N. The
/// eigenvalue with the smaller magnitude is the determinant divided by the other eigenvalue. The
/// smaller eigenvalue therefore keeps its relative accuracy as it converges to zero.
inline void both_roots(const Small& k, Vec& low, Vec& high) {
  const Vec zero{};
  const Vec r = k.n12 / k.n11;
  const Vec rest = k.n22 - k.n12 * r;
  const Vec b21 = k.h12 - r * k.h11, b22 = k.h22 - 2.0 * r * k.h12 + r * r * k.h11;
  const Vec g11 = k.h11 / k.n11, g22 = b22 / rest, g12_squared = b21 * b21 / (k.n11 * rest);
  const Vec mean = 0.5 * (g11 + g22), half = 0.5 * (g11 - g22);
  Vec root = half * half + g12_squared;
  for (int l = 0; l < kWidth; ++l) root[l] = __builtin_sqrt(root[l]);
  const Vec large = mean < zero ? mean - root : mean + root;
  const Vec determinant = g11 * g22 - g12_squared;
  const Vec small = large == zero ? zero : determinant / large;
  low = mean < zero ? large : small;
  high = mean < zero ? small : large;
}

inline void evaluate_lanes(const Secular& s, int lanes, const Pack& lambda, const int* lower_pole,
                           const SecularScratch& scratch, SecularSteps& steps) {
  const Vec z = at(lambda, lanes);
  weigh(s, lanes, z, lower_pole, scratch);
  accumulate(s, lanes, scratch.weights, 0, s.rows(), scratch.matrix);
  if (s.terms > 0) accumulate(s, lanes, scratch.slopes, s.near, s.rows(), scratch.slope_matrix);
  Small k;
  gather_poles(s, lanes, lambda, lower_pole, scratch, k);
  factor_matrix(s, lanes, scratch, k, steps);
  substitute_back(s.columns, lanes, scratch);
  differentiate(s, lanes, scratch, k);
  Vec low, high;
  both_roots(k, low, high);
  at(steps.low, lanes) = low;
  at(steps.high, lanes) = high;
  shape(k, low, s.residual_factor, true, steps.low_step, steps.low_residual, steps.low_v1,
        steps.low_v2, steps.low_a1, steps.low_a2, lanes);
  shape(k, high, s.residual_factor, false, steps.high_step, steps.high_residual, steps.high_v1,
        steps.high_v2, steps.high_a1, steps.high_a2, lanes);
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
      for (int j = 0; j < s.near; ++j) to[j * kPairChunk] = ca[j] * cb[j] / s.scales[j];
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

void subtract(double* to, const double* from, double factor, int size) {
  for (int j = 0; j < size; ++j) to[j] -= factor * from[j];
}

/// Computes Σ_j a[j] b[j] w[j] with the same partial sums as `dot`.
double weighted_dot(const double* a, const double* b, const double* w, int size) {
  constexpr int kParts = kLanes / kWidth;
  Vec part[kParts] = {};
  int j = 0;
  for (; j + kLanes <= size; j += kLanes)
    for (int i = 0; i < kParts; ++i)
      part[i] += load(a + j + i * kWidth) * load(b + j + i * kWidth) * load(w + j + i * kWidth);
  double sum = 0.0;
  for (; j < size; ++j) sum += a[j] * b[j] * w[j];
  for (int i = 0; i < kParts; ++i)
    for (int l = 0; l < kWidth; ++l) sum += part[i][l];
  return sum;
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
                                                      .subtract = subtract,
                                                      .weighted_dot = weighted_dot,
                                                      .project = project};

}  // namespace wheeltap::fem::detail

#include "identification/planning/normal_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <numbers>

#include "base/constants.hpp"
#include "base/lanes.hpp"
#include "base/vector_clones.hpp"

namespace wheeltap::identification::planning {
namespace {

/// The quadrature ends where the exponent is 4.5²/2 below its largest value.
constexpr double kReach = 4.5;
/// A normal density is inside an interval if both ends are this many standard deviations away.
constexpr double kInside = 5.0;

/// Nodes and weights of Gauss and Legendre on [-1, 1], 12 nodes.
constexpr std::size_t kQuadrature = 12;
alignas(32) constexpr std::array<double, kQuadrature> kNodes = {
    -0.9815606342467192, -0.9041172563704748, -0.7699026741943047, -0.5873179542866175,
    -0.3678314989981802, -0.1252334085114689, 0.1252334085114689,  0.3678314989981802,
    0.5873179542866175,  0.7699026741943047,  0.9041172563704748,  0.9815606342467192};
alignas(32) constexpr std::array<double, kQuadrature> kWeights = {
    0.0471753363865118, 0.1069393259953183, 0.1600783285433462, 0.2031674267230659,
    0.2334925365383548, 0.2491470458134028, 0.2491470458134028, 0.2334925365383548,
    0.2031674267230659, 0.1600783285433462, 0.1069393259953183, 0.0471753363865118};

/// exp(x²) erfc(x) for x >= 0, by a polynomial in (x - 3) / (x + 3); relative error below 1e-10
/// (Shepherd & Laframboise 1981, Math. Comp. 36:249).
template <class V>
[[gnu::always_inline]] inline V scaled_erfc(V x) {
  constexpr double kCoefficients[] = {
      -1.1960727533733006e-07, -1.1057228275603848e-05, 4.28047409741339e-06,
      0.0001132462340285656,   -0.00010470632307260531, -0.0007713736686656603,
      0.0018885053250241412,   0.0025260688633941437,   -0.023770472036750513,
      0.06830870677289447,     -0.11927366842706578,    0.1296450969688861,
      -0.04756229412651298,    -0.13562110449401815,    1.253008058268025};
  const V t = (x - 3.0) / (x + 3.0);
  V p = V{} + kCoefficients[0];
  for (std::size_t i = 1; i < std::size(kCoefficients); ++i) p = p * t + kCoefficients[i];
  return p / (1.0 + 2.0 * x);
}

template <class V>
[[gnu::always_inline]] inline V limited(V x) {
  const V low = V{} - 700.0, high = V{} + 700.0;
  x = x > low ? x : low;
  return x < high ? x : high;
}

/// The integral over y at constant x: ∫ exp(q(x, y) - q_best) dy = √(π/2h) exp(e) (erf(α) +
/// erf(β)), with h = hyy, μ the best y, α = √(h/2) (y1 - μ), β = √(h/2) (μ - y0) and e = q(x, μ) -
/// q_best. Products of exp and erfc replace the differences of two values near 1.
struct Slices {
  double middle, half;   // centre and half width of the interval of x
  double bx, hxx;        // coefficients in q(x, μ)
  double shift, slope;   // μ = shift - slope x
  double scale, y0, y1;  // √(h/2)
  double best;           // q_best without its constant
};

/// Σ weight · exp(e) (erf(α) + erf(β)) over the nodes.
WHEELTAP_VECTOR_CLONES double sum_of_slices(const Slices& s) {
  using V [[gnu::vector_size(32)]] = double;
  V sum = V{};
  for (std::size_t i = 0; i < kQuadrature; i += 4) {
    V node, weight;
    std::memcpy(&node, kNodes.data() + i, sizeof(V));
    std::memcpy(&weight, kWeights.data() + i, sizeof(V));
    const V x = s.middle + s.half * node;
    const V mu = s.shift - s.slope * x;
    const V alpha = s.scale * (s.y1 - mu), beta = s.scale * (mu - s.y0);
    const V e = s.bx * x - 0.5 * s.hxx * x * x - s.best;
    const V top = base::lanes::exp<V>(limited<V>(e));
    const V a = base::lanes::exp<V>(limited<V>(e - alpha * alpha)) *
                scaled_erfc<V>(base::lanes::abs<V>(alpha));
    const V b = base::lanes::exp<V>(limited<V>(e - beta * beta)) *
                scaled_erfc<V>(base::lanes::abs<V>(beta));
    sum += weight * (alpha < 0.0 ? a - b : beta < 0.0 ? b - a : 2.0 * top - a - b);
  }
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/// See screen_pairs.
WHEELTAP_VECTOR_CLONES float screen(const PairRow& row, float square, float* weight, float* extra) {
  using V [[gnu::vector_size(4 * kPairLanes)]] = float;
  const V zero = V{};
  constexpr float kLowest = -std::numeric_limits<float>::infinity();
  V most = zero + kLowest;
  const float ga = row.amplitude, wa = row.bend;
  for (std::size_t i = 0; i < row.size; i += kPairLanes) {
    V gb, wb, slope, rho, inverse, log_weight, interaction;
    std::memcpy(&wb, row.bends + i, sizeof(V));
    std::memcpy(&slope, row.slopes + i, sizeof(V));
    std::memcpy(&gb, row.amplitudes + i, sizeof(V));
    std::memcpy(&rho, row.correlation + i, sizeof(V));
    std::memcpy(&inverse, row.inverse + i, sizeof(V));
    std::memcpy(&log_weight, row.log_weight + i, sizeof(V));
    std::memcpy(&interaction, row.interaction + i, sizeof(V));
    V limit_b;
    std::memcpy(&limit_b, row.limits + i, sizeof(V));
    // One defect: the largest exponent c g - c²/2 for 0 <= c <= limit.
    V one_a = zero + ga, one_b = gb > zero ? gb : zero;
    one_a = one_a > zero ? one_a : zero;
    const V free_a = 0.5F * one_a * one_a, free_b = 0.5F * one_b * one_b;
    one_a = one_a < row.limit ? one_a : zero + row.limit;
    one_b = one_b < limit_b ? one_b : limit_b;
    const V single_a = one_a * (ga - 0.5F * one_a), single_b = one_b * (gb - 0.5F * one_b);
    const V single = single_a > single_b ? single_a : single_b;
    V most_free = free_a > free_b ? free_a : free_b;
    V ca = (ga - rho * gb) * inverse, cb = (gb - rho * ga) * inverse;
    const auto both = (ca > zero) & (cb > zero);
    const V free_pair = both ? 0.5F * (ca * ga + cb * gb) : zero;
    most_free = free_pair > most_free ? free_pair : most_free;
    ca = both ? (ca < row.limit ? ca : zero + row.limit) : one_a;
    cb = both ? (cb < limit_b ? cb : limit_b) : one_b;
    const V pair = ca * ga + cb * gb - 0.5F * (ca * ca + cb * cb) - rho * ca * cb;
    const V best = both & (pair > single) ? pair : single;
    const V kappa = both ? ca * cb * interaction : zero;
    V residual = 0.5F * square - best;
    residual = residual > zero ? residual : zero;
    const V gain = kappa * (4.0F + 0.5F * kappa);
    V more = gain < residual ? gain : residual;
    V inverses[kSymmetric];
    for (std::size_t k = 0; k < kSymmetric; ++k)
      std::memcpy(&inverses[k], row.gram_inverse + k * row.stride + i, sizeof(V));
    const V free =
        ga * (0.5F * ga * inverses[0] + wa * inverses[1] + gb * inverses[2] + wb * inverses[3]) +
        wa * (0.5F * wa * inverses[4] + gb * inverses[5] + wb * inverses[6]) +
        gb * (0.5F * gb * inverses[7] + wb * inverses[8]) + 0.5F * wb * wb * inverses[9];
    V u = free - most_free;
    u = u > zero ? u : zero;
    const V deviation = ca * row.slope + cb * slope;
    // d √(2 u) <= λ d²/2 + u/λ, with equality for λ = √(2 u)/d: λ = 2, 8, 32 and 128.
    const V square_d = deviation * deviation;
    V limit = u;
    for (const float lambda : {2.0F, 8.0F, 32.0F, 128.0F}) {
      const V one_limit = 0.5F * lambda * square_d + u * (1.0F / lambda);
      limit = one_limit < limit ? one_limit : limit;
    }
    more += limit + (most_free - best);
    const V w = best + log_weight, certain = more < kSmallChange ? w : zero + kLowest;
    most = certain > most ? certain : most;
    std::memcpy(weight + i, &w, sizeof(V));
    std::memcpy(extra + i, &more, sizeof(V));
  }
  float top = most[0];
  for (std::size_t i = 1; i < kPairLanes; ++i) top = most[i] > top ? most[i] : top;
  return top;
}

/// See exponentials. 2ᵏ times the Taylor polynomial of exp(r), degree 6, |r| <= ½ ln 2.
WHEELTAP_VECTOR_CLONES void exponentials_of(float* values, std::size_t size, float most) {
  using V [[gnu::vector_size(4 * kPairLanes)]] = float;
  using Bits = decltype(V{} < V{});
  constexpr float kShift = 12582912.0F;  // 1.5·2²³: stores the nearest integer in the low bits
  for (std::size_t i = 0; i < size; i += kPairLanes) {
    V x;
    std::memcpy(&x, values + i, sizeof(V));
    x -= most;
    x = x > -80.0F ? x : V{} - 80.0F;
    const V shifted = x * 1.44269504F + kShift;
    const V k = shifted - kShift;
    const V r = (x - k * 0.693359375F) + k * 2.12194440e-4F;
    V p = r * (1.0F / 720.0F) + 1.0F / 120.0F;
    for (const float c : {1.0F / 24.0F, 1.0F / 6.0F, 0.5F, 1.0F, 1.0F}) p = p * r + c;
    const V out = (V)((Bits)p + ((Bits)shifted << 23));
    std::memcpy(values + i, &out, sizeof(V));
  }
}

/// See scalar_product.
WHEELTAP_VECTOR_CLONES float product_of(const float* x, const float* y, std::size_t size) {
  using V [[gnu::vector_size(4 * kPairLanes)]] = float;
  V sum = V{};
  for (std::size_t i = 0; i < size; i += kPairLanes) {
    V a, b;
    std::memcpy(&a, x + i, sizeof(V));
    std::memcpy(&b, y + i, sizeof(V));
    sum += a * b;
  }
  float out = 0.0F;
  for (std::size_t lane = 0; lane < kPairLanes; ++lane) out += sum[lane];
  return out;
}

template <class V>
[[gnu::always_inline]] inline V clamped(V x, V high) {
  x = x > V{} ? x : V{};
  return x < high ? x : high;
}

/// See fit_curved_pairs.
WHEELTAP_VECTOR_CLONES void fit_curved(const CurvedPairs& pairs, float square, float* exponent,
                                       float* extra) {
  using V [[gnu::vector_size(4 * kPairLanes)]] = float;
  for (std::size_t i = 0; i < pairs.size; i += kPairLanes) {
    V in[CurvedPairs::count];
    for (std::size_t k = 0; k < CurvedPairs::count; ++k)
      std::memcpy(&in[k], pairs.arrays + k * pairs.stride + i, sizeof(V));
    const V va = in[CurvedPairs::v_a], wa = in[CurvedPairs::w_a], vb = in[CurvedPairs::v_b],
            wb = in[CurvedPairs::w_b], la = in[CurvedPairs::limit_a], lb = in[CurvedPairs::limit_b],
            alpha = in[CurvedPairs::alpha_a], beta = in[CurvedPairs::alpha_b],
            tau_a = in[CurvedPairs::tau_a], tau_b = in[CurvedPairs::tau_b],
            rho = in[CurvedPairs::rho], vw = in[CurvedPairs::vw], wv = in[CurvedPairs::wv],
            ww = in[CurvedPairs::ww];
    V inverse = 1.0F - rho * rho;
    inverse = 1.0F / (inverse > 1e-4F ? inverse : V{} + 1e-4F);
    V a = clamped<V>((va - rho * vb) * inverse, la), b = clamped<V>(vb - rho * a, lb);
    a = clamped<V>(va - rho * b, la);
    constexpr int kSteps = 3;
    for (int step = 0; step < kSteps; ++step) {
      const V xa = alpha * a * (a - tau_a), sa = alpha * (2.0F * a - tau_a);
      const V xb = beta * b * (b - tau_b), sb = beta * (2.0F * b - tau_b);
      // Products of v and w of both places with the residual.
      const V rest_va = va - a - rho * b - vw * xb, rest_wa = wa - xa - wv * b - ww * xb;
      const V rest_vb = vb - b - rho * a - wv * xa, rest_wb = wb - xb - vw * a - ww * xa;
      const V ga = rest_va + sa * rest_wa, gb = rest_vb + sb * rest_wb;
      const V haa = 1.0F + sa * sa, hbb = 1.0F + sb * sb;
      const V hab = rho + vw * sb + wv * sa + ww * sa * sb;
      V det = haa * hbb - hab * hab;
      det = det > 1e-4F * haa * hbb ? det : 1e-4F * haa * hbb;
      const V to_a = clamped<V>(a + (ga * hbb - gb * hab) / det, la);
      const V to_b = clamped<V>(b + (gb - hab * (to_a - a)) / hbb, lb);
      a = clamped<V>(a + (ga - hab * (to_b - b)) / haa, la);
      b = to_b;
    }
    const V xa = alpha * a * (a - tau_a), xb = beta * b * (b - tau_b);
    const V best = a * va + xa * wa + b * vb + xb * wb -
                   0.5F * (a * a + xa * xa + b * b + xb * xb) - rho * a * b - vw * a * xb -
                   wv * xa * b - ww * xa * xb;
    V residual = square - 2.0F * best;  // r²
    residual = residual > 1e-6F ? residual : V{} + 1e-6F;
    const V kappa = a * b * in[CurvedPairs::interaction];
    V gain = kappa * (4.0F + 0.5F * kappa);
    gain = gain < 0.5F * residual ? gain : 0.5F * residual;
    // d r <= λ d²/2 + r²/(2 λ); λ = 1 gives r²/2 or more.
    const V d = a * in[CurvedPairs::slope_a] + b * in[CurvedPairs::slope_b];
    V more = 0.5F * residual;
    for (const float lambda : {2.0F, 8.0F, 32.0F, 128.0F, 512.0F}) {
      const V limit = 0.5F * lambda * d * d + residual * (0.5F / lambda);
      more = limit < more ? limit : more;
    }
    more += gain;
    std::memcpy(exponent + i, &best, sizeof(V));
    std::memcpy(extra + i, &more, sizeof(V));
  }
}

/// See products_with_tile.
WHEELTAP_VECTOR_CLONES void tile_products(const double* tile, std::size_t rows,
                                          const double* columns, std::size_t count, double* out,
                                          std::size_t out_stride) {
  using V [[gnu::vector_size(32)]] = double;
  static_assert(kTile == 8);
  std::size_t c = 0;
  for (; c + 4 <= count; c += 4) {
    const double* const x = columns + c * rows;
    V a0 = V{}, a1 = V{}, b0 = V{}, b1 = V{}, c0 = V{}, c1 = V{}, d0 = V{}, d1 = V{};
    for (std::size_t r = 0; r < rows; ++r) {
      V low, high;
      std::memcpy(&low, tile + r * kTile, sizeof(V));
      std::memcpy(&high, tile + r * kTile + 4, sizeof(V));
      a0 += low * x[r];
      a1 += high * x[r];
      b0 += low * x[rows + r];
      b1 += high * x[rows + r];
      c0 += low * x[2 * rows + r];
      c1 += high * x[2 * rows + r];
      d0 += low * x[3 * rows + r];
      d1 += high * x[3 * rows + r];
    }
    double* to = out + c * out_stride;
    const auto store = [&](const V& low, const V& high) __attribute__((always_inline)) {
      std::memcpy(to, &low, sizeof(V));
      std::memcpy(to + 4, &high, sizeof(V));
      to += out_stride;
    };
    store(a0, a1);
    store(b0, b1);
    store(c0, c1);
    store(d0, d1);
  }
  for (; c < count; ++c) {
    const double* const x = columns + c * rows;
    V low_sum = V{}, high_sum = V{};
    for (std::size_t r = 0; r < rows; ++r) {
      V low, high;
      std::memcpy(&low, tile + r * kTile, sizeof(V));
      std::memcpy(&high, tile + r * kTile + 4, sizeof(V));
      low_sum += low * x[r];
      high_sum += high * x[r];
    }
    std::memcpy(out + c * out_stride, &low_sum, sizeof(V));
    std::memcpy(out + c * out_stride + 4, &high_sum, sizeof(V));
  }
}

double value_at(const Quadratic& q, double x, double y) {
  return q.bx * x + q.by * y - 0.5 * (q.hxx * x * x + q.hyy * y * y) - q.hxy * x * y;
}

double best_on_line(double b, double h, double low, double high) {
  if (h > 0.0) return std::clamp(b / h, low, high);
  return b > 0.0 ? high : low;
}

/// The interval of x around the best point outside which the integral is negligible: there the
/// largest exponent over y, a concave function of x, is more than kReach²/2 below the maximum.
/// Newton's method approaches each end from outside; it starts where the marginal curvature gives
/// the exact drop or too small a drop.
std::array<double, 2> relevant(const Quadratic& q, const Rectangle& r,
                               const std::array<double, 2>& best) {
  constexpr double kDrop = 0.5 * kReach * kReach;
  const double top = value_at(q, best[0], best[1]);
  const double curvature = std::max(q.hyy > 0.0 ? q.hxx - q.hxy * q.hxy / q.hyy : q.hxx, 1e-300);
  const auto end = [&](double side, double bound) {
    const double g = std::max(0.0, -side * (q.bx - q.hxx * best[0] - q.hxy * best[1]));
    double reach = 2.0 * kDrop / (g + std::sqrt(g * g + 2.0 * kDrop * curvature));
    reach = std::min(reach, side * (bound - best[0]));
    for (int step = 0; step < 5 && reach > 0.0; ++step) {
      const double x = best[0] + side * reach;
      const double y = best_on_line(q.by - q.hxy * x, q.hyy, r.y0, r.y1);
      const double drop = top - value_at(q, x, y);
      if (drop < 1.2 * kDrop) break;
      reach -= (drop - kDrop) / (-side * (q.bx - q.hxx * x - q.hxy * y));
    }
    return best[0] + side * reach;
  };
  return {end(-1.0, r.x0), end(1.0, r.x1)};
}

/// ln ∫ dx in closed form if the density along y is inside [y0, y1] at all relevant x, else NaN.
double closed_form(const Quadratic& q, const Rectangle& r, const std::array<double, 2>& x) {
  if (!(q.hyy > 0.0)) return kNaN;
  const double sd = 1.0 / std::sqrt(q.hyy), margin = kInside * sd;
  for (const double end : x) {
    const double mu = (q.by - q.hxy * end) / q.hyy;
    if (!(mu - margin > r.y0 && mu + margin < r.y1)) return kNaN;
  }
  return q.constant + 0.5 * q.by * q.by / q.hyy + 0.5 * std::log(kTwoPi) + std::log(sd) +
         log_normal_integral(q.bx - q.by * q.hxy / q.hyy,
                             std::max(q.hxx - q.hxy * q.hxy / q.hyy, 0.0), r.x0, r.x1);
}

}  // namespace

double log_normal_integral(double b, double h, double low, double high) {
  const double width = high - low;
  if (width <= 0.0) return b * low - 0.5 * h * low * low;
  // Slopes of the exponent at both ends.
  const double slope = b - h * low, end_slope = b - h * high;
  if (h * width * width < 1e-9) {
    const double rise = 0.5 * (slope + end_slope) * width;
    const double from = b * low - 0.5 * h * low * low;
    return from + std::log(width) +
           (std::abs(rise) < 1e-6 ? 0.5 * rise
            : rise > 0.0          ? rise + std::log(-std::expm1(-rise) / rise)
                                  : std::log(std::expm1(rise) / rise));
  }
  const double root = std::sqrt(0.5 * h), scale = 0.5 * std::log(0.5 * kPi / h);
  if (slope > 0.0 && end_slope < 0.0)
    return 0.5 * b * b / h + scale +
           std::log(std::erf(-end_slope / h * root) + std::erf(slope / h * root));
  // The maximum is at one end.
  const double near = slope <= 0.0 ? -slope / h * root : end_slope / h * root;
  const double far = near + width * root, fall = near * near - far * far;
  const double end = slope <= 0.0 ? low : high;
  return b * end - 0.5 * h * end * end + scale +
         std::log(scaled_erfc<double>(near) -
                  (fall > -40.0 ? std::exp(fall) * scaled_erfc<double>(far) : 0.0));
}

double value_at(const Quadratic& q, const std::array<double, 2>& point) {
  return q.constant + value_at(q, point[0], point[1]);
}

std::array<double, 2> best_point(const Quadratic& q, const Rectangle& r) {
  const double det = q.hxx * q.hyy - q.hxy * q.hxy;
  if (det > 1e-12 * q.hxx * q.hyy) {
    const double x = (q.bx * q.hyy - q.by * q.hxy) / det, y = (q.by * q.hxx - q.bx * q.hxy) / det;
    if (x >= r.x0 && x <= r.x1 && y >= r.y0 && y <= r.y1) return {x, y};
  }
  const auto best_y = [&](double x) {
    return std::array{x, best_on_line(q.by - q.hxy * x, q.hyy, r.y0, r.y1)};
  };
  const auto best_x = [&](double y) {
    return std::array{best_on_line(q.bx - q.hxy * y, q.hxx, r.x0, r.x1), y};
  };
  std::array<double, 2> found = best_y(r.x0);
  double most = value_at(q, found[0], found[1]);
  for (const auto& point : {best_y(r.x1), best_x(r.y0), best_x(r.y1)})
    if (const double value = value_at(q, point[0], point[1]); value > most) {
      most = value;
      found = point;
    }
  return found;
}

double log_integral(const Quadratic& q, const Rectangle& r, const std::array<double, 2>& best) {
  if (r.x1 <= r.x0) return q.constant + log_normal_integral(q.by, q.hyy, r.y0, r.y1);
  if (r.y1 <= r.y0) return q.constant + log_normal_integral(q.bx, q.hxx, r.x0, r.x1);
  const Quadratic turned{q.constant, q.by, q.bx, q.hyy, q.hxy, q.hxx};
  const Rectangle across{r.y0, r.y1, r.x0, r.x1};
  const std::array<double, 2> x = relevant(q, r, best);
  if (const double value = closed_form(q, r, x); !std::isnan(value)) return value;
  const std::array<double, 2> y = relevant(turned, across, {best[1], best[0]});
  if (const double value = closed_form(turned, across, y); !std::isnan(value)) return value;
  const double middle = 0.5 * (x[0] + x[1]), half = 0.5 * (x[1] - x[0]);
  const double width = r.y1 - r.y0;
  if (q.hyy * width * width > 1e-6) {
    const double top = value_at(q, best[0], best[1]);
    const double sum = sum_of_slices({.middle = middle,
                                      .half = half,
                                      .bx = q.bx - q.by * q.hxy / q.hyy,
                                      .hxx = q.hxx - q.hxy * q.hxy / q.hyy,
                                      .shift = q.by / q.hyy,
                                      .slope = q.hxy / q.hyy,
                                      .scale = std::sqrt(0.5 * q.hyy),
                                      .y0 = r.y0,
                                      .y1 = r.y1,
                                      .best = top - 0.5 * q.by * q.by / q.hyy});
    return q.constant + top + std::log(half * std::sqrt(0.5 * kPi / q.hyy) * sum);
  }
  std::array<double, kQuadrature> terms;
  double most = -kInfinity, sum = 0.0;
  for (std::size_t i = 0; i < kQuadrature; ++i) {
    const double at = middle + half * kNodes[i];
    terms[i] = q.bx * at - 0.5 * q.hxx * at * at +
               log_normal_integral(q.by - q.hxy * at, q.hyy, r.y0, r.y1);
    most = std::max(most, terms[i]);
  }
  for (std::size_t i = 0; i < kQuadrature; ++i) sum += kWeights[i] * std::exp(terms[i] - most);
  return q.constant + most + std::log(half * sum);
}

float screen_pairs(const PairRow& row, float square, float* weight, float* extra) {
  return screen(row, square, weight, extra);
}

void exponentials(float* values, std::size_t size, float most) {
  exponentials_of(values, size, most);
}

float scalar_product(const float* x, const float* y, std::size_t size) {
  return product_of(x, y, size);
}

void fit_curved_pairs(const CurvedPairs& pairs, float square, float* exponent, float* extra) {
  fit_curved(pairs, square, exponent, extra);
}

void products_with_tile(const double* tile, std::size_t rows, const double* columns,
                        std::size_t count, double* out, std::size_t out_stride) {
  tile_products(tile, rows, columns, count, out, out_stride);
}

}  // namespace wheeltap::identification::planning

#include "inference/packed_mixture.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstring>

#include "base/constants.hpp"
#include "base/log_gamma.hpp"
#include "inference/standard_normal.hpp"

namespace wheeltap::inference::packed {
namespace {

#if defined(__GNUC__) && defined(__x86_64__)
#define WHEELTAP_INLINE [[gnu::always_inline]] inline
#else
#define WHEELTAP_INLINE inline
#endif

// GCC's and Clang's vectors: eight doubles, in however many registers the processor needs.
using Lanes [[gnu::vector_size(kLanes * sizeof(double))]] = double;
using Bits [[gnu::vector_size(kLanes * sizeof(double))]] = long long;

WHEELTAP_INLINE void load(Lanes& v, const double* p) {
  std::memcpy(&v, p, sizeof v);
}
WHEELTAP_INLINE void store(double* p, const Lanes& v) {
  std::memcpy(p, &v, sizeof v);
}

// |A z - b|² of one group.
WHEELTAP_INLINE void quadratic_form(const double* group, const double* z, std::size_t d,
                                    Lanes& result) {
  const double* p = group + kLanes;
  result = Lanes{};
  for (std::size_t i = 0; i < d; ++i) {
    Lanes y, a;
    load(y, p);
    y = -y;
    p += kLanes;
    for (std::size_t j = 0; j <= i; ++j, p += kLanes) {
      load(a, p);
      y += a * z[j];
    }
    result += y * y;
  }
}

// e^x for x <= 0, to 1e-15 relative; 0 below -700. x = n ln 2 + r with |r| <= ½ ln 2, and the
// Taylor series in r, whose first dropped term is 2e-16.
WHEELTAP_INLINE void exponential(Lanes& x) {
  constexpr double kMagic =
      0x1.8p52;  // adding it rounds to an integer, which the low bits then hold
  const Lanes floor = Lanes{} - 700.0;
  const auto tiny = x < floor;
  x = tiny ? floor : x;
  const Lanes shifted = x * 1.4426950408889634 + kMagic;
  const Lanes n = shifted - kMagic;
  const Lanes r = (x - n * 0x1.62e42fefa3800p-1) - n * 0x1.ef35793c76730p-45;
  Lanes sum = Lanes{} + 1.0 / 479001600.0;
  constexpr std::array<double, 12> kInverseFactorials = {
      1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0,
      1.0 / 120.0,      1.0 / 24.0,      1.0 / 6.0,      0.5,           1.0,          1.0};
  for (const double c : kInverseFactorials) sum = sum * r + c;
  Bits bits, exponent;
  std::memcpy(&bits, &sum, sizeof bits);
  std::memcpy(&exponent, &shifted, sizeof exponent);
  bits += exponent << 52;
  std::memcpy(&sum, &bits, sizeof sum);
  x = tiny ? Lanes{} : sum;
}

WHEELTAP_INLINE double largest(const Lanes& v) {
  double m = v[0];
  for (std::size_t l = 1; l < kLanes; ++l) m = v[l] > m ? v[l] : m;
  return m;
}

WHEELTAP_INLINE double total(const Lanes& v) {
  return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7]));
}

// values_k = c_k - ½ |A_k z - b_k|²; returns the largest.
WHEELTAP_INLINE double log_components(const double* packed, std::size_t groups, std::size_t stride,
                                      const double* z, std::size_t d, double* values) {
  Lanes top = Lanes{} - kInfinity;
  for (std::size_t g = 0; g < groups; ++g) {
    Lanes q, c;
    quadratic_form(packed + g * stride, z, d, q);
    load(c, packed + g * stride);
    c -= 0.5 * q;
    store(values + g * kLanes, c);
    top = c > top ? c : top;
  }
  return largest(top);
}

WHEELTAP_INLINE double log_density_body(const double* packed, std::size_t groups,
                                        std::size_t stride, const double* z, std::size_t d) {
  std::array<double, kMaxComponents> values;
  const double top = log_components(packed, groups, stride, z, d, values.data());
  if (top == -kInfinity) return top;
  Lanes sum = Lanes{};
  for (std::size_t g = 0; g < groups; ++g) {
    Lanes v;
    load(v, values.data() + g * kLanes);
    v -= top;
    exponential(v);
    sum += v;
  }
  return top + std::log(total(sum));
}

WHEELTAP_INLINE void quadratic_forms_body(const double* packed, std::size_t groups,
                                          std::size_t stride, const double* z, std::size_t d,
                                          double* values) {
  for (std::size_t g = 0; g < groups; ++g) {
    Lanes q;
    quadratic_form(packed + g * stride, z, d, q);
    store(values + g * kLanes, q);
  }
}

WHEELTAP_INLINE double em_pass_body(const double* packed, const double* means, std::size_t groups,
                                    std::size_t stride, const Samples& s, double* moments) {
  std::array<double, kMaxComponents> values;
  const std::size_t moment_stride = stride + kLanes;
  double log_likelihood = 0.0;
  for (std::size_t i = 0; i < s.n; ++i) {
    const double* z = s.z + i * s.d;
    const double top = log_components(packed, groups, stride, z, s.d, values.data());
    Lanes sum = Lanes{};
    for (std::size_t g = 0; g < groups; ++g) {
      Lanes v;
      load(v, values.data() + g * kLanes);
      v -= top;
      exponential(v);
      store(values.data() + g * kLanes, v);
      sum += v;
    }
    const double all = total(sum);
    log_likelihood += s.weight[i] * (top + std::log(all));
    for (std::size_t g = 0; g < groups; ++g) {
      Lanes r, m, a;
      load(r, values.data() + g * kLanes);
      r *= 1.0 / all;
      if (largest(r) < 1e-12) continue;
      double* p = moments + g * moment_stride;
      const double* mean = means + g * kLanes * s.d;
      const Lanes wr = r * s.weight[i];
      load(a, p);
      store(p, a + wr);
      load(a, p + kLanes);
      store(p + kLanes, a + r);
      p += 2 * kLanes;
      for (std::size_t u = 0; u < s.d; ++u) {
        load(m, mean + u * kLanes);
        const Lanes e = wr * (z[u] - m);
        load(a, p);
        store(p, a + e);
        p += kLanes;
        for (std::size_t v = 0; v <= u; ++v, p += kLanes) {
          load(m, mean + v * kLanes);
          load(a, p);
          store(p, a + e * (z[v] - m));
        }
      }
    }
  }
  return log_likelihood;
}

// One copy of each routine for each instruction set. None contracts to fused multiply-add, so that
// all give the same bits and a chain does not depend on where it ran.
#define WHEELTAP_ROUTINES(NAME, ATTRIBUTE)                                                       \
  ATTRIBUTE double log_density_##NAME(const double* packed, std::size_t groups,                  \
                                      std::size_t stride, const double* z, std::size_t d) {      \
    return log_density_body(packed, groups, stride, z, d);                                       \
  }                                                                                              \
  ATTRIBUTE void quadratic_forms_##NAME(const double* packed, std::size_t groups,                \
                                        std::size_t stride, const double* z, std::size_t d,      \
                                        double* values) {                                        \
    quadratic_forms_body(packed, groups, stride, z, d, values);                                  \
  }                                                                                              \
  ATTRIBUTE double em_pass_##NAME(const double* packed, const double* means, std::size_t groups, \
                                  std::size_t stride, const Samples& s, double* moments) {       \
    return em_pass_body(packed, means, groups, stride, s, moments);                              \
  }                                                                                              \
  constexpr Routines kRoutines_##NAME{log_density_##NAME, quadratic_forms_##NAME, em_pass_##NAME};

WHEELTAP_ROUTINES(baseline, )
#if defined(__GNUC__) && defined(__x86_64__)
WHEELTAP_ROUTINES(avx2, [[gnu::target("avx2")]])
WHEELTAP_ROUTINES(avx512, [[gnu::target("avx512f,avx512dq,avx512vl")]])
constexpr base::Compiled<Routines> kCompiled{&kRoutines_baseline, &kRoutines_avx2,
                                             &kRoutines_avx512};
#else
constexpr base::Compiled<Routines> kCompiled{&kRoutines_baseline};
#endif

}  // namespace

std::vector<const Routines*> runnable_routines(base::Instructions instructions) {
  return base::runnable(kCompiled, instructions);
}

const Routines& routines() {
  static const Routines chosen = *runnable_routines(base::Instructions::automatic).back();
  return chosen;
}

double log_sum_diagonal(const Eigen::MatrixXd& factor) {
  return factor.diagonal().array().log().sum();
}

std::vector<double> pack(const std::vector<NormalMixture::Component>& components, double nu) {
  const auto d = components.front().mean.size();
  const auto dimension = static_cast<std::size_t>(d);
  const std::size_t stride = group_stride(dimension);
  const auto half = 0.5 * static_cast<double>(d);
  const double normaliser = std::isinf(nu)
                                ? -2.0 * half * kLogSqrt2Pi
                                : base::log_gamma(0.5 * nu + half) - base::log_gamma(0.5 * nu) -
                                      half * std::log(nu * M_PI);
  std::vector<double> packed(groups_of(components.size()) * stride, 0.0);
  for (std::size_t k = 0; k < groups_of(components.size()) * kLanes; ++k) {
    double* p = packed.data() + (k / kLanes) * stride + k % kLanes;
    if (k >= components.size()) {
      *p = -kInfinity;  // a lane without a component
      continue;
    }
    const auto& c = components[k];
    *p = std::log(c.weight) + normaliser - log_sum_diagonal(c.factor);
    const Eigen::MatrixXd inverse =
        c.factor.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(d, d));
    const Eigen::VectorXd b = inverse * c.mean;
    for (Eigen::Index i = 0; i < d; ++i) {
      *(p += kLanes) = b[i];
      for (Eigen::Index j = 0; j <= i; ++j) *(p += kLanes) = inverse(i, j);
    }
  }
  return packed;
}

}  // namespace wheeltap::inference::packed

// The routines of packed_routines.hpp for SIMD registers of WHEELTAP_PACKED_WIDTH doubles. Each
// source file that includes this header is compiled for one instruction set. No operation depends
// on the SIMD width, and no operation is contracted to a fused multiply-add. The results are
// therefore equal bit for bit, and a chain does not depend on the processor.

// <cmath> is not included, because instances of its templates could be shared between instruction
// sets.
#include <math.h>

#include <cstring>

#include "inference/mixtures/packed_routines.hpp"

namespace wheeltap::inference::packed {
namespace {

constexpr std::size_t kWidth = WHEELTAP_PACKED_WIDTH;
constexpr std::size_t kParts = kLanes / kWidth;
constexpr double kNever = -__builtin_inf();

// A vector as wide as a SIMD register of the processor. GCC splits wider vectors into parts and
// exchanges data between the parts through memory. This data exchange took half of the run time.
using Part [[gnu::vector_size(kWidth * sizeof(double))]] = double;
using PartBits [[gnu::vector_size(kWidth * sizeof(double))]] = long long;

// Eight numbers, one for each component of a group.
struct Lanes {
  Part part[kParts];
};

inline Lanes load(const double* p) {
  Lanes v;
  for (std::size_t i = 0; i < kParts; ++i) std::memcpy(&v.part[i], p + i * kWidth, sizeof(Part));
  return v;
}
inline void store(double* p, const Lanes& v) {
  for (std::size_t i = 0; i < kParts; ++i) std::memcpy(p + i * kWidth, &v.part[i], sizeof(Part));
}
inline Lanes all(double x) {
  Lanes v;
  for (Part& part : v.part) part = Part{} + x;
  return v;
}

inline Lanes& operator+=(Lanes& a, const Lanes& b) {
  for (std::size_t i = 0; i < kParts; ++i) a.part[i] += b.part[i];
  return a;
}
inline Lanes operator-(Lanes a, const Lanes& b) {
  for (std::size_t i = 0; i < kParts; ++i) a.part[i] -= b.part[i];
  return a;
}
inline Lanes operator*(Lanes a, const Lanes& b) {
  for (std::size_t i = 0; i < kParts; ++i) a.part[i] *= b.part[i];
  return a;
}
inline Lanes operator-(Lanes a, double b) {
  for (Part& part : a.part) part -= b;
  return a;
}
inline Lanes operator*(Lanes a, double b) {
  for (Part& part : a.part) part *= b;
  return a;
}

inline void add_to(double* p, const Lanes& v) {
  Lanes sum = load(p);
  store(p, sum += v);
}

inline double largest(const Lanes& v) {
  Part most = v.part[0];
  for (std::size_t i = 1; i < kParts; ++i) most = v.part[i] > most ? v.part[i] : most;
  double m = most[0];
  for (std::size_t l = 1; l < kWidth; ++l) m = most[l] > m ? most[l] : m;
  return m;
}

inline double total(const Lanes& v) {
  double x[kLanes];
  store(x, v);
  return ((x[0] + x[4]) + (x[1] + x[5])) + ((x[2] + x[6]) + (x[3] + x[7]));
}

// |A z - b|² of one group.
inline Lanes quadratic_form(const double* group, const double* z, std::size_t d) {
  const double* p = group + kLanes;
  Lanes result = all(0.0);
  for (std::size_t i = 0; i < d; ++i) {
    Lanes y = load(p);
    for (Part& part : y.part) part = -part;
    p += kLanes;
    for (std::size_t j = 0; j <= i; ++j, p += kLanes) y += load(p) * z[j];
    result += y * y;
  }
  return result;
}

// e^x for x <= 0 with a relative error of 1e-15; 0 for x below -700. Uses x = n ln 2 + r, |r| <=
// ½ ln 2, and the Taylor series in r; its first neglected term is 2e-16.
inline Part exponential(Part x) {
  // Adding kMagic to a number rounds the number to an integer and stores the integer in the low
  // bits of the sum.
  constexpr double kMagic = 0x1.8p52;
  constexpr double kInverseFactorials[] = {
      1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0,
      1.0 / 120.0,      1.0 / 24.0,      1.0 / 6.0,      0.5,           1.0,          1.0};
  const Part floor = Part{} - 700.0;
  const auto tiny = x < floor;
  x = tiny ? floor : x;
  const Part shifted = x * 1.4426950408889634 + kMagic;
  const Part n = shifted - kMagic;
  const Part r = (x - n * 0x1.62e42fefa3800p-1) - n * 0x1.ef35793c76730p-45;
  Part sum = Part{} + 1.0 / 479001600.0;
  for (const double c : kInverseFactorials) sum = sum * r + c;
  PartBits bits, exponent;
  std::memcpy(&bits, &sum, sizeof bits);
  std::memcpy(&exponent, &shifted, sizeof exponent);
  bits += exponent << 52;
  std::memcpy(&sum, &bits, sizeof sum);
  return tiny ? Part{} : sum;
}

// Computes values_k = c_k - ½ |A_k z - b_k|² for all components k and returns the largest value.
inline double log_components(const double* packed, std::size_t groups, std::size_t stride,
                             const double* z, std::size_t d, double* values) {
  Lanes top = all(kNever);
  for (std::size_t g = 0; g < groups; ++g) {
    const double* group = packed + g * stride;
    const Lanes c = load(group) - quadratic_form(group, z, d) * 0.5;
    store(values + g * kLanes, c);
    for (std::size_t i = 0; i < kParts; ++i)
      top.part[i] = c.part[i] > top.part[i] ? c.part[i] : top.part[i];
  }
  return largest(top);
}

// Replaces values_k by exp(values_k - top) and returns their sum.
inline double exponentials(std::size_t groups, double top, double* values) {
  Lanes sum = all(0.0);
  for (std::size_t g = 0; g < groups; ++g) {
    Lanes v = load(values + g * kLanes) - top;
    for (Part& part : v.part) part = exponential(part);
    store(values + g * kLanes, v);
    sum += v;
  }
  return total(sum);
}

double log_density(const double* packed, std::size_t groups, std::size_t stride, const double* z,
                   std::size_t d) {
  double values[kMaxComponents];
  const double top = log_components(packed, groups, stride, z, d, values);
  if (top == kNever) return top;
  return top + log(exponentials(groups, top, values));
}

void quadratic_forms(const double* packed, std::size_t groups, std::size_t stride, const double* z,
                     std::size_t d, double* values) {
  for (std::size_t g = 0; g < groups; ++g)
    store(values + g * kLanes, quadratic_form(packed + g * stride, z, d));
}

double em_pass(const double* packed, const double* means, std::size_t groups, std::size_t stride,
               const Samples& s, double* moments) {
  constexpr double kNegligible = 1e-12;  // responsibility below which a component is ignored
  double values[kMaxComponents];
  const std::size_t moment_stride = stride + kLanes;
  double log_likelihood = 0.0;
  for (std::size_t i = 0; i < s.n; ++i) {
    const double* z = s.z + i * s.d;
    const double top = log_components(packed, groups, stride, z, s.d, values);
    const double sum = exponentials(groups, top, values);
    log_likelihood += s.weight[i] * (top + log(sum));
    for (std::size_t g = 0; g < groups; ++g) {
      const Lanes r = load(values + g * kLanes) * (1.0 / sum);
      if (largest(r) < kNegligible) continue;
      double* p = moments + g * moment_stride;
      const double* mean = means + g * kLanes * s.d;
      const Lanes wr = r * s.weight[i];
      add_to(p, wr);
      add_to(p + kLanes, r);
      p += 2 * kLanes;
      for (std::size_t u = 0; u < s.d; ++u) {
        const Lanes e = wr * (all(z[u]) - load(mean + u * kLanes));
        add_to(p, e);
        p += kLanes;
        for (std::size_t v = 0; v <= u; ++v, p += kLanes)
          add_to(p, e * (all(z[v]) - load(mean + v * kLanes)));
      }
    }
  }
  return log_likelihood;
}

}  // namespace

extern const Routines WHEELTAP_PACKED_ROUTINES = {log_density, quadratic_forms, em_pass};

}  // namespace wheeltap::inference::packed

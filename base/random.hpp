// Counter-based random numbers. A random number depends only on seed, chain, iteration, purpose and
// its index in the stream. It does not depend on the number of threads or on other streams.
#pragma once

// Philox uses only integer arithmetic. Without R123_USE_SSE = 0, Random123 includes the headers of
// all vector instructions, so that every source file takes longer to compile.
#ifndef R123_USE_SSE
#define R123_USE_SSE 0
#endif
#include <Random123/philox.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace wheeltap::base {

/// Purpose of a stream of random numbers. The purpose is part of the counter of the stream, so that
/// streams with different purposes never overlap.
enum class Purpose : std::uint32_t {
  start,
  exploration,
  adaptation,
  fit,
  sampling,
  swap,
  prediction,
  evidence,
  simulation,
  test,
  search,
  settling,
  following
};

/// A stream of Philox 4x64-10 (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3").
/// A stream is cheap to construct; every iteration constructs a new stream.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t chain, std::uint64_t iteration, Purpose purpose)
      : key_{{seed, 0x7768656c74617000ULL}},
        counter_{{0, iteration, chain, static_cast<std::uint64_t>(purpose)}} {}

  using result_type = std::uint64_t;  ///< a UniformRandomBitGenerator, for the standard algorithms
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~result_type{0}; }
  result_type operator()() { return bits(); }

  std::uint64_t bits() {
    if (next_ == 4) {
      block_ = r123::Philox4x64_R<10>{}(counter_, key_);
      ++counter_[0];
      next_ = 0;
    }
    return block_[next_++];
  }

  /// Draws a number with the uniform distribution on the open interval (0, 1).
  double uniform() { return (static_cast<double>(bits() >> 11) + 0.5) * 0x1.0p-53; }

  /// Draws an integer with the uniform distribution on {0, …, n-1}; n >= 1.
  int index(int n) { return static_cast<int>(uniform() * n); }

  /// Draws a number with the standard normal distribution (Box & Muller 1958).
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }

  /// Draws a number with the standard exponential distribution.
  double exponential() { return -std::log(uniform()); }

  /// Draws a number from the gamma distribution with the shape parameter `shape` (> 0) and scale 1
  /// (Marsaglia & Tsang 2000). If the shape parameter is small, the number may underflow to 0.
  double gamma(double shape) {
    if (shape < 1.0) {
      const double grown = gamma(shape + 1.0);
      return grown * std::pow(uniform(), 1.0 / shape);
    }
    const double d = shape - 1.0 / 3.0;
    const double c = 1.0 / std::sqrt(9.0 * d);
    for (;;) {
      const double x = normal();
      const double v = (1.0 + c * x) * (1.0 + c * x) * (1.0 + c * x);
      if (v > 0.0 && std::log(uniform()) < 0.5 * x * x + d - d * v + d * std::log(v)) return d * v;
    }
  }

 private:
  r123::Philox4x64_R<10>::key_type key_;
  r123::Philox4x64_R<10>::ctr_type counter_;
  r123::Philox4x64_R<10>::ctr_type block_{};
  std::size_t next_ = 4;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace wheeltap::base

// Double-double numbers with 106 significant bits: unevaluated sums of two doubles.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace wheeltap::fem {

/// A number high + low with |low| <= ulp(high) / 2. On fine meshes, the condition number of the
/// assembled matrices grows with (elements)⁴. Computations with 53 or 64 bits then lose digits of
/// the low modes; computations with 106 bits do not. Sums and products have a relative error of at
/// most 2⁻¹⁰⁴ (Joldes, Muller & Popescu 2017, ACM Trans. Math. Softw. 44:15res, algorithms 6, 12
/// and 17). The class requires rounding to nearest, compilation without -ffast-math, and |x|
/// between 1e-250 and 1e250.
class DoubleDouble {
 public:
  constexpr DoubleDouble(double x = 0.0) : high_(x) {}  // NOLINT: every double is a DoubleDouble
  /// Converts x, rounded to 106 bits; the conversion is exact for a long double with 64 bits.
  static DoubleDouble from(long double x) {
    const auto high = static_cast<double>(x);
    return fast_sum(high, static_cast<double>(x - static_cast<long double>(high)));
  }

  explicit constexpr operator double() const { return high_; }
  explicit constexpr operator long double() const {
    return static_cast<long double>(high_) + static_cast<long double>(low_);
  }
  explicit constexpr operator int() const { return static_cast<int>(high_); }

  friend DoubleDouble operator-(const DoubleDouble& a) { return {-a.high_, -a.low_}; }
  friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble s = sum(a.high_, b.high_), t = sum(a.low_, b.low_);
    const DoubleDouble v = fast_sum(s.high_, s.low_ + t.high_);
    return fast_sum(v.high_, t.low_ + v.low_);
  }
  friend DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
  friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble p = product(a.high_, b.high_);
    return fast_sum(p.high_, p.low_ + (a.high_ * b.low_ + a.low_ * b.high_));
  }
  friend DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double first = a.high_ / b.high_;
    const DoubleDouble rest = a - b * first;
    const double second = rest.high_ / b.high_;
    const DoubleDouble last = rest - b * second;
    return fast_sum(first, second) + last.high_ / b.high_;
  }
  friend DoubleDouble sqrt(const DoubleDouble& a) {
    if (a.high_ <= 0.0) return std::sqrt(a.high_);
    // One Newton step from a square root that is accurate to 53 bits.
    const double root = std::sqrt(a.high_);
    const DoubleDouble rest = a - product(root, root);
    return fast_sum(root, rest.high_ / (2.0 * root));
  }
  friend DoubleDouble abs(const DoubleDouble& a) { return a.high_ < 0.0 ? -a : a; }
  friend bool isfinite(const DoubleDouble& a) { return std::isfinite(a.high_); }

  DoubleDouble& operator+=(const DoubleDouble& b) { return *this = *this + b; }
  DoubleDouble& operator-=(const DoubleDouble& b) { return *this = *this - b; }
  DoubleDouble& operator*=(const DoubleDouble& b) { return *this = *this * b; }
  DoubleDouble& operator/=(const DoubleDouble& b) { return *this = *this / b; }

  friend constexpr bool operator==(const DoubleDouble&, const DoubleDouble&) = default;
  friend constexpr bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
    return a.high_ < b.high_ || (a.high_ == b.high_ && a.low_ < b.low_);
  }
  friend constexpr bool operator>(const DoubleDouble& a, const DoubleDouble& b) { return b < a; }
  friend constexpr bool operator<=(const DoubleDouble& a, const DoubleDouble& b) {
    return a.high_ < b.high_ || (a.high_ == b.high_ && a.low_ <= b.low_);
  }
  friend constexpr bool operator>=(const DoubleDouble& a, const DoubleDouble& b) { return b <= a; }

 private:
  constexpr DoubleDouble(double high, double low) : high_(high), low_(low) {}

  /// Computes a + b exactly (Knuth 1969). `fast_sum` requires |a| >= |b| and needs only three
  /// operations (Dekker 1971).
  static DoubleDouble sum(double a, double b) {
    const double s = a + b, t = s - a;
    return {s, (a - (s - t)) + (b - t)};
  }
  static DoubleDouble fast_sum(double a, double b) {
    const double s = a + b;
    return {s, b - (s - a)};
  }
  /// Computes the product a b exactly, by a fused multiply-add or from halves of 26 bits. The
  /// results of both methods are bitwise equal.
  static DoubleDouble product(double a, double b) {
    const double p = a * b;
#ifdef __FMA__
    return {p, __builtin_fma(a, b, -p)};
#else
    const auto halves = [](double x) {
      const double c = 134217729.0 * x;  // 2²⁷ + 1
      const double high = c - (c - x);
      return DoubleDouble(high, x - high);
    };
    const DoubleDouble x = halves(a), y = halves(b);
    return {p, ((x.high_ * y.high_ - p) + x.high_ * y.low_ + x.low_ * y.high_) + x.low_ * y.low_};
#endif
  }

  double high_ = 0.0, low_ = 0.0;
};

}  // namespace wheeltap::fem

template <>
class std::numeric_limits<wheeltap::fem::DoubleDouble> : public std::numeric_limits<double> {
 public:
  static constexpr int digits = 106;
  static constexpr int digits10 = 31;
  static constexpr int max_digits10 = 33;
  static constexpr wheeltap::fem::DoubleDouble epsilon() { return 0x1p-104; }
};

/// Scalar traits for Eigen.
template <>
struct Eigen::NumTraits<wheeltap::fem::DoubleDouble> : Eigen::GenericNumTraits<double> {
  using Real = wheeltap::fem::DoubleDouble;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 20,
    MulCost = 25
  };
  static Real epsilon() { return std::numeric_limits<Real>::epsilon(); }
  static Real dummy_precision() { return 1e-25; }
  static int digits10() { return 31; }
};

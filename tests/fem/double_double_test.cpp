#include "fem/double_double.hpp"

#include <gtest/gtest.h>

#include <random>

namespace wheeltap::fem {
namespace {

/// 2⁻¹⁰⁴ relative; long double (64 bits or more) can only check that the rounded result is correct.
constexpr double kEpsilon = 0x1p-100;

DoubleDouble random(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return DoubleDouble(uniform(generator)) + DoubleDouble(0x1p-54 * uniform(generator));
}

TEST(DoubleDouble, InverseOperationsRestoreTheValue) {
  std::mt19937_64 generator(1);
  for (int i = 0; i < 10000; ++i) {
    const DoubleDouble a = random(generator), b = random(generator);
    EXPECT_LE(abs((a + b) - b - a), (abs(a) + abs(b)) * kEpsilon);
    EXPECT_LE(abs(a * b / b - a), abs(a) * kEpsilon);
    const DoubleDouble root = sqrt(abs(a));
    EXPECT_LE(abs(root * root - abs(a)), abs(a) * kEpsilon);
    // (a + b)² - (a - b)² = 4 a b
    EXPECT_LE(abs((a + b) * (a + b) - (a - b) * (a - b) - 4.0 * a * b),
              (a * a + b * b) * (8.0 * kEpsilon));
  }
}

TEST(DoubleDouble, KeepsDigitsThatDoubleLoses) {
  const DoubleDouble one_and_little = DoubleDouble(1.0) + DoubleDouble(0x1p-80);
  EXPECT_EQ(static_cast<double>(one_and_little - DoubleDouble(1.0)), 0x1p-80);
  EXPECT_GT(one_and_little, DoubleDouble(1.0));
  const DoubleDouble third = DoubleDouble(1.0) / DoubleDouble(3.0);
  EXPECT_LT(std::abs(static_cast<double>(third * 3.0 - 1.0)), 1e-31);
  EXPECT_NE(static_cast<double>(third - 1.0 / 3.0), 0.0);
  const long double wide = 1.0L + 0x1p-60L;
  EXPECT_EQ(static_cast<long double>(DoubleDouble::from(wide)), wide);
}

}  // namespace
}  // namespace wheeltap::fem

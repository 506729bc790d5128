#include "identification/emulation/outside_emulator.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <cmath>

namespace wheeltap::identification {
namespace {

using inference::Parameter;

/// y = (√(x_0 (1 + x_1)), oscillation in x_1); fails beyond x_1 = `wall`.
class Smooth final : public OutsideModel {
 public:
  explicit Smooth(double waves, double wall = 1e9) : waves_(waves), wall_(wall) {}
  [[nodiscard]] int inputs() const override { return 2; }
  [[nodiscard]] int outputs() const override { return 2; }
  void evaluate(std::span<const double> x, std::span<double> y) override {
    ++calls;
    if (x[1] > wall_) throw OutsideModelError(OutsideModelError::Kind::bad_answer, "a wall");
    y[0] = std::sqrt(x[0] * (1.0 + x[1]));
    y[1] = 10.0 + std::sin(waves_ * x[1]);
  }
  std::atomic<int> calls = 0;

 private:
  double waves_, wall_;
};

std::vector<Parameter> unknowns() {
  return {{"k", inference::Prior(inference::LogNormal{std::log(1e4), 0.8})},
          {"r", inference::Prior(inference::Uniform{0.0, 1.0})}};
}

TEST(OutsideEmulator, ItsBoxIsThatOfThePriors) {
  Smooth model(3.0);
  const OutsideEmulator emulator(model, unknowns(), {}, 2);
  EXPECT_EQ(model.calls, 50);  // 20 per unknown, and a quarter for the holdout
  const auto& box = emulator.box();
  EXPECT_NEAR(box[0].low(), 1e4 * std::exp(-3.2), 1e-6 * box[0].low());
  EXPECT_NEAR(box[0].high(), 1e4 * std::exp(3.2), 1e-6 * box[0].high());
  EXPECT_EQ(box[0].scale, emulator::Scale::logarithm);
  EXPECT_EQ(box[1].low(), 0.0);
  EXPECT_EQ(box[1].high(), 1.0);
  EXPECT_EQ(box[1].scale, emulator::Scale::linear);
  EXPECT_TRUE(emulator.contains(std::vector<double>{1e4, 1.0}));
  EXPECT_FALSE(emulator.contains(std::vector<double>{1e6, 0.5}));
}

// Errors at 400 new points, standardised by the claimed variance, have mean square 1. 40 fresh runs
// determine their variance to about a factor of 2; one value in 10^6 is beyond 4.75 sd of χ².
TEST(OutsideEmulator, VarianceIsThatOfItsErrors) {
  for (const double waves : {3.0, 200.0}) {
    Smooth model(waves);
    const OutsideEmulator emulator(model, unknowns(), {.runs = 40, .holdout = 40}, 2);
    const auto points = emulator::random_design(emulator.box(), 400, 77);
    double sum = 0.0;
    std::vector<double> y(2), found(2), variance(2);
    for (Eigen::Index i = 0; i < points.runs(); ++i) {
      model.evaluate(points.point(i), y);
      emulator.evaluate(points.point(i), found, variance);
      sum += (y[1] - found[1]) * (y[1] - found[1]) / variance[1];
    }
    EXPECT_LT(sum / 400.0, 2.0 * (1.0 + 4.75 * std::sqrt(2.0 / 400.0))) << waves;
    EXPECT_EQ(emulator.error().holdout[1].cannot_be_predicted(), waves > 100.0);
  }
}

TEST(OutsideEmulator, ItsErrorCanBeDisabled) {
  Smooth model(3.0);
  const OutsideEmulator emulator(model, unknowns(), {.emulator_error = false}, 1);
  std::vector<double> y(2), variance(2, 1.0);
  emulator.evaluate(std::vector<double>{1e4, 0.5}, y, variance);
  EXPECT_EQ(variance, (std::vector<double>{0.0, 0.0}));
  EXPECT_NEAR(y[0], std::sqrt(1.5e4), 0.05 * std::sqrt(1.5e4));
}

TEST(OutsideEmulator, RethrowsTheModelsFailure) {
  Smooth model(3.0, 0.9);
  EXPECT_THROW(OutsideEmulator(model, unknowns(), {}, 2), OutsideModelError);
}

}  // namespace
}  // namespace wheeltap::identification

#include "signals/modal/stochastic_subspace.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "random_vibration.hpp"

namespace wheeltap::signals {
namespace {

using Complex = std::complex<double>;

/// R_i of three modes, exact: real and imaginary parts of complex exponentials, with complex
/// shapes.
struct ExactModes {
  std::vector<Complex> lambda;
  Eigen::MatrixXcd shapes, weights;
  double step = 0.05;

  ExactModes() {
    for (const double f : {1.0, 2.8, 3.1}) {
      const double omega = 2.0 * std::numbers::pi * f, zeta = 0.01 * f;
      lambda.emplace_back(-zeta * omega, omega * std::sqrt(1.0 - zeta * zeta));
    }
    shapes.resize(4, 3);
    shapes << Complex(1.0, 0.1), 1.0, 0.3, 0.5, Complex(-0.7, 0.2), 0.9, 0.4, 0.3, 1.0, -0.6, 0.2,
        Complex(0.5, -0.3);
    weights.resize(3, 2);
    weights << Complex(1.0, 0.2), 0.4, Complex(0.5, -0.5), 0.9, 0.3, Complex(-0.8, 0.1);
  }
  [[nodiscard]] OutputCovariances covariances(int lags) const {
    OutputCovariances out{.lags = lags,
                          .samples = 1000,
                          .references = {0, 1},
                          .scale = Eigen::Vector4d(1.0, 2.0, 0.5, 3.0),
                          .zero_lag = Eigen::Vector4d::Ones(),
                          .blocks = {},
                          .mean = Eigen::MatrixXd::Zero(4 * lags, 2)};
    for (int i = 1; i <= lags; ++i)
      for (int m = 0; m < 3; ++m)
        out.mean.middleRows(4 * (i - 1), 4) +=
            (out.scale.cwiseInverse().asDiagonal() * shapes.col(m) *
             std::exp(lambda[static_cast<std::size_t>(m)] * (step * i)) * weights.row(m))
                .real();
    return out;
  }
};

OutputCovariances with_blocks(OutputCovariances c, const Eigen::MatrixXd& moved) {
  c.blocks = {c.mean + moved, c.mean - moved};
  return c;
}

Eigen::MatrixXd some_move(const OutputCovariances& c, std::uint64_t seed) {
  base::Random random(seed, 0, 0, base::Purpose::test);
  Eigen::MatrixXd out(c.mean.rows(), c.mean.cols());
  for (double& x : out.reshaped()) x = random.normal();
  return out;
}

TEST(StochasticSubspace, FindsExactModesFromExactCovariances) {
  const ExactModes exact;
  const OutputCovariances c = exact.covariances(20);
  const StochasticSubspace subspace(with_blocks(c, 0.0 * c.mean),
                                    {.step = exact.step, .largest_order = 6});
  const std::vector<Pole> poles = subspace.poles(6, {});
  ASSERT_EQ(poles.size(), 3U);
  for (std::size_t m = 0; m < 3; ++m) {
    EXPECT_LT(std::abs(poles[m].eigenvalue - exact.lambda[m]), 1e-9);
    EXPECT_NEAR(poles[m].damping, -exact.lambda[m].real() / std::abs(exact.lambda[m]), 1e-10);
    EXPECT_NEAR(modal_assurance(poles[m].shape, exact.shapes.col(static_cast<Eigen::Index>(m))),
                1.0, 1e-12);
    EXPECT_NEAR(poles[m].shape.cwiseAbs().maxCoeff(), 1.0, 1e-14);
  }
}

// Compares the derivative to H along a random direction with differences of the algorithm: at the
// true order, and at larger and smaller ones, where the truncated part of H matters.
TEST(StochasticSubspace, MovesEqualDerivatives) {
  const ExactModes exact;
  OutputCovariances c = exact.covariances(20);
  c.mean += 1e-3 * some_move(c, 1);  // no exact rank
  const Eigen::MatrixXd direction = some_move(c, 2);
  const double h = 1e-7, norm = std::numbers::sqrt2;
  for (const int order : {2, 6, 8, 12}) {
    const SubspaceOptions options{.step = exact.step, .largest_order = 12};
    const StochasticSubspace subspace(with_blocks(c, direction), options);
    const std::vector<Pole> poles = subspace.poles(order, {});
    ASSERT_FALSE(poles.empty());
    std::vector<int> places;
    for (const Pole& p : poles) places.push_back(p.place);
    const MovedPoles moved = subspace.moved_poles(order, places);
    const auto at = [&](double side) {
      OutputCovariances other = c;
      other.mean += side * h * direction;
      return StochasticSubspace(with_blocks(other, direction), options).poles(order, {});
    };
    const std::vector<Pole> up = at(1.0), down = at(-1.0);
    ASSERT_EQ(up.size(), poles.size());
    ASSERT_EQ(down.size(), poles.size());
    for (std::size_t i = 0; i < poles.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const double df = (up[i].frequency_hz - down[i].frequency_hz) / (2.0 * h);
      const double dz = (up[i].damping - down[i].damping) / (2.0 * h);
      EXPECT_NEAR(norm * moved.frequency_moves(row, 0), df, 1e-4 * std::abs(df) + 1e-4) << order;
      EXPECT_NEAR(norm * moved.damping_moves(row, 0), dz, 1e-4 * std::abs(dz) + 1e-4) << order;
      const Eigen::VectorXcd dphi = (up[i].shape - down[i].shape) / (2.0 * h);
      Eigen::VectorXd parts(8);
      parts << dphi.real(), dphi.imag();
      EXPECT_LT((norm * moved.shape_moves[i].col(0) - parts).norm(), 1e-3 * (1.0 + parts.norm()))
          << order;
      // Two blocks move it in opposite directions: both ways of computing agree.
      EXPECT_NEAR(poles[i].frequency_sd, std::abs(df), 1e-4 * std::abs(df) + 1e-4);
      EXPECT_NEAR(poles[i].damping_sd, std::abs(dz), 1e-4 * std::abs(dz) + 1e-4);
    }
  }
}

// The results are independent of units.
TEST(StochasticSubspace, ChannelScalesAffectOnlyShapes) {
  const Eigen::MatrixXd y = chain(3, 1.0, 200.0).accelerations(4000, 0.05, 1);
  const Eigen::Vector3d units(1e3, 1.0, 1e-3);
  const auto poles_of = [](const Eigen::MatrixXd& records) {
    const OutputCovariances c = output_covariances(records, {.lags = 20, .blocks = 20});
    return StochasticSubspace(c, {.step = 0.05, .largest_order = 6}).poles(6, {});
  };
  const std::vector<Pole> a = poles_of(y), b = poles_of(units.asDiagonal() * y);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(b[i].frequency_hz, a[i].frequency_hz, 1e-9);
    EXPECT_NEAR(b[i].damping_sd, a[i].damping_sd, 1e-9);
    EXPECT_NEAR(modal_assurance(b[i].shape, units.asDiagonal() * a[i].shape), 1.0, 1e-12);
  }
}

TEST(StochasticSubspace, RejectsInvalidOrders) {
  const ExactModes exact;
  const OutputCovariances c = exact.covariances(20);
  EXPECT_THROW(StochasticSubspace(with_blocks(c, c.mean), {.step = 0.0}), std::invalid_argument);
  EXPECT_THROW(StochasticSubspace(with_blocks(c, c.mean), {.largest_order = 22}),
               std::invalid_argument);
  EXPECT_THROW(StochasticSubspace(with_blocks(c, c.mean), {.columns = 20}), std::invalid_argument);
  const StochasticSubspace subspace(with_blocks(c, c.mean), {.largest_order = 6});
  EXPECT_THROW((void)subspace.poles(8, {}), std::invalid_argument);
  EXPECT_THROW((void)subspace.poles(3, {}), std::invalid_argument);
  EXPECT_THROW((void)subspace.moved_poles(6, {6}), std::invalid_argument);
}

TEST(Shapes, PhaseCollinearityDistinguishesLinesFromCircles) {
  Eigen::VectorXcd line(4), circle(4);
  line << 1.0, -2.0, 0.5, 3.0;
  circle << Complex(1, 0), Complex(0, 1), Complex(-1, 0), Complex(0, -1);
  const Complex turn = std::polar(2.0, 0.7);
  EXPECT_NEAR(phase_collinearity(turn * line), 1.0, 1e-12);
  EXPECT_NEAR(mean_phase_deviation(turn * line), 0.0, 1e-7);
  EXPECT_NEAR(phase_collinearity(circle), 0.0, 1e-12);
  EXPECT_NEAR(mean_phase_deviation(circle), std::numbers::pi / 4.0, 1e-7);
  EXPECT_NEAR(modal_assurance(line, turn * line), 1.0, 1e-12);
  EXPECT_NEAR(modal_assurance(line, circle), 25.25 / (14.25 * 4.0), 1e-12);
}

}  // namespace
}  // namespace wheeltap::signals

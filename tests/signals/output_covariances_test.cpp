#include "signals/modal/output_covariances.hpp"

#include <gtest/gtest.h>

#include "random_vibration.hpp"

namespace wheeltap::signals {
namespace {

Eigen::MatrixXd white_noise(int channels, int samples) {
  base::Random random(3, 0, 0, base::Purpose::test);
  Eigen::MatrixXd y(channels, samples);
  for (Eigen::Index k = 0; k < samples; ++k)
    for (Eigen::Index c = 0; c < channels; ++c) y(c, k) = random.normal();
  return y;
}

// The sums from their definition, one product after the other.
TEST(OutputCovariances, EqualTheSumsOfProducts) {
  const Eigen::MatrixXd y = white_noise(3, 400);
  const OutputCovariances c = output_covariances(y, {.lags = 4, .blocks = 5, .references = {2, 0}});
  EXPECT_EQ(c.samples, (400 - 4) / 5);
  // The scaled channels of the library: detrended, of unit variance.
  Eigen::MatrixXd z(3, 400);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(400, -1.0, 1.0);
    Eigen::ArrayXd x = y.row(i).transpose();
    x -= x.mean();
    x -= t * (x * t).sum() / t.square().sum();
    z.row(i) = (x / std::sqrt(x.square().mean())).matrix().transpose();
    EXPECT_NEAR(c.scale[i], std::sqrt(x.square().mean()), 1e-12);
  }
  for (int block = 0; block < 5; ++block)
    for (int lag = 1; lag <= 4; ++lag)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 2; ++j) {
          double sum = 0.0;
          for (long k = block * c.samples; k < (block + 1) * c.samples; ++k)
            sum += z(i, k + lag) * z(c.references[static_cast<std::size_t>(j)], k);
          EXPECT_NEAR(c.blocks[static_cast<std::size_t>(block)]((lag - 1) * 3 + i, j),
                      sum / static_cast<double>(c.samples), 1e-12);
        }
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(12, 2);
  for (const Eigen::MatrixXd& b : c.blocks) mean += b / 5.0;
  EXPECT_LT((mean - c.mean).norm(), 1e-13);
}

TEST(OutputCovariances, RejectInvalidRecords) {
  Eigen::MatrixXd y = white_noise(2, 400);
  EXPECT_THROW((void)output_covariances(y, {.lags = 80, .blocks = 5}), std::invalid_argument);
  EXPECT_THROW((void)output_covariances(y, {.lags = 4, .blocks = 5, .references = {2}}),
               std::invalid_argument);
  EXPECT_THROW((void)output_covariances(y, {.lags = 4, .blocks = 1}), std::invalid_argument);
  y.row(1).setConstant(7.0);
  EXPECT_THROW((void)output_covariances(y, {.lags = 4, .blocks = 5}), std::invalid_argument);
  y(1, 3) = std::nan("");
  EXPECT_THROW((void)output_covariances(y, {.lags = 4, .blocks = 5}), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::signals

// Output covariances of simultaneous records at several time lags, for all samples and for blocks
// of samples.
#pragma once

#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::signals {

struct CovarianceOptions {
  int lags = 60;                     ///< number of lags: i = 1 … lags
  int blocks = 50;                   ///< number n_b of blocks of equal length; remaining samples
                                     ///< are not used
  std::vector<int> references = {};  ///< reference channels; empty: all channels
  int threads = 0;
};

/// The output covariances R_i = 1/n Σ_k y_{k+i} y_{k,ref}ᵀ, i = 1 … lags, of detrended channels
/// divided by their standard deviations. A product of two samples belongs to the block of the
/// earlier sample, and every lag has the same number of products. The mean of R_i over the blocks
/// therefore equals R_i of all samples.
struct OutputCovariances {
  int lags = 0;
  long samples = 0;             ///< number of samples per block
  std::vector<int> references;  ///< reference channels, in the given order
  Eigen::VectorXd scale;        ///< standard deviation of each channel [unit of the channel]
  Eigen::VectorXd zero_lag;     ///< variance of each scaled channel over the samples used, about 1
  std::vector<Eigen::MatrixXd> blocks;  ///< one matrix per block, (lags · channels) × references;
                                        ///< block rows R_1, …
  Eigen::MatrixXd mean;                 ///< mean of the matrices of the blocks

  [[nodiscard]] int channels() const { return static_cast<int>(scale.size()); }
};

/// Estimates the output covariances of `records`, with one channel per row. Throws ChannelError for
/// a channel that is constant or not finite, a reference that does not exist, and blocks that are
/// not longer than the lags.
[[nodiscard]] OutputCovariances output_covariances(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                                   const CovarianceOptions& options);

}  // namespace wheeltap::signals

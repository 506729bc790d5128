#include "signals/modal/output_covariances.hpp"

#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "base/parallel.hpp"
#include "signals/refuse.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::signals {
OutputCovariances output_covariances(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                     const CovarianceOptions& options) {
  const auto r = records.rows(), n = records.cols();
  if (options.lags < 1) refuse("lags", options.lags, "must be at least 1");
  if (options.blocks < 2) refuse("blocks", options.blocks, "must be at least 2");
  if (r < 1) refuse("channels", r, "must be at least 1");
  OutputCovariances out{.lags = options.lags,
                        .samples = (n - options.lags) / options.blocks,
                        .references = options.references,
                        .scale = Eigen::VectorXd(r),
                        .zero_lag = Eigen::VectorXd(r),
                        .blocks = {},
                        .mean = {}};
  if (out.samples <= options.lags)
    refuse("samples", n,
           "must be more than " + std::to_string((options.blocks + 1L) * options.lags) +
               ": each of " + std::to_string(options.blocks) + " blocks must be longer than " +
               std::to_string(options.lags) + " lags");
  if (out.references.empty()) {
    out.references.resize(static_cast<std::size_t>(r));
    std::iota(out.references.begin(), out.references.end(), 0);
  }
  for (const int c : out.references)
    if (c < 0 || c >= r) refuse("reference", c, "must be a channel below " + std::to_string(r));

  Eigen::MatrixXd y(r, n);
  std::vector<double> x(static_cast<std::size_t>(n));
  for (Eigen::Index c = 0; c < r; ++c) {
    Eigen::Map<Eigen::RowVectorXd> row(x.data(), n);
    row = records.row(c);
    if (!row.allFinite()) throw ChannelError(c, "holds values that are not finite");
    const double largest = row.cwiseAbs().maxCoeff();
    detrend(x, 1);
    out.scale[c] = std::sqrt(row.squaredNorm() / static_cast<double>(n));
    if (!(out.scale[c] > 1e-12 * largest)) throw ChannelError(c, "is constant");
    y.row(c) = row / out.scale[c];
    out.zero_lag[c] = y.row(c).squaredNorm() / static_cast<double>(n);
  }
  const auto r0 = static_cast<Eigen::Index>(out.references.size());
  Eigen::MatrixXd ref(r0, n);
  for (Eigen::Index c = 0; c < r0; ++c)
    ref.row(c) = y.row(out.references[static_cast<std::size_t>(c)]);

  // Column k holds y_{k+1}, …, y_{k+lags}, contiguous in memory.
  const Eigen::Index b = out.samples, rows = options.lags * r;
  out.blocks.resize(static_cast<std::size_t>(options.blocks));
  base::parallel_for(options.blocks, options.threads, [&](int k) {
    const Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> later(
        y.data() + (k * b + 1) * r, rows, b, Eigen::OuterStride<>(r));
    out.blocks[static_cast<std::size_t>(k)] =
        later * ref.middleCols(k * b, b).transpose() / static_cast<double>(b);
  });
  out.mean = Eigen::MatrixXd::Zero(rows, r0);
  for (const Eigen::MatrixXd& block : out.blocks) out.mean += block;
  out.mean /= static_cast<double>(options.blocks);
  return out;
}

}  // namespace wheeltap::signals

// Data of the charts from the draws of a run: histograms, thinned histories, quantiles.
#pragma once

#include "apps/results/summary.hpp"

namespace wheeltap::io {
class NetcdfReader;
}

namespace wheeltap::apps {

/// Reads posterior.nc of the run with this `summary`, one variable at a time. Returns the data of
/// the charts, at most a few hundred kilobytes of JSON:
/// - visits: model of every n-th draw, per chain; `running`: P(model) as draws accumulate.
/// - log_posterior: every n-th draw, per chain.
/// - parameters: per model with P >= 0.5 %: histogram, prior density, thinned history per chain.
/// - pairs: joint histograms of up to six parameters per model with P >= 0.5 %.
/// - joint: histograms of location and severity per kind of defect, for all counts together and for
/// each count.
/// - predictive: quantiles of the replicated frequencies.
/// - responses: for each response channel, data and 95 % band of replicated data over time,
///   spectra, frequency response functions for the excitations, autocorrelation of the residuals.
///
/// The prior densities are computed from the case. The i-th of n exchangeable locations has the
/// prior of the i-th order statistic. Throws io::FileError (corrupt, foreign).
[[nodiscard]] Report digest(const io::NetcdfReader& posterior, const Report& summary);

}  // namespace wheeltap::apps

// What the report draws, from the draws of a run: histograms, thinned histories, quantiles.
#pragma once

#include "apps/results/summary.hpp"

namespace wheeltap::io {
class NetcdfReader;
}

namespace wheeltap::apps {

/// Reads posterior.nc beside its `summary`, one variable at a time, and returns what the charts
/// need, at most a few hundred kilobytes of JSON:
///   visits       model of every n-th draw, per chain; `running`: P(model) as draws accumulate
///   log_posterior every n-th draw, per chain
///   parameters   per model with P >= 0.5 %: histogram, prior density, thinned history per chain
///   pairs        joint histograms of up to six parameters per such model
///   joint        location × severity per kind of defect, all counts together and for each
///   predictive   quantiles of the replicated frequencies
///   responses    per channel of a record: data and replicated band over time, spectra, frequency
///                responses to what drove it, autocorrelation of the residuals
/// Priors are those of the case; the i-th of n exchangeable locations has the i-th order
/// statistic's. Throws io::FileError (corrupt, foreign).
[[nodiscard]] Report digest(const io::NetcdfReader& posterior, const Report& summary);

}  // namespace wheeltap::apps

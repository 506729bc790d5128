// Shared parts of the digest: variables of posterior.nc, their draws, histogram bins.
#pragma once

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/results/summary.hpp"
#include "io/netcdf/netcdf_reader.hpp"

namespace wheeltap::apps {

// Models with a probability below this value have no charts
inline constexpr double kCharted = 0.005;
inline constexpr std::size_t kHistoryPoints = 400;  // points per chain in the histories

struct Bins {
  double from = 0.0, width = 1.0;
  std::size_t n = 1;
  [[nodiscard]] std::size_t at(double x) const {
    const double position = (x - from) / width;
    return position <= 0.0 ? 0 : std::min(static_cast<std::size_t>(position), n - 1);
  }
  [[nodiscard]] Report json() const {
    return {{"from", compact(from, width)}, {"width", width}, {"n", n}};
  }
};

/// Returns a number of bins proportional to the cube root of the number of draws, as in the rule of
/// Freedman & Diaconis (1981). The bins are narrower than those of this rule, because posteriors
/// often have several narrow peaks.
[[nodiscard]] std::size_t bins_for(std::size_t draws, double factor, std::size_t fewest,
                                   std::size_t most);
/// Returns n bins over the range of the draws; one bin if all draws are equal.
[[nodiscard]] Bins bins_over(const std::vector<double>& values, std::size_t n);
/// A two-dimensional histogram.
class CellCounts {
 public:
  CellCounts(const Bins& x, const Bins& y) : x_(x), y_(y), counts_(x.n * y.n) {}
  void add(double x, double y, double weight = 1.0) {
    counts_[x_.at(x) * y_.n + y_.at(y)] += weight;
  }
  /// Returns each non-empty cell as [i, j, density], density = count / (total · cell area).
  [[nodiscard]] Report json(double total) const;

 private:
  Bins x_, y_;
  std::vector<double> counts_;
};

/// Largest number of draws in a chart. More draws do not visibly change the chart.
constexpr std::size_t kMostCharted = 1 << 18;

/// An unknown of a model and the variable of posterior.nc with its draws.
struct Series {
  std::string label;     ///< label of the unknown, as in summary.json
  std::size_t slot = 0;  ///< row of the variable, 0-based
  std::string prior;     ///< JSON pointer to the prior of the unknown in the case
  /// Size of the group of exchangeable unknowns to which this unknown belongs as number slot + 1;
  /// 0: not exchangeable
  int ordered_among = 0;
  std::string unit;  ///< unit of the unknown; empty if not known
  const io::NetcdfArray* variable = nullptr;

  [[nodiscard]] double at(std::size_t draw) const {
    return variable->values[draw * variable->inner() + slot];
  }
};

/// The draws of a run. If the run has more than kMostCharted draws, only every step()-th draw is
/// used.
class StoredDraws {
 public:
  StoredDraws(const io::NetcdfReader& file, const Report& summary);
  [[nodiscard]] std::size_t chains() const { return chains_; }
  /// The number of stored draws of each chain.
  [[nodiscard]] std::size_t draws() const { return draws_; }
  [[nodiscard]] std::size_t step() const { return step_; }
  /// The number of draws of each chain in the run.
  [[nodiscard]] std::size_t all_draws() const { return all_draws_; }
  /// The index (from 1) of the i-th stored draw among all draws of its chain.
  [[nodiscard]] std::size_t number(std::size_t i) const { return i * step_ + 1; }
  [[nodiscard]] std::size_t model(std::size_t at) const { return model_[at]; }
  /// The weight of a draw; the average weight is 1.
  [[nodiscard]] double weight(std::size_t at) const { return weights_[at]; }
  [[nodiscard]] std::size_t size() const { return model_.size(); }
  [[nodiscard]] const io::NetcdfArray* find(const std::string& name) const;
  /// The unknowns of a model in the order of summary.json.
  [[nodiscard]] std::vector<Series> series(const std::string& model) const;

 private:
  Report unknowns_;
  std::map<std::string, io::NetcdfArray> variables_;
  std::size_t chains_ = 0, draws_ = 0, all_draws_ = 0, step_ = 1;
  std::vector<std::size_t> model_;
  std::vector<double> weights_;
};

/// Adds "parameters" (histogram, prior density and thinned history of each parameter of the models
/// with P >= kCharted) and "pairs" (joint histograms) to `out`.
void digest_parameters(const StoredDraws& posterior, const Report& summary, Report& out);
/// Returns for each response channel of a record: data and predictions with and without noise over
/// time, spectra, frequency response functions for the excitations, autocorrelation of the
/// residuals.
[[nodiscard]] Report digest_responses(const io::NetcdfReader& file);
/// Returns thinned time histories of each link: extension, rate and tension at the draw of highest
/// posterior density, and the tension from the data. The result is empty if the run did not store
/// the series.
[[nodiscard]] Report digest_links(const io::NetcdfReader& file);

}  // namespace wheeltap::apps

// What the parts of the digest share: variables of posterior.nc, the draws in them, bins.
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

inline constexpr double kCharted = 0.005;           // models with less probability have no charts
inline constexpr std::size_t kHistoryPoints = 400;  // a chain, in the histories

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

/// As many bins as the draws can fill: in proportion to the cube root of their number, as Freedman
/// & Diaconis's rule (1981) has it, but finer, since posteriors here are often several narrow
/// islands.
[[nodiscard]] std::size_t bins_for(std::size_t draws, double factor, std::size_t fewest,
                                   std::size_t most);
/// Bins over the draws; all alike where they are one value.
[[nodiscard]] Bins bins_over(const std::vector<double>& values, std::size_t n);
/// A two-dimensional histogram.
class CellCounts {
 public:
  CellCounts(const Bins& x, const Bins& y) : x_(x), y_(y), counts_(x.n * y.n) {}
  void add(double x, double y, double weight = 1.0) {
    counts_[x_.at(x) * y_.n + y_.at(y)] += weight;
  }
  /// Cells that hold anything: [i, j, density], of what adds up to `total`.
  [[nodiscard]] Report json(double total) const;

 private:
  Bins x_, y_;
  std::vector<double> counts_;
};

/// More draws make no other picture.
constexpr std::size_t kMostCharted = 1 << 18;

/// An unknown of a model and the variable that holds its draws.
struct Series {
  std::string label;      ///< as in summary.json
  std::size_t slot = 0;   ///< of the variable's rows, 0-based
  std::string prior;      ///< where the case states it, a JSON pointer
  int ordered_among = 0;  ///< of so many exchangeable ones it is the (slot + 1)-th; 0: of none
  std::string unit;       ///< empty where not known
  const io::NetcdfArray* variable = nullptr;

  [[nodiscard]] double at(std::size_t draw) const {
    return variable->values[draw * variable->inner() + slot];
  }
};

/// The draws of a run, of more than kMostCharted every step()-th.
class StoredDraws {
 public:
  StoredDraws(const io::NetcdfReader& file, const Report& summary);
  [[nodiscard]] std::size_t chains() const { return chains_; }
  /// Those held of each chain.
  [[nodiscard]] std::size_t draws() const { return draws_; }
  [[nodiscard]] std::size_t step() const { return step_; }
  /// Those made.
  [[nodiscard]] std::size_t all_draws() const { return all_draws_; }
  /// The number, from 1, that the i-th held of a chain has among all of it.
  [[nodiscard]] std::size_t number(std::size_t i) const { return i * step_ + 1; }
  [[nodiscard]] std::size_t model(std::size_t at) const { return model_[at]; }
  /// What a draw counts beside others, 1 on average.
  [[nodiscard]] double weight(std::size_t at) const { return weights_[at]; }
  [[nodiscard]] std::size_t size() const { return model_.size(); }
  [[nodiscard]] const io::NetcdfArray* find(const std::string& name) const;
  /// Those of a model, as summary.json lists them.
  [[nodiscard]] std::vector<Series> series(const std::string& model) const;

 private:
  Report unknowns_;
  std::map<std::string, io::NetcdfArray> variables_;
  std::size_t chains_ = 0, draws_ = 0, all_draws_ = 0, step_ = 1;
  std::vector<std::size_t> model_;
  std::vector<double> weights_;
};

/// Histogram, prior density and thinned history of each parameter of the models that matter, and
/// joint histograms of pairs, as "parameters" and "pairs" of `out`.
void digest_parameters(const StoredDraws& posterior, const Report& summary, Report& out);
/// Each response channel of a record: data, what is predicted without noise and with it, over time,
/// spectra, frequency responses to what drove it, autocorrelation of the residuals.
[[nodiscard]] Report digest_responses(const io::NetcdfReader& file);
/// What each link went through in the motion of the best draw, and what the data say of its
/// tension; thinned evenly. Empty where the run did not keep it.
[[nodiscard]] Report digest_links(const io::NetcdfReader& file);

}  // namespace wheeltap::apps

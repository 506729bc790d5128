#include <algorithm>
#include <cmath>

#include "apps/report/digest_draws.hpp"
#include "base/log_gamma.hpp"

namespace wheeltap::apps {
namespace {

constexpr std::size_t kMostPairs = 6;  // parameters in plots of pairs
constexpr std::size_t kCurve = 161;    // points of a prior's density

double density(const inference::Prior& prior, double x) {
  return std::exp(prior.log_density(x));
}

// Density of the i-th smallest (1-based) of n independent draws.
double order_statistic(const inference::Prior& prior, double x, int i, int n) {
  const double f = 0.5 * std::erfc(-prior.to_standard_normal(x) / std::sqrt(2.0));
  const double choose =
      std::exp(base::log_gamma(n + 1) - base::log_gamma(i) - base::log_gamma(n - i + 1));
  return choose * std::pow(f, i - 1) * std::pow(1.0 - f, n - i) * density(prior, x);
}

// The prior at this location in the case; empty if it is not a single prior.
std::optional<inference::Prior> prior_of(const CaseFile& stated, const std::string& pointer) {
  if (pointer.empty()) return {};
  try {
    const Pointer where(pointer);
    if (!stated.json.contains(where) || !stated.json[where].is_object()) return {};
    return parse_prior(stated, where);
  } catch (const std::exception&) {
    return {};
  }
}

// Adds the default priors of a discovery's terms. The summary contains these priors as text,
// "uniform [0, 2]", with the names that a case uses.
void add_priors_made(const Report& summary, Json& stated) {
  if (!summary.contains("priors") || !summary["priors"].is_object()) return;
  for (const auto& [label, words] : summary["priors"].items()) {
    if (!words.is_string() || stated["parameters"].contains(label)) continue;
    const auto text = words.get<std::string>();
    const std::size_t space = text.find(' ');
    if (space == std::string::npos) continue;
    const Json numbers = Json::parse(text.substr(space), nullptr, false);
    if (numbers.is_discarded()) continue;
    stated["parameters"][label] = {{text.substr(0, space), numbers}};
  }
}

Report one_parameter(const StoredDraws& posterior, const Series& series, std::size_t model,
                     std::vector<double>& all, const CaseFile& stated) {
  all.clear();
  std::vector<std::vector<std::size_t>> inside(posterior.chains());  // draws of the model
  for (std::size_t c = 0; c < posterior.chains(); ++c) {
    for (std::size_t i = c * posterior.draws(); i < (c + 1) * posterior.draws(); ++i) {
      if (posterior.model(i) != model) continue;
      const double x = series.at(i);
      if (!std::isfinite(x)) continue;
      all.push_back(x);
      inside[c].push_back(i);
    }
  }
  if (all.empty()) return {};
  const auto [low, high] = std::ranges::minmax(all);
  Report history = Report::array();
  for (std::size_t c = 0; c < posterior.chains(); ++c) {
    Report one = Report::array();
    const std::size_t step = std::max<std::size_t>(1, inside[c].size() / kHistoryPoints);
    for (std::size_t n = 0; n < inside[c].size(); n += step) {
      const std::size_t i = inside[c][n];
      one.push_back(
          {posterior.number(i - c * posterior.draws()), compact(series.at(i), high - low)});
    }
    history.push_back(std::move(one));
  }
  const Bins bins = bins_over(all, bins_for(all.size(), 4.0, 20, 200));
  std::vector<std::size_t> counts(bins.n);
  for (const double x : all) ++counts[bins.at(x)];
  Report heights = Report::array();
  for (const std::size_t n : counts) {
    heights.push_back(
        compact(static_cast<double>(n) / (static_cast<double>(all.size()) * bins.width)));
  }
  Report out = {
      {"name", series.label}, {"unit", series.unit}, {"bins", bins.json()}, {"density", heights}};
  if (const auto prior = prior_of(stated, series.prior)) {
    Report x_list = Report::array(), p_list = Report::array();
    const double span = bins.width * static_cast<double>(bins.n);
    const bool ordered = series.ordered_among > 1;
    const auto prior_density = [&](double x) {
      return ordered && x > prior->lower() && x < prior->upper()
                 ? order_statistic(*prior, x, static_cast<int>(series.slot) + 1,
                                   series.ordered_among)
                 : density(*prior, x);
    };
    for (std::size_t i = 0; i < kCurve; ++i) {
      const double x = bins.from + span * (static_cast<double>(i) / (kCurve - 1) * 1.1 - 0.05);
      const double p = prior_density(x);
      if (!std::isfinite(p)) continue;
      x_list.push_back(compact(x, bins.width));
      p_list.push_back(compact(p));
    }
    // The overlap of the posterior and prior densities: 1 if the data contain no information.
    double overlap = 0.0;
    for (std::size_t b = 0; b < bins.n; ++b) {
      const double x = bins.from + (static_cast<double>(b) + 0.5) * bins.width;
      overlap += bins.width * std::min(heights[b].get<double>(), prior_density(x));
    }
    out["prior"] = {{"words", prior->describe()},
                    {"overlap", compact(overlap)},
                    {"ordered", ordered},
                    {"x", x_list},
                    {"density", p_list}};
  }
  out["history"] = history;
  return out;
}

}  // namespace

void digest_parameters(const StoredDraws& posterior, const Report& summary, Report& out) {
  CaseFile stated;
  stated.json = Json::parse(summary.at("wheeltap").at("case").dump());
  if (summary.contains("discovery")) add_priors_made(summary, stated.json);
  out["parameters"] = Report::object();
  out["pairs"] = Report::object();
  for (std::size_t m = 0; m < summary.at("models").size(); ++m) {
    const std::string name = summary.at("models")[m].at("name").get<std::string>();
    if (!(summary.at("models")[m].at("probability").get<double>() >= kCharted) ||
        !summary.at("parameters").contains(name)) {
      continue;
    }
    Report list = Report::array();
    std::vector<std::vector<double>> draws;
    std::vector<std::string> labels, units;
    for (const Series& series : posterior.series(name)) {
      std::vector<double> all;
      Report one = one_parameter(posterior, series, m, all, stated);
      if (one.is_null()) continue;
      list.push_back(std::move(one));
      // Omit a constant unknown from the pairs (for example, if all damages are on one member).
      const auto [low, high] = std::ranges::minmax(all);
      if (labels.size() < kMostPairs && low < high) {
        labels.push_back(series.label);
        units.push_back(series.unit);
        draws.push_back(std::move(all));
      }
    }
    Report pairs = Report::array();
    for (std::size_t i = 0; i < draws.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (draws[i].size() != draws[j].size()) continue;
        const std::size_t bins = bins_for(draws[i].size(), 1.5, 12, 40);
        const Bins bx = bins_over(draws[j], bins), by = bins_over(draws[i], bins);
        CellCounts counts(bx, by);
        for (std::size_t n = 0; n < draws[i].size(); ++n) counts.add(draws[j][n], draws[i][n]);
        pairs.push_back({{"x", labels[j]},
                         {"y", labels[i]},
                         {"x_unit", units[j]},
                         {"y_unit", units[i]},
                         {"bins_x", bx.json()},
                         {"bins_y", by.json()},
                         {"cells", counts.json(static_cast<double>(draws[i].size()))}});
      }
    }
    if (!list.empty()) out["parameters"][name] = std::move(list);
    if (!pairs.empty()) out["pairs"][name] = std::move(pairs);
  }
}

}  // namespace wheeltap::apps

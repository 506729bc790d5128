#include "apps/report/digest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "apps/report/digest_draws.hpp"

namespace wheeltap::apps {

using identification::weighted_quantile;

namespace {

// Quantiles of values with weights.
Report quantiles_of(const std::vector<std::pair<double, double>>& values) {
  Report out = Report::array();
  for (const double p : {0.025, 0.25, 0.5, 0.75, 0.975}) {
    out.push_back(weighted_quantile(values, p));
  }
  return out;
}

Report visits(const StoredDraws& posterior, std::size_t models) {
  const std::size_t step = std::max<std::size_t>(1, posterior.draws() / kHistoryPoints);
  Report chains = Report::array();
  for (std::size_t c = 0; c < posterior.chains(); ++c) {
    Report one = Report::array();
    for (std::size_t i = 0; i < posterior.draws(); i += step) {
      one.push_back(posterior.model(c * posterior.draws() + i));
    }
    chains.push_back(std::move(one));
  }
  constexpr std::size_t kPoints = 100;
  Report draws = Report::array(), probability = Report::array();
  std::vector<double> seen(models);
  double all = 0.0;
  for (std::size_t i = 0, next = 1; i < posterior.draws(); ++i) {
    for (std::size_t c = 0; c < posterior.chains(); ++c) {
      const std::size_t at = c * posterior.draws() + i;
      seen[posterior.model(at)] += posterior.weight(at);
      all += posterior.weight(at);
    }
    if ((i + 1) * kPoints < next * posterior.draws() && i + 1 < posterior.draws()) continue;
    ++next;
    draws.push_back(std::min(posterior.number(i) + posterior.step() - 1, posterior.all_draws()));
    Report row = Report::array();
    for (const double n : seen) row.push_back(compact(n / all));
    probability.push_back(std::move(row));
  }
  return {{"step", step * posterior.step()},
          {"chains", chains},
          {"running", {{"draws", draws}, {"probability", probability}}}};
}

// Expected number of defects per metre and unit of severity.
Report joint(const StoredDraws& posterior, const Report& summary) {
  Report out = Report::array();
  if (!summary.contains("kinds") || !summary.contains("beam")) return out;
  const double length = summary.at("beam").at("length").get<double>();
  const bool several = summary.at("kinds").size() > 1;
  for (const Report& kind : summary.at("kinds")) {
    if (!kind.at("severity").is_string()) continue;
    const auto name = kind.at("name").get<std::string>();
    const std::string prefix = several ? name + "_" : "";
    const bool share = kind.value("share", kind["severity"] == "reduction");
    const std::string severity = kind.at("severity").get<std::string>();
    const io::NetcdfArray* x = posterior.find(prefix + "location");
    const io::NetcdfArray* y = posterior.find(prefix + severity);
    if (x == nullptr || y == nullptr || x->values.size() != y->values.size()) continue;
    const std::size_t slots = x->inner();
    const auto present = [&](std::size_t i) { return std::isfinite(x->values[i]); };
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < x->values.size(); ++i) {
      if (!present(i)) continue;
      low = std::min(low, y->values[i]);
      high = std::max(high, y->values[i]);
    }
    if (!(low <= high)) continue;
    // About a hundred bins along the beam, with a whole number of bins per element.
    const auto elements =
        std::max<std::size_t>(1, summary.at("beam").value("elements", std::size_t{1}));
    const std::size_t along = elements * std::max<std::size_t>(1, (100 + elements - 1) / elements);
    const Bins bx{0.0, length / static_cast<double>(along), along};
    // The axis of a fraction extends from zero to a round number above the largest value.
    const double top = share ? std::min(1.0, std::ceil(10.0 * high) / 10.0) : high;
    const double bottom = share ? 0.0 : low;
    const Bins by{bottom, top > bottom ? (top - bottom) / 50.0 : 1.0, 50};
    struct View {
      CellCounts counts;
      double draws = 0.0;
    };
    std::map<std::size_t, View> by_count;  // by count; 0: all counts
    for (std::size_t at = 0; at < posterior.size(); ++at) {
      const double weight = posterior.weight(at);
      std::size_t count = 0;
      for (std::size_t s = 0; s < slots; ++s) count += present(at * slots + s);
      for (const std::size_t into : {std::size_t{0}, count}) {
        View& view = by_count.try_emplace(into, View{CellCounts(bx, by)}).first->second;
        view.draws += weight;
        for (std::size_t i = at * slots; i < (at + 1) * slots; ++i)
          if (present(i)) view.counts.add(x->values[i], y->values[i], weight);
        if (count == 0) break;
      }
    }
    Report views = Report::array();
    for (const auto& [count, view] : by_count) {
      if (view.draws < kCharted * static_cast<double>(posterior.size()) * 10.0) continue;
      views.push_back({{"count", count},
                       {"probability", view.draws / static_cast<double>(posterior.size())},
                       {"cells", view.counts.json(view.draws)}});
    }
    out.push_back({{"kind", name},
                   {"severity", severity},
                   {"share", share},
                   {"bins_x", bx.json()},
                   {"bins_y", by.json()},
                   {"views", views}});
  }
  return out;
}

// Quantiles of replicated frequencies, one row per mode.
Report predictive(const io::NetcdfReader& file, const StoredDraws& posterior) {
  const auto group = file.group("posterior_predictive");
  const auto observed = file.group("observed_data");
  Report out = Report::object();
  if (!group || !observed) return out;
  const auto names = file.variables(*group);
  if (std::ranges::find(names, "frequency") == names.end()) return out;
  const std::vector<std::size_t> shape = file.shape(*group, "frequency");
  const io::NetcdfArray measured = file.read(*observed, "frequency");
  if (shape.size() != 3 || measured.values.size() != shape[2] || shape[0] != posterior.chains() ||
      shape[1] != posterior.all_draws()) {
    return out;
  }
  const std::size_t modes = shape[2];
  const auto observed_names = file.variables(*observed);
  std::optional<io::NetcdfArray> sd;
  if (std::ranges::find(observed_names, "sd") != observed_names.end()) {
    sd = file.read(*observed, "sd");
  }
  Report rows = Report::array();
  for (std::size_t m = 0; m < modes; ++m) {
    const std::vector<double> replicated = file.read_last(*group, "frequency", m);
    std::vector<std::pair<double, double>> values;
    values.reserve(posterior.size());
    for (std::size_t at = 0; at < posterior.size(); ++at) {
      const std::size_t chain = at / posterior.draws(), i = at % posterior.draws();
      const double f = replicated[chain * shape[1] + i * posterior.step()];
      if (std::isfinite(f)) values.emplace_back(f, posterior.weight(at));
    }
    if (values.empty()) continue;
    rows.push_back({{"mode", m + 1},
                    {"observed", measured.values[m]},
                    {"sd", sd ? Report(sd->values[m]) : Report()},
                    {"quantiles", quantiles_of(values)}});
  }
  out["frequency"] = rows;
  return out;
}

}  // namespace

Report digest(const io::NetcdfReader& file, const Report& summary) {
  Report out = Report::object();
  {
    const StoredDraws posterior(file, summary);
    out["chains"] = posterior.chains();
    out["draws"] = posterior.all_draws();
    out["visits"] = visits(posterior, summary.at("models").size());
    digest_parameters(posterior, summary, out);
    out["joint"] = joint(posterior, summary);
    out["predictive"] = predictive(file, posterior);
  }
  if (const auto group = file.group("sample_stats")) {
    const io::NetcdfArray lp = file.read(*group, "lp");
    if (lp.shape.size() != 2)
      file.foreign("has a log posterior whose dimensions are not (chain, draw)");
    const std::size_t step = std::max<std::size_t>(1, lp.shape[1] / kHistoryPoints);
    const auto [low, high] = std::ranges::minmax(lp.values);
    Report chains = Report::array();
    for (std::size_t c = 0; c < lp.shape[0]; ++c) {
      Report one = Report::array();
      for (std::size_t i = 0; i < lp.shape[1]; i += step) {
        one.push_back({i + 1, compact(lp.values[c * lp.shape[1] + i], high - low)});
      }
      chains.push_back(std::move(one));
    }
    out["log_posterior"] = chains;
  }
  out["responses"] = digest_responses(file);
  out["link_paths"] = digest_links(file);
  out["created_at"] = file.text("created_at");
  return out;
}

}  // namespace wheeltap::apps

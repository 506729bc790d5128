#include "apps/report/digest.hpp"

#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "apps/case_file.hpp"
#include "io/file_error.hpp"
#include "signals/residuals.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::apps {
namespace {

using io::FileError;

constexpr double kShown = 0.005;       // models with less probability have no charts of their own
constexpr std::size_t kHistory = 400;  // points a chain in the histories
constexpr std::size_t kMostPairs = 6;  // parameters that are paired
constexpr std::size_t kTimePoints = 8000;  // of all channels together
constexpr std::size_t kMostDrivers = 2;    // excitations with frequency responses
constexpr double kExcited = 1e-4;          // of its peak: a spectrum below has no response to show
constexpr std::size_t kCurve = 161;        // points of a prior's density

// Five digits are more than a chart shows, and shorter to store.
double compact(double x) {
  if (!std::isfinite(x) || x == 0.0) return x;
  char text[32];
  std::snprintf(text, sizeof text, "%.5g", x);
  return std::strtod(text, nullptr);
}

struct Variable {
  std::vector<std::size_t> shape;  // chain, draw, …
  std::vector<double> values;
  [[nodiscard]] std::size_t inner() const {
    std::size_t n = 1;
    for (std::size_t i = 2; i < shape.size(); ++i) n *= shape[i];
    return n;
  }
};

class NetcdfReader {
 public:
  explicit NetcdfReader(const std::filesystem::path& path) : path_(path) {
    if (!std::filesystem::exists(path)) {
      throw FileError(FileError::Kind::missing, path, "no such file");
    }
    if (const int status = nc_open(path.c_str(), NC_NOWRITE, &file_); status != NC_NOERR) {
      throw FileError(FileError::Kind::corrupt, path,
                      std::string("is truncated or not a NetCDF-4 file: ") + nc_strerror(status));
    }
  }
  NetcdfReader(const NetcdfReader&) = delete;
  NetcdfReader& operator=(const NetcdfReader&) = delete;
  ~NetcdfReader() { nc_close(file_); }

  [[nodiscard]] std::optional<int> group(const char* name) const {
    int id = 0;
    if (nc_inq_grp_ncid(file_, name, &id) != NC_NOERR) return {};
    return id;
  }
  [[nodiscard]] int required_group(const char* name) const {
    const auto id = group(name);
    if (!id) foreign(std::string("has no group \"") + name + "\"");
    return *id;
  }
  [[nodiscard]] std::vector<std::string> variables(int group) const {
    int n = 0;
    check(nc_inq_varids(group, &n, nullptr));
    std::vector<int> ids(static_cast<std::size_t>(n));
    check(nc_inq_varids(group, &n, ids.data()));
    std::vector<std::string> names;
    for (const int id : ids) {
      char name[NC_MAX_NAME + 1];
      check(nc_inq_varname(group, id, name));
      names.emplace_back(name);
    }
    return names;
  }
  [[nodiscard]] Variable read(int group, const std::string& name) const {
    int id = 0, rank = 0;
    if (nc_inq_varid(group, name.c_str(), &id) != NC_NOERR) {
      foreign("has no variable \"" + name + "\"");
    }
    check(nc_inq_varndims(group, id, &rank));
    std::vector<int> dimensions(static_cast<std::size_t>(rank));
    check(nc_inq_vardimid(group, id, dimensions.data()));
    Variable out;
    std::size_t size = 1;
    for (const int d : dimensions) {
      std::size_t length = 0;
      check(nc_inq_dimlen(group, d, &length));
      out.shape.push_back(length);
      size *= length;
    }
    out.values.resize(size);
    check(nc_get_var_double(group, id, out.values.data()));
    return out;
  }
  // A global attribute; empty where there is none.
  [[nodiscard]] std::string text(const char* attribute) const {
    std::size_t length = 0;
    if (nc_inq_attlen(file_, NC_GLOBAL, attribute, &length) != NC_NOERR) return {};
    std::string value(length, '\0');
    return nc_get_att_text(file_, NC_GLOBAL, attribute, value.data()) == NC_NOERR ? value : "";
  }
  [[nodiscard]] std::string text(int group, const std::string& name, const char* attribute) const {
    int id = 0;
    std::size_t length = 0;
    if (nc_inq_varid(group, name.c_str(), &id) != NC_NOERR ||
        nc_inq_attlen(group, id, attribute, &length) != NC_NOERR) {
      return {};
    }
    std::string value(length, '\0');
    return nc_get_att_text(group, id, attribute, value.data()) == NC_NOERR ? value : "";
  }
  [[noreturn]] void foreign(const std::string& why) const {
    throw FileError(FileError::Kind::foreign, path_, why + ": not a posterior of wheeltap");
  }

 private:
  void check(int status) const {
    if (status == NC_NOERR) return;
    throw FileError(FileError::Kind::corrupt, path_,
                    std::string("cannot be read, truncated or damaged: ") + nc_strerror(status));
  }
  std::filesystem::path path_;
  int file_ = -1;
};

struct Bins {
  double from = 0.0, width = 1.0;
  std::size_t n = 1;
  [[nodiscard]] std::size_t at(double x) const {
    const double position = (x - from) / width;
    return position <= 0.0 ? 0 : std::min(static_cast<std::size_t>(position), n - 1);
  }
  [[nodiscard]] Report json() const {
    return {{"from", compact(from)}, {"width", width}, {"n", n}};
  }
};

// As many bins as the draws can fill: in proportion to the cube root of their number, as Freedman &
// Diaconis's rule (1981) has it, but finer, since posteriors here are often several narrow islands.
std::size_t bins_for(std::size_t draws, double factor, std::size_t fewest, std::size_t most) {
  const auto wanted = static_cast<std::size_t>(factor * std::cbrt(static_cast<double>(draws)));
  return std::clamp(wanted, fewest, most);
}

// Bins over the draws; all alike where they are one value.
Bins bins_over(const std::vector<double>& values, std::size_t n) {
  const auto [low, high] = std::ranges::minmax(values);
  if (!(high > low)) {
    const double unit = low == 0.0 ? 1.0 : 0.01 * std::abs(low);
    return {low - 0.5 * unit, unit, 1};
  }
  return {low, (high - low) / static_cast<double>(n), n};
}

// Cells of a two-dimensional histogram that hold anything: [i, j, density].
Report cells(const std::vector<double>& x, const std::vector<double>& y, const Bins& bx,
             const Bins& by, double total, const std::vector<double>& weights = {}) {
  std::vector<double> counts(bx.n * by.n);
  for (std::size_t i = 0; i < x.size(); ++i) {
    counts[bx.at(x[i]) * by.n + by.at(y[i])] += weights.empty() ? 1.0 : weights[i];
  }
  Report out = Report::array();
  for (std::size_t c = 0; c < counts.size(); ++c) {
    if (counts[c] == 0.0) continue;
    out.push_back({c / by.n, c % by.n, compact(counts[c] / (total * bx.width * by.width))});
  }
  return out;
}

// Of values and what each counts.
Report quantiles_of(const std::vector<std::pair<double, double>>& values) {
  Report out = Report::array();
  for (const double p : {0.025, 0.25, 0.5, 0.75, 0.975}) {
    out.push_back(weighted_quantile(values, p));
  }
  return out;
}

// ---- priors --------------------------------------------------------------------------------

double density(const inference::Prior& prior, double x) {
  return std::exp(prior.log_density(x));
}

// Density of the i-th smallest (1-based) of n independent draws.
double order_statistic(const inference::Prior& prior, double x, int i, int n) {
  const double f = 0.5 * std::erfc(-prior.to_standard_normal(x) / std::sqrt(2.0));
  const double choose = std::exp(std::lgamma(n + 1) - std::lgamma(i) - std::lgamma(n - i + 1));
  return choose * std::pow(f, i - 1) * std::pow(1.0 - f, n - i) * density(prior, x);
}

// The priors that a case states, by the names that parameters have.
class CasePriors {
 public:
  explicit CasePriors(const Report& summary) {
    file_.json = Json::parse(summary["wheeltap"]["case"].dump());
  }
  // `base` is the name without its index, e.g. "location"; `kind` 0-based among several blocks.
  [[nodiscard]] std::optional<inference::Prior> find(const std::string& base,
                                                     std::size_t kind) const {
    const Pointer block = file_.json.value("/damage"_json_pointer, Json()).is_array()
                              ? Pointer("/damage") / kind
                              : Pointer("/damage");
    for (const Pointer& where :
         {block / base, Pointer("/parameters") / base, Pointer("/data") / base}) {
      if (!file_.json.contains(where) || !file_.json[where].is_object()) continue;
      try {
        return parse_prior(file_, where);
      } catch (const std::exception&) {
        return {};  // not a plain prior: drawn without one
      }
    }
    return {};
  }

 private:
  CaseFile file_;
};

// ---- draws ---------------------------------------------------------------------------------

struct Slot {
  std::string label;  // as in summary.json
  std::string base;   // without index and kind
  int index = 0;      // 1-based; 0: not of a defect
  std::size_t kind = 0;
  const Variable* variable = nullptr;
};

class Posterior {
 public:
  Posterior(const NetcdfReader& file, const Report& summary) : summary_(summary) {
    const int group = file.required_group("posterior");
    names_ = file.variables(group);
    const Variable model = file.read(group, "model");
    if (model.shape.size() != 2 || model.values.empty()) {
      file.foreign("has no draws of the model");
    }
    chains_ = model.shape[0];
    draws_ = model.shape[1];
    const auto models = static_cast<double>(summary["models"].size());
    for (const double m : model.values) {
      if (!(m >= 0.0 && m < models)) file.foreign("names a model that summary.json does not have");
      model_.push_back(static_cast<std::size_t>(m));
    }
    for (const std::string& name : names_) {
      if (name == "chain" || name == "draw" || name == "model" || name.ends_with("slot")) continue;
      Variable v = file.read(group, name);
      if (v.shape.size() < 2 || v.shape[0] != chains_ || v.shape[1] != draws_) continue;
      variables_.emplace(name, std::move(v));
    }
    weights_.assign(model_.size(), 1.0);
    if (const auto stats = file.group("sample_stats")) {
      const auto names = file.variables(*stats);
      if (std::ranges::find(names, "weight") != names.end()) {
        const Variable weight = file.read(*stats, "weight");
        if (weight.values.size() == model_.size()) weights_ = weight.values;
      }
    }
    if (summary.contains("kinds")) {
      for (const auto& kind : summary["kinds"]) kinds_.push_back(kind["name"]);
    }
  }
  [[nodiscard]] std::size_t chains() const { return chains_; }
  [[nodiscard]] std::size_t draws() const { return draws_; }
  [[nodiscard]] std::size_t model(std::size_t at) const { return model_[at]; }
  // What a draw counts beside others, 1 on average.
  [[nodiscard]] double weight(std::size_t at) const { return weights_[at]; }
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] std::size_t size() const { return model_.size(); }
  [[nodiscard]] const std::vector<std::string>& kinds() const { return kinds_; }
  [[nodiscard]] const Variable* find(const std::string& name) const {
    const auto at = variables_.find(name);
    return at == variables_.end() ? nullptr : &at->second;
  }
  // The draws behind a label of summary.json's parameters, e.g. "support location[2]".
  [[nodiscard]] std::optional<Slot> slot(const std::string& label) const {
    std::string stored = label;  // a NetCDF name holds no "/"
    std::ranges::replace(stored, '/', '_');
    while (stored.ends_with(' ')) stored.pop_back();
    Slot out{label, label, 0, 0, find(stored)};
    if (out.variable != nullptr) return out;
    const std::size_t bracket = label.rfind('[');
    if (bracket == std::string::npos || !label.ends_with(']')) return {};
    out.base = label.substr(0, bracket);
    const std::string digits = label.substr(bracket + 1, label.size() - bracket - 2);
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) return {};
    out.index = std::stoi(digits);
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      std::string bare = out.base;
      if (bare.starts_with(kinds_[k] + " ")) {
        bare = bare.substr(kinds_[k].size() + 1);
      } else if (kinds_.size() > 1 && find(kinds_[k] + "_" + bare) == nullptr) {
        continue;
      }
      const Variable* v = find(kinds_.size() > 1 ? kinds_[k] + "_" + bare : bare);
      if (v == nullptr) continue;
      out.base = bare, out.kind = k, out.variable = v;
      break;
    }
    if (out.variable == nullptr || out.index < 1 ||
        static_cast<std::size_t>(out.index) > out.variable->inner()) {
      return {};
    }
    return out;
  }
  [[nodiscard]] static double value(const Slot& slot, std::size_t at) {
    const auto i = static_cast<std::size_t>(std::max(slot.index - 1, 0));
    return slot.variable->values[at * slot.variable->inner() + i];
  }

 private:
  const Report& summary_;
  std::vector<std::string> names_, kinds_;
  std::map<std::string, Variable> variables_;
  std::size_t chains_ = 0, draws_ = 0;
  std::vector<std::size_t> model_;
  std::vector<double> weights_;
};

Report visits(const Posterior& posterior, std::size_t models) {
  const std::size_t step = std::max<std::size_t>(1, posterior.draws() / kHistory);
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
    draws.push_back(i + 1);
    Report row = Report::array();
    for (const double n : seen) row.push_back(compact(n / all));
    probability.push_back(std::move(row));
  }
  return {{"step", step},
          {"chains", chains},
          {"running", {{"draws", draws}, {"probability", probability}}}};
}

Report one_parameter(const Posterior& posterior, const Slot& slot, std::size_t model,
                     std::vector<double>& all, const CasePriors& priors, int of) {
  all.clear();
  Report history = Report::array();
  for (std::size_t c = 0; c < posterior.chains(); ++c) {
    std::vector<std::size_t> inside;
    for (std::size_t i = c * posterior.draws(); i < (c + 1) * posterior.draws(); ++i) {
      if (posterior.model(i) != model) continue;
      const double x = Posterior::value(slot, i);
      if (!std::isfinite(x)) continue;
      all.push_back(x);
      inside.push_back(i);
    }
    Report one = Report::array();
    const std::size_t step = std::max<std::size_t>(1, inside.size() / kHistory);
    for (std::size_t n = 0; n < inside.size(); n += step) {
      one.push_back(
          {inside[n] - c * posterior.draws() + 1, compact(Posterior::value(slot, inside[n]))});
    }
    history.push_back(std::move(one));
  }
  if (all.empty()) return {};
  const Bins bins = bins_over(all, bins_for(all.size(), 4.0, 20, 200));
  std::vector<std::size_t> counts(bins.n);
  for (const double x : all) ++counts[bins.at(x)];
  Report heights = Report::array();
  for (const std::size_t n : counts) {
    heights.push_back(
        compact(static_cast<double>(n) / (static_cast<double>(all.size()) * bins.width)));
  }
  Report out = {{"name", slot.label}, {"bins", bins.json()}, {"density", heights}};
  if (const auto prior = priors.find(slot.base, slot.kind)) {
    Report x_list = Report::array(), p_list = Report::array();
    const double span = bins.width * static_cast<double>(bins.n);
    const bool ordered = slot.base == "location" && of > 1;
    const auto prior_density = [&](double x) {
      return ordered && x > prior->lower() && x < prior->upper()
                 ? order_statistic(*prior, x, slot.index, of)
                 : density(*prior, x);
    };
    for (std::size_t i = 0; i < kCurve; ++i) {
      const double x = bins.from + span * (static_cast<double>(i) / (kCurve - 1) * 1.1 - 0.05);
      const double p = prior_density(x);
      if (!std::isfinite(p)) continue;
      x_list.push_back(compact(x));
      p_list.push_back(compact(p));
    }
    // The area that posterior and prior share: 1 where the data said nothing.
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

void parameters(const Posterior& posterior, const Report& summary, Report& out) {
  const CasePriors priors(summary);
  out["parameters"] = Report::object();
  out["pairs"] = Report::object();
  for (std::size_t m = 0; m < summary["models"].size(); ++m) {
    const std::string name = summary["models"][m]["name"];
    if (!(summary["models"][m]["probability"].get<double>() >= kShown) ||
        !summary["parameters"].contains(name)) {
      continue;
    }
    std::vector<Slot> slots;
    for (const auto& [label, row] : summary["parameters"][name].items()) {
      if (const auto slot = posterior.slot(label)) slots.push_back(*slot);
    }
    Report list = Report::array();
    std::vector<std::vector<double>> draws;
    std::vector<std::string> labels;
    for (const Slot& slot : slots) {
      int of = 0;
      for (const Slot& other : slots) {
        of += other.base == slot.base && other.kind == slot.kind ? 1 : 0;
      }
      std::vector<double> all;
      Report one = one_parameter(posterior, slot, m, all, priors, of);
      if (one.is_null()) continue;
      list.push_back(std::move(one));
      if (labels.size() < kMostPairs) {
        labels.push_back(slot.label);
        draws.push_back(std::move(all));
      }
    }
    Report pairs = Report::array();
    for (std::size_t i = 0; i < draws.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (draws[i].size() != draws[j].size()) continue;
        const std::size_t bins = bins_for(draws[i].size(), 1.5, 12, 40);
        const Bins bx = bins_over(draws[j], bins), by = bins_over(draws[i], bins);
        pairs.push_back(
            {{"x", labels[j]},
             {"y", labels[i]},
             {"bins_x", bx.json()},
             {"bins_y", by.json()},
             {"cells", cells(draws[j], draws[i], bx, by, static_cast<double>(draws[i].size()))}});
      }
    }
    if (!list.empty()) out["parameters"][name] = std::move(list);
    if (!pairs.empty()) out["pairs"][name] = std::move(pairs);
  }
}

// Expected number of defects per metre and unit of severity.
Report joint(const Posterior& posterior, const Report& summary) {
  Report out = Report::array();
  if (!summary.contains("kinds") || !summary.contains("beam")) return out;
  const double length = summary["beam"]["length"];
  for (std::size_t k = 0; k < posterior.kinds().size(); ++k) {
    const Report& kind = summary["kinds"][k];
    if (!kind["severity"].is_string()) continue;
    const std::string prefix = posterior.kinds().size() > 1 ? posterior.kinds()[k] + "_" : "";
    const std::string severity = kind["severity"];
    const Variable* x = posterior.find(prefix + "location");
    const Variable* y = posterior.find(prefix + severity);
    if (x == nullptr || y == nullptr || x->values.size() != y->values.size()) continue;
    const std::size_t slots = x->inner();
    struct Cloud {
      std::vector<double> x, y, weights;
      double draws = 0.0;
    };
    std::map<std::size_t, Cloud> by_count;  // 0: all
    for (std::size_t at = 0; at < posterior.size(); ++at) {
      std::size_t count = 0;
      for (std::size_t s = 0; s < slots; ++s) count += std::isfinite(x->values[at * slots + s]);
      for (const std::size_t into : {std::size_t{0}, count}) {
        Cloud& cloud = by_count[into];
        cloud.draws += posterior.weight(at);
        for (std::size_t s = 0; s < slots; ++s) {
          if (!std::isfinite(x->values[at * slots + s])) continue;
          cloud.x.push_back(x->values[at * slots + s]);
          cloud.y.push_back(y->values[at * slots + s]);
          cloud.weights.push_back(posterior.weight(at));
        }
        if (count == 0) break;
      }
    }
    if (by_count[0].x.empty()) continue;
    const Bins bx{0.0, length / 100.0, 100};
    const auto [low, high] = std::ranges::minmax(by_count[0].y);
    // Reductions are drawn from zero to a round number above the largest.
    const double top =
        severity == "reduction" ? std::min(1.0, std::ceil(10.0 * high) / 10.0) : high;
    const double bottom = severity == "reduction" ? 0.0 : low;
    const Bins by{bottom, top > bottom ? (top - bottom) / 50.0 : 1.0, 50};
    Report views = Report::array();
    for (const auto& [count, cloud] : by_count) {
      if (cloud.draws < kShown * static_cast<double>(posterior.size()) * 10.0) continue;
      views.push_back({{"count", count},
                       {"probability", cloud.draws / static_cast<double>(posterior.size())},
                       {"cells", cells(cloud.x, cloud.y, bx, by, cloud.draws, cloud.weights)}});
    }
    out.push_back({{"kind", posterior.kinds()[k]},
                   {"severity", severity},
                   {"bins_x", bx.json()},
                   {"bins_y", by.json()},
                   {"views", views}});
  }
  return out;
}

// Quantiles of replicated frequencies, one row a mode.
Report predictive(const NetcdfReader& file, const std::vector<double>& weights) {
  const auto group = file.group("posterior_predictive");
  const auto observed = file.group("observed_data");
  Report out = Report::object();
  if (!group || !observed) return out;
  const auto names = file.variables(*group);
  if (std::ranges::find(names, "frequency") == names.end()) return out;
  const Variable replicated = file.read(*group, "frequency");
  const Variable measured = file.read(*observed, "frequency");
  const std::size_t modes = replicated.inner();
  if (replicated.shape.size() != 3 || measured.values.size() != modes ||
      replicated.values.size() != modes * weights.size()) {
    return out;
  }
  const auto observed_names = file.variables(*observed);
  std::optional<Variable> sd;
  if (std::ranges::find(observed_names, "sd") != observed_names.end()) {
    sd = file.read(*observed, "sd");
  }
  Report rows = Report::array();
  for (std::size_t m = 0; m < modes; ++m) {
    std::vector<std::pair<double, double>> values;
    for (std::size_t i = m; i < replicated.values.size(); i += modes) {
      if (std::isfinite(replicated.values[i])) {
        values.emplace_back(replicated.values[i], weights[i / modes]);
      }
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

// ---- time histories ------------------------------------------------------------------------

// What drove the chain, as the run kept it.
struct Driver {
  std::string name, role, unit;
  std::vector<double> values;
};

std::vector<Driver> drivers(const NetcdfReader& file, std::size_t samples) {
  std::vector<Driver> out;
  const auto group = file.group("constant_data");
  if (!group) return out;
  for (const std::string& name : file.variables(*group)) {
    if (name == "sample") continue;
    Driver one{name, file.text(*group, name, "role"), file.text(*group, name, "units"),
               file.read(*group, name).values};
    const auto [low, high] = std::ranges::minmax(one.values);
    if (one.values.size() == samples && high > low) out.push_back(std::move(one));
  }
  // A base displacement beside the base's acceleration is the same motion.
  if (std::ranges::any_of(out, [](const Driver& d) { return d.role == "base acceleration"; })) {
    std::erase_if(out, [](const Driver& d) { return d.role == "base displacement"; });
  }
  return out;
}

// Frequency responses H1 of the data and of the predicted median to one excitation, estimated with
// the same windows: frequency, |H1| and phase of both, coherence of the data; frequencies that
// nothing excited are left out.
Report transfer(const Driver& driver, const std::vector<double>& y,
                const std::vector<double>& median, double rate, const std::string& unit) {
  // At least fifteen half-overlapping segments: the coherence of few is near 1 whatever the data.
  const int segment = static_cast<int>(std::clamp<std::size_t>(y.size() / 8, 8, 1024));
  const auto data = signals::frequency_response(driver.values, y, rate, {.segment = segment});
  const auto model = signals::frequency_response(driver.values, median, rate, {.segment = segment});
  const auto excited = signals::welch(driver.values, rate, {.segment = segment});
  const double enough = kExcited * std::ranges::max(excited.density);
  Report rows = Report::array();
  for (std::size_t f = 1; f < data.frequencies_hz.size(); ++f) {
    if (excited.density[f] < enough) continue;
    rows.push_back({compact(data.frequencies_hz[f]), compact(std::abs(data.h1[f])),
                    compact(std::abs(model.h1[f])), compact(std::arg(data.h1[f])),
                    compact(std::arg(model.h1[f])), compact(data.coherence[f])});
  }
  return {{"name", driver.name},
          {"role", driver.role},
          {"unit", unit + " / " + driver.unit},
          {"segments", data.segments},
          {"rows", rows}};
}

// Each response channel of a record: data, predictive median and 95 % band over time; spectra of
// data, median and residual; autocorrelation of the residual. Long records are cut into buckets
// that keep the extremes.
Report responses(const NetcdfReader& file) {
  Report out = Report::array();
  const auto group = file.group("posterior_predictive");
  const auto data = file.group("observed_data");
  if (!group || !data) return out;
  const auto observed_names = file.variables(*data);
  if (std::ranges::find(observed_names, "time") == observed_names.end()) return out;
  const std::vector<double> time = file.read(*data, "time").values;
  std::vector<std::string> names;
  for (const std::string& name : file.variables(*group)) {
    if (name != "time" && name != "sample" &&
        std::ranges::find(observed_names, name) != observed_names.end()) {
      names.push_back(name);
    }
  }
  const std::size_t samples = time.size();
  if (names.empty() || samples < 4) return out;
  const std::size_t points = std::min(samples, kTimePoints / names.size());
  const std::vector<Driver> driven = drivers(file, samples);
  for (const std::string& name : names) {
    const std::vector<double> y = file.read(*data, name).values;
    Report json = {{"name", name}, {"unit", file.text(*group, name, "units")}};
    std::vector<double> low(samples), median(samples), high(samples);
    {
      const Variable replicated = file.read(*group, name);
      if (replicated.shape.size() != 3 || replicated.inner() != samples || y.size() != samples) {
        continue;
      }
      std::vector<double> column(replicated.shape[0] * replicated.shape[1]);
      for (std::size_t n = 0; n < samples; ++n) {
        for (std::size_t d = 0; d < column.size(); ++d) {
          column[d] = replicated.values[d * samples + n];
        }
        std::ranges::sort(column);
        low[n] = quantile(column, 0.025);
        median[n] = quantile(column, 0.5);
        high[n] = quantile(column, 0.975);
      }
    }
    Report rows = Report::array();
    for (std::size_t b = 0; b < points; ++b) {
      const std::size_t from = b * samples / points, to = (b + 1) * samples / points;
      const auto lowest = [&](const std::vector<double>& x) {
        return *std::min_element(x.begin() + static_cast<long>(from),
                                 x.begin() + static_cast<long>(to));
      };
      const auto highest = [&](const std::vector<double>& x) {
        return *std::max_element(x.begin() + static_cast<long>(from),
                                 x.begin() + static_cast<long>(to));
      };
      if (to - from == 1) {
        rows.push_back({time[from], compact(y[from]), compact(low[from]), compact(median[from]),
                        compact(high[from])});
      } else {
        // Lowest, then highest of the bucket: a line through both fills what it spans.
        const double half = 0.5 * (time[to - 1] - time[from]);
        rows.push_back({time[from], compact(lowest(y)), compact(lowest(low)),
                        compact(lowest(median)), compact(highest(high))});
        rows.push_back({time[from] + half, compact(highest(y)), compact(lowest(low)),
                        compact(highest(median)), compact(highest(high))});
      }
    }
    json["bucket"] = (samples + points - 1) / points;
    json["history"] = std::move(rows);
    std::vector<double> residual(samples);
    for (std::size_t n = 0; n < samples; ++n) residual[n] = y[n] - median[n];
    const double rate = static_cast<double>(samples - 1) / (time.back() - time.front());
    const int segment = static_cast<int>(std::clamp<std::size_t>(samples / 4, 4, 1024));
    const auto s_y = signals::welch(y, rate, {.segment = segment});
    const auto s_m = signals::welch(median, rate, {.segment = segment});
    const auto s_r = signals::welch(residual, rate, {.segment = segment});
    Report spectrum = Report::array();
    for (std::size_t f = 1; f < s_y.frequencies_hz.size(); ++f) {
      spectrum.push_back({compact(s_y.frequencies_hz[f]), compact(s_y.density[f]),
                          compact(s_m.density[f]), compact(s_r.density[f])});
    }
    json["spectrum"] = std::move(spectrum);
    json["transfer"] = Report::array();
    for (const Driver& driver : driven) {
      if (json["transfer"].size() == kMostDrivers) break;
      json["transfer"].push_back(
          transfer(driver, y, median, rate, json["unit"].get<std::string>()));
    }
    const int lags = static_cast<int>(std::min<std::size_t>(50, samples / 4));
    Report correlation = Report::array();
    for (const double rho : signals::autocorrelation(residual, lags)) {
      correlation.push_back(compact(rho));
    }
    json["autocorrelation"] = std::move(correlation);
    json["samples"] = samples;
    out.push_back(std::move(json));
  }
  return out;
}

}  // namespace

Report digest(const std::filesystem::path& posterior_file, const Report& summary) {
  const NetcdfReader file(posterior_file);
  Report out = Report::object();
  {
    const Posterior posterior(file, summary);
    out["chains"] = posterior.chains();
    out["draws"] = posterior.draws();
    out["visits"] = visits(posterior, summary["models"].size());
    parameters(posterior, summary, out);
    out["joint"] = joint(posterior, summary);
    out["predictive"] = predictive(file, posterior.weights());
  }
  if (const auto group = file.group("sample_stats")) {
    const Variable lp = file.read(*group, "lp");
    if (lp.shape.size() != 2) file.foreign("has a log posterior of another shape");
    const std::size_t step = std::max<std::size_t>(1, lp.shape[1] / kHistory);
    Report chains = Report::array();
    for (std::size_t c = 0; c < lp.shape[0]; ++c) {
      Report one = Report::array();
      for (std::size_t i = 0; i < lp.shape[1]; i += step) {
        one.push_back({i + 1, compact(lp.values[c * lp.shape[1] + i])});
      }
      chains.push_back(std::move(one));
    }
    out["log_posterior"] = chains;
  }
  out["responses"] = responses(file);
  out["created_at"] = file.text("created_at");
  return out;
}

}  // namespace wheeltap::apps

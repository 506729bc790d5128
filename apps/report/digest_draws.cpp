#include "apps/report/digest_draws.hpp"

#include <algorithm>

namespace wheeltap::apps {

std::size_t bins_for(std::size_t draws, double factor, std::size_t fewest, std::size_t most) {
  const auto wanted = static_cast<std::size_t>(factor * std::cbrt(static_cast<double>(draws)));
  return std::clamp(wanted, fewest, most);
}

Bins bins_over(const std::vector<double>& values, std::size_t n) {
  const auto [low, high] = std::ranges::minmax(values);
  if (!(high > low)) {
    const double unit = low == 0.0 ? 1.0 : 0.01 * std::abs(low);
    return {low - 0.5 * unit, unit, 1};
  }
  return {low, (high - low) / static_cast<double>(n), n};
}

Report CellCounts::json(double total) const {
  Report out = Report::array();
  for (std::size_t c = 0; c < counts_.size(); ++c) {
    if (counts_[c] == 0.0) continue;
    out.push_back({c / y_.n, c % y_.n, compact(counts_[c] / (total * x_.width * y_.width))});
  }
  return out;
}

StoredDraws::StoredDraws(const io::NetcdfReader& file, const Report& summary)
    : unknowns_(summary.value("unknowns", Report::object())) {
  const int group = file.required_group("posterior");
  const std::vector<std::size_t> shape = file.shape(group, "model");
  if (shape.size() != 2 || shape[0] == 0 || shape[1] == 0) {
    file.foreign("has no draws of the model");
  }
  step_ = (shape[0] * shape[1] + kMostCharted - 1) / kMostCharted;
  const io::NetcdfArray model = file.read_every(group, "model", step_);
  chains_ = shape[0];
  all_draws_ = shape[1];
  draws_ = model.shape[1];
  const auto models = static_cast<double>(summary.at("models").size());
  for (const double m : model.values) {
    if (!(m >= 0.0 && m < models)) file.foreign("names a model that summary.json does not have");
    model_.push_back(static_cast<std::size_t>(m));
  }
  for (const std::string& name : file.variables(group)) {
    if (name == "chain" || name == "draw" || name == "model" || name.ends_with("slot")) continue;
    const std::vector<std::size_t> of = file.shape(group, name);
    if (of.size() < 2 || of[0] != shape[0] || of[1] != shape[1]) continue;
    io::NetcdfArray v = file.read_every(group, name, step_);
    variables_.emplace(name, std::move(v));
  }
  weights_.assign(model_.size(), 1.0);
  if (const auto stats = file.group("sample_stats")) {
    const auto names = file.variables(*stats);
    if (std::ranges::find(names, "weight") != names.end()) {
      const io::NetcdfArray weight = file.read_every(*stats, "weight", step_);
      if (weight.values.size() == model_.size()) weights_ = weight.values;
    }
  }
}

const io::NetcdfArray* StoredDraws::find(const std::string& name) const {
  const auto at = variables_.find(name);
  return at == variables_.end() ? nullptr : &at->second;
}

std::vector<Series> StoredDraws::series(const std::string& model) const {
  std::vector<Series> out;
  if (!unknowns_.contains(model)) return out;
  for (const Report& u : unknowns_[model]) {
    const int slot = u.value("slot", 1) - 1;
    Series one{.label = u.value("label", ""),
               .slot = static_cast<std::size_t>(std::max(slot, 0)),
               .prior = u.value("prior", ""),
               .ordered_among = u.value("ordered_among", 0),
               .unit = u.value("unit", ""),
               .variable = find(u.value("variable", ""))};
    if (one.variable != nullptr && slot >= 0 && one.slot < one.variable->inner()) {
      out.push_back(std::move(one));
    }
  }
  return out;
}

}  // namespace wheeltap::apps

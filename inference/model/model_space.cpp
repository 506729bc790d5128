#include "inference/model/model_space.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

namespace wheeltap::inference {

namespace {

[[nodiscard]] int to_int(std::size_t n) {
  return static_cast<int>(n);
}

std::string count_name(const std::vector<ComponentKind>& kinds, const std::vector<int>& counts) {
  std::string name;
  for (std::size_t j = 0; j < kinds.size(); ++j) {
    if (!name.empty()) name += ", ";
    name += std::to_string(counts[j]) + ' ' + (counts[j] == 1 ? kinds[j].name : kinds[j].plural);
  }
  return name;
}

}  // namespace

ModelSpace ModelSpace::of_models(std::vector<Parameter> parameters,
                                 const std::vector<ListedModel>& models) {
  ModelSpace space;
  space.parameters_ = std::move(parameters);
  std::vector<bool> used(space.parameters_.size(), false);
  std::vector<double> weights;
  std::set<std::string> names;
  for (const ListedModel& listed : models) {
    if (!names.insert(listed.name).second) {
      throw std::invalid_argument("model name '" + listed.name + "' is given twice");
    }
    Model model{
        .name = listed.name, .log_prior = 0.0, .parameters = {}, .counts = {}, .offsets = {}};
    for (const std::string& name : listed.parameters) {
      const auto found = std::find_if(space.parameters_.begin(), space.parameters_.end(),
                                      [&](const Parameter& p) { return p.name == name; });
      if (found == space.parameters_.end()) {
        throw std::invalid_argument("model '" + listed.name + "' names parameter '" + name +
                                    "', which has no prior");
      }
      const auto index = found - space.parameters_.begin();
      if (std::find(model.parameters.begin(), model.parameters.end(), index) !=
          model.parameters.end()) {
        throw std::invalid_argument("model '" + listed.name + "' lists parameter '" + name +
                                    "' twice");
      }
      used[static_cast<std::size_t>(index)] = true;
      model.parameters.push_back(static_cast<int>(index));
    }
    space.models_.push_back(std::move(model));
    weights.push_back(listed.weight);
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) {
      throw std::invalid_argument("parameter '" + space.parameters_[i].name +
                                  "' is used by no model");
    }
  }
  space.finish(weights);
  return space;
}

ModelSpace ModelSpace::of_components(std::vector<Parameter> common,
                                     std::vector<ComponentKind> kinds,
                                     const std::vector<Counts>& counts) {
  ModelSpace space;
  space.parameters_ = std::move(common);
  space.kinds_ = std::move(kinds);
  std::vector<int> own(space.parameters_.size());
  for (std::size_t i = 0; i < own.size(); ++i) own[i] = to_int(i);
  std::vector<double> weights;
  std::set<std::vector<int>> seen;
  for (const Counts& entry : counts) {
    if (entry.counts.size() != space.kinds_.size()) {
      throw std::invalid_argument("a model lists " + std::to_string(entry.counts.size()) +
                                  " counts for " + std::to_string(space.kinds_.size()) +
                                  " kinds of component");
    }
    for (const int k : entry.counts) {
      if (k < 0) throw std::invalid_argument("count " + std::to_string(k) + " is below 0");
    }
    if (!seen.insert(entry.counts).second) {
      throw std::invalid_argument("the counts of '" + count_name(space.kinds_, entry.counts) +
                                  "' are given twice");
    }
    space.models_.push_back({.name = count_name(space.kinds_, entry.counts),
                             .log_prior = 0.0,
                             .parameters = own,
                             .counts = entry.counts,
                             .offsets = {}});
    weights.push_back(entry.weight);
  }
  space.finish(weights);
  return space;
}

void ModelSpace::finish(const std::vector<double>& weights) {
  double total = 0.0;
  for (std::size_t m = 0; m < weights.size(); ++m) {
    if (!(weights[m] >= 0.0) || !std::isfinite(weights[m])) {
      throw std::invalid_argument("prior weight " + std::to_string(weights[m]) + " of model '" +
                                  models_[m].name + "' must be finite and at least 0");
    }
    total += weights[m];
  }
  if (!(total > 0.0)) throw std::invalid_argument("no model has a prior weight above 0");
  for (std::size_t m = 0; m < weights.size(); ++m) {
    Model& model = models_[m];
    model.log_prior = std::log(weights[m] / total);
    model.counts.resize(kinds_.size(), 0);
    for (std::size_t j = 0, at = model.parameters.size(); j < kinds_.size(); ++j) {
      model.offsets.push_back(to_int(at));
      at += static_cast<std::size_t>(model.counts[j]) * kinds_[j].parameters.size();
    }
    std::vector<Prior>& priors = priors_.emplace_back();
    for (const int p : model.parameters) {
      priors.push_back(parameters_[static_cast<std::size_t>(p)].prior);
    }
    for (std::size_t j = 0; j < kinds_.size(); ++j) {
      for (int c = 0; c < model.counts[j]; ++c) {
        for (const Parameter& p : kinds_[j].parameters) priors.push_back(p.prior);
      }
    }
    model.dimension = to_int(priors.size());
    max_dimension_ = std::max(max_dimension_, model.dimension);
  }
  for (int m = 0; m < size(); ++m) {
    for (std::size_t j = 0; j < kinds_.size(); ++j) {
      for (const int step : {-1, +1}) {
        std::vector<int> counts = (*this)[m].counts;
        counts[j] += step;
        neighbours_.push_back(find(counts));
      }
    }
  }
}

const Prior& ModelSpace::prior(int m, int i) const {
  return priors_[static_cast<std::size_t>(m)][static_cast<std::size_t>(i)];
}

std::string ModelSpace::parameter_name(int m, int i) const {
  const Model& model = (*this)[m];
  if (i < to_int(model.parameters.size())) {
    return parameters_[static_cast<std::size_t>(model.parameters[static_cast<std::size_t>(i)])]
        .name;
  }
  std::size_t j = kinds_.size() - 1;
  while (i < model.offsets[j]) --j;
  const int each = to_int(kinds_[j].parameters.size());
  const int within = i - model.offsets[j];
  return kinds_[j].parameters[static_cast<std::size_t>(within % each)].name + '[' +
         std::to_string(within / each + 1) + ']';
}

int ModelSpace::find(std::string_view name) const {
  std::string known;
  for (int m = 0; m < size(); ++m) {
    if ((*this)[m].name == name) return m;
    known += (m == 0 ? "'" : ", '") + (*this)[m].name + "'";
  }
  throw std::invalid_argument("there is no model '" + std::string(name) + "' among " + known);
}

int ModelSpace::find(std::span<const int> counts) const {
  for (int m = 0; m < size(); ++m) {
    if (std::ranges::equal((*this)[m].counts, counts)) return m;
  }
  return -1;
}

int ModelSpace::neighbour(int m, int kind, int step) const {
  const std::size_t row =
      static_cast<std::size_t>(m) * kinds_.size() + static_cast<std::size_t>(kind);
  return neighbours_[2 * row + (step > 0 ? 1 : 0)];
}

}  // namespace wheeltap::inference

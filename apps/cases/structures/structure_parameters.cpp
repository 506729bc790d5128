#include "apps/cases/structures/structure_parameters.hpp"

#include <algorithm>
#include <utility>

#include "apps/cases/structures/state_places.hpp"
#include "apps/cases/syntax/case_remedies.hpp"
#include "apps/law_words.hpp"

namespace wheeltap::apps {

using identification::AnyStructure;

StructureParameters::StructureParameters(const CaseFile& file) : file_(file) {
  const Json priors = file.json.value("parameters", Json::object());
  for (const auto& [name, ignored] : priors.items())
    parameters_.push_back({name, parse_prior(file, Pointer("/parameters") / name)});
  used_.assign(parameters_.size(), false);
  setters_.resize(parameters_.size());
}

Coefficient StructureParameters::coefficient(const Pointer& where, const Bounds& bounds) {
  const Json& value = file_.json.at(where);
  const std::string must = std::string("must be ") + bounds.words;
  const auto is_inside = [&](double x) {
    return bounds.open ? x > bounds.lower && x < bounds.upper
                       : x >= bounds.lower && x <= bounds.upper;
  };
  if (value.is_number()) {
    const double x = value.get<double>();
    if (!is_inside(x)) file_.refuse(where, must);
    return {.nominal = x};
  }
  if (!value.is_string()) file_.refuse(where, "must be a number, or the name of a parameter");
  const auto name = value.get<std::string>();
  const auto found = std::ranges::find(parameters_, name, &inference::Parameter::name);
  if (found == parameters_.end()) {
    std::vector<std::string> names;
    for (const auto& parameter : parameters_) names.push_back(parameter.name);
    file_.refuse(where, unknown_parameter(name, names));
  }
  const inference::Prior& prior = found->prior;
  const Pointer of_prior = Pointer("/parameters") / name;
  const auto refuse_prior = [&](const std::string& reaches) {
    file_.refuse(of_prior, reaches + ", but " + where.to_string() + " " + must +
                               kept_within(file_, of_prior, bounds.lower, bounds.upper));
  };
  const std::vector<Pointer> known = known_places(file_, name);
  for (const Pointer& place : known)
    if (!is_inside(file_.json.at(place).get<double>()))
      file_.refuse(place, must + ": it is the value of " + where.to_string());
  // If states give the values of the coefficient, its prior is only the range of these values.
  if (known.empty() && prior.lower() < bounds.lower)
    refuse_prior("reaches down to " + plain_number(prior.lower()));
  if (known.empty() && prior.upper() > bounds.upper)
    refuse_prior("reaches up to " + plain_number(prior.upper()));
  const auto p = found - parameters_.begin();
  used_[static_cast<std::size_t>(p)] = true;
  return {.nominal = prior.from_standard_normal(0.0), .parameter = static_cast<int>(p)};
}

double StructureParameters::place(const Pointer& where, const Bounds& bounds,
                                  std::function<void(AnyStructure&, double)> set) {
  const Coefficient value = coefficient(where, bounds);
  follow(value, std::move(set));
  return value.nominal;
}

void StructureParameters::follow(const Coefficient& coefficient,
                                 std::function<void(AnyStructure&, double)> set) {
  if (coefficient.known()) return;
  setters_[static_cast<std::size_t>(coefficient.parameter)].push_back(std::move(set));
}

void StructureParameters::follow_all(
    std::function<void(AnyStructure&, std::span<const double>)> set) {
  dependent_.push_back(std::move(set));
}

std::vector<double> StructureParameters::nominal() const {
  std::vector<double> values;
  for (const auto& parameter : parameters_)
    values.push_back(parameter.prior.from_standard_normal(0.0));
  return values;
}

identification::StructureModel StructureParameters::model(AnyStructure nominal) && {
  for (std::size_t p = 0; p < parameters_.size(); ++p)
    if (!used_[p])
      file_.refuse(
          Pointer("/parameters") / parameters_[p].name,
          "no coefficient of the structure has this name, so the data do not depend on "
          "it: write the name of the parameter in place of a number, or remove the parameter");
  identification::StructureModel model{.nominal = std::move(nominal),
                                       .parameters = std::move(parameters_)};
  for (auto& places : setters_)
    model.setters.emplace_back([places = std::move(places)](AnyStructure& structure, double value) {
      for (const auto& set : places) set(structure, value);
    });
  model.dependent = std::move(dependent_);
  return model;
}

}  // namespace wheeltap::apps

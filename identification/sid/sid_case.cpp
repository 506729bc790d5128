#include "identification/sid/sid_case.hpp"

#include <algorithm>
#include <set>

namespace wheeltap::identification {

signals::Dimension SidChannel::dimension() const {
  using signals::Dimension;
  switch (role) {
    case Role::time:
      return Dimension::time;
    case Role::force:
      return Dimension::force;
    case Role::base_acceleration:
      return Dimension::acceleration;
    case Role::base_displacement:
      return Dimension::length;
    default:
      break;
  }
  switch (quantity) {
    case dynamics::Quantity::displacement:
      return Dimension::length;
    case dynamics::Quantity::velocity:
      return Dimension::velocity;
    default:
      return Dimension::acceleration;
  }
}

void SidChannel::take_unit(const std::string& header_unit) {
  if (!unit_given) unit = header_unit;
  const bool untouched = signal.scale.is_constant() && signal.scale.value == 1.0;
  if (role == Role::ignore || scale_given || !untouched) return;
  const signals::Conversion found = signals::conversion_of(unit, dimension());
  if (found.basis == signals::Conversion::Basis::unit) signal.scale = found.factor;
}

std::string SidChannel::foreign_unit() const {
  if (!is_excitation() && role != Role::response) return {};
  const signals::Conversion found = signals::conversion_of(unit, dimension());
  const bool foreign = found.basis == signals::Conversion::Basis::foreign;
  return foreign && !scale_given ? unit : std::string();
}

signals::Conversion SidChannel::conversion() const {
  signals::Conversion out = signals::conversion_of(unit, dimension());
  if (!scale_given) return out;
  out.basis = signals::Conversion::Basis::stated_scale;
  out.factor = signal.scale.is_constant() ? signal.scale.value : 1.0;
  return out;
}

std::string SidChannel::used_unit() const {
  if (const std::string foreign = foreign_unit(); !foreign.empty()) return foreign;
  return std::string(signals::si_unit(dimension()));
}

std::vector<double> SidResiduals::at(std::size_t c, std::span<const double> theta) const {
  std::vector<double> out;
  if (coefficients.empty()) return out;
  for (const dynamics::Coefficient& one : coefficients[c]) out.push_back(one.at(theta));
  return out;
}

using dynamics::Coefficient;
using Role = SidChannel::Role;

std::vector<const SidChannel*> SidCase::responses() const {
  std::vector<const SidChannel*> list;
  for (const SidChannel& channel : channels) {
    if (channel.role == Role::response) list.push_back(&channel);
  }
  return list;
}

const SidChannel* SidCase::find(Role role) const {
  const auto found = std::ranges::find(channels, role, &SidChannel::role);
  return found == channels.end() ? nullptr : &*found;
}

dynamics::Excitation SidCase::excitation() const {
  dynamics::Excitation out{.sample_rate_hz = sample_rate_hz * stride};
  for (const SidChannel& channel : channels) {
    if (channel.role == Role::force) out.forces.push_back({channel.mass, channel.signal});
    if (channel.role == Role::base_acceleration || channel.role == Role::base_displacement) {
      if (!out.base) out.base.emplace();
      (channel.role == Role::base_acceleration ? out.base->acceleration : out.base->displacement) =
          channel.signal;
    }
  }
  return out;
}

std::vector<dynamics::Sensor> SidCase::sensors() const {
  std::vector<dynamics::Sensor> list;
  for (const SidChannel* channel : responses()) {
    list.push_back({channel->mass, channel->quantity, channel->frame});
  }
  return list;
}

std::vector<int> SidCase::parameters_of(const SidModel& model) const {
  std::set<int> used;
  const auto use = [&](const Coefficient& c) {
    if (!c.is_constant()) used.insert(c.parameter);
  };
  for (const auto& mass : model.chain.masses) use(mass);
  for (const auto& link : model.chain.links) {
    use(link.stiffness), use(link.damping);
    for (const auto& law : link.laws) {
      for (const auto& c : law.coefficients) use(c);
    }
  }
  for (const auto& c : model.initial.displacement) use(c);
  for (const auto& c : model.initial.velocity) use(c);
  for (const auto& c : model.noise) use(c);
  for (const auto& channel : model.residuals.coefficients) {
    for (const auto& c : channel) use(c);
  }
  for (const SidChannel& channel : channels) {
    use(channel.signal.scale), use(channel.signal.offset);
  }
  return {used.begin(), used.end()};
}

std::vector<const SidCase*> SidCase::records() const {
  std::vector<const SidCase*> list = {this};
  for (const SidCase& record : further) list.push_back(&record);
  return list;
}

void SidCase::unite() {
  for (std::size_t m = 0; m < models.size(); ++m) {
    std::set<int> used;
    for (const SidCase* record : records()) {
      for (const int p : record->parameters_of(record->models[m])) used.insert(p);
    }
    models[m].parameters.assign(used.begin(), used.end());
    for (SidCase& record : further) record.models[m].parameters = models[m].parameters;
  }
  for (SidCase& record : further) record.parameters = parameters;
}

Coefficient SidCase::parameter(const std::string& name, inference::Prior prior) {
  const auto same = std::ranges::find(parameters, name, &inference::Parameter::name);
  const auto at = static_cast<int>(same - parameters.begin());
  if (same == parameters.end()) parameters.push_back({name, std::move(prior)});
  return Coefficient::of_parameter(at);
}

}  // namespace wheeltap::identification

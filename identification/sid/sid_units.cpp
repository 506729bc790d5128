#include "identification/sid/sid_units.hpp"

#include <cctype>
#include <vector>

#include "dynamics/laws.hpp"

namespace wheeltap::identification {
namespace {

using Role = SidChannel::Role;

/// Formats a unit as a factor, in brackets if a power after it would be misread.
std::string as_factor(const std::string& unit) {
  for (const char c : unit) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || (c & 0x80) != 0;
    if (!plain) return "(" + unit + ")";
  }
  return unit;
}

/// The unit that the channels agree on so far; "": none yet.
struct Agreement {
  std::string unit;
  bool disagree = false;

  void add(const std::string& one) {
    if (one.empty() || (!unit.empty() && unit != one)) disagree = true;
    unit = one;
  }
};

/// Unit of length in the unit of a motion; empty if the unit contains no length.
std::string length_of(const SidChannel& channel) {
  const std::string foreign = channel.foreign_unit();
  if (foreign.empty()) return "m";
  return channel.dimension() == signals::Dimension::length ? foreign : "";
}

/// Collects the units that the uses of each parameter imply.
class Uses {
 public:
  explicit Uses(std::size_t parameters) : of_(parameters) {}

  void add(const dynamics::Coefficient& c, const std::string& unit) {
    if (!c.is_constant()) of_[static_cast<std::size_t>(c.parameter)].add(unit);
  }
  [[nodiscard]] std::string unit(std::size_t parameter) const {
    return of_[parameter].disagree ? std::string() : of_[parameter].unit;
  }

 private:
  std::vector<Agreement> of_;
};

}  // namespace

std::string UnitSystem::in_place_of(const std::string& si) const {
  std::string out;
  for (std::size_t i = 0; i < si.size();) {
    std::size_t end = i;
    while (end < si.size() && std::isalpha(static_cast<unsigned char>(si[end])) != 0) ++end;
    const std::string word = si.substr(i, end - i);
    out += word == "N" ? as_factor(force) : word == "m" ? as_factor(length) : word;
    if (end < si.size()) out += si[end];
    i = end + 1;
  }
  return out;
}

std::optional<UnitSystem> unit_system(const SidCase& sid_case) {
  Agreement force, length;
  for (const SidChannel& channel : sid_case.channels) {
    if (channel.role == Role::force) force.add(channel.used_unit());
    if (channel.role == Role::response || (channel.is_excitation() && channel.role != Role::force))
      length.add(length_of(channel));
  }
  if (force.disagree || length.disagree) return {};
  UnitSystem out{.force = force.unit, .length = length.unit};
  if (force.unit.empty()) {
    if (out.length != "m") return {};  // a force would be in kg V/s², which is useless
    out.force = "N";
  }
  return out;
}

namespace {

void add_uses(const SidCase& sid_case, Uses& uses) {
  const auto system = unit_system(sid_case);
  const auto unit = [&](const std::string& si) { return system ? system->in_place_of(si) : ""; };
  const std::string mass = !system || system->is_si() ? "kg" : unit("N s^2/m");
  const bool driven = sid_case.find(Role::force) != nullptr;
  const auto responses = sid_case.responses();
  for (const SidModel& model : sid_case.models) {
    for (const auto& m : model.chain.masses) uses.add(m, system || !driven ? mass : "");
    for (const dynamics::Link& link : model.chain.links) {
      uses.add(link.stiffness, unit("N/m"));
      uses.add(link.damping, unit("N s/m"));
      for (const dynamics::Law& law : link.laws) {
        const dynamics::LawInfo& info = dynamics::law_infos()[static_cast<std::size_t>(law.kind)];
        for (std::size_t i = 0; i < static_cast<std::size_t>(info.size()); ++i) {
          uses.add(law.coefficients[i], unit(std::string(info.coefficients[i].unit)));
        }
      }
    }
    for (const auto& y : model.initial.displacement) uses.add(y, unit("m"));
    for (const auto& v : model.initial.velocity) uses.add(v, unit("m/s"));
    for (std::size_t c = 0; c < model.noise.size() && c < responses.size(); ++c) {
      uses.add(model.noise[c], responses[c]->used_unit());
    }
    const auto own = model.residuals.model->parameters({});
    for (const auto& channel : model.residuals.coefficients) {
      for (std::size_t i = 0; i < channel.size(); ++i) {
        uses.add(channel[i], own[i].unit == "1" ? "1" : unit(std::string(own[i].unit)));
      }
    }
  }
  for (const SidChannel& channel : sid_case.channels) {
    if (!channel.is_excitation() && channel.role != Role::response) continue;
    const std::string used = channel.used_unit();
    uses.add(channel.signal.offset, used);
    uses.add(channel.signal.scale,
             channel.unit.empty() ? "" : used + "/" + as_factor(channel.unit));
  }
}

}  // namespace

std::map<std::string, std::string> parameter_units(const SidCase& sid_case) {
  Uses uses(sid_case.parameters.size());
  for (const SidCase* record : sid_case.records()) add_uses(*record, uses);
  std::map<std::string, std::string> out;
  for (std::size_t p = 0; p < sid_case.parameters.size(); ++p) {
    out[sid_case.parameters[p].name] = uses.unit(p);
  }
  return out;
}

}  // namespace wheeltap::identification

#include "apps/cases/monitoring/monitored_structure.hpp"

#include <algorithm>
#include <numeric>
#include <set>

#include "apps/explained.hpp"
#include "base/index.hpp"

namespace wheeltap::apps {
namespace {

using identification::AnyStructure;
using identification::DamageCase;
using identification::DefectKind;

const Pointer kExplanation("/explanation");
constexpr double kMassShare = 0.05;  // default of largest added mass / mass of structure

/// Converts the structure and the damage of the case to a damage case with the same keys.
CaseFile as_damage_case(const CaseFile& file) {
  CaseFile out = file;
  out.json = Json{{"kind", "damage"}};
  for (const char* key : {"structure", "beam", "damage"})
    if (file.json.contains(key)) out.json[key] = file.json[key];
  return out;
}

double mass_of(const fem::Structure& structure) {
  const fem::Mesh mesh(structure);
  double total = 0.0;
  for (std::size_t m = 0; m < structure.members.size(); ++m) {
    double from = 0.0;
    const auto& pieces = structure.members[m].pieces;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const double to =
          i + 1 < pieces.size() ? pieces[i].to : mesh.member_length(static_cast<int>(m));
      total += pieces[i].material.density * pieces[i].section.area * (to - from);
      from = to;
    }
  }
  for (const fem::NodeMass& one : structure.masses) total += one.mass;
  return total;
}

/// An added mass as a kind of defect of a damage case, with its prior; null for structures given by
/// matrices, which have no locations for a mass.
Json added_mass(const CaseFile& file, const DamageCase& damage) {
  const AnyStructure structure = damage.solved_structure();
  Json prior;
  if (file.json.contains(kExplanation / "added_mass")) {
    prior = file.json.at(kExplanation / "added_mass");
  } else if (const auto* members = std::get_if<fem::Structure>(&structure)) {
    prior = {{"uniform", {0.0, kMassShare * mass_of(*members)}}};
  } else if (const auto* chain = std::get_if<fem::LumpedChain>(&structure)) {
    prior = {
        {"uniform",
         {0.0, kMassShare * std::accumulate(chain->masses.begin(), chain->masses.end(), 0.0)}}};
  }
  if (prior.is_null() || std::holds_alternative<fem::MatrixStructure>(structure)) return {};
  Json kind = {{"kind", "mass"}, {"count", {{"min", 0}, {"max", 1}}}, {"mass", prior}};
  if (!damage.structure) kind["location"] = {{"uniform", {0.0, damage.beam.length}}};
  return kind;
}

bool is_mass(const DefectKind& kind) {
  return kind.type->name == "mass";
}

/// Parses the kinds of defect, including the added mass.
DamageCaseFile parse_kinds(const CaseFile& file) {
  CaseFile alone = as_damage_case(file);
  DamageCaseFile parsed = parse_damage_case(alone, Needs::structure);
  const Pointer mass_prior = kExplanation / "added_mass";
  if (std::ranges::any_of(parsed.damage.kinds, is_mass)) {
    if (file.json.contains(mass_prior))
      file.refuse(mass_prior,
                  "\"damage\" already contains the kind \"mass\": give only one of the two");
    return parsed;
  }
  const Json mass = added_mass(file, parsed.damage);
  if (mass.is_null()) return parsed;
  if (file.json.contains(mass_prior)) static_cast<void>(parse_prior(file, mass_prior));
  Json& list = alone.json["damage"];
  if (!list.is_array()) list = Json::array({list});
  list.push_back(mass);
  return parse_damage_case(std::move(alone), Needs::structure);
}

std::vector<int> modes_of(const CaseFile& file, std::size_t features) {
  std::vector<int> out(features);
  std::iota(out.begin(), out.end(), 0);
  const Pointer where = kExplanation / "modes";
  if (!file.json.contains(where)) return out;
  const Json& list = file.json.at(where);
  if (list.size() != features)
    file.refuse(where, "must have one mode number for each of the " + std::to_string(features) +
                           " features");
  std::set<int> seen;
  for (std::size_t j = 0; j < features; ++j) {
    out[j] = list[j].get<int>() - 1;
    if (!seen.insert(out[j]).second) file.refuse(where / j, "is named twice");
  }
  return out;
}

/// Expected number of defects of a kind.
double expected_count(const DefectKind& kind) {
  double out = 0.0;
  for (std::size_t i = 0; i < kind.weights.size(); ++i)
    out += kind.weights[i] * (kind.min_count + static_cast<double>(i));
  return out;
}

void read_weights(const CaseFile& file, MonitoredStructure& out) {
  auto& causes = out.causes;
  const Pointer where = kExplanation / "prior";
  const Json prior = file.json.value(where, Json::object());
  auto& w = causes.weights;
  w.damage = prior.value("damage", w.damage);
  w.mass = prior.value("mass", w.mass);
  w.sensor = prior.value("sensor", w.sensor);
  w.other = prior.value("other", w.other);
  for (const DefectKind& kind : out.parsed.damage.kinds) {
    causes.is_mass.push_back(is_mass(kind));
    causes.share.push_back(expected_count(kind));
  }
  if (std::ranges::find(causes.is_mass, false) == causes.is_mass.end())
    file.refuse(Pointer("/damage"),
                "contains only an added mass, which is not damage: add a kind of damage");
  for (std::size_t k = 0; k < causes.share.size(); ++k)
    if (!(causes.share[k] > 0.0))
      file.refuse(out.parsed.kinds[k],
                  "has no prior probability: \"count\" must allow at least one defect");
  if (!(w.damage > 0.0)) file.refuse(where / "damage", "must be > 0");
}

}  // namespace

bool has_monitored_structure(const CaseFile& file) {
  return file.json.contains("structure") || file.json.contains("beam");
}

std::optional<MonitoredStructure> parse_monitored_structure(const CaseFile& file,
                                                            std::size_t features) {
  if (!has_monitored_structure(file)) {
    for (const char* key : {"damage", "explanation"})
      if (file.json.contains(key))
        file.refuse(Pointer() / std::string(key),
                    "needs the monitored structure: give \"structure\" or \"beam\"");
    return {};
  }
  if (!file.json.contains("damage"))
    file.refuse(Pointer("/damage"),
                "is missing: state what may be damaged, for example {\"kind\": \"reduction\", "
                "\"count\": {\"max\": 1}, \"reduction\": {\"uniform\": [0, 0.9]}}");
  MonitoredStructure out{.parsed = parse_kinds(file), .modes = modes_of(file, features)};
  read_weights(file, out);
  const int wanted = *std::ranges::max_element(out.modes) + 1;
  DamageCase intact = out.parsed.damage;
  for (DefectKind& kind : intact.kinds) kind.truth.clear();
  const auto found = explained(out.parsed, [&] { return true_frequencies(intact, wanted); });
  if (static_cast<int>(found.size()) < wanted)
    file.refuse(Pointer("/series/features"), "the structure has " + std::to_string(found.size()) +
                                                 " elastic modes, fewer than the features need");
  for (const int mode : out.modes) out.intact_hz.push_back(found[index(mode)]);
  return out;
}

}  // namespace wheeltap::apps

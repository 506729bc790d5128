#include "random_case.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identification/structural/defects/crack.hpp"
#include "identification/structural/defects/joint.hpp"
#include "identification/structural/defects/mass.hpp"
#include "identification/structural/defects/reduction.hpp"
#include "identification/structural/defects/storey.hpp"
#include "random_structure.hpp"

namespace wheeltap::coverage {
namespace {

using identification::DamageCase, identification::DefectKind, identification::DefectType;
using identification::SiteLine;
namespace defects = identification::defects;

SiteLine line_of(const DamageCase& c, const RandomStructure& about, const DefectType& type) {
  if (!c.structure) return SiteLine::of_beam(c.beam);
  const auto names_of = [](const auto& list, const std::vector<int>& of) {
    std::vector<std::string> names;
    for (const int i : of) names.push_back(list[static_cast<std::size_t>(i)].name);
    return names;
  };
  const auto first = [](std::size_t n) {
    std::vector<int> list(n);
    std::iota(list.begin(), list.end(), 0);
    return list;
  };
  if (const auto* chain = std::get_if<fem::LumpedChain>(&c.structure->nominal)) {
    const std::vector<int> links = first(chain->links.size());
    return SiteLine::of_points(links, names_of(chain->links, links));
  }
  const auto& members = std::get<fem::Structure>(c.structure->nominal);
  if (type.sites == DefectType::Sites::nodes)
    return SiteLine::of_points(about.joints, names_of(members.nodes, about.joints));
  return SiteLine::of_members(fem::Mesh(members), first(members.members.size()));
}

inference::Prior severity_of(const DefectType& type, const RandomStructure& about) {
  if (&type == &defects::kCrack) return inference::Uniform{0.01, 0.6};
  if (&type == &defects::kJoint) return inference::Uniform{0.0, 0.9};
  if (&type == &defects::kMass) return inference::Uniform{0.0, 0.1 * about.mass};
  if (&type == &defects::kStorey) return inference::Uniform{0.0, 0.8};
  return inference::Uniform{0.0, 0.7};
}

/// A random choice of the types that this structure may have, with counts that add up to 1, 2 or 3.
std::vector<DefectKind> random_kinds(base::Random& random, const DamageCase& c,
                                     const RandomStructure& about) {
  std::vector<const DefectType*> types = {&defects::kReduction, &defects::kCrack, &defects::kMass};
  if (!about.joints.empty()) types.push_back(&defects::kJoint);
  if (about.mass == 0.0) types = {&defects::kStorey};
  for (std::size_t i = types.size() - 1; i > 0; --i)
    std::swap(types[i], types[static_cast<std::size_t>(random.index(static_cast<int>(i) + 1))]);
  const double u = random.uniform();
  const int most = u < 0.2 ? 1 : (u < 0.5 ? 2 : 3);
  const int many = 1 + random.index(std::min(most, static_cast<int>(types.size())));
  std::vector<DefectKind> kinds;
  for (int k = 0; k < many; ++k) {
    const DefectType& type = *types[static_cast<std::size_t>(k)];
    const SiteLine line = line_of(c, about, type);
    kinds.push_back({.type = &type,
                     .name = std::string(type.noun),
                     .plural = type.noun_plural(),
                     .max_count = 1,
                     .location = inference::Uniform{0.0, line.length()},
                     .severity = severity_of(type, about),
                     .line = line});
  }
  for (int left = most - many; left > 0; --left)
    ++kinds[static_cast<std::size_t>(random.index(many))].max_count;
  return kinds;
}

void draw_truth(base::Random& random, DefectKind& kind) {
  const int count = random.index(kind.max_count + 1);  // all counts alike
  for (int i = 0; i < count; ++i)
    kind.truth.push_back({kind.location.from_standard_normal(random.normal()),
                          kind.severity_prior()->from_standard_normal(random.normal())});
  std::ranges::sort(kind.truth, {}, &DefectKind::True::location);
}

std::vector<double> frequencies(const DamageCase& c, int modes) {
  return c.solved_as_structure()
             ? identification::true_frequencies(c, modes)
             : identification::elastic_frequencies(c.beam, c.true_defects(), modes);
}

}  // namespace

RandomCase random_case(std::uint64_t seed, int number) {
  base::Random random(seed, static_cast<std::uint64_t>(number), 0, base::Purpose::test);
  RandomCase out{.seed = seed, .number = number, .damage_case = {}};
  DamageCase& c = out.damage_case;
  const RandomStructure about = random_structure(random, c);
  out.family = about.family;
  c.title = about.family;
  c.kinds = random_kinds(random, c, about);
  const int wanted = 8 + random.index(8);
  out.cv = std::exp(std::log(0.0005) + random.uniform() * std::log(20.0));
  const std::vector<double> intact = frequencies(c, wanted);
  for (DefectKind& kind : c.kinds) draw_truth(random, kind);
  const std::vector<double> damaged = frequencies(c, static_cast<int>(intact.size()));
  for (std::size_t i = 0; i < intact.size(); ++i) {
    c.data.sd_hz.push_back(out.cv * intact[i]);
    c.data.frequencies_hz.push_back(damaged[i] + c.data.sd_hz[i] * random.normal());
  }
  c.data.simulated = true;
  c.data.origin = "drawn from the prior";
  return out;
}

}  // namespace wheeltap::coverage

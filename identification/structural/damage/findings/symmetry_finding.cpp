#include "identification/structural/damage/findings/symmetry_finding.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace wheeltap::identification {

using inference::ChainsOf;
using Component = DamageProblem::Component;

namespace {

// A symmetry that is its own inverse, if there is one; otherwise the first symmetry. If it is its
// own inverse, equal numbers of defects are before and beyond their images on the line.
const inference::Symmetry& mirror_of(const DamageProblem& problem) {
  const auto& maps = problem.symmetries.maps;
  const auto is_its_inverse = [&](const inference::Symmetry& map) {
    return std::ranges::all_of(map.parts, [&](const inference::Symmetry::Part& part) {
      const SiteLine& line = problem.damage_case.kinds[static_cast<std::size_t>(part.kind)].line;
      return std::ranges::all_of(line.stretches(), [&](const SiteLine::Stretch& s) {
        const double x = s.start + 0.3 * (s.end - s.start);
        return std::abs(part.image(part.image(x)) - x) <= 1e-6 * line.length();
      });
    });
  };
  const auto found = std::ranges::find_if(maps, is_its_inverse);
  return found == maps.end() ? maps.front() : *found;
}

// Returns -1 for a defect before its image on the line, 1 for a defect beyond its image.
std::function<double(const Component&)> side(const DamageProblem& problem) {
  if (problem.symmetries.empty()) {
    return [middle = 0.5 * problem.damage_case.beam.length](const Component& c) {
      return c.location < middle ? -1.0 : 1.0;
    };
  }
  return [&map = mirror_of(problem)](const Component& c) {
    return c.location < map.parts[static_cast<std::size_t>(c.kind)].image(c.location) ? -1.0 : 1.0;
  };
}

}  // namespace

std::vector<std::vector<ParameterFinding>> folded(const UnpackedDraws& draws) {
  const DamageProblem& problem = draws.problem();
  const double length = problem.damage_case.beam.length;
  std::vector<std::vector<ParameterFinding>> tables;
  for (int m = 0; m < draws.space().size(); ++m) {
    const auto& model = draws.space()[m];
    std::vector<ParameterFinding> table;
    const std::vector<Unknown> list = unknowns(draws.space(), m);
    for (std::size_t k = 0; k < model.counts.size(); ++k) {
      const DefectKind& kind = problem.damage_case.kinds[k];
      for (int n = 0; n < model.counts[k]; ++n) {
        const auto nth = [&](std::size_t c, std::size_t i) {
          std::vector<Component> components;
          for (Component component : draws.at(c, i)) {
            if (component.kind != static_cast<int>(k)) continue;
            component.location = std::min(component.location, length - component.location);
            components.push_back(component);
          }
          std::ranges::sort(components, {}, &Component::location);
          return components[static_cast<std::size_t>(n)];
        };
        const ChainsOf location = draws_in_model(
            draws.posterior(), m, [&](auto c, auto i) { return nth(c, i).location; });
        if (std::ranges::all_of(location, [](const auto& chain) { return chain.empty(); }))
          continue;
        const auto at = static_cast<std::size_t>(model.offsets[k] + n * kind.parameters());
        table.push_back({.unknown = list[at], .estimate = marginal(location)});
        if (kind.severity_prior()) {
          const ChainsOf severity = draws_in_model(
              draws.posterior(), m, [&](auto c, auto i) { return nth(c, i).severity; });
          table.push_back({.unknown = list[at + 1], .estimate = marginal(severity)});
        }
      }
    }
    tables.push_back(std::move(table));
  }
  return tables;
}

ChainsOf left_less_right(const UnpackedDraws& draws) {
  const auto side_of = side(draws.problem());
  return all_draws(draws.posterior(), [&](std::size_t c, std::size_t i) {
    double difference = 0.0;
    for (const Component& component : draws.at(c, i)) difference -= side_of(component);
    return difference;
  });
}

SymmetryFinding symmetry(const UnpackedDraws& draws, const ChainsOf& difference,
                         std::vector<Remark>& remarks) {
  const DamageProblem& problem = draws.problem();
  SymmetryFinding out{.center = 0.5 * problem.damage_case.beam.length,
                      .emulated = problem.emulator && !problem.exact(),
                      .chains = {},
                      .alike = problem.symmetries.alike,
                      .turned = problem.symmetries.turned};
  const auto side_of = side(problem);
  double expected = 0.0;
  for (std::size_t c = 0; c < difference.size(); ++c) {
    double left = 0.0, right = 0.0, all = 0.0;
    for (std::size_t i = 0; i < difference[c].size(); ++i) all += draws.weight(c, i);
    for (std::size_t i = 0; i < difference[c].size(); ++i) {
      for (const Component& component : draws.at(c, i)) {
        (side_of(component) < 0.0 ? left : right) += draws.weight(c, i) / all;
      }
    }
    draws.posterior().chains[c].let_go();
    out.chains.push_back({left, right, inference::mcse_mean({difference[c]})});
    expected += (left + right) / static_cast<double>(difference.size());
  }
  if (expected > kWorthReporting && problem.symmetries.empty())
    remarks.push_back(remark::MirrorImages{out.emulated});
  else if (expected > kWorthReporting)
    remarks.push_back(remark::StructureImages{out.alike, out.turned});
  return out;
}

}  // namespace wheeltap::identification

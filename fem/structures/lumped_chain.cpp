#include "fem/structures/lumped_chain.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace wheeltap::fem {

void validate(const LumpedChain& chain) {
  using Part = InvalidStructure::Part;
  const auto masses = static_cast<int>(chain.masses.size());
  if (masses == 0) throw InvalidStructure(Part::whole, 0, "has no masses");
  if (chain.links.empty()) throw InvalidStructure(Part::whole, 0, "has no links");
  const auto positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  for (int i = 0; i < masses; ++i) {
    const double mass = chain.masses[static_cast<std::size_t>(i)];
    if (!positive(mass))
      throw InvalidStructure(Part::masses, i,
                             "mass = " + std::to_string(mass) + ": must be positive");
  }
  for (std::size_t i = 0; i < chain.links.size(); ++i) {
    const LumpedChain::Link& link = chain.links[i];
    const auto refuse = [&](const std::string& message) {
      throw InvalidStructure(Part::members, static_cast<int>(i), message);
    };
    for (const int end : link.between)
      if (end < 0 || end > masses)
        refuse("between " + std::to_string(end) + ": must be 0 (the ground) to " +
               std::to_string(masses) + ", the number of masses");
    if (link.between[0] == link.between[1]) refuse("connects a mass to itself");
    if (!positive(link.stiffness))
      refuse("stiffness = " + std::to_string(link.stiffness) + ": must be positive");
  }
}

Discretisation discretise(const LumpedChain& chain) {
  validate(chain);
  Discretisation d;
  const auto n = static_cast<Eigen::Index>(chain.masses.size());
  std::vector<Eigen::Triplet<double>> stiffness, mass;
  for (int i = 0; i < static_cast<int>(n); ++i) {
    mass.emplace_back(i, i, chain.masses[static_cast<std::size_t>(i)]);
    d.names.push_back({"mass " + std::to_string(i + 1), "x"});
  }
  // Connected groups of masses. Group 0 is the group of the ground.
  std::vector<int> group(static_cast<std::size_t>(n) + 1);
  std::iota(group.begin(), group.end(), 0);
  // Disjoint sets as trees, each rooted at its lowest member, with path halving.
  const auto root_of = [&group](int i) {
    auto at = static_cast<std::size_t>(i);
    while (group[at] != static_cast<int>(at)) {
      group[at] = group[static_cast<std::size_t>(group[at])];
      at = static_cast<std::size_t>(group[at]);
    }
    return static_cast<int>(at);
  };
  for (const LumpedChain::Link& link : chain.links) {
    SparseRow row;
    const auto [low, high] = std::minmax(link.between[0], link.between[1]);
    const double root = std::sqrt(link.stiffness);
    if (low > 0) {
      row.dofs.push_back(low - 1);
      row.coefficients.push_back(-root);
    }
    row.dofs.push_back(high - 1);
    row.coefficients.push_back(root);
    for (std::size_t i = 0; i < row.dofs.size(); ++i)
      for (std::size_t j = 0; j < row.dofs.size(); ++j)
        stiffness.emplace_back(row.dofs[i], row.dofs[j], row.coefficients[i] * row.coefficients[j]);
    d.strains.push_back({std::move(row), 1.0});
    const int from = root_of(high), to = root_of(low);
    group[static_cast<std::size_t>(std::max(from, to))] = std::min(from, to);
  }
  for (int i = 0; i <= static_cast<int>(n); ++i) group[static_cast<std::size_t>(i)] = root_of(i);
  d.stiffness.resize(n, n);
  d.stiffness.setFromTriplets(stiffness.begin(), stiffness.end());
  d.mass.resize(n, n);
  d.mass.setFromTriplets(mass.begin(), mass.end());
  d.rest.resize(n, n);
  std::vector<int> free(group.begin() + 1, group.end());
  std::ranges::sort(free);
  free.erase(std::unique(free.begin(), free.end()), free.end());
  std::erase(free, 0);
  d.rigid_motions = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(free.size()));
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = std::ranges::lower_bound(free, group[static_cast<std::size_t>(i) + 1]);
    if (at != free.end() && *at == group[static_cast<std::size_t>(i) + 1])
      d.rigid_motions(i, at - free.begin()) = 1.0;
  }
  return d;
}

}  // namespace wheeltap::fem

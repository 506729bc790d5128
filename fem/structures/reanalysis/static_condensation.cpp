#include "fem/structures/reanalysis/static_condensation.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <stdexcept>
#include <utility>

#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Discretisation::Sparse;

constexpr std::size_t kTwoNodes = 12;  // degrees of freedom

/// Pattern of coupling by K or M, even where entries cancel: 1 in both triangles.
Sparse coupling(const Discretisation& d) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const Strain& s : d.strains)
    for (const int i : s.row.dofs)
      for (const int j : s.row.dofs) entries.emplace_back(i, j, 1.0);
  for (const Sparse* matrix : {&d.stiffness, &d.mass})
    for (int k = 0; k < matrix->outerSize(); ++k)
      for (Sparse::InnerIterator it(*matrix, k); it; ++it)
        for (const auto& [i, j] : {std::pair{it.row(), it.col()}, {it.col(), it.row()}})
          entries.emplace_back(static_cast<int>(i), static_cast<int>(j), 1.0);
  Sparse out(d.size(), d.size());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

/// Groups of dofs with identical coupling, such as those of one node.
struct Groups {
  std::vector<std::vector<int>> dofs;        // one list per group
  std::vector<std::vector<int>> neighbours;  // other groups, ascending
};

Groups groups_of(const Sparse& graph, const std::vector<char>& held) {
  Groups out;
  std::map<std::vector<int>, int> known;
  std::vector<int> group(index(graph.rows()));
  for (int dof = 0; dof < static_cast<int>(graph.rows()); ++dof) {
    std::vector<int> coupled;
    for (Sparse::InnerIterator it(graph, dof); it; ++it)
      coupled.push_back(static_cast<int>(it.row()));
    // A restrained dof forms its own group, so that it can remain on the boundary.
    if (held[index(dof)]) coupled = {-1 - dof};
    const auto [at, is_new] =
        known.try_emplace(std::move(coupled), static_cast<int>(out.dofs.size()));
    if (is_new) out.dofs.emplace_back();
    group[index(dof)] = at->second;
    out.dofs[index(at->second)].push_back(dof);
  }
  out.neighbours.resize(out.dofs.size());
  for (int dof = 0; dof < static_cast<int>(graph.rows()); ++dof)
    for (Sparse::InnerIterator it(graph, dof); it; ++it)
      if (const int other = group[index(it.row())]; other != group[index(dof)])
        out.neighbours[index(group[index(dof)])].push_back(other);
  for (std::vector<int>& list : out.neighbours) {
    std::ranges::sort(list);
    list.erase(std::ranges::unique(list).begin(), list.end());
  }
  return out;
}

/// True if a group lies inside a member: the group is coupled with at most two ends of at most the
/// dofs of two nodes. The dofs of an end must be coupled with each other.
bool is_chained(const Groups& groups, std::size_t g) {
  const std::vector<int>& all = groups.neighbours[g];
  std::size_t dofs = 0;
  for (const int other : all) dofs += groups.dofs[index(other)].size();
  if (dofs > kTwoNodes) return false;
  std::vector<int> left = all;
  int ends = 0;
  for (; !left.empty(); ++ends) {
    std::vector<int> reached = {left.back()};
    left.pop_back();
    while (!reached.empty()) {
      const std::vector<int>& from = groups.neighbours[index(reached.back())];
      reached.pop_back();
      const auto coupled = std::ranges::stable_partition(
          left, [&](int other) { return !std::ranges::binary_search(from, other); });
      reached.insert(reached.end(), coupled.begin(), coupled.end());
      left.erase(coupled.begin(), coupled.end());
    }
  }
  return ends <= 2;
}

using Layer = std::vector<int>;  // dofs

/// Cuts the interiors of members into parts.
class Cutter {
 public:
  Cutter(const Discretisation& d, const Sparse& graph, double stiffer_than)
      : d_(d),
        held_(d.holding_dofs()),
        groups_(groups_of(graph, held_)),
        stiffer_than_(stiffer_than),
        part_of(index(graph.rows()), -1) {
    const std::size_t count = groups_.dofs.size();
    open_.assign(count, 0);
    for (std::size_t g = 0; g < count; ++g)
      open_[g] = !held_[index(groups_.dofs[g].front())] && is_chained(groups_, g);
    for (const int neighbours :
         {1, 2 * static_cast<int>(kTwoNodes)})  // starts from an end if an end exists
      for (std::size_t g = 0; g < count; ++g)
        if (open_[g] && open_neighbours(g) <= neighbours) split(layers_from(g));
  }

 private:
  [[nodiscard]] std::ptrdiff_t open_neighbours(std::size_t g) const {
    return std::ranges::count_if(groups_.neighbours[g],
                                 [&](int other) { return open_[index(other)] != 0; });
  }

  /// Groups by distance; each layer is coupled only with the previous layer and the next layer.
  std::vector<Layer> layers_from(std::size_t first) {
    std::vector<Layer> layers;
    std::vector<std::size_t> last = {first};
    open_[first] = 0;
    while (!last.empty()) {
      std::vector<std::size_t> next;
      layers.emplace_back();
      for (const std::size_t g : last) {
        layers.back().insert(layers.back().end(), groups_.dofs[g].begin(), groups_.dofs[g].end());
        for (const int other : groups_.neighbours[g])
          if (open_[index(other)]) {
            open_[index(other)] = 0;
            next.push_back(index(other));
          }
      }
      last = std::move(next);
    }
    return layers;
  }

  /// True if K - λ M of these dofs alone is positive definite.
  [[nodiscard]] bool is_stiff(const std::vector<int>& dofs) const {
    const auto m = static_cast<Index>(dofs.size());
    Eigen::MatrixXd k(m, m);
    for (Index i = 0; i < m; ++i)
      for (Index j = 0; j < m; ++j)
        k(i, j) = d_.stiffness.coeff(dofs[index(i)], dofs[index(j)]) -
                  stiffer_than_ * d_.mass.coeff(dofs[index(i)], dofs[index(j)]);
    return Eigen::LLT<Eigen::MatrixXd>(k).info() == Eigen::Success;
  }

  void split(std::span<const Layer> layers) {
    std::vector<int> dofs;
    for (const Layer& layer : layers) dofs.insert(dofs.end(), layer.begin(), layer.end());
    if (dofs.empty()) return;
    if (dofs.size() <= index(StaticCondensation::kLargest) && is_stiff(dofs)) {
      for (const int dof : dofs) part_of[index(dof)] = parts;
      ++parts;
      return;
    }
    const std::size_t middle = layers.size() / 2;  // remains on the boundary
    split(layers.first(middle));
    split(layers.subspan(middle + 1));
  }

  const Discretisation& d_;
  std::vector<char> held_;
  Groups groups_;
  double stiffer_than_;
  std::vector<char> open_;  // in a chain and not yet visited

 public:
  std::vector<int> part_of;  ///< one per dof, -1 on the boundary
  int parts = 0;
};

}  // namespace

StaticCondensation::StaticCondensation(const Discretisation& d, double stiffer_than) {
  const Sparse graph = coupling(d);
  Cutter cutter(d, graph, stiffer_than);
  part_of_ = std::move(cutter.part_of);
  parts_.resize(index(cutter.parts));
  place_.resize(part_of_.size());
  for (int dof = 0; dof < static_cast<int>(part_of_.size()); ++dof) {
    std::vector<int>& list =
        part_of_[index(dof)] < 0 ? boundary_ : parts_[index(part_of_[index(dof)])].inside;
    place_[index(dof)] = static_cast<int>(list.size());
    list.push_back(dof);
  }
  for (Part& part : parts_) {
    for (const int dof : part.inside)
      for (Sparse::InnerIterator it(graph, dof); it; ++it)
        if (part_of_[index(it.row())] < 0) part.edge.push_back(place_[index(it.row())]);
    std::ranges::sort(part.edge);
    part.edge.erase(std::ranges::unique(part.edge).begin(), part.edge.end());
    const auto m = static_cast<Index>(part.inside.size()), e = static_cast<Index>(part.edge.size());
    part.edge_stiffness.setZero(e, m);
    part.mass.setZero(m, m);
    part.edge_mass.setZero(e, m);
  }
  std::vector<Wide> stiffness;
  for (const Part& part : parts_) {
    const auto m = static_cast<Index>(part.inside.size());
    stiffness.emplace_back(Wide::Zero(m, m));
  }
  // Adds to row i of a part's columns; columns of the boundary are not stored.
  const auto add = [&](int i, int j, auto value, auto& inner, auto& edge) {
    const int p = part_of_[index(j)];
    if (p < 0) return;
    if (part_of_[index(i)] == p) {
      inner(index(p))(place_[index(i)], place_[index(j)]) += value;
      return;
    }
    const std::vector<int>& list = parts_[index(p)].edge;
    const auto row = std::ranges::lower_bound(list, place_[index(i)]) - list.begin();
    edge(index(p))(row, place_[index(j)]) += value;
  };
  const auto inner_stiffness = [&](std::size_t p) -> Wide& { return stiffness[p]; };
  const auto edge_stiffness = [&](std::size_t p) -> Wide& { return parts_[p].edge_stiffness; };
  const auto inner_mass = [&](std::size_t p) -> Eigen::MatrixXd& { return parts_[p].mass; };
  const auto edge_mass = [&](std::size_t p) -> Eigen::MatrixXd& { return parts_[p].edge_mass; };
  for (const Strain& s : d.strains)
    for (std::size_t a = 0; a < s.row.dofs.size(); ++a)
      for (std::size_t b = 0; b < s.row.dofs.size(); ++b)
        add(s.row.dofs[a], s.row.dofs[b],
            static_cast<long double>(s.factor) * s.row.coefficients[a] * s.row.coefficients[b],
            inner_stiffness, edge_stiffness);
  for (int k = 0; k < d.rest.outerSize(); ++k)
    for (Sparse::InnerIterator it(d.rest, k); it; ++it)
      add(static_cast<int>(it.row()), static_cast<int>(it.col()),
          static_cast<long double>(it.value()), inner_stiffness, edge_stiffness);
  for (int k = 0; k < d.mass.outerSize(); ++k)
    for (Sparse::InnerIterator it(d.mass, k); it; ++it)
      add(static_cast<int>(it.row()), static_cast<int>(it.col()), it.value(), inner_mass,
          edge_mass);
  for (std::size_t p = 0; p < parts_.size(); ++p) parts_[p].stiffness.compute(stiffness[p]);
}

StaticCondensation::Local StaticCondensation::local(const SparseRow& load) const {
  Local out;
  for (const int dof : load.dofs) {
    const int part = part_of_[index(dof)];
    if (part >= 0 && out.part >= 0 && part != out.part)
      throw std::invalid_argument("a load acts on two parts of a structure");
    out.part = std::max(out.part, part);
  }
  if (out.part < 0) {
    for (const int dof : load.dofs) out.edge.push_back(place_[index(dof)]);
    out.forces.fill(VectorXd::Zero(static_cast<Index>(out.edge.size())));
    for (std::size_t i = 0; i < load.dofs.size(); ++i)
      out.forces[0][static_cast<Index>(i)] = load.coefficients[i];
    return out;
  }
  const Part& part = parts_[index(out.part)];
  out.inside = part.inside;
  out.edge = part.edge;
  out.load = VectorXd::Zero(static_cast<Index>(part.inside.size()));
  Wide on_edge = Wide::Zero(static_cast<Index>(part.edge.size()), 1);
  for (std::size_t i = 0; i < load.dofs.size(); ++i) {
    const int dof = load.dofs[i], place = place_[index(dof)];
    if (part_of_[index(dof)] >= 0) {
      out.load[place] = load.coefficients[i];
      continue;
    }
    const auto at = std::ranges::lower_bound(part.edge, place);
    if (at == part.edge.end() || *at != place)
      throw std::invalid_argument("a load acts beyond the edge of a part of a structure");
    on_edge(at - part.edge.begin(), 0) = load.coefficients[i];
  }
  Wide inside = out.load.cast<long double>();
  for (std::size_t n = 0; n < kTerms; ++n) {
    if (n > 0) {
      on_edge = (part.edge_mass * out.motion[n - 1]).cast<long double>();
      inside = (part.mass * out.motion[n - 1]).cast<long double>();
    }
    const Wide motion = part.stiffness.solve(inside);
    out.motion[n] = motion.cast<double>();
    out.forces[n] = (on_edge - part.edge_stiffness * motion).cast<double>();
  }
  return out;
}

}  // namespace wheeltap::fem

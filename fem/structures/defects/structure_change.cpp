#include "fem/structures/defects/structure_change.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;

/// If less than this share of a restrained motion remains, the other supports restrain the motion.
constexpr double kDependentColumn = 1e-12;

void require_change(bool holds, const char* name, double value, const char* allowed) {
  if (!holds)
    throw std::invalid_argument(std::string(name) + " = " + std::to_string(value) + ": " + allowed);
}

/// Expresses eliminated degrees of freedom by the remaining degrees of freedom.
class Elimination {
 public:
  /// Restrains r · u = 0 for every row r of `held`. Rows that depend on other rows are omitted.
  Elimination(Index n, const std::vector<SparseRow>& held) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(static_cast<Index>(held.size()), n);
    for (std::size_t i = 0; i < held.size(); ++i)
      for (std::size_t k = 0; k < held[i].dofs.size(); ++k)
        rows(static_cast<Index>(i), held[i].dofs[k]) = held[i].coefficients[k];
    std::vector<int> row_of(index(n), -1);
    for (Index i = 0; i < rows.rows(); ++i) {
      const double size = held[index(i)].empty()
                              ? 0.0
                              : *std::ranges::max_element(held[index(i)].coefficients, {},
                                                          [](double c) { return std::abs(c); });
      Index pivot = 0;
      if (!(rows.row(i).cwiseAbs().maxCoeff(&pivot) > kDependentColumn * std::abs(size))) {
        rows.row(i).setZero();
        continue;
      }
      rows.row(i) /= rows(i, pivot);
      for (Index other = 0; other < rows.rows(); ++other)
        if (other != i) rows.row(other) -= rows(other, pivot) * rows.row(i).eval();
      row_of[index(pivot)] = static_cast<int>(i);
    }
    std::vector<int> place(index(n), -1);
    for (Index j = 0; j < n; ++j)
      if (row_of[index(j)] < 0) {
        place[index(j)] = static_cast<int>(kept_.size());
        kept_.push_back(static_cast<int>(j));
      }
    std::vector<Eigen::Triplet<double>> entries;
    for (Index j = 0; j < n; ++j) {
      if (place[index(j)] >= 0) {
        entries.emplace_back(static_cast<int>(j), place[index(j)], 1.0);
        continue;
      }
      for (Index k = 0; k < n; ++k) {
        const double c = rows(row_of[index(j)], k);
        if (c != 0.0 && place[index(k)] >= 0)
          entries.emplace_back(static_cast<int>(j), place[index(k)], -c);
      }
    }
    map_.resize(n, static_cast<Index>(kept_.size()));
    map_.setFromTriplets(entries.begin(), entries.end());
  }

  [[nodiscard]] const std::vector<int>& kept() const { return kept_; }
  [[nodiscard]] Discretisation::Sparse of(const Discretisation::Sparse& matrix) const {
    return Discretisation::Sparse(map_.transpose() * matrix * map_);
  }
  [[nodiscard]] SparseRow of(const SparseRow& row) const {
    Eigen::SparseVector<double> all(map_.rows());
    for (std::size_t i = 0; i < row.dofs.size(); ++i)
      all.coeffRef(row.dofs[i]) += row.coefficients[i];
    const Eigen::SparseVector<double> left = map_.transpose() * all;
    SparseRow out;
    for (Eigen::SparseVector<double>::InnerIterator it(left); it; ++it) {
      out.dofs.push_back(static_cast<int>(it.index()));
      out.coefficients.push_back(it.value());
    }
    return out;
  }

 private:
  std::vector<int> kept_;
  Discretisation::Sparse map_;  // n × kept
};

/// Eliminates motions that rigid springs restrain; the other degrees of freedom keep their names.
void hold(Discretisation& d, const std::vector<SparseRow>& held, std::span<SparseRow> motions) {
  const Elimination left(d.size(), held);
  std::vector<DofName> names;
  Eigen::MatrixXd rigid(static_cast<Index>(left.kept().size()), d.rigid_motions.cols());
  for (std::size_t i = 0; i < left.kept().size(); ++i) {
    names.push_back(d.names[index(left.kept()[i])]);
    rigid.row(static_cast<Index>(i)) = d.rigid_motions.row(left.kept()[i]);
  }
  d.names = std::move(names);
  d.rigid_motions = std::move(rigid);
  for (Strain& s : d.strains) s.row = left.of(s.row);
  for (SparseRow& motion : motions) motion = left.of(motion);
  if (d.rest.nonZeros() > 0)
    d.rest = left.of(d.rest);
  else
    d.rest.resize(static_cast<Index>(left.kept().size()), static_cast<Index>(left.kept().size()));
  for (Discretisation::Sparse& part : d.parts) part = left.of(part);
  d.mass = left.of(d.mass);
}

/// Adds factor · r rᵀ.
void add_square(std::vector<Eigen::Triplet<double>>& to, const SparseRow& r, double factor) {
  for (std::size_t i = 0; i < r.dofs.size(); ++i)
    for (std::size_t j = 0; j < r.dofs.size(); ++j)
      to.emplace_back(r.dofs[i], r.dofs[j], factor * r.coefficients[i] * r.coefficients[j]);
}

Discretisation::Sparse changed_mass(const Discretisation& d, const StructureChange& change) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const StructureChange::Mass& m : change.masses) add_square(entries, m.motion, m.mass);
  Discretisation::Sparse extra(d.size(), d.size());
  extra.setFromTriplets(entries.begin(), entries.end());
  return d.mass + extra;
}

/// True if any motion has a negative mass, from the signs of D in M + ε diag (M + M₀) = L D Lᵀ. The
/// shift is relative to the mass M₀ before the change, because the rounding errors of M are: the
/// rotation of a joint that is nearly a hinge loses nearly all of its mass.
bool has_negative_mass(const Discretisation::Sparse& mass, const Eigen::VectorXd& before) {
  constexpr double kShift = 1e-12;
  std::vector<Eigen::Triplet<double>> entries;
  const Eigen::VectorXd diagonal =
      mass.diagonal() + kShift * (before + mass.diagonal().cwiseMax(0.0));
  if (diagonal.minCoeff() < 0.0) return true;
  std::vector<int> place(index(mass.rows()), -1);
  int n = 0;
  for (Index i = 0; i < mass.rows(); ++i)
    if (diagonal[i] > 0.0) place[index(i)] = n++;
  for (int k = 0; k < mass.outerSize(); ++k)
    for (Discretisation::Sparse::InnerIterator it(mass, k); it; ++it)
      if (place[index(it.row())] >= 0 && place[index(it.col())] >= 0)
        entries.emplace_back(place[index(it.row())], place[index(it.col())],
                             it.row() == it.col() ? diagonal[it.row()] : it.value());
  Discretisation::Sparse shifted(n, n);
  shifted.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Discretisation::Sparse> ldlt(shifted);
  return ldlt.info() == Eigen::Success && (ldlt.vectorD().array() < 0.0).any();
}

}  // namespace

void require_mass_left(const Discretisation& d, const StructureChange& change) {
  const auto lost = [](const StructureChange::Mass& m) { return m.mass < 0.0; };
  if (std::ranges::any_of(change.masses, lost) &&
      has_negative_mass(changed_mass(d, change), d.mass.diagonal()))
    throw ImpossibleChange("lost mass: exceeds the mass of the structure");
}

void validate(const Discretisation& d, const StructureChange& change) {
  for (const StructureChange::Softening& s : change.softenings) {
    require_change(s.remaining > 0.0 && s.remaining <= 1.0, "remaining stiffness", s.remaining,
                   "must be in (0, 1]");
    for (const auto& [row, weight] : s.direction)
      require_change(row >= 0 && index(row) < d.strains.size(), "strain", row, "does not exist");
  }
  for (const StructureChange::Scaling& s : change.scalings) {
    require_change(s.remaining > 0.0 && s.remaining <= 1.0, "remaining stiffness", s.remaining,
                   "must be in (0, 1]");
    require_change(s.part >= 0 && index(s.part) < d.parts.size(), "part", s.part, "does not exist");
  }
  for (const StructureChange::Spring& s : change.springs)
    require_change(s.stiffness > 0.0, "spring stiffness", s.stiffness, "must be positive");
  for (const StructureChange::Mass& m : change.masses)
    require_change(std::isfinite(m.mass), "added mass", m.mass, "must be finite");
}

void compound(StructureChange& change) {
  std::vector<StructureChange::Softening> merged;
  for (StructureChange::Softening& s : change.softenings) {
    const auto same = std::ranges::find_if(merged, [&](const StructureChange::Softening& other) {
      return s.direction.size() == 1 && other.direction.size() == 1 &&
             other.direction[0].first == s.direction[0].first;
    });
    if (same == merged.end()) {
      merged.push_back(std::move(s));
    } else {
      same->remaining *= s.remaining;
    }
  }
  change.softenings = std::move(merged);
  std::vector<StructureChange::Scaling> scalings;
  for (const StructureChange::Scaling& s : change.scalings) {
    const auto same = std::ranges::find(scalings, s.part, &StructureChange::Scaling::part);
    if (same == scalings.end()) {
      scalings.push_back(s);
    } else {
      same->remaining *= s.remaining;
    }
  }
  change.scalings = std::move(scalings);
}

Discretisation changed(const Discretisation& d, const StructureChange& change,
                       std::span<SparseRow> motions) {
  validate(d, change);
  Discretisation out = d;
  // Returns row + weight · other.
  const auto plus = [&](const SparseRow& row, double weight, const SparseRow& other) {
    Eigen::SparseVector<double> sum(d.size());
    for (std::size_t i = 0; i < row.dofs.size(); ++i)
      sum.coeffRef(row.dofs[i]) += row.coefficients[i];
    for (std::size_t i = 0; i < other.dofs.size(); ++i)
      sum.coeffRef(other.dofs[i]) += weight * other.coefficients[i];
    SparseRow out_row;
    for (Eigen::SparseVector<double>::InnerIterator it(sum); it; ++it) {
      out_row.dofs.push_back(static_cast<int>(it.index()));
      out_row.coefficients.push_back(it.value());
    }
    return out_row;
  };
  std::vector<Eigen::Triplet<double>> k;
  // I - (1 - q) v vᵀ is the square of S = I - (1 - √q) v vᵀ. The product of S and the rows has no
  // cancellation.
  for (const StructureChange::Softening& s : change.softenings) {
    const double lost = 1.0 - std::sqrt(s.remaining);
    if (s.direction.size() == 1 && std::abs(s.direction[0].second) == 1.0) {
      for (double& c : out.strains[index(s.direction[0].first)].row.coefficients) c *= 1.0 - lost;
      continue;
    }
    SparseRow along;
    for (const auto& [row, weight] : s.direction)
      along = plus(along, weight, out.strains[index(row)].row);
    for (const auto& [row, weight] : s.direction)
      out.strains[index(row)].row = plus(out.strains[index(row)].row, -lost * weight, along);
  }
  if (!change.scalings.empty()) {
    for (const StructureChange::Scaling& s : change.scalings)
      out.parts[index(s.part)] *= s.remaining;
    out.rest = out.parts[0];
    for (std::size_t j = 1; j < out.parts.size(); ++j) out.rest += out.parts[j];
  }
  std::vector<SparseRow> held;
  for (const StructureChange::Spring& s : change.springs) {
    if (std::isinf(s.stiffness)) {
      held.push_back(s.motion);
      continue;
    }
    SparseRow row = s.motion;
    for (double& c : row.coefficients) c *= std::sqrt(s.stiffness);
    out.strains.push_back({std::move(row), 1.0});
  }
  require_mass_left(d, change);
  out.mass = changed_mass(d, change);
  if (out.rigid_motions.cols() > 0 && !change.springs.empty()) {
    // The rigid motions that the springs do not restrain.
    Eigen::MatrixXd holds(static_cast<Index>(change.springs.size()), out.rigid_motions.cols());
    for (std::size_t s = 0; s < change.springs.size(); ++s)
      for (Index r = 0; r < out.rigid_motions.cols(); ++r)
        holds(static_cast<Index>(s), r) = change.springs[s].motion.of(out.rigid_motions.col(r));
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(holds);
    const Eigen::MatrixXd kernel = lu.kernel();
    out.rigid_motions = lu.dimensionOfKernel() > 0 ? Eigen::MatrixXd(out.rigid_motions * kernel)
                                                   : Eigen::MatrixXd(d.size(), 0);
  }
  if (!held.empty()) hold(out, held, motions);
  const Index n = out.size();
  out.stiffness = out.rest.nonZeros() > 0 ? out.rest : Discretisation::Sparse(n, n);
  for (const Strain& s : out.strains) add_square(k, s.row, s.factor);
  Discretisation::Sparse stiffness(n, n);
  stiffness.setFromTriplets(k.begin(), k.end());
  out.stiffness += stiffness;
  return out;
}

}  // namespace wheeltap::fem

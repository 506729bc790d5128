#include "fem/structures/reanalysis/scaled_structure.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;
using Sparse = Discretisation::Sparse;

/// Relative difference below which entries of a matrix are equal within rounding.
constexpr double kEqual = 1e-9;
/// Relative eigenvalue of a change of mass that counts as zero.
constexpr double kZeroComponent = 1e-13;
/// Largest number of degrees of freedom whose mass may change.
constexpr std::size_t kMostDofs = 24;
/// Relative change of a scaled stiffness that is a rounding error.
constexpr double kUnchanged = 1e-14;

/// The factor a for which most entries of `slope` equal a times those of `mass`; 0 without a
/// majority.
double common_ratio(const Sparse& slope, const Sparse& mass) {
  std::vector<double> ratios;
  for (Index c = 0; c < mass.outerSize(); ++c)
    for (Sparse::InnerIterator entry(mass, c); entry; ++entry)
      if (entry.value() != 0.0)
        ratios.push_back(slope.coeff(entry.row(), entry.col()) / entry.value());
  if (ratios.empty()) return 0.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::ranges::nth_element(ratios, middle);
  const double median = *middle;
  const auto equal = std::ranges::count_if(
      ratios, [&](double r) { return std::abs(r - median) <= kEqual * std::abs(median); });
  return 2 * equal > std::ssize(ratios) ? median : 0.0;
}

struct Motion {
  SparseRow row;
  double mass;
};

/// slope - ratio · mass = Σ mass_i row_i row_iᵀ; empty if the mass of too many degrees of freedom
/// changes.
std::optional<std::vector<Motion>> low_rank(const Sparse& slope, double ratio, const Sparse& mass) {
  const Sparse rest = slope - ratio * mass;
  // Entries far below the diagonal entries are rounding errors.
  const Eigen::VectorXd size = (std::abs(ratio) * mass.diagonal().array()).sqrt().matrix();
  const auto counts = [&](Index row, Index column, double value) {
    return std::abs(value) >
           kEqual * (std::abs(slope.coeff(row, column)) + size[row] * size[column]);
  };
  std::vector<int> dofs;
  for (Index c = 0; c < rest.outerSize(); ++c)
    for (Sparse::InnerIterator entry(rest, c); entry; ++entry)
      if (counts(entry.row(), entry.col(), entry.value()))
        dofs.push_back(static_cast<int>(entry.col()));
  dofs.erase(std::unique(dofs.begin(), dofs.end()), dofs.end());
  if (dofs.size() > kMostDofs) return {};
  std::vector<Motion> out;
  if (dofs.empty()) return out;
  const auto n = static_cast<Index>(dofs.size());
  Eigen::MatrixXd block(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const double value = rest.coeff(dofs[index(i)], dofs[index(j)]);
      block(i, j) = counts(dofs[index(i)], dofs[index(j)], value) ? value : 0.0;
    }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(block);
  const double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  for (Index k = 0; k < n; ++k) {
    if (std::abs(solver.eigenvalues()[k]) <= kZeroComponent * largest) continue;
    Motion motion{.row = {}, .mass = solver.eigenvalues()[k]};
    for (Index i = 0; i < n; ++i)
      if (const double c = solver.eigenvectors()(i, k); std::abs(c) > kZeroComponent) {
        motion.row.dofs.push_back(dofs[index(i)]);
        motion.row.coefficients.push_back(c);
      }
    out.push_back(std::move(motion));
  }
  return out;
}

}  // namespace

std::optional<ScaledStructure> ScaledStructure::of(StructureFamily family,
                                                   std::span<const std::vector<double>> samples) {
  ScaledStructure out;
  out.origin_ = family.nominal;
  const ParametricStructure structure(family, samples);
  if (!out.take_stiffness(structure) || !out.take_mass(structure) || out.columns() > kMostColumns)
    return {};
  out.base_ = std::make_shared<const Discretisation>(structure.nominal());
  if (out.masses_.empty()) return out;
  // Added masses need fewer checks than removed masses.
  for (const ChangedMass& mass : out.masses_)
    for (std::size_t j = 0; j < mass.slopes.size(); ++j)
      for (const std::vector<double>& sample : samples)
        if (mass.slopes[j] > 0.0) family.nominal[j] = std::min(family.nominal[j], sample[j]);
  ScaledStructure moved;
  moved.origin_ = family.nominal;
  const ParametricStructure base(std::move(family), samples);
  if (!moved.take_stiffness(base) || !moved.take_mass(base)) return out;
  moved.base_ = std::make_shared<const Discretisation>(base.nominal());
  return moved;
}

bool ScaledStructure::take_stiffness(const ParametricStructure& structure) {
  if (structure.form() != ParametricStructure::Form::affine) return false;
  const Discretisation& nominal = structure.nominal();
  if (nominal.rest.nonZeros() > 0) return false;
  const std::span<const int> term = structure.term_of_strain();
  std::vector<std::ptrdiff_t> count(index(structure.terms()));
  for (const int t : term) ++count[index(t)];
  const auto whole = static_cast<int>(std::ranges::max_element(count) - count.begin());
  const auto slopes = [&](int t) {
    const Eigen::RowVectorXd row = structure.scale_slopes().row(t);
    return Slopes(row.begin(), row.end());
  };
  stiffness_ = slopes(whole);
  for (std::size_t i = 0; i < term.size(); ++i) {
    if (term[i] == whole) continue;
    if (nominal.strains[i].factor < 0.0 || index(kMostColumns) <= strains_.size()) return false;
    strains_.push_back({.strain = static_cast<int>(i), .slopes = slopes(term[i])});
  }
  return true;
}

bool ScaledStructure::take_mass(const ParametricStructure& structure) {
  mass_.assign(index(structure.parameters()), 0.0);
  if (!structure.mass_changes()) return true;
  for (int j = 0; j < structure.parameters(); ++j) {
    const Sparse& slope = structure.mass_slopes()[index(j)];
    if (slope.nonZeros() == 0) continue;
    const double ratio = common_ratio(slope, structure.nominal().mass);
    auto motions = low_rank(slope, ratio, structure.nominal().mass);
    if (!motions) return false;
    mass_[index(j)] = ratio;
    for (Motion& motion : *motions) add_mass(std::move(motion.row), index(j), motion.mass);
  }
  return true;
}

// A point mass does not scale with the density, but both change the mass of the same
// motions.
void ScaledStructure::add_mass(SparseRow motion, std::size_t parameter, double slope) {
  const auto same = std::ranges::find_if(masses_, [&](const ChangedMass& other) {
    if (other.motion.dofs != motion.dofs) return false;
    double product = 0.0;
    for (std::size_t i = 0; i < motion.dofs.size(); ++i)
      product += other.motion.coefficients[i] * motion.coefficients[i];
    return std::abs(std::abs(product) - 1.0) <= kEqual;
  });
  if (same != masses_.end()) {
    same->slopes[parameter] += slope;
    return;
  }
  masses_.push_back({.motion = std::move(motion), .slopes = Slopes(mass_.size(), 0.0)});
  masses_.back().slopes[parameter] = slope;
}

double ScaledStructure::change(const Slopes& slopes, std::span<const double> theta) const {
  double sum = 0.0;
  for (std::size_t j = 0; j < slopes.size(); ++j) sum += slopes[j] * (theta[j] - origin_[j]);
  return sum;
}

std::optional<ScaledStructure::Scales> ScaledStructure::scales(
    std::span<const double> theta) const {
  const Scales out{.stiffness = 1.0 + change(stiffness_, theta),
                   .mass = 1.0 + change(mass_, theta)};
  if (!(out.stiffness > 0.0 && out.mass > 0.0)) return {};
  return out;
}

ScaledStructure::Outcome ScaledStructure::transform(std::span<const double> theta,
                                                    const Scales& scales,
                                                    StructureChange& change) const {
  for (StructureChange::Spring& spring : change.springs) spring.stiffness /= scales.stiffness;
  for (StructureChange::Mass& mass : change.masses) mass.mass /= scales.mass;
  for (const ChangedStrain& strain : strains_) {
    double remaining = (1.0 + this->change(strain.slopes, theta)) / scales.stiffness;
    if (!(remaining > 0.0)) return Outcome::impossible;
    for (std::size_t i = 0; i < change.softenings.size(); ++i) {
      const StructureChange::Softening& softening = change.softenings[i];
      const auto own =
          std::ranges::find(softening.direction, strain.strain, &std::pair<int, double>::first);
      if (own == softening.direction.end() || own->second == 0.0) continue;
      if (std::abs(std::abs(own->second) - 1.0) > kEqual) return Outcome::unsupported;
      remaining *= softening.remaining;
      change.softenings.erase(change.softenings.begin() + static_cast<std::ptrdiff_t>(i--));
    }
    if (std::abs(remaining - 1.0) <= kUnchanged) continue;
    if (remaining < 1.0)
      change.softenings.push_back({.direction = {{strain.strain, 1.0}}, .remaining = remaining});
    else
      change.springs.push_back(
          {.motion = base_->strains[index(strain.strain)].row, .stiffness = remaining - 1.0});
  }
  for (const ChangedMass& mass : masses_) {
    const double added = this->change(mass.slopes, theta) / scales.mass;
    if (added != 0.0) change.masses.push_back({.motion = mass.motion, .mass = added});
  }
  return Outcome::possible;
}

}  // namespace wheeltap::fem

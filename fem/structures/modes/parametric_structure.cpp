#include "fem/structures/modes/parametric_structure.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Discretisation::Sparse;

/// Relative difference below which two numbers are equal within rounding.
constexpr double kSame = 1e-10;
/// With more terms, the projection of the separate terms takes longer than it saves.
constexpr int kMostTerms = 400;
/// Largest number of low-rank columns of one term, and of all terms.
constexpr Index kLowRank = 24, kMostColumns = 64;
/// Largest negative eigenvalue of a semidefinite term, relative to the diagonal of K.
constexpr double kIndefinite = 1e-9;

bool same(double a, double b) {
  return std::abs(a - b) <= kSame * std::max(std::abs(a), std::abs(b));
}

/// (c/c₀)² if the row is c/c₀ times the nominal row; otherwise NaN.
double squared_ratio(const Strain& nominal, const Strain& strain) {
  if (strain.row.dofs != nominal.row.dofs || strain.factor != nominal.factor) return kNaN;
  double largest = 0.0, ratio = 1.0;
  for (std::size_t i = 0; i < nominal.row.dofs.size(); ++i)
    if (const double c = nominal.row.coefficients[i]; std::abs(c) > largest) {
      largest = std::abs(c);
      ratio = strain.row.coefficients[i] / c;
    }
  for (std::size_t i = 0; i < nominal.row.dofs.size(); ++i) {
    const double miss = strain.row.coefficients[i] - ratio * nominal.row.coefficients[i];
    if (std::abs(miss) > kSame * std::max(std::abs(ratio) * largest, 1e-300)) return kNaN;
  }
  return ratio * ratio;
}

double largest_entry(const Sparse& a) {
  return a.nonZeros() > 0
             ? Eigen::Map<const VectorXd>(a.valuePtr(), a.nonZeros()).cwiseAbs().maxCoeff()
             : 0.0;
}

/// True if two matrices are equal within rounding.
bool equal(const Sparse& a, const Sparse& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
  Sparse difference = a - b;
  difference.makeCompressed();
  return largest_entry(difference) <= kSame * std::max(largest_entry(a), largest_entry(b));
}

Sparse symmetric(const Sparse& a) {
  Sparse out = 0.5 * (a + Sparse(a.transpose()));
  out.makeCompressed();
  return out;
}

bool is_semidefinite(const Sparse& a, const VectorXd& allowance) {
  Sparse lifted = a;
  for (Index i = 0; i < a.rows(); ++i) lifted.coeffRef(i, i) += kIndefinite * allowance[i];
  const Eigen::SimplicialLDLT<Sparse> ldlt(lifted);
  return ldlt.info() == Eigen::Success && (ldlt.vectorD().array() > 0.0).all();
}

}  // namespace

ParametricStructure::ParametricStructure(StructureFamily family,
                                         std::span<const std::vector<double>> samples)
    : family_(std::move(family)), nominal_(family_.at(family_.nominal)) {
  std::vector<std::vector<double>> tried;
  std::vector<Discretisation> at_samples;
  constexpr std::size_t kTried = 12;
  for (const std::vector<double>& sample : samples) {
    if (tried.size() == kTried) break;
    try {
      at_samples.push_back(family_.at(sample));
      tried.push_back(sample);
    } catch (const std::invalid_argument&) {
      // No valid structure exists at this sample.
    }
  }
  take_parts();
  group_strains(at_samples);
  if (terms_ == 0) return;
  for (std::size_t s = 0; s < tried.size(); ++s)
    if (!scales_of(tried[s], at_samples[s])) {
      terms_ = 0;
      return;
    }
  form_ = Form::scaled;
  find_low_rank();
  try_affine(tried, at_samples);
}

void ParametricStructure::find_low_rank() {
  low_rank_.resize(nominal_.size(), 0);
  if (!definite_) return;
  const int first = terms_ - static_cast<int>(part_terms_.size());
  std::vector<std::pair<int, MatrixXd>> found;
  for (int t = 0; t < first; ++t) {
    std::vector<const SparseRow*> rows;
    for (std::size_t i = 0; i < group_.size(); ++i)
      if (group_[i] == t) rows.push_back(&nominal_.strains[i].row);
    if (static_cast<Index>(rows.size()) > kLowRank) continue;
    MatrixXd columns = MatrixXd::Zero(nominal_.size(), static_cast<Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t k = 0; k < rows[i]->dofs.size(); ++k)
        columns(rows[i]->dofs[k], static_cast<Index>(i)) = rows[i]->coefficients[k];
    found.emplace_back(t, std::move(columns));
  }
  for (std::size_t p = 0; p < part_terms_.size(); ++p) {
    std::vector<Index> dofs;
    for (Index c = 0; c < part_terms_[p].cols(); ++c)
      if (part_terms_[p].col(c).norm() > 0.0) dofs.push_back(c);
    const auto n = static_cast<Index>(dofs.size());
    if (n > 4 * kLowRank) continue;
    MatrixXd block(n, n);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j)
        block(i, j) = part_terms_[p].coeff(dofs[static_cast<std::size_t>(i)],
                                           dofs[static_cast<std::size_t>(j)]);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(block);
    const VectorXd& values = solver.eigenvalues();
    // The omitted part is smaller than the allowed deviation from a semidefinite matrix.
    const Index rank = (values.array() > 1e-13 * values[n - 1]).count();
    if (rank > kLowRank) continue;
    MatrixXd columns = MatrixXd::Zero(nominal_.size(), rank);
    for (Index k = 0; k < rank; ++k)
      for (Index i = 0; i < n; ++i)
        columns(dofs[static_cast<std::size_t>(i)], k) =
            std::sqrt(values[n - 1 - k]) * solver.eigenvectors()(i, n - 1 - k);
    found.emplace_back(first + static_cast<int>(p), std::move(columns));
  }
  std::ranges::stable_sort(found, {}, [](const auto& f) { return f.second.cols(); });
  for (const auto& [term, columns] : found) {
    const Index before = low_rank_.cols(), all = before + columns.cols();
    if (all > kMostColumns) break;
    low_rank_.conservativeResize(Eigen::NoChange, all);
    low_rank_.rightCols(columns.cols()) = columns;
    term_of_column_.resize(static_cast<std::size_t>(all), term);
  }
}

void ParametricStructure::take_parts() {
  definite_ = std::ranges::all_of(nominal_.strains, [](const Strain& s) { return s.factor > 0.0; });
  const VectorXd diagonal = nominal_.stiffness.diagonal();
  if (family_.parts.empty()) {
    if (nominal_.rest.nonZeros() > 0) part_terms_ = {symmetric(nominal_.rest)};
  } else {
    nominal_scales_ = family_.scales(family_.nominal);
    for (std::size_t i = 0; i < family_.parts.size(); ++i)
      part_terms_.emplace_back(nominal_scales_[i] * symmetric(family_.parts[i]));
  }
  for (const Sparse& part : part_terms_) definite_ = definite_ && is_semidefinite(part, diagonal);
}

void ParametricStructure::group_strains(const std::vector<Discretisation>& at_samples) {
  std::vector<std::vector<double>> keys;
  group_.assign(nominal_.strains.size(), 0);
  for (std::size_t i = 0; i < nominal_.strains.size(); ++i) {
    std::vector<double> key;
    for (const Discretisation& d : at_samples) {
      if (d.strains.size() != nominal_.strains.size() || d.size() != nominal_.size()) return;
      key.push_back(squared_ratio(nominal_.strains[i], d.strains[i]));
      if (std::isnan(key.back())) return;
    }
    const auto found = std::ranges::find_if(
        keys, [&](const auto& other) { return std::ranges::equal(other, key, same); });
    group_[i] = static_cast<int>(found - keys.begin());
    if (found == keys.end()) keys.push_back(std::move(key));
    if (keys.size() > kMostTerms) return;
  }
  terms_ = static_cast<int>(keys.size() + part_terms_.size());
}

std::optional<VectorXd> ParametricStructure::scales_of(std::span<const double> theta,
                                                       const Discretisation& d) const {
  const auto parts = static_cast<Index>(part_terms_.size());
  VectorXd q = VectorXd::Ones(terms_);
  std::vector<bool> set(static_cast<std::size_t>(terms_));
  if (d.strains.size() != nominal_.strains.size()) return {};
  for (std::size_t i = 0; i < d.strains.size(); ++i) {
    const double ratio = squared_ratio(nominal_.strains[i], d.strains[i]);
    if (std::isnan(ratio)) return {};
    const auto g = static_cast<std::size_t>(group_[i]);
    if (set[g] && !same(q[group_[i]], ratio)) return {};
    set[g] = true;
    q[group_[i]] = ratio;
  }
  if (!family_.parts.empty()) {
    const std::vector<double> scales = family_.scales(theta);
    Sparse sum(d.size(), d.size());
    for (Index i = 0; i < parts; ++i) {
      const auto at = static_cast<std::size_t>(i);
      q[terms_ - parts + i] = scales[at] / nominal_scales_[at];
      sum += q[terms_ - parts + i] * part_terms_[at];
    }
    if (!equal(sum, d.rest)) return {};
  } else if (parts > 0 && !equal(part_terms_[0], d.rest)) {
    return {};
  }
  return q;
}

VectorXd ParametricStructure::change_of(std::span<const double> theta) const {
  VectorXd change(parameters());
  for (Index j = 0; j < change.size(); ++j)
    change[j] = theta[static_cast<std::size_t>(j)] - family_.nominal[static_cast<std::size_t>(j)];
  return change;
}

void ParametricStructure::try_affine(std::span<const std::vector<double>> samples,
                                     const std::vector<Discretisation>& at_samples) {
  MatrixXd slopes(terms_, parameters());
  std::vector<Sparse> mass_slopes;
  bool changes = false;
  for (int j = 0; j < parameters(); ++j) {
    // The step leads to the value of the parameter in a sample: within its bounds, and not small.
    std::vector<double> stepped = family_.nominal;
    const auto at = static_cast<std::size_t>(j);
    for (const auto& sample : samples)
      if (std::abs(sample[at] - family_.nominal[at]) > std::abs(stepped[at] - family_.nominal[at]))
        stepped[at] = sample[at];
    const double step = stepped[at] - family_.nominal[at];
    if (step == 0.0) return;
    try {
      const Discretisation d = family_.at(stepped);
      const auto q = scales_of(stepped, d);
      if (!q) return;
      slopes.col(j) = (*q - VectorXd::Ones(terms_)) / step;
      const bool here = !equal(d.mass, nominal_.mass);
      changes = changes || here;
      Sparse slope(d.size(), d.size());
      if (here) slope = (d.mass - nominal_.mass) / step;
      slope.makeCompressed();
      mass_slopes.push_back(std::move(slope));
    } catch (const std::invalid_argument&) {
      return;
    }
  }
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const VectorXd change = change_of(samples[s]);
    const VectorXd q = *scales_of(samples[s], at_samples[s]);
    const VectorXd guess = VectorXd::Ones(terms_) + slopes * change;
    for (Index t = 0; t < terms_; ++t)
      if (std::abs(q[t] - guess[t]) > kSame * std::max(1.0, std::abs(q[t]))) return;
    Sparse mass = nominal_.mass;
    for (int j = 0; j < parameters(); ++j)
      mass += change[j] * mass_slopes[static_cast<std::size_t>(j)];
    if (!equal(mass, at_samples[s].mass)) return;
  }
  form_ = Form::affine;
  slopes_ = std::move(slopes);
  mass_slopes_ = std::move(mass_slopes);
  mass_changes_ = changes;
}

ParametricStructure::Point ParametricStructure::at(std::span<const double> theta) const {
  Point point{.scales = {}, .change = change_of(theta)};
  if (form_ == Form::affine) {
    point.scales = VectorXd::Ones(terms_) + slopes_ * point.change;
  } else {
    point.assembled = family_.at(theta);
    if (form_ == Form::scaled)
      if (auto q = scales_of(theta, *point.assembled)) point.scales = std::move(*q);
  }
  if (!definite_ || point.scales.size() == 0) return point;
  point.floor = 1.0;
  for (int t = 0; t < terms_; ++t)
    if (std::ranges::find(term_of_column_, t) == term_of_column_.end())
      point.floor = std::min(point.floor, std::max(0.0, point.scales[t]));
  point.excess.resize(low_rank_.cols());
  for (Index c = 0; c < point.excess.size(); ++c)
    point.excess[c] =
        point.scales[term_of_column_[static_cast<std::size_t>(c)]] / point.floor - 1.0;
  return point;
}

MatrixXd ParametricStructure::stiffness_times(const Point& point, const MatrixXd& u) const {
  MatrixXd out(u.rows(), u.cols());
  if (point.assembled) {
    for (Index c = 0; c < u.cols(); ++c) out.col(c) = point.assembled->stiffness_times(u.col(c));
    return out;
  }
  out.setZero();
  Eigen::RowVectorXd stress(u.cols());
  for (std::size_t i = 0; i < nominal_.strains.size(); ++i) {
    const SparseRow& row = nominal_.strains[i].row;
    stress.setZero();
    for (std::size_t k = 0; k < row.dofs.size(); ++k)
      stress += row.coefficients[k] * u.row(row.dofs[k]);
    stress *= nominal_.strains[i].factor * point.scales[group_[i]];
    for (std::size_t k = 0; k < row.dofs.size(); ++k)
      out.row(row.dofs[k]) += row.coefficients[k] * stress;
  }
  const Index first = terms_ - static_cast<Index>(part_terms_.size());
  for (std::size_t p = 0; p < part_terms_.size(); ++p)
    out += point.scales[first + static_cast<Index>(p)] * (part_terms_[p] * u);
  return out;
}

MatrixXd ParametricStructure::mass_times(const Point& point, const MatrixXd& u) const {
  if (point.assembled) return point.assembled->mass * u;
  MatrixXd out = nominal_.mass * u;
  if (mass_changes_)
    for (Index j = 0; j < point.change.size(); ++j) {
      const Sparse& slope = mass_slopes_[static_cast<std::size_t>(j)];
      if (slope.nonZeros() > 0) out += point.change[j] * (slope * u);
    }
  return out;
}

Discretisation ParametricStructure::assemble(const Point& point) const {
  if (point.assembled) return *point.assembled;
  std::vector<double> theta = family_.nominal;
  for (std::size_t j = 0; j < theta.size(); ++j) theta[j] += point.change[static_cast<Index>(j)];
  return family_.at(theta);
}

std::vector<MatrixXd> ParametricStructure::project_terms(const MatrixXd& basis) const {
  const Index m = basis.cols();
  std::vector<MatrixXd> out(static_cast<std::size_t>(terms_), MatrixXd::Zero(m, m));
  VectorXd strain(m);
  for (std::size_t i = 0; i < nominal_.strains.size() && terms_ > 0; ++i) {
    const SparseRow& row = nominal_.strains[i].row;
    strain.setZero();
    for (std::size_t k = 0; k < row.dofs.size(); ++k)
      strain += row.coefficients[k] * basis.row(row.dofs[k]).transpose();
    out[static_cast<std::size_t>(group_[i])].selfadjointView<Eigen::Lower>().rankUpdate(
        strain, nominal_.strains[i].factor);
  }
  const std::size_t first =
      static_cast<std::size_t>(terms_) - (terms_ > 0 ? part_terms_.size() : 0);
  for (std::size_t t = 0; t < out.size(); ++t) {
    if (t >= first) out[t] = basis.transpose() * (part_terms_[t - first] * basis);
    out[t] = MatrixXd(out[t].selfadjointView<Eigen::Lower>());
  }
  return out;
}

std::vector<Sparse> ParametricStructure::term_matrices() const {
  std::vector<std::vector<Eigen::Triplet<double>>> entries(static_cast<std::size_t>(terms_));
  for (std::size_t i = 0; i < nominal_.strains.size() && terms_ > 0; ++i) {
    const auto& [row, factor] = nominal_.strains[i];
    for (std::size_t a = 0; a < row.dofs.size(); ++a)
      for (std::size_t b = 0; b < row.dofs.size(); ++b)
        entries[static_cast<std::size_t>(group_[i])].emplace_back(
            row.dofs[a], row.dofs[b], factor * row.coefficients[a] * row.coefficients[b]);
  }
  std::vector<Sparse> out;
  for (const auto& of_term : entries) {
    out.emplace_back(nominal_.size(), nominal_.size());
    out.back().setFromTriplets(of_term.begin(), of_term.end());
  }
  for (std::size_t p = 0; p < part_terms_.size() && terms_ > 0; ++p)
    out[out.size() - part_terms_.size() + p] = part_terms_[p];
  return out;
}

}  // namespace wheeltap::fem

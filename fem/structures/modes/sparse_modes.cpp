#include "fem/structures/modes/sparse_modes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/eigen_solvers.hpp"
#include "fem/structures/modes/tridiagonal.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Discretisation::Sparse;

constexpr int kLanes = 4;
/// Relative residual at which a Ritz pair counts as converged. The error of a Ritz value is of
/// second order in its residual.
constexpr double kRitzConverged = 1e-7;
/// If a new Lanczos vector has a smaller relative size, the subspace counts as invariant.
constexpr double kInvariant = 1e-13;
/// Share of a vector without any symmetry in the first Lanczos vector.
constexpr double kGeneric = 0.05;
/// Smallest relative gap of 1/λ for a count of modes, and gap that is clearly sufficient.
constexpr double kCountGap = 1e-6, kClearGap = 1e-3;
/// Largest relative residual of a solution for derivatives of shapes, and of rounding errors.
constexpr double kSolved = 1e-6, kRounding = 1e-6;
/// Lanczos' method finds only one of several equal modes; each further round finds another.
constexpr Index kRounds = 4;
/// Convergence is first checked after 2 steps per mode plus kBeforeChecks, then every
/// kBetweenChecks steps. The largest number of steps is 3 per mode plus kSpareSteps.
constexpr Index kBeforeChecks = 4, kBetweenChecks = 3, kSpareSteps = 60;

std::size_t to_size(Index i) {
  return static_cast<std::size_t>(i);
}

Sparse pattern_of(const ParametricStructure& structure, const std::vector<Sparse>& terms) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto take = [&](const Sparse& matrix) {
    for (int c = 0; c < matrix.outerSize(); ++c)
      for (Sparse::InnerIterator it(matrix, c); it; ++it) entries.emplace_back(it.row(), c, 1.0);
  };
  for (const Sparse& term : terms) take(term);
  take(structure.nominal().mass);
  for (const Sparse& slope : structure.mass_slopes()) take(slope);
  Sparse out(structure.nominal().size(), structure.nominal().size());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

}  // namespace

SparseModes::SparseModes(const ParametricStructure& structure, Index massive, Index elastic,
                         const MatrixXd& start, const std::vector<SparseRow>& motions)
    : structure_(structure),
      n_(structure.nominal().size()),
      massive_(massive),
      elastic_(elastic),
      factor_(pattern_of(structure, structure.term_matrices())),
      touching_(to_size(n_)),
      start_(n_, start.cols()) {
  for (const Sparse& term : structure.term_matrices()) terms_.push_back(entries(term));
  for (const Sparse& slope : structure.mass_slopes()) mass_slopes_.push_back(entries(slope));
  mass_ = entries(structure.nominal().mass);
  std::vector<char> stiff(factor_.entries()), heavy(factor_.entries());
  const auto mark = [](std::vector<char>& marked) {
    return [&](const Entries& e) {
      for (const std::size_t i : e.lower_at) marked[i] = 1;
    };
  };
  std::ranges::for_each(terms_, mark(stiff));
  std::ranges::for_each(mass_slopes_, mark(heavy));
  mark(heavy)(mass_);
  for (std::size_t i = 0; i < stiff.size(); ++i)
    if (stiff[i] != 0 || heavy[i] != 0) {
      used_.push_back(i);
      touching_[factor_.row(i)].push_back(i);
      touching_[factor_.column(i)].push_back(i);
    }
  stiffness_columns_ = columns_of(stiff);
  mass_columns_ = columns_of(heavy);
  const auto moved = [&](SparseRow row) {
    for (int& dof : row.dofs)
      dof = static_cast<int>(factor_.position(static_cast<std::size_t>(dof)));
    return row;
  };
  for (const SparseRow& motion : motions) motions_.push_back(moved(motion));
  for (const Strain& strain : structure.nominal().strains) strains_.push_back(moved(strain.row));
  for (Index i = 0; i < n_; ++i)
    start_.row(static_cast<Index>(factor_.position(to_size(i)))) = start.row(i);
}

SparseModes::Entries SparseModes::entries(const Sparse& matrix) const {
  Entries out;
  for (int c = 0; c < matrix.outerSize(); ++c)
    for (Sparse::InnerIterator it(matrix, c); it; ++it) {
      const std::size_t a = factor_.position(static_cast<std::size_t>(it.row()));
      const std::size_t b = factor_.position(static_cast<std::size_t>(c));
      if (a == b) {
        out.diagonal_at.push_back(a);
        out.diagonal.push_back(it.value());
      } else if (a > b) {
        out.lower_at.push_back(factor_.index(a, b));
        out.rows.push_back(static_cast<std::uint32_t>(a));
        out.columns.push_back(static_cast<std::uint32_t>(b));
        out.lower.push_back(it.value());
      }
    }
  return out;
}

SparseModes::Columns SparseModes::columns_of(const std::vector<char>& marked) const {
  Columns out;
  // Entries of `lower` are stored column by column.
  for (std::size_t column = 0, i = 0; column < to_size(n_); ++column) {
    out.start.push_back(out.entries.size());
    for (; i < marked.size() && factor_.column(i) == column; ++i)
      if (marked[i] != 0)
        out.entries.push_back({.entry = static_cast<std::uint32_t>(i),
                               .row = static_cast<std::uint32_t>(factor_.row(i))});
  }
  out.start.push_back(out.entries.size());
  return out;
}

void SparseModes::add(double factor, const Entries& entries, double* diagonal, double* lower) {
  for (std::size_t i = 0; i < entries.diagonal.size(); ++i)
    diagonal[entries.diagonal_at[i]] += factor * entries.diagonal[i];
  for (std::size_t i = 0; i < entries.lower.size(); ++i)
    lower[entries.lower_at[i]] += factor * entries.lower[i];
}

void SparseModes::times(const double* diagonal, const double* lower, const Columns& columns,
                        const double* u, double* out) const {
  for (Index i = 0; i < n_; ++i) out[i] = diagonal[i] * u[i];
  const auto size = static_cast<std::size_t>(n_);
  for (std::size_t column = 0; column < size; ++column) {
    // No later column changes out[column].
    const double by = u[column];
    double sum = out[column];
    for (std::size_t k = columns.start[column]; k < columns.start[column + 1]; ++k) {
      const double value = lower[columns.entries[k].entry];
      const std::uint32_t row = columns.entries[k].row;
      out[row] += value * by;
      sum += value * u[row];
    }
    out[column] = sum;
  }
}

/// Adds scale_w A u_w for each of the kLanes vectors u_w.
void SparseModes::multiply(const Entries& entries, const double* u, const double* scale,
                           double* out) {
  using Lanes = Eigen::Array<double, kLanes, 1>;
  const Lanes scales = Eigen::Map<const Lanes>(scale);
  const auto add = [&](std::size_t to, double value, std::size_t from) {
    Eigen::Map<Lanes>(out + kLanes * to) +=
        scales * value * Eigen::Map<const Lanes>(u + kLanes * from);
  };
  for (std::size_t i = 0; i < entries.diagonal.size(); ++i)
    add(entries.diagonal_at[i], entries.diagonal[i], entries.diagonal_at[i]);
  for (std::size_t i = 0; i < entries.lower.size(); ++i) {
    add(entries.rows[i], entries.lower[i], entries.columns[i]);
    add(entries.columns[i], entries.lower[i], entries.rows[i]);
  }
}

/// Computes K u for the modes u. Strains avoid cancellation for smooth shapes; terms that are given
/// as matrices have none.
MatrixXd SparseModes::stiffness_times(const ParametricStructure::Point& point,
                                      const Workspace& ws) const {
  const MatrixXd& u = ws.modes;
  MatrixXd out = MatrixXd::Zero(n_, u.cols());
  const auto terms = structure_.term_of_strain();
  for (Index c = 0; c < u.cols(); ++c) {
    if (structure_.matrix_terms() > 0)
      times(ws.matrices_diagonal.data(), ws.matrices.data(), stiffness_columns_, u.col(c).data(),
            out.col(c).data());
    for (std::size_t i = 0; i < strains_.size(); ++i) {
      const SparseRow& row = strains_[i];
      const double stress =
          structure_.nominal().strains[i].factor * point.scales[terms[i]] * row.of(u.col(c));
      for (std::size_t k = 0; k < row.dofs.size(); ++k)
        out(row.dofs[k], c) += row.coefficients[k] * stress;
    }
  }
  return out;
}

/// Computes the Ritz modes in the span of `ws.modes` and the norms of their residuals. The errors
/// of the Ritz values are of second order.
bool SparseModes::rayleigh_ritz(const ParametricStructure::Point& point, Workspace& ws) const {
  MatrixXd momenta(n_, elastic_);
  for (Index i = 0; i < elastic_; ++i)
    mass_times(ws, ws.modes.col(i).data(), momenta.col(i).data());
  MatrixXd forces = stiffness_times(point, ws);
  const MatrixXd energy = ws.modes.transpose() * forces, gram = ws.modes.transpose() * momenta;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> ritz(
      MatrixXd(0.5 * (energy + energy.transpose())), MatrixXd(0.5 * (gram + gram.transpose())));
  if (ritz.info() != Eigen::Success || !(ritz.eigenvalues()[0] > 0.0)) return false;
  ws.eigenvalues = ritz.eigenvalues();
  ws.modes = ws.modes * ritz.eigenvectors();
  momenta = momenta * ritz.eigenvectors();
  forces = forces * ritz.eigenvectors();
  ws.residuals.resize(elastic_);
  // √(rᵀ K⁻¹ r / λ) of each mode, several at once.
  const MatrixXd residuals = forces - momenta * ws.eigenvalues.asDiagonal();
  std::vector<double> moved(kLanes * to_size(n_));
  for (Index group = 0; group < elastic_; group += kLanes) {
    const Index count = std::min<Index>(kLanes, elastic_ - group);
    std::ranges::fill(moved, 0.0);
    for (Index w = 0; w < count; ++w)
      for (Index i = 0; i < n_; ++i) moved[to_size(kLanes * i + w)] = residuals(i, group + w);
    factor_.solve_several<kLanes>(ws.shifted, moved.data());
    for (Index w = 0; w < count; ++w) {
      const Eigen::Map<const VectorXd, 0, Eigen::InnerStride<kLanes>> mine(moved.data() + w, n_);
      ws.residuals[group + w] =
          std::sqrt(std::max(0.0, residuals.col(group + w).dot(mine)) / ws.eigenvalues[group + w]);
    }
  }
  return ws.residuals.allFinite();
}

/// Iterates until the `wanted` largest Ritz values converge. Adds these values to `mu` and their
/// vectors to `locked` (M-orthonormal). `beyond` receives estimates of the next values.
bool SparseModes::lanczos(Workspace& ws, MatrixXd& locked, VectorXd& mu, VectorXd& beyond,
                          Index wanted, Index round) const {
  const Index known = locked.cols();
  const Index most = std::min(massive_ - known, 3 * wanted + kSpareSteps);
  if (most < 1) return false;
  // The columns of v are the locked vectors, then the Lanczos vectors; momenta = M v.
  MatrixXd v(n_, known + most), momenta(n_, known + most);
  v.leftCols(known) = locked;
  const auto weigh = [&](Index column) {
    mass_times(ws, v.col(column).data(), momenta.col(column).data());
  };
  for (Index c = 0; c < known; ++c) weigh(c);
  VectorXd next(n_), moved(n_);
  for (Index i = 0; i < n_; ++i)
    next[i] =
        std::sin((1.7 + 0.37 * static_cast<double>(round)) * static_cast<double>(i + 1)) + 0.1;
  mass_times(ws, next.data(), moved.data());
  factor_.solve<1>(ws.shifted, moved.data());
  mass_times(ws, moved.data(), next.data());
  moved /= std::sqrt(std::max(moved.dot(next), 1e-300));
  next = moved;
  if (round == 0) next = start_.rowwise().sum() + kGeneric * moved;

  const Index first_check = 2 * wanted + kBeforeChecks;
  VectorXd alpha = VectorXd::Zero(most), beta = VectorXd::Zero(most);
  const auto orthogonalise = [&](Index columns, VectorXd& shares) {
    shares = VectorXd::Zero(columns);
    for (int pass = 0; pass < 2; ++pass) {
      const VectorXd share = momenta.leftCols(columns).transpose() * next;
      next.noalias() -= v.leftCols(columns) * share;
      shares += share;
    }
  };
  const auto append = [&](Index column) {
    v.col(column) = next;
    weigh(column);
    const double size = std::sqrt(std::max(0.0, next.dot(momenta.col(column))));
    if (size > 0.0) {
      v.col(column) /= size;
      momenta.col(column) /= size;
    }
    return size;
  };
  VectorXd shares;
  if (known > 0) orthogonalise(known, shares);
  if (!(append(known) > 0.0)) return false;
  for (Index j = 0; j < most; ++j) {
    next = momenta.col(known + j);
    factor_.solve<1>(ws.shifted, next.data());
    orthogonalise(known + j + 1, shares);
    alpha[j] = shares[known + j];
    const bool full = j + 1 == most;
    if (!full) beta[j] = append(known + j + 1);
    const bool invariant = full || beta[j] <= kInvariant * std::abs(alpha[0]);
    if (!invariant && (j < first_check || (j - first_check) % kBetweenChecks != 0)) continue;
    if (!alpha.head(j + 1).allFinite() || !beta.head(j + 1).allFinite()) return false;
    VectorXd values, last;
    if (!last_components(alpha.head(j + 1), beta.head(j), values, last)) return false;
    const Index k = std::min(wanted, j + 1);
    Index converged = 0;
    while (converged < k && (invariant || beta[j] * std::abs(last[j - converged]) <
                                              kRitzConverged * values[j - converged]))
      ++converged;
    if (converged < k) continue;
    if (full && j + 1 < massive_ - known) return false;  // did not converge
    Eigen::SelfAdjointEigenSolver<MatrixXd> ritz;
    ritz.computeFromTridiagonal(alpha.head(j + 1), beta.head(j), Eigen::ComputeEigenvectors);
    if (ritz.info() != Eigen::Success) return false;
    const Index kept = k, more = std::min<Index>(j + 1 - k, 3);
    beyond = ritz.eigenvalues().head(j + 1 - k).tail(more).reverse();
    locked.conservativeResize(n_, known + kept);
    locked.rightCols(kept) =
        v.middleCols(known, j + 1) * ritz.eigenvectors().rightCols(kept).rowwise().reverse();
    mu.conservativeResize(known + kept);
    mu.tail(kept) = ritz.eigenvalues().tail(kept).reverse();
    return true;
  }
  return false;
}

/// True if `mu`, in descending order, has the largest values. The inertia shows this, in the first
/// clear gap from the k-th value on, or in the widest gap.
bool SparseModes::none_missing(Workspace& ws, const VectorXd& mu, Index k) const {
  if (mu.size() >= massive_) return true;
  Index split = -1;
  double widest = kCountGap;
  for (Index i = k - 1; i + 1 < mu.size(); ++i)
    if (const double gap = 1.0 - mu[i + 1] / mu[i]; gap > widest) {
      widest = gap;
      split = i;
      if (gap > kClearGap) break;
    }
  if (split < 0) return false;
  // K - s M, where s lies between the two eigenvalues.
  const double s = 1.0 / std::sqrt(mu[split] * std::max(mu[split + 1], 1e-12 * mu[split]));
  SparseFactor::Values& values = ws.several;
  values.diagonal.resize(to_size(n_));
  values.lower.assign(factor_.entries(), 0.0);
  for (Index i = 0; i < n_; ++i)
    values.diagonal[to_size(i)] = ws.stiffness_diagonal[i] - s * ws.mass_diagonal[i];
  for (const std::size_t e : used_) values.lower[e] = ws.stiffness[e] - s * ws.mass[e];
  factor_.factorise<1>(values);
  return std::ranges::all_of(values.diagonal, [](double d) { return std::isfinite(d); }) &&
         std::ranges::count_if(values.diagonal, [](double d) { return d < 0.0; }) == split + 1;
}

bool SparseModes::solve(const ParametricStructure::Point& point, Workspace& ws,
                        VectorXd& eigenvalues, MatrixXd& shapes) const {
  ws.solved = false;
  ws.stiffness_diagonal = VectorXd::Zero(n_);
  ws.mass_diagonal = VectorXd::Zero(n_);
  ws.stiffness.assign(factor_.entries(), 0.0);
  ws.mass.assign(factor_.entries(), 0.0);
  for (std::size_t t = 0; t < terms_.size(); ++t)
    add(point.scales[static_cast<Index>(t)], terms_[t], ws.stiffness_diagonal.data(),
        ws.stiffness.data());
  if (const std::size_t given = structure_.matrix_terms(); given > 0) {
    ws.matrices_diagonal = VectorXd::Zero(n_);
    ws.matrices.assign(factor_.entries(), 0.0);
    for (std::size_t t = terms_.size() - given; t < terms_.size(); ++t)
      add(point.scales[static_cast<Index>(t)], terms_[t], ws.matrices_diagonal.data(),
          ws.matrices.data());
  }
  add(1.0, mass_, ws.mass_diagonal.data(), ws.mass.data());
  if (structure_.mass_changes())
    for (std::size_t j = 0; j < mass_slopes_.size(); ++j)
      add(point.change[static_cast<Index>(j)], mass_slopes_[j], ws.mass_diagonal.data(),
          ws.mass.data());
  ws.shifted.diagonal.resize(to_size(n_));
  ws.shifted.lower.assign(factor_.entries(), 0.0);
  for (Index i = 0; i < n_; ++i) ws.shifted.diagonal[to_size(i)] = ws.stiffness_diagonal[i];
  for (const std::size_t e : used_) ws.shifted.lower[e] = ws.stiffness[e];
  factor_.factorise<1>(ws.shifted);
  if (!std::ranges::all_of(ws.shifted.diagonal, [](double d) { return d > 0.0; })) return false;

  MatrixXd found(n_, 0);
  VectorXd mu, beyond;
  bool complete = false;
  for (Index round = 0; round < kRounds && !complete; ++round) {
    const Index wanted = round == 0 ? elastic_ : std::min<Index>(elastic_, 2 + 2 * round);
    if (!lanczos(ws, found, mu, beyond, wanted, round)) return false;
    std::vector<Index> order(to_size(mu.size()));
    std::iota(order.begin(), order.end(), Index{0});
    std::ranges::stable_sort(order, std::ranges::greater{}, [&](Index i) { return mu[i]; });
    found = MatrixXd(found(Eigen::all, order));
    mu = VectorXd(mu(order));
    // The lowest modes may include a mode that has not converged.
    if (beyond.size() > 0 && beyond[0] >= mu[elastic_ - 1]) continue;
    ws.mu.resize(mu.size() + beyond.size());
    ws.mu << mu, beyond;
    std::ranges::sort(ws.mu, std::ranges::greater{});
    complete = none_missing(ws, ws.mu, elastic_);
  }
  if (!complete) return false;
  ws.modes = found.leftCols(elastic_);
  if (massive_ < n_) {
    // The recurrence amplifies rounding errors in motions without mass, and orthogonality in M does
    // not control these errors. K⁻¹ M removes them (Nour-Omid, Parlett, Ericsson & Jensen 1987).
    VectorXd moved(n_);
    for (Index i = 0; i < elastic_; ++i) {
      mass_times(ws, ws.modes.col(i).data(), moved.data());
      factor_.solve<1>(ws.shifted, moved.data());
      ws.modes.col(i) = moved / mu[i];
    }
  }
  if (!rayleigh_ritz(point, ws)) return false;
  eigenvalues = ws.eigenvalues;
  shapes.resize(static_cast<Index>(motions_.size()), elastic_);
  for (Index i = 0; i < elastic_; ++i)
    for (std::size_t s = 0; s < motions_.size(); ++s)
      shapes(static_cast<Index>(s), i) = motions_[s].of(ws.modes.col(i));
  ws.solved = true;
  return true;
}

bool SparseModes::differentiate(Workspace& ws, double twin, MatrixXd& eigenvalues,
                                std::vector<MatrixXd>& shapes) const {
  if (!ws.solved) return false;
  const Index d = structure_.parameters();
  const MatrixXd& scale_slopes = structure_.scale_slopes();
  constexpr std::size_t kWide = kLanes;
  eigenvalues.resize(elastic_, d);
  shapes.assign(to_size(d), MatrixXd(static_cast<Index>(motions_.size()), elastic_));
  MatrixXd momenta(n_, elastic_);
  for (Index i = 0; i < elastic_; ++i)
    mass_times(ws, ws.modes.col(i).data(), momenta.col(i).data());
  const auto distance = [&](Index i, Index j) {
    return std::abs(ws.eigenvalues[i] - ws.eigenvalues[j]) / ws.eigenvalues[j];
  };
  std::vector<double> modes(kWide * to_size(n_)), force(kWide * to_size(n_));
  for (Index group = 0; group < elastic_; group += kLanes) {
    std::array<Index, kWide> mode{}, first{}, last{};
    std::array<double, kWide> lambda{}, scale{};
    for (std::size_t w = 0; w < kWide; ++w) {
      const Index i = std::min<Index>(group + static_cast<Index>(w), elastic_ - 1);
      mode[w] = first[w] = last[w] = i;
      lambda[w] = ws.eigenvalues[i];
      while (first[w] > 0 && distance(first[w] - 1, i) < twin) --first[w];
      while (last[w] + 1 < elastic_ && distance(last[w] + 1, i) < twin) ++last[w];
      for (Index r = 0; r < n_; ++r) modes[kWide * to_size(r) + w] = ws.modes(r, i);
    }
    std::array<std::vector<std::size_t>, kWide> pinned;
    if (!motions_.empty()) {
      for (std::size_t w = 0; w < kWide; ++w) pinned[w] = pins(ws, first[w], last[w]);
      if (!factorise_at(ws, lambda.data(), pinned.data())) return false;
    }
    for (Index j = 0; j < d; ++j) {
      // ∂K y - λ ∂M y
      std::ranges::fill(force, 0.0);
      for (std::size_t t = 0; t < terms_.size(); ++t) {
        const double slope = scale_slopes(static_cast<Index>(t), j);
        if (slope == 0.0) continue;
        scale.fill(slope);
        multiply(terms_[t], modes.data(), scale.data(), force.data());
      }
      std::array<double, kWide> norm{};
      if (structure_.mass_changes()) {
        std::vector<double> by_mass(force.size());
        scale.fill(1.0);
        multiply(mass_slopes_[to_size(j)], modes.data(), scale.data(), by_mass.data());
        for (std::size_t r = 0; r < force.size(); ++r) {
          force[r] -= lambda[r % kWide] * by_mass[r];
          norm[r % kWide] -= 0.5 * modes[r] * by_mass[r];
        }
      }
      // (K - λM) ∂y = -(∂K - λ ∂M - ∂λ M) y, yᵀM ∂y = -½ yᵀ ∂M y; no rotation among twins.
      for (std::size_t w = 0; w < kWide; ++w) {
        const Eigen::Map<const VectorXd, 0, Eigen::InnerStride<kLanes>> mine(force.data() + w, n_);
        eigenvalues(mode[w], j) = ws.modes.col(mode[w]).dot(mine);
        if (motions_.empty()) continue;
        const VectorXd right =
            momenta.middleCols(first[w], last[w] - first[w] + 1) *
                (ws.modes.middleCols(first[w], last[w] - first[w] + 1).transpose() * mine) -
            mine;
        for (Index r = 0; r < n_; ++r) force[kWide * to_size(r) + w] = right[r];
        for (const std::size_t p : pinned[w]) force[kWide * p + w] = 0.0;
      }
      if (motions_.empty()) continue;
      const std::vector<double> right_sides = force;
      factor_.solve<kLanes>(ws.several, force.data());
      for (std::size_t w = 0; w < kWide; ++w) {
        const Eigen::Map<const VectorXd, 0, Eigen::InnerStride<kLanes>> mine(force.data() + w, n_);
        VectorXd change = mine;
        const Eigen::Map<const VectorXd, 0, Eigen::InnerStride<kLanes>> right(
            right_sides.data() + w, n_);
        if (!solves(ws, lambda[w], pinned[w], change, right))
          change = dense_change(ws, lambda[w], pinned[w], right);
        VectorXd missing =
            -momenta.middleCols(first[w], last[w] - first[w] + 1).transpose() * change;
        missing[mode[w] - first[w]] += norm[w];
        change += ws.modes.middleCols(first[w], last[w] - first[w] + 1) * missing;
        for (std::size_t s = 0; s < motions_.size(); ++s)
          shapes[to_size(j)](static_cast<Index>(s), mode[w]) = motions_[s].of(change);
      }
    }
  }
  return true;
}

/// Degrees of freedom at which the motions of a mode and of its twins are independent, and large in
/// units of energy.
std::vector<std::size_t> SparseModes::pins(const Workspace& ws, Index first, Index last) const {
  MatrixXd left = ws.stiffness_diagonal.cwiseAbs().cwiseSqrt().asDiagonal() *
                  ws.modes.middleCols(first, last - first + 1);
  std::vector<std::size_t> out;
  for (Index c = 0; c < left.cols(); ++c) {
    Index p = 0;
    left.col(c).cwiseAbs().maxCoeff(&p);
    out.push_back(to_size(p));
    for (Index other = c + 1; other < left.cols(); ++other)
      left.col(other) -= left.col(c) * (left(p, other) / left(p, c));
  }
  return out;
}

/// Factorises K - λ_w M in each lane w, with zero motion at the pinned degrees of freedom.
bool SparseModes::factorise_at(Workspace& ws, const double* lambda,
                               const std::vector<std::size_t>* pinned) const {
  constexpr std::size_t kWide = kLanes;
  SparseFactor::Values& values = ws.several;
  values.diagonal.resize(kWide * to_size(n_));
  values.lower.assign(kWide * factor_.entries(), 0.0);
  for (std::size_t i = 0; i < to_size(n_); ++i)
    for (std::size_t w = 0; w < kWide; ++w)
      values.diagonal[kWide * i + w] = ws.stiffness_diagonal[static_cast<Index>(i)] -
                                       lambda[w] * ws.mass_diagonal[static_cast<Index>(i)];
  for (const std::size_t e : used_)
    for (std::size_t w = 0; w < kWide; ++w)
      values.lower[kWide * e + w] = ws.stiffness[e] - lambda[w] * ws.mass[e];
  for (std::size_t w = 0; w < kWide; ++w)
    for (const std::size_t p : pinned[w]) {
      values.diagonal[kWide * p + w] = std::abs(ws.stiffness_diagonal[static_cast<Index>(p)]);
      for (const std::size_t e : touching_[p]) values.lower[kWide * e + w] = 0.0;
    }
  factor_.factorise<kLanes>(values);
  return std::ranges::all_of(values.diagonal,
                             [](double v) { return std::isfinite(v) && v != 0.0; });
}

/// True if x solves (K - λM) x = b at all degrees of freedom that are not pinned. Without pivoting,
/// the factor is wrong if λ is an eigenvalue of a part of the structure.
bool SparseModes::solves(const Workspace& ws, double lambda, const std::vector<std::size_t>& pinned,
                         const VectorXd& x, const VectorXd& b) const {
  VectorXd stiff(n_), heavy(n_);
  times(ws.stiffness_diagonal.data(), ws.stiffness.data(), stiffness_columns_, x.data(),
        stiff.data());
  mass_times(ws, x.data(), heavy.data());
  VectorXd miss = stiff - lambda * heavy - b;
  for (const std::size_t p : pinned) miss[static_cast<Index>(p)] = 0.0;
  return miss.norm() <= kSolved * (b.norm() + kRounding * stiff.norm());
}

/// Computes x with pivoting, by dense matrices.
VectorXd SparseModes::dense_change(const Workspace& ws, double lambda,
                                   const std::vector<std::size_t>& pinned,
                                   const VectorXd& b) const {
  MatrixXd a = MatrixXd::Zero(n_, n_);
  for (Index i = 0; i < n_; ++i) a(i, i) = ws.stiffness_diagonal[i] - lambda * ws.mass_diagonal[i];
  for (const std::size_t e : used_) {
    const auto row = static_cast<Index>(factor_.row(e));
    const auto column = static_cast<Index>(factor_.column(e));
    a(row, column) = a(column, row) = ws.stiffness[e] - lambda * ws.mass[e];
  }
  for (const std::size_t p : pinned) {
    const auto i = static_cast<Index>(p);
    a.row(i).setZero();
    a.col(i).setZero();
    a(i, i) = ws.stiffness_diagonal[i];
  }
  return a.partialPivLu().solve(b);
}

double SparseModes::cost() const {
  const auto n = static_cast<double>(n_), entries = static_cast<double>(factor_.entries());
  const auto products = static_cast<double>(factor_.products());
  const double steps = 2.0 * static_cast<double>(elastic_) + 12.0;
  double sum = 2.0 * products +
               steps * (2.0 * entries + 2.0 * static_cast<double>(mass_columns_.entries.size()) +
                        2.0 * n * steps);
  sum += 5.0 * steps * steps * steps;  // Ritz values
  if (!motions_.empty()) {
    const double lanes = kLanes * std::ceil(static_cast<double>(elastic_) / kLanes);
    sum += lanes * (products + 2.0 * entries * static_cast<double>(structure_.parameters()));
  }
  return sum;
}

}  // namespace wheeltap::fem

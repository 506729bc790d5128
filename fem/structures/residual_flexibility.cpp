#include "fem/structures/residual_flexibility.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <list>
#include <mutex>
#include <unordered_map>

namespace wheeltap::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Wide = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// Of the scaled energies of the forms: less is rounding.
constexpr double kDependent = 1e-11;
/// Pairs of forms whose moments are remembered.
constexpr std::size_t kPairs = 1 << 20;

}  // namespace

struct ResidualFlexibility::Impl {
  struct Column {
    VectorXd u, mass_u, w, mass_w;
  };
  using Columns = std::list<std::pair<int, std::shared_ptr<const Column>>>;

  std::shared_ptr<const Discretisation> d;
  MatrixXd shapes, mass_shapes;
  VectorXd eigenvalues;
  int rigid = 0;
  std::vector<char> held;  // degrees of freedom, as many as there are rigid motions
  Eigen::SimplicialLDLT<Discretisation::Sparse, Eigen::Lower, Eigen::AMDOrdering<int>> ldlt;
  std::size_t most_columns = 2;

  mutable std::mutex mutex;
  mutable Columns columns;  // last asked for first
  mutable std::unordered_map<int, Columns::iterator> known;
  mutable std::unordered_map<std::uint64_t, Moments> pairs;

  [[nodiscard]] SparseRow row_of(int basic) const {
    const auto strains = static_cast<int>(d->strains.size());
    if (basic < strains) return d->strains[static_cast<std::size_t>(basic)].row;
    return {.dofs = {basic - strains}, .coefficients = {1.0}};
  }

  // K⁻¹ load of a load that moves nothing rigidly; refined so often by what the strains leave of
  // it.
  [[nodiscard]] VectorXd solve(const VectorXd& load, int refinements) const {
    VectorXd left = load;
    for (Index i = 0; i < left.size(); ++i)
      if (held[static_cast<std::size_t>(i)]) left[i] = 0.0;
    Wide u = Wide::Zero(load.size());
    for (int pass = 0;; ++pass) {
      u += ldlt.solve(left).cast<long double>();
      if (pass == refinements) break;
      Wide rest = load.cast<long double>();
      for (const Strain& strain : d->strains) {
        long double e = 0;
        for (std::size_t i = 0; i < strain.row.dofs.size(); ++i)
          e += strain.row.coefficients[i] * u[strain.row.dofs[i]];
        e *= strain.factor;
        for (std::size_t i = 0; i < strain.row.dofs.size(); ++i)
          rest[strain.row.dofs[i]] -= e * strain.row.coefficients[i];
      }
      for (int k = 0; k < d->rest.outerSize(); ++k)
        for (Discretisation::Sparse::InnerIterator it(d->rest, k); it; ++it)
          rest[it.row()] -= it.value() * u[it.col()];
      left = rest.cast<double>();
      for (Index i = 0; i < left.size(); ++i)
        if (held[static_cast<std::size_t>(i)]) left[i] = 0.0;
    }
    return u.cast<double>();
  }

  void remove_kept(VectorXd& u) const { u -= shapes * (mass_shapes.transpose() * u); }

  [[nodiscard]] std::shared_ptr<const Column> compute(int basic) const {
    auto column = std::make_shared<Column>();
    VectorXd load = VectorXd::Zero(d->size());
    const SparseRow row = row_of(basic);
    for (std::size_t i = 0; i < row.dofs.size(); ++i) load[row.dofs[i]] = row.coefficients[i];
    load -= mass_shapes.leftCols(rigid) * (shapes.leftCols(rigid).transpose() * load);
    column->u = solve(load, 1);
    remove_kept(column->u);
    column->mass_u = d->mass * column->u;
    column->w = solve(column->mass_u, 0);
    remove_kept(column->w);
    column->mass_w = d->mass * column->w;
    return column;
  }

  [[nodiscard]] std::shared_ptr<const Column> column(int basic) const {
    {
      const std::lock_guard lock(mutex);
      if (const auto at = known.find(basic); at != known.end()) {
        columns.splice(columns.begin(), columns, at->second);
        return at->second->second;
      }
    }
    std::shared_ptr<const Column> computed = compute(basic);
    const std::lock_guard lock(mutex);
    if (const auto at = known.find(basic); at != known.end()) return at->second->second;
    columns.emplace_front(basic, computed);
    known[basic] = columns.begin();
    if (columns.size() > most_columns) {
      known.erase(columns.back().first);
      columns.pop_back();
    }
    return computed;
  }

  [[nodiscard]] Moments basic_moments(int a, int b) const {
    if (a > b) std::swap(a, b);
    const std::uint64_t key = static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
    {
      const std::lock_guard lock(mutex);
      if (const auto at = pairs.find(key); at != pairs.end()) return at->second;
    }
    const auto first = column(a), second = column(b);
    const Moments out{{row_of(a).of(second->u), first->u.dot(second->mass_u),
                       first->w.dot(second->mass_u), first->w.dot(second->mass_w)}};
    const std::lock_guard lock(mutex);
    if (pairs.size() >= kPairs) pairs.clear();
    pairs.emplace(key, out);
    return out;
  }
};

ResidualFlexibility::ResidualFlexibility(std::shared_ptr<const Discretisation> d,
                                         const MatrixXd& shapes, const VectorXd& eigenvalues,
                                         std::size_t memory)
    : impl_(std::make_unique<Impl>()) {
  Impl& impl = *impl_;
  impl.d = std::move(d);
  const Index n = impl.d->size();
  impl.shapes = shapes;
  impl.mass_shapes = impl.d->mass * shapes;
  impl.eigenvalues = eigenvalues;
  impl.rigid = static_cast<int>(impl.d->rigid_motions.cols());
  impl.held = impl.d->holding_dofs();
  Discretisation::Sparse k = impl.d->stiffness;
  k.prune([&](Index i, Index j, double) {
    return !impl.held[static_cast<std::size_t>(i)] && !impl.held[static_cast<std::size_t>(j)];
  });
  for (Index i = 0; i < n; ++i)
    if (impl.held[static_cast<std::size_t>(i)]) k.coeffRef(i, i) = 1.0;
  impl.ldlt.compute(k);
  if (impl.ldlt.info() != Eigen::Success)
    throw InvalidStructure(InvalidStructure::Part::whole, 0,
                           "is a mechanism: its stiffness cannot be factored");
  const std::size_t bytes = 4 * sizeof(double) * static_cast<std::size_t>(n);
  impl.most_columns = std::max<std::size_t>(memory / bytes, 64);
}

ResidualFlexibility::~ResidualFlexibility() = default;

int ResidualFlexibility::dof(int i) const {
  return static_cast<int>(impl_->d->strains.size()) + i;
}

ResidualFlexibility::Form ResidualFlexibility::motion(const SparseRow& row) const {
  Form form;
  for (std::size_t i = 0; i < row.dofs.size(); ++i)
    form.emplace_back(dof(row.dofs[i]), row.coefficients[i]);
  return form;
}

ResidualFlexibility::Moments ResidualFlexibility::moments(const Form& a, const Form& b) const {
  Moments sum;
  for (const auto& [i, weight] : a)
    for (const auto& [j, other] : b) {
      const Moments part = impl_->basic_moments(i, j);
      for (int n = 0; n < 4; ++n) sum.r[n] += weight * other * part.r[n];
    }
  return sum;
}

std::pair<double, double> ResidualFlexibility::responses(const SparseRow& row,
                                                         const Form& form) const {
  double u = 0.0, w = 0.0;
  for (const auto& [basic, weight] : form) {
    const auto column = impl_->column(basic);
    u += weight * row.of(column->u);
    w += weight * row.of(column->w);
  }
  return {u, w};
}

ResidualModes residual_modes(const MatrixXd (&moments)[4]) {
  const Index m = moments[0].rows();
  ResidualModes out{.eigenvalues = {}, .forms = MatrixXd(m, 0), .weights = MatrixXd(2 * m, 0)};
  // The solvers of nothing: nothing changes, or only what cannot move.
  if (m == 0 || !(moments[0].diagonal().maxCoeff() > 0.0)) return out;
  MatrixXd stiffness(2 * m, 2 * m), mass(2 * m, 2 * m);
  stiffness << moments[0], moments[1], moments[1], moments[2];
  mass << moments[1], moments[2], moments[2], moments[3];
  VectorXd scale(2 * m);
  for (Index i = 0; i < 2 * m; ++i)
    scale[i] = stiffness(i, i) > 0.0 ? 1.0 / std::sqrt(stiffness(i, i)) : 0.0;
  stiffness = scale.asDiagonal() * stiffness * scale.asDiagonal();
  mass = scale.asDiagonal() * mass * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> energies(stiffness);
  const double largest = energies.eigenvalues().maxCoeff();
  Index first = 0;
  while (first < 2 * m && !(energies.eigenvalues()[first] > kDependent * largest)) ++first;
  const Index kept = 2 * m - first;
  const MatrixXd basis = energies.eigenvectors().rightCols(kept) *
                         energies.eigenvalues().tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(basis.transpose() * mass * basis);
  out.eigenvalues.resize(kept);
  out.weights.resize(2 * m, kept);
  const double least = std::numeric_limits<double>::epsilon() * solver.eigenvalues().maxCoeff();
  for (Index i = 0; i < kept; ++i) {
    const Index from = kept - 1 - i;  // the largest μ first
    // What has no mass yields statically.
    const double mu = std::max(solver.eigenvalues()[from], least);
    out.eigenvalues[i] = 1.0 / mu;
    out.weights.col(i) =
        scale.asDiagonal() * (basis * solver.eigenvectors().col(from)) / std::sqrt(mu);
  }
  out.forms = moments[0] * out.weights.topRows(m) + moments[1] * out.weights.bottomRows(m);
  return out;
}

}  // namespace wheeltap::fem

#include "fem/structures/reanalysis/residual_flexibility.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <list>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "fem/structures/mechanisms.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Smaller values, relative to the scaled energies of the forms, are rounding errors.
constexpr double kDependent = 1e-11;
/// Number of pairs of forms whose moments are cached.
constexpr std::size_t kPairs = 1 << 20;
/// Number of boundary dofs that are solved for together. The batches are fixed, so that results do
/// not depend on earlier requests.
constexpr int kBatch = 8;
/// Up to this number, all batches are computed in advance; more batches, on request.
constexpr std::size_t kFewBatches = 256;
constexpr int kTerms = StaticCondensation::kTerms;

template <class Real>
using Rows = Eigen::Matrix<Real, Eigen::Dynamic, kBatch, Eigen::RowMajor>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Cache of computed values by number. The least recently used value is removed first.
template <class Value>
class Recent {
 public:
  using Pointer = std::shared_ptr<const Value>;

  void set_most(std::size_t most) { most_ = most; }
  [[nodiscard]] std::size_t most() const { return most_; }

  /// Two threads may compute the same value; one copy is kept.
  template <class Compute>
  [[nodiscard]] Pointer get(int number, const Compute& compute) {
    {
      const std::lock_guard lock(mutex_);
      if (const auto at = known_.find(number); at != known_.end()) {
        values_.splice(values_.begin(), values_, at->second);
        return at->second->second;
      }
    }
    auto computed = std::make_shared<const Value>(compute(number));
    const std::lock_guard lock(mutex_);
    if (const auto at = known_.find(number); at != known_.end()) return at->second->second;
    values_.emplace_front(number, computed);
    known_[number] = values_.begin();
    if (values_.size() > most_) {
      known_.erase(values_.back().first);
      values_.pop_back();
    }
    return computed;
  }

 private:
  using Values = std::list<std::pair<int, Pointer>>;
  std::size_t most_ = 2;
  std::mutex mutex_;
  Values values_;  // most recently requested first
  std::unordered_map<int, typename Values::iterator> known_;
};

}  // namespace

struct ResidualFlexibility::Impl {
  struct Column {
    StaticCondensation::Local local;
    std::array<VectorXd, kTerms> kept;  // α_n
  };
  /// Q_n of kBatch dofs of the boundary, boundary × kBatch.
  using Batch = std::array<Rows<double>, kTerms>;

  std::shared_ptr<const Discretisation> d;
  std::optional<StaticCondensation> parts;
  MatrixXd shapes, mass_shapes;
  RowMajor shape_rows, mass_rows;  // the same, one row per degree of freedom
  VectorXd eigenvalues;
  std::vector<char> held;  // degrees of freedom that hold the rigid motions
  Eigen::SimplicialLDLT<Discretisation::Sparse, Eigen::Lower, Eigen::AMDOrdering<int>> ldlt;

  mutable Recent<Column> columns;
  mutable Recent<Batch> batches;
  mutable std::mutex mutex;
  mutable std::unordered_map<std::uint64_t, Moments> pairs;

  [[nodiscard]] SparseRow row_of(int basic) const {
    const auto strains = static_cast<int>(d->strains.size());
    if (basic < strains) return d->strains[index(basic)].row;
    return {.dofs = {basic - strains}, .coefficients = {1.0}};
  }

  void release_held(Rows<double>& x) const {
    for (Index i = 0; i < x.rows(); ++i)
      if (held[index(i)]) x.row(i).setZero();
  }

  /// Solves L D Lᵀ x = b for all columns in one pass over L.
  [[nodiscard]] Rows<double> back_substituted(const Rows<double>& b) const {
    Rows<double> x = ldlt.permutationP() * b;
    const auto& l = ldlt.matrixL().nestedExpression();
    for (Index k = 0; k < l.outerSize(); ++k)
      for (typename std::decay_t<decltype(l)>::InnerIterator it(l, k); it; ++it)
        if (it.row() > k) x.row(it.row()) -= it.value() * x.row(k);
    const VectorXd pivots = ldlt.vectorD();
    for (Index k = 0; k < x.rows(); ++k) x.row(k) /= pivots[k];
    for (Index k = l.outerSize(); k-- > 0;)
      for (typename std::decay_t<decltype(l)>::InnerIterator it(l, k); it; ++it)
        if (it.row() > k) x.row(k) -= it.value() * x.row(it.row());
    return ldlt.permutationPinv() * x;
  }

  /// Computes load - K u from the strains, with u in extended precision.
  [[nodiscard]] Rows<double> left_of(const Rows<double>& load, const Rows<long double>& u) const {
    Rows<long double> rest = load.cast<long double>();
    Eigen::Matrix<long double, 1, kBatch> stress;
    for (const Strain& strain : d->strains) {
      stress.setZero();
      for (std::size_t i = 0; i < strain.row.dofs.size(); ++i)
        stress += static_cast<long double>(strain.row.coefficients[i]) * u.row(strain.row.dofs[i]);
      stress *= static_cast<long double>(strain.factor);
      for (std::size_t i = 0; i < strain.row.dofs.size(); ++i)
        rest.row(strain.row.dofs[i]) -=
            static_cast<long double>(strain.row.coefficients[i]) * stress;
    }
    for (int k = 0; k < d->rest.outerSize(); ++k)
      for (Discretisation::Sparse::InnerIterator it(d->rest, k); it; ++it)
        rest.row(it.row()) -= static_cast<long double>(it.value()) * u.row(it.col());
    return rest.cast<double>();
  }

  /// Computes K⁻¹ times loads that cause no rigid motion.
  [[nodiscard]] Rows<double> solve(Rows<double> load) const {
    release_held(load);
    return back_substituted(load);
  }

  void remove_kept(Rows<double>& u) const { u -= shapes * (mass_shapes.transpose() * u); }

  [[nodiscard]] Batch batch(int number) const {
    const std::vector<int>& boundary = parts->boundary();
    const auto size = static_cast<Index>(boundary.size());
    Batch out;
    const auto keep = [&](Rows<double>& q, const Rows<double>& u) {
      q.resize(size, kBatch);
      for (Index i = 0; i < size; ++i) q.row(i) = u.row(boundary[index(i)]);
    };
    Rows<double> load = Rows<double>::Zero(d->size(), kBatch);
    MatrixXd kept = MatrixXd::Zero(shapes.cols(), kBatch);
    for (Index k = 0; k < kBatch && number * kBatch + k < size; ++k) {
      const int dof = boundary[index(number * kBatch + k)];
      load(dof, k) = 1.0;
      kept.col(k) = shape_rows.row(dof);
    }
    load -= mass_shapes * kept;
    // One refinement step with the residual loads from the strains.
    Rows<double> u = solve(load);
    u += solve(left_of(load, u.cast<long double>()));
    remove_kept(u);
    keep(out[0], u);
    for (std::size_t n = 1; n < kTerms; ++n) {
      u = solve(d->mass * u);
      remove_kept(u);
      keep(out[n], u);
    }
    return out;
  }

  [[nodiscard]] Column column(int basic) const {
    Column out{.local = parts->local(row_of(basic)), .kept = {}};
    for (std::size_t n = 0; n < kTerms; ++n) {
      out.kept[n] = VectorXd::Zero(shapes.cols());
      for (std::size_t i = 0; i < out.local.inside.size(); ++i)
        out.kept[n] +=
            out.local.motion[n][static_cast<Index>(i)] * mass_rows.row(out.local.inside[i]);
    }
    return out;
  }

  /// Φ_E α at one degree of freedom of the boundary.
  [[nodiscard]] double at_boundary(int place, const VectorXd& kept) const {
    return shape_rows.row(parts->boundary()[index(place)]).dot(kept);
  }

  /// Motions (D M)ⁱ D f of a form at the boundary dofs `to`, without the motion of the part alone;
  /// one row per i.
  [[nodiscard]] Eigen::MatrixXd responses_at(const std::vector<int>& to, const Column& of) const {
    const auto places = static_cast<Index>(to.size());
    MatrixXd out = MatrixXd::Zero(kTerms, places);
    for (Index n = 0; of.local.part >= 0 && n < kTerms; ++n)
      for (Index e = 0; e < places; ++e) out(n, e) = -at_boundary(to[index(e)], of.kept[index(n)]);
    for (std::size_t f = 0; f < of.local.edge.size(); ++f) {
      const int dof = of.local.edge[f];
      const auto q = batches.get(dof / kBatch, [this](int number) { return batch(number); });
      for (Index e = 0; e < places; ++e)
        for (Index n = 0; n < kTerms; ++n)
          for (Index k = 0; k <= n; ++k)
            out(n, e) += (*q)[index(k)](to[index(e)], dof % kBatch) *
                         of.local.forces[index(n - k)][static_cast<Index>(f)];
    }
    return out;
  }

  [[nodiscard]] Moments compute(const Column& a, const Column& b) const {
    Moments out;
    const MatrixXd at = responses_at(b.local.edge, a);
    for (std::size_t n = 0; n < kTerms; ++n) {
      double& r = out.r[n];
      for (std::size_t i = 0; i <= n; ++i)
        r += at.row(static_cast<Index>(i)).dot(b.local.forces[n - i]);
      if (b.local.part < 0) continue;
      for (std::size_t e = 0; e < a.local.edge.size(); ++e)
        r -= a.local.forces[0][static_cast<Index>(e)] * at_boundary(a.local.edge[e], b.kept[n]);
      if (a.local.part < 0) continue;
      r -= (eigenvalues.array() * a.kept[0].array() * b.kept[n].array()).sum();
      if (a.local.part == b.local.part) r += a.local.load.dot(b.local.motion[n]);
    }
    return out;
  }

  [[nodiscard]] Moments basic_moments(int a, int b) const {
    if (a > b) std::swap(a, b);
    const std::uint64_t key = static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
    {
      const std::lock_guard lock(mutex);
      if (const auto at = pairs.find(key); at != pairs.end()) return at->second;
    }
    const auto compute_column = [this](int basic) { return column(basic); };
    const auto first = columns.get(a, compute_column), second = columns.get(b, compute_column);
    const Moments out = compute(*first, *second);
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
  // Parts whose eigenvalues (with a fixed edge) lie above the kept eigenvalues.
  impl.parts.emplace(*impl.d, eigenvalues.maxCoeff());
  impl.shapes = shapes;
  impl.mass_shapes = impl.d->mass * shapes;
  impl.shape_rows = impl.shapes;
  impl.mass_rows = impl.mass_shapes;
  impl.eigenvalues = eigenvalues;
  impl.held = impl.d->holding_dofs();
  Discretisation::Sparse k = impl.d->stiffness;
  k.prune([&](Index i, Index j, double) { return !impl.held[index(i)] && !impl.held[index(j)]; });
  for (Index i = 0; i < n; ++i)
    if (impl.held[index(i)]) k.coeffRef(i, i) = 1.0;
  impl.ldlt.compute(k);
  if (impl.ldlt.info() != Eigen::Success) {
    refuse_mechanisms(*impl.d);
    throw InvalidStructure(InvalidStructure::Part::whole, 0,
                           "its stiffness matrix is not positive definite: it cannot be factored");
  }
  const std::size_t boundary = impl.parts->boundary().size();
  const std::size_t column_bytes =
      sizeof(double) * kTerms * (index(shapes.cols()) + 3 * index(StaticCondensation::kLargest));
  const std::size_t batch_bytes =
      sizeof(double) * kTerms * kBatch * std::max<std::size_t>(boundary, 1);
  impl.columns.set_most(std::max<std::size_t>(memory / 4 / column_bytes, 64));
  impl.batches.set_most(std::max<std::size_t>(memory / 2 / batch_bytes, 64));
  const std::size_t batches = (boundary + kBatch - 1) / kBatch;
  if (batches > std::min(kFewBatches, impl.batches.most())) return;
  for (std::size_t b = 0; b < batches; ++b)
    static_cast<void>(impl.batches.get(static_cast<int>(b), [&](int i) { return impl.batch(i); }));
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
  const Moments of = moments(motion(row), form);
  return {of.r[0], of.r[1]};
}

ResidualModes residual_modes(const MatrixXd (&moments)[4]) {
  const Index m = moments[0].rows();
  ResidualModes out{.eigenvalues = {}, .forms = MatrixXd(m, 0), .weights = MatrixXd(2 * m, 0)};
  // There are no residual modes if nothing changes or if only restrained motions change.
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
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(MatrixXd(basis.transpose() * mass * basis));
  out.eigenvalues.resize(kept);
  out.weights.resize(2 * m, kept);
  const double least = std::numeric_limits<double>::epsilon() * solver.eigenvalues().maxCoeff();
  for (Index i = 0; i < kept; ++i) {
    const Index from = kept - 1 - i;  // the largest μ first
    // The response of massless motions is static.
    const double mu = std::max(solver.eigenvalues()[from], least);
    out.eigenvalues[i] = 1.0 / mu;
    out.weights.col(i) =
        scale.asDiagonal() * (basis * solver.eigenvectors().col(from)) / std::sqrt(mu);
  }
  out.forms = moments[0] * out.weights.topRows(m) + moments[1] * out.weights.bottomRows(m);
  return out;
}

}  // namespace wheeltap::fem

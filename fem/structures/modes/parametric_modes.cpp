#include "fem/structures/modes/parametric_modes.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/eigen_solvers.hpp"
#include "fem/structures/modes/sparse_modes.hpp"
#include "fem/structures/modes/structure_modes.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Discretisation::Sparse;
using SimplicialFactor = Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::AMDOrdering<int>>;

/// Modes with a smaller relative distance of 1/(λ + σ) share one error bound.
constexpr double kCluster = 0.02;
/// Smallest relative component of a column outside the basis for which the column is added.
constexpr double kNotNew = 1e-6;
/// Number of modes above the requested modes, for the gap above the requested modes.
constexpr Index kBeyond = 3;
/// Largest size of a reduced problem that a dense solver solves.
constexpr Index kDenseCondensed = 40;
/// Relative residual at which the iteration in the basis ends, well below the tolerances.
constexpr double kConverged = 1e-7;
constexpr int kMostCycles = 12;
/// Number of blocks of a Krylov subspace.
constexpr Index kBlocks = 3;
/// Shapes with a smaller relative distance of 1/(λ + σ) are differentiated as a subspace.
constexpr double kTwin = 1e-6;
/// Largest number of degrees of freedom for sparse matrices; the factor of a larger space frame may
/// have more products than fit in memory.
constexpr Index kMostSparse = 2000;
/// Number of points in the first training, which decides between sparse matrices and a basis.
constexpr std::ptrdiff_t kSomePoints = 40;
/// The training ends when all error bounds are below this share of the tolerance.
constexpr double kSubspaceMargin = 0.25;

MatrixXd orthonormalised(const MatrixXd& a) {
  const Eigen::HouseholderQR<MatrixXd> qr(a);
  return qr.householderQ() * MatrixXd::Identity(a.rows(), a.cols());
}

/// Modes of the reduced problem: y with yᵀ(K + σM)y = 1, and μ = 1/(λ + σ), descending.
struct ReducedModes {
  VectorXd mu;
  MatrixXd y;
  bool ok = false;
};

}  // namespace

struct ParametricModes::Workspace::Impl {
  MatrixXd stiffness, mass, shifted;  // projected onto the basis
  ReducedModes reduced;
  SparseModes::Workspace sparse;
  bool in_basis = false;      // `reduced` or `sparse` holds mass-normalised modes of the last θ
  std::vector<double> theta;  // parameters of the last solution, `last`; or empty
  Modes last;
  long solved = 0, in_full = 0;
};

struct ParametricModes::Impl {
  std::shared_ptr<const ParametricStructure> structure;
  ParametricModesOptions options;
  Index n = 0, rigid = 0, wanted = 0;  // wanted: number of elastic modes
  double sigma = 0.0;
  SimplicialFactor shifted;  // K₀ + σM₀
  MatrixXd lifted;           // (K₀ + σM₀)⁻¹ C for the low-rank terms C
  MatrixXd compliance;       // Cᵀ (K₀ + σM₀)⁻¹ C
  Training training;

  std::unique_ptr<const SparseModes> sparse;  // if it costs less than the basis
  MatrixXd basis;
  std::vector<MatrixXd> terms;        // Vᵀ K_t V
  MatrixXd mass;                      // Vᵀ M₀ V
  std::vector<MatrixXd> mass_slopes;  // Vᵀ ∂M/∂θ_j V; empty if M is constant
  MatrixXd motions;                   // motions × basis
  MatrixXd start;                     // modes at θ₀, in the basis

  [[nodiscard]] Index followed() const {
    return std::min<Index>(rigid + wanted + kBeyond, basis.cols());
  }

  /// Adds the components of the columns outside the basis, orthonormal in K₀ + σM₀.
  void extend(const MatrixXd& columns) {
    const Discretisation& d = structure->nominal();
    const auto times = [&](const VectorXd& v) -> VectorXd {
      VectorXd out = d.stiffness_times(v);
      if (sigma > 0.0) out += sigma * (d.mass * v);
      return out;
    };
    for (Index c = 0; c < columns.cols(); ++c) {
      VectorXd v = columns.col(c);
      const double before = std::sqrt(v.dot(times(v)));
      if (!(before > 0.0)) continue;
      v /= before;
      for (int pass = 0; pass < 2 && basis.cols() > 0; ++pass)
        v -= basis * (basis.transpose() * times(v));
      const double left = std::sqrt(std::max(0.0, v.dot(times(v))));
      if (left < kNotNew) continue;
      basis.conservativeResize(n, basis.cols() + 1);
      basis.rightCols(1) = v / left;
    }
  }

  void project() {
    const Discretisation& d = structure->nominal();
    terms = structure->project_terms(basis);
    mass = basis.transpose() * (d.mass * basis);
    mass_slopes.clear();
    if (structure->form() == ParametricStructure::Form::affine && structure->mass_changes())
      for (const Sparse& slope : structure->mass_slopes())
        mass_slopes.emplace_back(basis.transpose() * (slope * basis));
    motions.resize(static_cast<Index>(options.motions.size()), basis.cols());
    for (Index c = 0; c < basis.cols(); ++c)
      for (std::size_t s = 0; s < options.motions.size(); ++s)
        motions(static_cast<Index>(s), c) = options.motions[s].of(basis.col(c));
    // In the basis, K₀ + σM₀ is the identity matrix.
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(MatrixXd(0.5 * (mass + mass.transpose())));
    start = solver.eigenvectors().rightCols(followed()).rowwise().reverse();
  }

  /// Approximate number of multiplications of one solution in the basis with its derivatives. These
  /// are the factor of K + σM, two cycles of the iteration, and one factor per mode for the
  /// derivatives of shapes.
  [[nodiscard]] double basis_cost(Index columns) const {
    const auto m = static_cast<double>(columns);
    const auto p = static_cast<double>(std::min(rigid + wanted + kBeyond, columns));
    double sum = m * m * m / 6.0 + m * m * static_cast<double>(structure->terms());
    sum += columns > kDenseCondensed ? 2.0 * kBlocks * p * m * (2.0 * m + 3.0 * kBlocks * p)
                                     : 6.0 * m * m * m;
    if (!options.motions.empty())
      sum += static_cast<double>(wanted) * (m * m * m / 3.0 + m * m * structure->parameters());
    return sum;
  }

  /// Uses the sparse matrices if they take less time than a basis with this number of columns.
  bool take_sparse(Index columns, std::unique_ptr<const SparseModes>& candidate) {
    if (!candidate ||
        (options.solver == ParametricSolver::cheaper && candidate->cost() > basis_cost(columns)))
      return false;
    sparse = std::move(candidate);
    training.complete = true;
    training.basis = static_cast<int>(n);
    return true;
  }

  void reduce(const ParametricStructure::Point& point, Workspace::Impl& ws) const {
    if (point.scales.size() > 0) {
      ws.stiffness = point.scales[0] * terms[0];
      for (std::size_t t = 1; t < terms.size(); ++t)
        ws.stiffness += point.scales[static_cast<Index>(t)] * terms[t];
    } else {
      ws.stiffness = point.assembled->projected_stiffness(basis);
    }
    if (point.assembled) {
      ws.mass = basis.transpose() * (point.assembled->mass * basis);
    } else {
      ws.mass = mass;
      for (std::size_t j = 0; j < mass_slopes.size(); ++j)
        ws.mass += point.change[static_cast<Index>(j)] * mass_slopes[j];
    }
    ws.shifted = ws.stiffness;
    if (sigma > 0.0) ws.shifted += sigma * ws.mass;
  }

  /// L Lᵀ = K + σM, A = L⁻¹ M L⁻ᵀ, A z = μ z, y = L⁻ᵀ z. Small problems are solved densely, others
  /// by Rayleigh-Ritz steps in block Krylov subspaces span{q, A q, A² q}, first from the modes q at
  /// θ₀, then from Ritz vectors (Saad 2011, section 6.6); densely if this fails.
  void solve_reduced(Workspace::Impl& ws) const {
    ReducedModes& out = ws.reduced;
    out.ok = false;
    const Index m = basis.cols(), p = followed(), k = std::min(rigid + wanted, p);
    const Eigen::LLT<MatrixXd> llt(ws.shifted);
    if (llt.info() != Eigen::Success) return;
    const auto lower = llt.matrixL();
    if (m > kDenseCondensed) {
      const auto times = [&](const MatrixXd& z) -> MatrixXd {
        const MatrixXd y = lower.transpose().solve(z);
        return lower.solve(MatrixXd(ws.mass.selfadjointView<Eigen::Lower>() * y));
      };
      MatrixXd q = orthonormalised(lower.transpose() * start.leftCols(p));
      MatrixXd w = times(q);
      for (int cycle = 0; cycle < kMostCycles; ++cycle) {
        const MatrixXd h = q.transpose() * w;
        const Eigen::SelfAdjointEigenSolver<MatrixXd> ritz(MatrixXd(0.5 * (h + h.transpose())));
        const MatrixXd turn = ritz.eigenvectors().rightCols(p).rowwise().reverse();
        const VectorXd mu = ritz.eigenvalues().tail(p).reverse();
        const MatrixXd at = q * turn, next = w * turn;
        double worst = 0.0;
        for (Index i = 0; i < k; ++i)
          worst = std::max(worst, (next.col(i) - mu[i] * at.col(i)).norm() / mu[i]);
        if (worst < kConverged) {
          out.mu = mu;
          out.y = lower.transpose().solve(at);
          out.ok = none_missing(ws, mu, k);
          if (out.ok) return;
          break;
        }
        // The next subspace. Each block is A times the previous block, made orthogonal.
        q = at;
        w = next;
        for (Index block = 1; block < kBlocks && q.cols() + p <= m; ++block) {
          MatrixXd more = w.rightCols(p);
          for (int pass = 0; pass < 2; ++pass) more -= q * (q.transpose() * more);
          more = orthonormalised(more);
          more -= q * (q.transpose() * more);  // columns without a new component
          more = orthonormalised(more);
          const MatrixXd moved = times(more);
          q.conservativeResize(m, q.cols() + p);
          w.conservativeResize(m, w.cols() + p);
          q.rightCols(p) = more;
          w.rightCols(p) = moved;
        }
      }
    }
    MatrixXd c = lower.solve(ws.mass);
    c = lower.solve(MatrixXd(c.transpose()));
    const Eigen::SelfAdjointEigenSolver<MatrixXd> dense(MatrixXd(0.5 * (c + c.transpose())));
    out.mu = dense.eigenvalues().reverse().head(p);
    out.y =
        lower.transpose().solve(MatrixXd(dense.eigenvectors().rightCols(p).rowwise().reverse()));
    out.ok = dense.info() == Eigen::Success && out.mu[k - 1] > 0.0;
  }

  /// True if the block has the largest μ of the reduced problem. The inertia in the widest gap
  /// above the requested modes shows this.
  [[nodiscard]] static bool none_missing(const Workspace::Impl& ws, const VectorXd& mu, Index k) {
    Index at = -1;
    double widest = 1e-6;
    for (Index i = k - 1; i + 1 < mu.size(); ++i)
      if (const double gap = 1.0 - mu[i + 1] / mu[i]; gap > widest) {
        widest = gap;
        at = i;
      }
    if (at < 0) return false;
    const double between = std::sqrt(mu[at] * std::max(mu[at + 1], 0.0));
    const Eigen::LDLT<MatrixXd> ldlt(between * ws.shifted - ws.mass);
    return (ldlt.vectorD().array() < 0.0).count() == at + 1;
  }

  /// Computes the error bounds (see the header) from the residuals η of the lowest elastic modes,
  /// their λ, and all known 1/(λ + σ).
  void bound_by_residuals(const VectorXd& eta, const VectorXd& mu, const VectorXd& lambda,
                          Modes& out) const {
    const Index checked = eta.size(), known = mu.size();
    out.bounds.resize(wanted);
    out.shape_bounds.resize(wanted);
    for (Index i = 0; i < wanted; ++i) {
      Index from = i, to = i;
      while (from > 0 && mu[from - 1] - mu[from] < kCluster * mu[from]) --from;
      while (to + 1 < checked && mu[to] - mu[to + 1] < kCluster * mu[to]) ++to;
      double squares = 0.0;
      for (Index j = from; j <= to; ++j) squares += eta[j] * eta[j];
      double gap = 1.0;
      if (from > 0) gap = std::min(gap, (mu[from - 1] - mu[from]) / mu[i] - eta[from - 1]);
      if (to + 1 < known)
        gap = std::min(gap, (mu[to] - mu[to + 1]) / mu[i] - (to + 1 < checked ? eta[to + 1] : 0.0));
      const double shift = mu[i] > 0.0 ? (lambda[i] + sigma) / lambda[i] : 1.0;
      const double common = std::sqrt(squares);
      out.bounds[i] = shift * (gap > 0.0 ? std::min(common, squares / gap) : common);
      out.shape_bounds[i] = gap > 0.0 ? std::min(1.0, common / gap) : 1.0;
    }
  }

  /// Computes the error bounds (see the header) of the requested elastic modes.
  bool bound(const ParametricStructure::Point& point, const Workspace::Impl& ws, Modes& out) const {
    out.bounds = VectorXd::Zero(wanted);
    out.shape_bounds = VectorXd::Zero(wanted);
    if (training.complete) return true;
    const Index known = ws.reduced.mu.size() - rigid;  // number of known elastic modes
    const Index checked = std::min<Index>(wanted + 1, known);
    const VectorXd mu = ws.reduced.mu.segment(rigid, known);
    const MatrixXd u = basis * ws.reduced.y.middleCols(rigid, checked);
    const VectorXd lambda = (mu.head(checked).cwiseInverse().array() - sigma).matrix();
    const MatrixXd residuals = structure->stiffness_times(point, u) -
                               structure->mass_times(point, u) * lambda.asDiagonal();
    VectorXd eta(checked);
    if (point.floor > 0.0 && (sigma == 0.0 || !structure->mass_changes())) {
      // rᵀ (K₀ + σM₀ + C D Cᵀ)⁻¹ r = rᵀ K₀⁻¹ r - yᵀ (I + D G)⁻¹ D y  (Woodbury), uᵀ(K + σM)u = 1.
      const MatrixXd moved = shifted.solve(residuals);
      const Index c = point.excess.size();
      const MatrixXd y = lifted.transpose() * residuals;
      const MatrixXd correction =
          c > 0 ? MatrixXd((MatrixXd::Identity(c, c) + point.excess.asDiagonal() * compliance)
                               .partialPivLu()
                               .solve(point.excess.asDiagonal() * y))
                : MatrixXd(0, checked);
      for (Index i = 0; i < checked; ++i)
        eta[i] = std::sqrt(
            std::max(0.0, residuals.col(i).dot(moved.col(i)) - y.col(i).dot(correction.col(i))) /
            point.floor);
    } else {
      const Discretisation assembled = structure->assemble(point);
      const SimplicialFactor here(Sparse(assembled.stiffness + sigma * assembled.mass));
      if (here.info() != Eigen::Success || (here.vectorD().array() <= 0.0).any()) return false;
      const MatrixXd moved = here.solve(residuals);
      for (Index i = 0; i < checked; ++i)
        eta[i] = std::sqrt(std::max(0.0, residuals.col(i).dot(moved.col(i))));
    }
    bound_by_residuals(eta, mu, lambda, out);
    return out.bounds.allFinite();
  }

  /// Solves the reduced problem; returns false if the basis gives no result.
  bool in_basis(const ParametricStructure::Point& point, Workspace::Impl& ws, Modes& out) const {
    ws.in_basis = false;
    if (point.scales.size() > 0 && !(point.scales.minCoeff() > 0.0)) return false;
    if (sparse) {
      if (!sparse->solve(point, ws.sparse, out.eigenvalues, out.shapes)) return false;
      bound_by_residuals(ws.sparse.residuals, ws.sparse.mu, ws.sparse.eigenvalues, out);
      out.in_full = false;
      ws.in_basis = true;
      return out.bounds.allFinite();
    }
    reduce(point, ws);
    solve_reduced(ws);
    if (!ws.reduced.ok || !bound(point, ws, out)) return false;
    const VectorXd mu = ws.reduced.mu.segment(rigid, wanted);
    out.eigenvalues = (mu.cwiseInverse().array() - sigma).matrix();
    // Mass-normalises the modes; so far, yᵀ M y = μ.
    for (Index i = 0; i < wanted; ++i) ws.reduced.y.col(rigid + i) /= std::sqrt(mu[i]);
    ws.in_basis = true;
    out.shapes = motions * ws.reduced.y.middleCols(rigid, wanted);
    out.in_full = false;
    return true;
  }

  [[nodiscard]] bool good(const Modes& modes, double margin) const {
    return modes.bounds.maxCoeff() <= margin * options.tolerance &&
           (options.motions.empty() ||
            modes.shape_bounds.maxCoeff() <= std::sqrt(margin) * options.shape_tolerance);
  }

  StructureModes full(std::span<const double> theta, Index elastic) const {
    return structure_modes(structure->assemble(theta), static_cast<int>(rigid + elastic));
  }

  void solve_in_full(std::span<const double> theta, Workspace::Impl& ws, Modes& out) const {
    const StructureModes modes = full(theta, wanted);
    out.eigenvalues = modes.eigenvalues.tail(wanted);
    out.shapes.resize(static_cast<Index>(options.motions.size()), wanted);
    for (Index i = 0; i < wanted; ++i)
      for (std::size_t s = 0; s < options.motions.size(); ++s)
        out.shapes(static_cast<Index>(s), i) = options.motions[s].of(modes.shapes.col(rigid + i));
    out.bounds = VectorXd::Zero(wanted);
    out.shape_bounds = VectorXd::Zero(wanted);
    out.in_full = true;
    ++ws.in_full;
  }

  void train(const std::vector<std::vector<double>>& points) {
    const Discretisation& d = structure->nominal();
    const Index available = mode_count(d) - rigid;
    if (wanted < 1 || wanted > available)
      throw std::invalid_argument("modes = " + std::to_string(wanted) + ": must be between 1 and " +
                                  std::to_string(available) + ", the number of elastic modes");
    const Index snapshot = std::min<Index>(wanted + kBeyond, available);
    const StructureModes nominal = structure_modes(d, static_cast<int>(rigid + snapshot));
    if (rigid > 0) sigma = nominal.eigenvalues[rigid];
    std::unique_ptr<const SparseModes> candidate;
    if (structure->form() == ParametricStructure::Form::affine && rigid == 0 && n <= kMostSparse &&
        options.solver != ParametricSolver::basis)
      candidate = std::make_unique<const SparseModes>(*structure, available, wanted, nominal.shapes,
                                                      options.motions);
    if (n <= options.complete) {
      if (take_sparse(n, candidate)) return;
      training.complete = true;
      // The basis is scaled such that K₀ + σM₀ is the identity matrix.
      const MatrixXd whole =
          d.projected_stiffness(MatrixXd::Identity(n, n)) + sigma * MatrixXd(d.mass);
      const Eigen::LLT<MatrixXd> llt(whole);
      basis = llt.matrixU().solve(MatrixXd::Identity(n, n));
      project();
      training.basis = static_cast<int>(n);
      return;
    }
    shifted.compute(Sparse(d.stiffness + sigma * d.mass));
    lifted = shifted.solve(structure->low_rank());
    compliance = structure->low_rank().transpose() * lifted;
    // Some of the points often show at once that the sparse matrices take less time.
    if (candidate && std::ssize(points) > kSomePoints) {
      if (grow({points.begin(), points.begin() + kSomePoints}, nominal.shapes, snapshot, candidate,
               nullptr))
        return;
      basis.resize(n, 0);
    }
    if (grow(points, nominal.shapes, snapshot, candidate, options.progress)) return;
    training.basis = static_cast<int>(basis.cols());
    training.complete = basis.cols() == n;
    Workspace::Impl ws;
    count(points, ws);
  }

  /// Adds modes at the points with the largest error bounds until all bounds are small. Returns
  /// true if the sparse matrices take less time than the basis.
  bool grow(const std::vector<std::vector<double>>& points, const MatrixXd& nominal, Index snapshot,
            std::unique_ptr<const SparseModes>& candidate,
            const std::function<void(double)>& progress) {
    extend(nominal);
    extend(lifted);
    if (take_sparse(basis.cols(), candidate)) return true;
    project();
    training.solved = 1;
    std::vector<std::size_t> bad(points.size());
    std::iota(bad.begin(), bad.end(), std::size_t{0});
    Workspace::Impl ws;
    std::vector<bool> solved(points.size());
    while (true) {
      double worst = -1.0;
      std::size_t at = 0;
      Modes found;
      std::erase_if(bad, [&](std::size_t i) {
        double error = std::numeric_limits<double>::infinity();
        try {
          if (in_basis(structure->at(points[i]), ws, found)) {
            if (good(found, kSubspaceMargin)) return true;
            const double of_shapes =
                options.motions.empty()
                    ? 0.0
                    : std::pow(found.shape_bounds.maxCoeff() / options.shape_tolerance, 2);
            error = std::max(found.bounds.maxCoeff() / options.tolerance, of_shapes);
          }
        } catch (const std::invalid_argument&) {
          return true;  // no structure at θ
        }
        if (!solved[i] && error > worst) {
          worst = error;
          at = i;
        }
        return false;
      });
      if (progress)
        progress(1.0 - static_cast<double>(bad.size()) / static_cast<double>(points.size()));
      if (worst < 0.0 || basis.cols() >= options.most_basis) return false;
      solved[at] = true;
      try {
        extend(full(points[at], snapshot).shapes.rightCols(snapshot));
        if (take_sparse(basis.cols(), candidate)) return true;
        project();
        ++training.solved;
      } catch (const std::exception&) {
        std::erase(bad, at);  // no valid structure at θ, or the solver fails there
      }
    }
  }

  void count(const std::vector<std::vector<double>>& points, Workspace::Impl& ws) {
    Modes found;
    for (const auto& theta : points) {
      try {
        const auto point = structure->at(theta);
        ++training.points;
        if (!in_basis(point, ws, found) || !good(found, 1.0)) {
          ++training.beyond;
          continue;
        }
        training.largest_bound = std::max(training.largest_bound, found.bounds.maxCoeff());
        const VectorXd& mu = ws.reduced.mu;
        Index split = rigid + wanted - 1;
        for (Index i = split; i + 1 < mu.size(); ++i)
          if (mu[i + 1] / mu[i] < mu[split + 1] / mu[split]) split = i;
        if (split + 1 >= mu.size()) continue;
        const double sigma_between = 1.0 / std::sqrt(mu[split] * mu[split + 1]) - sigma;
        if (eigenvalues_below(structure->assemble(theta), sigma_between) != split + 1)
          ++training.miscounted;
      } catch (const std::invalid_argument&) {
        --training.points;
      }
    }
  }
};

ParametricModes::ParametricModes(std::shared_ptr<const ParametricStructure> structure,
                                 const std::vector<std::vector<double>>& training,
                                 ParametricModesOptions options) {
  auto impl = std::make_unique<Impl>();
  impl->structure = std::move(structure);
  impl->options = std::move(options);
  impl->n = impl->structure->nominal().size();
  impl->rigid = impl->structure->nominal().rigid_motions.cols();
  impl->wanted = impl->options.modes;
  impl->train(training);
  impl_ = std::move(impl);
}

ParametricModes::~ParametricModes() = default;
ParametricModes::ParametricModes(ParametricModes&&) noexcept = default;
ParametricModes& ParametricModes::operator=(ParametricModes&&) noexcept = default;

ParametricModes::Workspace ParametricModes::make_workspace() const {
  return Workspace(std::make_unique<Workspace::Impl>());
}

void ParametricModes::solve(std::span<const double> theta, Workspace& workspace, Modes& out) const {
  Workspace::Impl& ws = *workspace.impl_;
  // A local optimisation requests derivatives at the point that it evaluated last.
  if (!theta.empty() && std::ranges::equal(theta, ws.theta)) {
    out = ws.last;
    return;
  }
  ws.theta.clear();
  ++ws.solved;
  const auto point = impl_->structure->at(theta);
  if (!impl_->in_basis(point, ws, out) || !impl_->good(out, 1.0))
    impl_->solve_in_full(theta, ws, out);
  ws.last = out;
  ws.theta.assign(theta.begin(), theta.end());
}

bool ParametricModes::differentiate(std::span<const double> theta, Workspace& workspace, Modes& out,
                                    Slopes& slopes) const {
  const Impl& s = *impl_;
  if (s.structure->form() != ParametricStructure::Form::affine) return false;
  solve(theta, workspace, out);
  const Workspace::Impl& ws = *workspace.impl_;
  // After a full solution, the derivatives are those of the reduced basis.
  const bool shapes = s.motions.rows() > 0;
  if (!ws.in_basis || (s.sparse && out.in_full && shapes)) return false;
  if (s.sparse)
    return s.sparse->differentiate(workspace.impl_->sparse, kTwin, slopes.eigenvalues,
                                   slopes.shapes);
  const VectorXd mu = ws.reduced.mu.segment(s.rigid, s.wanted);
  const Index m = s.basis.cols(), d = s.structure->parameters();
  const MatrixXd& a = s.structure->scale_slopes();
  slopes.eigenvalues.resize(s.wanted, d);
  slopes.shapes.assign(static_cast<std::size_t>(d), MatrixXd(s.motions.rows(), s.wanted));
  for (Index i = 0; i < s.wanted; ++i) {
    const VectorXd y = ws.reduced.y.col(s.rigid + i);
    const double lambda = 1.0 / mu[i] - s.sigma;
    // Momenta M y of the mode and of modes with nearly the same eigenvalue (twins).
    Index first = i, last = i;
    while (first > 0 && mu[first - 1] - mu[i] < kTwin * mu[i]) --first;
    while (last + 1 < s.wanted && mu[i] - mu[last + 1] < kTwin * mu[i]) ++last;
    const Index twins = last - first + 1;
    if (out.in_full && shapes && twins > 1) return false;  // rotated differently in `out`
    const MatrixXd momenta = ws.mass * ws.reduced.y.middleCols(s.rigid + first, twins);
    const VectorXd momentum = momenta.col(i - first);
    MatrixXd right = MatrixXd::Zero(m + twins, d);
    MatrixXd of_terms(m, static_cast<Index>(s.terms.size()));
    for (std::size_t t = 0; t < s.terms.size(); ++t)
      of_terms.col(static_cast<Index>(t)) = s.terms[t] * y;
    for (Index j = 0; j < d; ++j) {
      VectorXd force = of_terms * a.col(j);
      double norm = 0.0;
      if (!s.mass_slopes.empty()) {
        const VectorXd by_mass = s.mass_slopes[static_cast<std::size_t>(j)] * y;
        force -= lambda * by_mass;
        norm = -0.5 * y.dot(by_mass);
      }
      const double slope = y.dot(force);
      slopes.eigenvalues(i, j) = slope;
      // (K - λM) ∂y = -(∂K - λ ∂M - ∂λ M) y, yᵀM ∂y = -½ yᵀ ∂M y; no rotation among twins.
      right.col(j).head(m) =
          momenta * (ws.reduced.y.middleCols(s.rigid + first, twins).transpose() * force) - force;
      right(m + i - first, j) = norm;
    }
    if (!shapes) continue;
    MatrixXd bordered(m + twins, m + twins);
    bordered << ws.stiffness - lambda * ws.mass, momenta, momenta.transpose(),
        MatrixXd::Zero(twins, twins);
    const MatrixXd change = bordered.partialPivLu().solve(right).topRows(m);
    // The sign of the mode in `out`, which may be that of the full solution.
    const bool turned = out.in_full && (s.motions * y).dot(out.shapes.col(i)) < 0.0;
    const MatrixXd moved = (turned ? -1.0 : 1.0) * s.motions * change;
    for (Index j = 0; j < d; ++j) slopes.shapes[static_cast<std::size_t>(j)].col(i) = moved.col(j);
  }
  return true;
}

const ParametricModes::Training& ParametricModes::training() const {
  return impl_->training;
}
int ParametricModes::modes() const {
  return static_cast<int>(impl_->wanted);
}
const ParametricStructure& ParametricModes::structure() const {
  return *impl_->structure;
}

ParametricModes::Workspace::Workspace(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ParametricModes::Workspace::Workspace(Workspace&&) noexcept = default;
ParametricModes::Workspace& ParametricModes::Workspace::operator=(Workspace&&) noexcept = default;
ParametricModes::Workspace::~Workspace() = default;
long ParametricModes::Workspace::solved() const {
  return impl_->solved;
}
long ParametricModes::Workspace::solved_in_full() const {
  return impl_->in_full;
}

}  // namespace wheeltap::fem

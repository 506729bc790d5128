#include "fem/structures/modes/structure_modes.hpp"

#include <Spectra/SymGEigsShiftSolver.h>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/eigen_solvers.hpp"
#include "fem/structures/mechanisms.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Discretisation::Sparse;
using Part = InvalidStructure::Part;

/// Below this number of degrees of freedom, a dense solver computes the modes.
constexpr Index kDense = 120;
/// Largest number of degrees of freedom for a dense solver if Lanczos' method misses modes.
constexpr Index kMostDense = 3000;
/// Number of modes computed above the requested modes, so that the Sturm count is in a gap.
constexpr Index kExtra = 6;
/// Smallest relative distance of eigenvalues that counts as a gap.
constexpr double kGap = 1e-6;

/// L D Lᵀ of a sparse symmetric matrix, with the interface of a solver for Spectra.
class Factor {
 public:
  using Scalar = double;

  explicit Factor(const Sparse& matrix) { ldlt_.compute(matrix); }
  [[nodiscard]] Index rows() const { return ldlt_.rows(); }
  void perform_op(const double* x, double* y) const {
    Eigen::Map<VectorXd>(y, rows()) = ldlt_.solve(Eigen::Map<const VectorXd>(x, rows()));
  }
  [[nodiscard]] MatrixXd solve(const MatrixXd& b) const { return ldlt_.solve(b); }
  [[nodiscard]] bool ok() const { return ldlt_.info() == Eigen::Success; }
  [[nodiscard]] int negative() const {
    return static_cast<int>((ldlt_.vectorD().array() < 0.0).count());
  }

 private:
  Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::AMDOrdering<int>> ldlt_;
};

/// Makes columns M-orthonormal to each other and to the M-orthonormal `against`, in two passes.
/// Omits columns that depend on earlier columns.
MatrixXd orthonormal(const Sparse& mass, const MatrixXd& against, const MatrixXd& columns) {
  const Index given = against.cols();
  MatrixXd all(columns.rows(), given + columns.cols());
  all.leftCols(given) = against;
  Index n = given;
  for (const auto& column : columns.colwise()) {
    VectorXd v = column, momentum = mass * v;
    const double before = std::sqrt(std::max(0.0, v.dot(momentum)));
    if (!(before > 0.0)) continue;
    v /= before;
    momentum /= before;
    for (int pass = 0; pass < 2; ++pass) {
      const VectorXd shares = all.leftCols(n).transpose() * momentum;
      v.noalias() -= all.leftCols(n) * shares;
      momentum.noalias() = mass * v;
    }
    const double left = std::sqrt(std::max(0.0, v.dot(momentum)));
    if (left > 1e-8) all.col(n++) = v / left;
  }
  return all.middleCols(given, n - given);
}

/// Ritz values λ, ascending, and their vectors, M-orthonormal.
struct Ritz {
  VectorXd values;
  MatrixXd shapes;
};

/// Throws if no solver can factor the matrices. The reason is a mechanism, which the message names,
/// or stiffnesses of too different size.
[[noreturn]] void refuse_spread(const Discretisation& d) {
  refuse_mechanisms(d);
  throw InvalidStructure(Part::whole, 0,
                         "its masses or stiffnesses differ by too many powers of ten: double "
                         "precision cannot separate its eigenvalues");
}

/// Rayleigh-Ritz step on M-orthonormal columns, with energies from the strains.
Ritz rayleigh_ritz(const Discretisation& d, const MatrixXd& basis) {
  const MatrixXd energy = d.projected_stiffness(basis);
  const MatrixXd gram = basis.transpose() * (d.mass * basis);
  // If rounding removes all stiffness, the search has no vectors or no finite numbers left.
  if (basis.cols() == 0 || !energy.allFinite() || !gram.allFinite()) refuse_spread(d);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(energy, gram);
  return {.values = solver.eigenvalues(), .shapes = basis * solver.eigenvectors()};
}

/// Shared data of the search for modes: the matrices in units of the lowest elastic eigenvalue.
struct ModeSearch {
  const Discretisation& d;
  MatrixXd rigid;  // M-orthonormal
  Sparse mass;     // M · unit; unit: order of magnitude of the lowest elastic λ
  Factor shifted;  // K + M · unit
};

/// The order of magnitude of λ₁: power iteration on (K + s M)⁻¹ M without the rigid motions.
double lowest_size(const Discretisation& d, const MatrixXd& rigid) {
  double scale = 0.0;
  for (Index i = 0; i < d.size(); ++i) {
    const double m = d.mass.coeff(i, i), k = d.stiffness.coeff(i, i);
    if (m > 0.0 && k > 0.0 && (scale == 0.0 || k / m < scale)) scale = k / m;
  }
  if (scale == 0.0) scale = 1.0;
  double shift = rigid.cols() > 0 ? 1e-6 * scale : 1e-9 * scale;
  for (int attempt = 0; attempt < 2; ++attempt) {
    const Factor factor(Sparse(d.stiffness + shift * d.mass));
    if (!factor.ok()) {
      shift *= 1e3;
      continue;
    }
    VectorXd v(d.size());
    for (Index i = 0; i < v.size(); ++i) v[i] = 1.0 + 0.5 * std::sin(1.7 * static_cast<double>(i));
    double lambda = 0.0;
    for (int step = 0; step < 6; ++step) {
      VectorXd next = factor.solve(d.mass * v);
      if (rigid.cols() > 0) next -= rigid * (rigid.transpose() * (d.mass * next));
      const double size = std::sqrt(std::max(0.0, next.dot(d.mass * next)));
      if (!(size > 0.0)) return scale;
      v = next / size;
      lambda = d.energy(v);
    }
    if (lambda > 0.0) return lambda;
    shift *= 1e3;
  }
  return scale;
}

/// Approximate lowest modes by Lanczos' method, M-orthogonal to `known`; fewer without convergence.
MatrixXd lanczos(const ModeSearch& s, const MatrixXd& known, Index count, int start) {
  struct Deflated {
    using Scalar = double;
    const ModeSearch& s;
    const MatrixXd& known;  // M·unit-orthonormal
    [[nodiscard]] Index rows() const { return s.d.size(); }
    [[nodiscard]] Index cols() const { return s.d.size(); }
    void set_shift(double) {}
    void perform_op(const double* x, double* y) const {
      Eigen::Map<VectorXd> out(y, rows());
      s.shifted.perform_op(x, y);
      if (known.cols() > 0)
        for (int pass = 0; pass < 2; ++pass) out -= known * (known.transpose() * (s.mass * out));
    }
  };
  /// Computes M u for Spectra; M has both triangles.
  struct Product {
    const Sparse& matrix;
    [[nodiscard]] Index rows() const { return matrix.rows(); }
    [[nodiscard]] Index cols() const { return matrix.cols(); }
    void perform_op(const double* x, double* y) const {
      Eigen::Map<VectorXd>(y, rows()).noalias() = matrix * Eigen::Map<const VectorXd>(x, cols());
    }
  };
  const Index n = s.d.size();
  count = std::min(count, n - 1 - known.cols());
  if (count < 1) return MatrixXd(n, 0);
  Deflated inverse{s, known};
  const Product mass{s.mass};
  const Index krylov = std::min(n, std::max<Index>(2 * count + 1, count + 20));
  Spectra::SymGEigsShiftSolver<Deflated, const Product, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, mass, count, krylov, -1.0);
  VectorXd residual(n);
  for (Index i = 0; i < n; ++i)
    residual[i] = std::sin((1.0 + 0.37 * start) * static_cast<double>(i + 1)) + 0.1;
  residual = s.shifted.solve(s.mass * residual);
  if (known.cols() > 0) residual -= known * (known.transpose() * (s.mass * residual));
  solver.init(residual.data());
  const Index found = solver.compute(Spectra::SortRule::LargestMagn, 300, 1e-11);
  return solver.eigenvectors(std::min(found, count));
}

/// All modes, lowest first. In M φ = μ (K + unit M) φ, the lowest mode has the largest μ, and
/// motions without mass have μ = 0.
MatrixXd dense(const ModeSearch& s, Index count) {
  const MatrixXd mass(s.mass), shifted(Sparse(s.d.stiffness + s.mass));
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(mass, shifted);
  const Index available = (solver.eigenvalues().array() > 1e-15).count();
  return solver.eigenvectors().rowwise().reverse().leftCols(std::min(count, available));
}

/// Rayleigh-Ritz steps with the residuals as additional directions. Residuals from the strains do
/// not have the rounding errors of the factored matrix. Returns the `count` lowest modes; the
/// `wanted` lowest of these are correct to rounding.
Ritz refined_ritz(const ModeSearch& s, const MatrixXd& vectors, Index count, Index wanted) {
  // Squared residual in the norm of (K + u M)⁻¹, divided by λ. By Temple's bound, this is the
  // relative error of λ, apart from λ / gap. Below kRoundingOfMode, no further improvement is
  // possible.
  constexpr double kRoundingOfMode = 1e-18;
  constexpr double kLost = 1e-12;  // share of a Ritz value
  const Discretisation& d = s.d;
  Ritz ritz = rayleigh_ritz(d, orthonormal(d.mass, s.rigid, vectors));
  for (int step = 0; step < 2; ++step) {
    const Index m = std::min<Index>(ritz.shapes.cols(), count);
    MatrixXd residuals(d.size(), m);
    for (Index i = 0; i < m; ++i)
      residuals.col(i) =
          d.stiffness_times(ritz.shapes.col(i)) - ritz.values[i] * (d.mass * ritz.shapes.col(i));
    MatrixXd corrections = s.shifted.solve(residuals);
    bool settled = true;
    for (Index i = 0; i < m; ++i) {
      const double squared = residuals.col(i).dot(corrections.col(i)) / std::abs(ritz.values[i]);
      settled &= i >= wanted || squared < kRoundingOfMode;
      // A correction far below rounding errors has no meaning.
      if (corrections.col(i).dot(d.mass * corrections.col(i)) < 1e-30) corrections.col(i).setZero();
    }
    if (settled) break;
    // Ritz vectors are M-orthonormal to each other and to the rigid motions.
    MatrixXd known(d.size(), s.rigid.cols() + ritz.shapes.cols());
    known << s.rigid, ritz.shapes;
    const MatrixXd more = orthonormal(d.mass, known, corrections);
    MatrixXd basis(d.size(), ritz.shapes.cols() + more.cols());
    basis << ritz.shapes, more;
    Ritz next = rayleigh_ritz(d, basis);
    // Apart from rounding, a larger space has no higher Ritz values. A correction that is mainly a
    // massless motion can raise them.
    if (((next.values.head(m) - ritz.values.head(m)).array() >
         kLost * ritz.values.head(m).array().abs())
            .any())
      break;
    ritz = std::move(next);
  }
  const Index kept = std::min(count, ritz.shapes.cols());
  return {.values = ritz.values.head(kept), .shapes = ritz.shapes.leftCols(kept)};
}

/// Throws if a motion has zero or negative stiffness.
void refuse_unresisted(const Discretisation& d, const Ritz& ritz) {
  for (Index i = 0; i < ritz.shapes.cols(); ++i) {
    const VectorXd shape = ritz.shapes.col(i);
    const double all = d.uncancelled_energy(shape);
    const bool compressed =
        std::ranges::any_of(d.strains, [](const Strain& s) { return s.factor < 0.0; });
    if (ritz.values[i] < -1e-12 * all && compressed)
      throw InvalidStructure(
          Part::members, 0,
          "the axial forces exceed the buckling load: a motion that is largest at " +
              motion_in_words(d, shape) + " has negative stiffness");
    if (ritz.values[i] < -1e-12 * all && d.rest.nonZeros() > 0)
      throw InvalidStructure(
          Part::whole, 0,
          "its stiffness is negative for a motion that is largest at " + motion_in_words(d, shape));
    if (ritz.values[i] < -1e-12 * all) refuse_spread(d);
    if (std::abs(ritz.values[i]) <= no_strain(d) * all) {
      refuse_mechanisms(d);
      throw InvalidStructure(Part::whole, 0,
                             "is a mechanism: nothing resists a motion that is largest at " +
                                 motion_in_words(d, shape));
    }
  }
}

void refuse_empty_pivots(const Discretisation& d) {
  for (Index i = 0; i < d.size(); ++i)
    if (!(d.stiffness.coeff(i, i) > 0.0) && !(d.mass.coeff(i, i) > 0.0))
      throw InvalidStructure(Part::whole, 0,
                             "has neither stiffness nor mass at " +
                                 d.names[static_cast<std::size_t>(i)].place + ", " +
                                 d.names[static_cast<std::size_t>(i)].direction);
}

}  // namespace

int eigenvalues_below(const Discretisation& d, double sigma) {
  const Factor factor(Sparse(d.stiffness - sigma * d.mass));
  if (!factor.ok())
    throw std::domain_error("sigma = " + std::to_string(sigma) +
                            ": is an eigenvalue, K - sigma M cannot be factored");
  return factor.negative();
}

Index mode_count(const Discretisation& d) {
  // The rank of M is that of D⁻½ M D⁻½, where D is the diagonal of M: the number of pivots of L D
  // Lᵀ that exceed rounding errors. With the shift, pivots of dependent motions are not exactly 0.
  constexpr double kShift = 1e-15, kNoPivot = 1e-12;
  const VectorXd diagonal = d.mass.diagonal();
  std::vector<int> massive(static_cast<std::size_t>(d.size()), -1);
  int n = 0;
  for (Index i = 0; i < d.size(); ++i)
    if (diagonal[i] > 0.0) massive[static_cast<std::size_t>(i)] = n++;
  std::vector<Eigen::Triplet<double>> entries;
  for (int c = 0; c < d.mass.outerSize(); ++c)
    for (Sparse::InnerIterator it(d.mass, c); it; ++it) {
      const int i = massive[static_cast<std::size_t>(it.row())];
      const int j = massive[static_cast<std::size_t>(it.col())];
      if (i < 0 || j < 0) continue;
      entries.emplace_back(
          i, j,
          i == j ? 1.0 + kShift
                 : it.value() / std::sqrt(diagonal[it.row()]) / std::sqrt(diagonal[it.col()]));
    }
  if (n == 0) return 0;
  Sparse scaled(n, n);
  scaled.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Sparse> ldlt(scaled);
  return ldlt.info() == Eigen::Success ? (ldlt.vectorD().array() > kNoPivot).count() : n;
}

namespace {

/// Counts the eigenvalues below the widest gap above the `wanted`-th Ritz value. Returns true if
/// these are the Ritz values, and false if there is no gap or a mode is missing.
bool certified(const Discretisation& d, const Ritz& ritz, Index wanted) {
  Index at = -1;
  double widest = kGap;
  for (Index i = std::max<Index>(wanted - 1, 0); i + 1 < ritz.values.size(); ++i) {
    const double gap = ritz.values[i + 1] / ritz.values[i] - 1.0;
    if (gap > widest) {
      widest = gap;
      at = i;
    }
  }
  if (at < 0) return false;
  const Factor factor(
      Sparse(d.stiffness - std::sqrt(ritz.values[at] * ritz.values[at + 1]) * d.mass));
  return factor.ok() && factor.negative() == static_cast<int>(at + 1 + d.rigid_motions.cols());
}

}  // namespace

StructureModes structure_modes(const Discretisation& d, int modes) {
  refuse_empty_pivots(d);
  const Index n = d.size();
  const Index available = mode_count(d);
  if (modes < 1 || modes > available)
    throw std::invalid_argument("modes = " + std::to_string(modes) + ": must be between 1 and " +
                                std::to_string(available) +
                                ", the free degrees of freedom that have mass");
  const MatrixXd rigid = orthonormal(d.mass, MatrixXd(n, 0), d.rigid_motions);
  const double unit = lowest_size(d, rigid);
  const ModeSearch search{.d = d,
                          .rigid = rigid,
                          .mass = d.mass * unit,
                          .shifted = Factor(Sparse(d.stiffness + unit * d.mass))};
  if (!search.shifted.ok()) refuse_spread(d);

  StructureModes out;
  out.rigid_body_modes = static_cast<int>(rigid.cols());
  const Index elastic = std::min<Index>(modes - std::min<Index>(modes, rigid.cols()) + kExtra,
                                        available - rigid.cols());
  const bool most = 3 * (modes + kExtra) > n;
  Ritz ritz{.values = VectorXd(0), .shapes = MatrixXd(n, 0)};
  bool densely = n <= kDense || most;
  out.solver = densely ? "dense (few degrees of freedom, or most modes requested)" : "spectra";
  if (elastic > 0 && !densely) {
    MatrixXd found = rigid;
    MatrixXd known = rigid / std::sqrt(unit);
    for (int attempt = 0; attempt < 6 && !out.certified; ++attempt) {
      const Index wanted = attempt == 0 ? elastic : std::min<Index>(elastic, 4 + 2 * attempt);
      MatrixXd more = lanczos(search, known, wanted, attempt);
      MatrixXd all(n, ritz.shapes.cols() + more.cols());
      all << ritz.shapes, more;
      ritz = refined_ritz(search, all, elastic, modes - rigid.cols());
      refuse_unresisted(d, ritz);
      out.certified = certified(d, ritz, modes - rigid.cols());
      if (!out.certified) {
        const MatrixXd taken = orthonormal(d.mass, MatrixXd(n, 0), ritz.shapes);
        known.resize(n, rigid.cols() + taken.cols());
        known << rigid / std::sqrt(unit), taken / std::sqrt(unit);
      }
    }
    if (!out.certified && n <= kMostDense) {
      densely = true;
      out.solver = "dense (Lanczos missed a mode)";
    }
  }
  if (elastic > 0 && densely) {
    ritz = refined_ritz(search, dense(search, available), elastic, modes - rigid.cols());
    refuse_unresisted(d, ritz);
    const bool all = ritz.values.size() == available - rigid.cols();
    out.certified = all || certified(d, ritz, modes - rigid.cols());
  }

  const Index rigid_wanted = std::min<Index>(modes, rigid.cols());
  if (ritz.shapes.cols() < modes - rigid_wanted) refuse_spread(d);  // rounding removed some modes
  out.eigenvalues = VectorXd::Zero(modes);
  out.residuals = VectorXd::Zero(modes);
  out.shapes.resize(n, modes);
  out.shapes.leftCols(rigid_wanted) = rigid.leftCols(rigid_wanted);
  for (Index i = rigid_wanted; i < modes; ++i) {
    const Index k = i - rigid_wanted;
    VectorXd shape = ritz.shapes.col(k);
    shape /= std::sqrt(shape.dot(d.mass * shape));
    out.shapes.col(i) = shape;
    out.eigenvalues[i] = d.energy(shape);
    if (!(out.eigenvalues[i] > 0.0 && std::isfinite(out.eigenvalues[i]))) refuse_spread(d);
    const VectorXd residual = d.stiffness_times(shape) - out.eigenvalues[i] * (d.mass * shape);
    const VectorXd moved = search.shifted.solve(residual);
    out.residuals[i] = std::sqrt(std::max(0.0, residual.dot(moved)) / out.eigenvalues[i]);
  }
  for (auto shape : out.shapes.colwise()) {
    const double almost_largest = (1.0 - 1e-6) * shape.cwiseAbs().maxCoeff();
    for (const double u : shape)
      if (std::abs(u) >= almost_largest) {
        if (u < 0.0) shape = -shape.eval();
        break;
      }
  }
  out.frequencies_hz = out.eigenvalues.cwiseSqrt() / (2.0 * std::numbers::pi);
  return out;
}

}  // namespace wheeltap::fem

#include "fem/structures/modes/subspace_modes.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/eigen_solvers.hpp"
#include "fem/structures/modes/structure_modes.hpp"

namespace wheeltap::fem {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {
/// Largest relative change of an eigenvalue due to rounding.
constexpr double kSubspaceRounding = 1e-6;
}  // namespace

SubspaceModes::SubspaceModes(const Discretisation& first, const Options& options)
    : options_(options) {
  const Index available = mode_count(first), rigid = first.rigid_motions.cols();
  const Index wanted = rigid + options.modes;
  const Index block = std::min(available, wanted + std::max<Index>(8, options.modes));
  const StructureModes modes =
      structure_modes(first, static_cast<int>(std::max(std::min(wanted, available), block)));
  if (options.modes < 1 || wanted > available)
    throw std::invalid_argument("modes = " + std::to_string(options.modes) +
                                ": must be between 1 and " + std::to_string(available - rigid) +
                                ", the number of elastic modes");
  start_ = modes.shapes;
  sigma_ = modes.eigenvalues[std::min(rigid, modes.eigenvalues.size() - 1)];
}

bool SubspaceModes::solve(const Discretisation& d, Found& out) const {
  const Index wanted = d.rigid_motions.cols() + options_.modes;
  out.steps = 0;
  if (d.size() <= kDense) return dense(d, wanted, out);
  if (d.size() != start_.rows() || wanted > start_.cols()) return in_full(d, wanted, out);
  return iterate(d, wanted, out);
}

bool SubspaceModes::in_full(const Discretisation& d, Index wanted, Found& out) const {
  try {
    const StructureModes modes = structure_modes(d, static_cast<int>(wanted));
    out.eigenvalues = modes.eigenvalues.tail(options_.modes);
    out.shapes = modes.shapes.rightCols(options_.modes);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

// Computes the largest eigenvalues μ of L⁻¹ M L⁻ᵀ with L Lᵀ = K + σM; λ = 1/μ - σ.
bool SubspaceModes::dense(const Discretisation& d, Index wanted, Found& out) const {
  const Index n = d.size(), rigid = wanted - options_.modes;
  if (wanted > n) return false;
  const double sigma = rigid > 0 ? sigma_ : 0.0;
  const MatrixXd mass(d.mass);
  const Eigen::LLT<MatrixXd> llt(MatrixXd(d.stiffness) + sigma * mass);
  if (llt.info() != Eigen::Success) return false;
  MatrixXd c = llt.matrixL().solve(mass);
  c = llt.matrixL().solve(MatrixXd(c.transpose()));
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(MatrixXd(0.5 * (c + c.transpose())));
  if (solver.info() != Eigen::Success) return false;
  out.eigenvalues.resize(options_.modes);
  MatrixXd y(n, options_.modes);
  for (Index i = 0; i < options_.modes; ++i) {
    const Index at = n - 1 - rigid - i;
    const double mu = solver.eigenvalues()[at];
    if (!(mu > 0.0)) return false;
    out.eigenvalues[i] = 1.0 / mu - sigma;
    y.col(i) = solver.eigenvectors().col(at) / std::sqrt(mu);
  }
  out.shapes = llt.matrixU().solve(y);
  return out.eigenvalues[0] > 0.0;
}

bool SubspaceModes::iterate(const Discretisation& d, Index wanted, Found& out) const {
  const Index rigid = wanted - options_.modes;
  const double sigma = rigid > 0 ? sigma_ : 0.0;
  const Discretisation::Sparse shifted =
      rigid > 0 ? Discretisation::Sparse(d.stiffness + sigma * d.mass) : d.stiffness;
  const Eigen::SimplicialLDLT<Discretisation::Sparse> ldlt(shifted);
  if (ldlt.info() != Eigen::Success || (ldlt.vectorD().array() <= 0.0).any()) return false;
  MatrixXd momentum = d.mass * start_;
  VectorXd before;
  double last = std::numeric_limits<double>::infinity();
  for (out.steps = 1; out.steps <= options_.most_steps; ++out.steps) {
    // X = (K + σM)⁻¹ M Y:  Xᵀ (K + σM) X = Xᵀ M Y.
    const MatrixXd x = ldlt.solve(momentum);
    const MatrixXd mass_x = d.mass * x;
    MatrixXd stiffness = x.transpose() * momentum;
    stiffness = 0.5 * (stiffness + stiffness.transpose()).eval();
    const MatrixXd mass = x.transpose() * mass_x;
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> ritz(stiffness,
                                                                  0.5 * (mass + mass.transpose()));
    if (ritz.info() != Eigen::Success) return false;
    const VectorXd now = ritz.eigenvalues().head(wanted).array() - sigma;
    const VectorXd elastic = now.tail(options_.modes);
    double moved = std::numeric_limits<double>::infinity();
    if (before.size() > 0)
      moved = ((elastic - before.tail(options_.modes)).array() / elastic.array()).abs().maxCoeff();
    // On fine meshes, rounding errors prevent full convergence.
    const bool done =
        moved <= options_.tolerance || (moved < kSubspaceRounding && moved > 0.5 * last);
    before = now;
    last = moved;
    momentum = mass_x * ritz.eigenvectors();
    if (!done) continue;
    out.eigenvalues = elastic;
    out.shapes = x * ritz.eigenvectors().middleCols(rigid, options_.modes);
    return elastic[0] > 0.0;
  }
  return false;
}

}  // namespace wheeltap::fem

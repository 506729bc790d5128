#include "fem/structures/reanalysis/structure_spectrum.hpp"

#include <algorithm>
#include <cmath>

#include "base/eigen_solvers.hpp"
#include "fem/structures/mechanisms.hpp"
#include "fem/structures/modes/structure_modes.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;

/// A mode with a smaller μ, relative to the largest μ, has no mass. Due to rounding, such modes
/// have 1e-16 (double) or 1e-19 (long double).
template <class Real>
constexpr double kMassless = 1e-13;
template <>
constexpr double kMassless<long double> = 1e-16;

template <class Real>
using Dense = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

/// Computes Bᵀ D B + K_rest with products in `Real`.
template <class Real>
Dense<Real> dense_stiffness(const Discretisation& d) {
  Dense<Real> k = Dense<Real>::Zero(d.size(), d.size());
  if (d.rest.nonZeros() > 0) k = Eigen::MatrixXd(d.rest).cast<Real>();
  for (const Strain& strain : d.strains)
    for (std::size_t i = 0; i < strain.row.dofs.size(); ++i)
      for (std::size_t j = 0; j < strain.row.dofs.size(); ++j)
        k(strain.row.dofs[i], strain.row.dofs[j]) += static_cast<Real>(strain.factor) *
                                                     strain.row.coefficients[i] *
                                                     strain.row.coefficients[j];
  return k;
}

struct All {
  StructureSpectrum::Matrix shapes;  // mass-normalised, lowest first
  Eigen::VectorXd eigenvalues;
};

template <class Real>
All all_modes(const Discretisation& d, double unit) {
  const Dense<Real> mass = Eigen::MatrixXd(d.mass).cast<Real>();
  const Dense<Real> shifted = dense_stiffness<Real>(d) + static_cast<Real>(unit) * mass;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Dense<Real>> solver(mass, shifted);
  const auto& mu = solver.eigenvalues();
  const Index n = mu.size();
  Index massive = 0;
  while (massive < n && mu[n - 1 - massive] > kMassless<Real> * mu[n - 1]) ++massive;
  All all{.shapes = StructureSpectrum::Matrix(d.size(), massive), .eigenvalues = {}};
  all.eigenvalues.resize(massive);
  for (Index i = 0; i < massive; ++i) {
    const Real m = mu[n - 1 - i];
    all.shapes.col(i) =
        (solver.eigenvectors().col(n - 1 - i) / std::sqrt(m)).template cast<long double>();
    all.eigenvalues[i] = static_cast<double>(1 / m - static_cast<Real>(unit));
  }
  return all;
}

/// A basis of the massless motions: the empty rows of M, and the null space of D⁻½ M D⁻½, D = diag
/// M, for the others. For example, M is singular if a mass has an offset from its node.
Eigen::MatrixXd without_mass(const Discretisation& d, Index count) {
  constexpr double kMasslessBelow = 1e-12;
  std::vector<Index> massive;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(d.size(), count);
  Index next = 0;
  for (Index i = 0; i < d.size(); ++i) {
    if (d.mass.coeff(i, i) > 0.0)
      massive.push_back(i);
    else if (next < count)
      out(i, next++) = 1.0;
  }
  if (next == count) return out;
  const auto n = static_cast<Index>(massive.size());
  const Eigen::VectorXd root = d.mass.diagonal()(massive).cwiseSqrt();
  const Eigen::MatrixXd scaled =
      Eigen::MatrixXd(d.mass)(massive, massive).cwiseQuotient(root * root.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  for (Index k = 0; k < n && next < count; ++k)
    if (solver.eigenvalues()[k] < kMasslessBelow)
      out(massive, next++) = solver.eigenvectors().col(k).cwiseQuotient(root);
  return out.leftCols(next);
}

/// K-orthogonal combinations of the massless motions with ψᵀ K ψ = 1.
StructureSpectrum::Matrix massless_shapes(const Discretisation& d, Index count) {
  using Matrix = StructureSpectrum::Matrix;
  if (count == 0) return Matrix(d.size(), 0);
  const Eigen::SparseMatrix<long double> basis =
      without_mass(d, count).cast<long double>().sparseView();
  const Matrix held = basis.transpose() * dense_stiffness<long double>(d);
  const Eigen::LLT<Matrix> llt(held * basis);
  if (llt.info() != Eigen::Success) {
    refuse_mechanisms(d);
    throw InvalidStructure(InvalidStructure::Part::whole, 0,
                           "is a mechanism: nothing resists a motion that has no mass");
  }
  return llt.matrixL().solve(Matrix(basis.transpose())).transpose();
}

}  // namespace

StructureSpectrum structure_spectrum(const Discretisation& d, int refined) {
  const auto available = static_cast<int>(mode_count(d));
  const auto rigid = static_cast<int>(d.rigid_motions.cols());
  const StructureModes low = structure_modes(d, std::min(available, std::max(refined, rigid + 1)));
  const double unit = low.eigenvalues.size() > rigid ? low.eigenvalues[rigid] : 1.0;
  const bool wide = d.size() <= kWideSpectrum;
  All all = wide ? all_modes<long double>(d, unit) : all_modes<double>(d, unit);
  const Index taken = wide ? rigid : low.eigenvalues.size();
  for (Index i = 0; i < taken; ++i) {
    all.shapes.col(i) = low.shapes.col(i).cast<long double>();
    all.eigenvalues[i] = low.eigenvalues[i];
  }
  return {.eigenvalues = std::move(all.eigenvalues),
          .shapes = std::move(all.shapes),
          .rigid_body_modes = rigid,
          .massless = massless_shapes(d, d.size() - available)};
}

}  // namespace wheeltap::fem

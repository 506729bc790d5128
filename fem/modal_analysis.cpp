#include "fem/modal_analysis.hpp"

#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>
#include <Eigen/CholmodSupport>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "fem/assembly.hpp"
#include "fem/strain_energy.hpp"
#include "fem/sturm_certificate.hpp"

namespace wheeltap::fem {
namespace {

using Sparse = Assembly<double>::Sparse;

/// Modes computed above the wanted ones, among which the Sturm count looks for a gap.
constexpr Eigen::Index kSpareModes = 3;

/// y = (K - σ M)⁻¹ x for Spectra, by CHOLMOD's simplicial L D Lᵀ.
class ShiftInvert {
 public:
  using Scalar = double;

  ShiftInvert(const Sparse& k, const Sparse& m) : k_(k), m_(m) {}
  [[nodiscard]] Eigen::Index rows() const { return k_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return k_.cols(); }
  void set_shift(double sigma) { ldlt_.compute(k_ - sigma * m_); }
  void perform_op(const double* x, double* y) const {
    Eigen::Map<Eigen::VectorXd>(y, rows()) =
        ldlt_.solve(Eigen::Map<const Eigen::VectorXd>(x, rows()));
  }
  [[nodiscard]] bool ok() const { return ldlt_.info() == Eigen::Success; }

 private:
  const Sparse& k_;
  const Sparse& m_;
  Eigen::CholmodSimplicialLDLT<Sparse> ldlt_;
};

/// The `count` lowest eigenvectors, in any order, or nothing where Spectra fails.
std::optional<Eigen::MatrixXd> sparse_vectors(const Assembly<double>& a, double shift,
                                              Eigen::Index count) {
  ShiftInvert inverse(a.stiffness, a.mass);
  Spectra::SparseSymMatProd<double> mass(a.mass);
  const Eigen::Index n = a.mass.rows();
  const Eigen::Index krylov = std::min(n, std::max<Eigen::Index>(2 * count + 1, 20));
  Spectra::SymGEigsShiftSolver<ShiftInvert, Spectra::SparseSymMatProd<double>,
                               Spectra::GEigsMode::ShiftInvert>
      solver(inverse, mass, count, krylov, shift);
  if (!inverse.ok()) return std::nullopt;
  solver.init();
  if (solver.compute(Spectra::SortRule::LargestMagn, 1000, 1e-13) < count) return std::nullopt;
  return solver.eigenvectors(count);
}

/// All eigenvectors, lowest first. M φ = μ (K - σ M) φ keeps the low modes accurate: their μ are
/// the largest, where K φ = λ M φ would bury them under the rounding of the highest λ.
Eigen::MatrixXd dense_vectors(const Assembly<double>& a, double shift) {
  const Eigen::MatrixXd mass(a.mass), shifted(a.stiffness - shift * a.mass);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(mass, shifted);
  return solver.eigenvectors().rowwise().reverse();
}

/// Turns eigenvectors into modes: exact Rayleigh quotients in place of computed eigenvalues,
/// ascending, mass-normalised and sign-fixed.
Modes finish(const Beam& beam, const Defects& defects, const Assembly<double>& a,
             const Eigen::MatrixXd& vectors) {
  const StrainEnergy<double> energy(beam, defects);
  const Eigen::Index count = vectors.cols();
  Eigen::MatrixXd shapes = a.free_to_all * vectors;
  Eigen::VectorXd eigenvalues(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::VectorXd q = vectors.col(i);
    shapes.col(i) /= std::sqrt(q.dot(a.mass * q));
    eigenvalues[i] = energy.twice(shapes.col(i));
  }
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](Eigen::Index i, Eigen::Index j) { return eigenvalues[i] < eigenvalues[j]; });

  Modes modes;
  modes.rigid_body_modes = rigid_body_freedom(beam, defects.supports);
  modes.eigenvalues = eigenvalues(order);
  modes.eigenvalues.head(std::min<Eigen::Index>(modes.rigid_body_modes, count)).setZero();
  modes.shapes = shapes(Eigen::all, order);
  for (auto shape : modes.shapes.colwise()) {
    const Eigen::VectorXd deflections = shape(Eigen::seq(0, Eigen::last, 2));
    // Of equal extremes, as in antisymmetric shapes, the first decides.
    const double almost_largest = (1.0 - 1e-6) * deflections.cwiseAbs().maxCoeff();
    for (const double w : deflections)
      if (std::abs(w) >= almost_largest) {
        if (w < 0.0) shape = -shape.eval();
        break;
      }
  }
  modes.frequencies_hz = modes.eigenvalues.cwiseSqrt() / (2.0 * std::numbers::pi);
  return modes;
}

/// Keeps the lowest `count` modes, certified or not.
void certify_and_trim(Modes& modes, const Assembly<double>& a, Eigen::Index count) {
  modes.certified = nothing_missed(a, modes.eigenvalues, count);
  modes.eigenvalues.conservativeResize(count);
  modes.frequencies_hz.conservativeResize(count);
  modes.shapes.conservativeResize(Eigen::NoChange, count);
}

}  // namespace

Modes modal_analysis(const Beam& beam, const Defects& defects, const ModalOptions& options) {
  const Assembly<double> a = assemble<double>(beam, defects);
  const Eigen::Index n = a.stiffness.rows();
  if (options.modes < 1 || options.modes > n)
    throw std::invalid_argument("modes = " + std::to_string(options.modes) +
                                ": must be between 1 and " + std::to_string(n) +
                                ", the free degrees of freedom of the mesh");
  // Below every eigenvalue, at the distance of the lowest elastic ones.
  const double shift = -10.0 * beam.material.young * beam.section.second_moment /
                       (beam.material.density * beam.section.area * std::pow(beam.length, 4));
  const Eigen::Index wanted = std::min<Eigen::Index>(n, options.modes + kSpareModes);

  std::string why_dense = options.dense ? "as asked" : "";
  if (!options.dense && 3 * wanted > n) why_dense = "most modes of the mesh are wanted";
  if (why_dense.empty()) {
    if (const auto vectors = sparse_vectors(a, shift, wanted)) {
      Modes modes = finish(beam, defects, a, *vectors);
      certify_and_trim(modes, a, options.modes);
      modes.solver = "spectra";
      if (modes.certified) return modes;
      why_dense = "the Sturm count found a mode that Spectra missed";
    } else {
      why_dense = "Spectra did not converge";
    }
  }
  Modes modes = finish(beam, defects, a, dense_vectors(a, shift).leftCols(wanted));
  certify_and_trim(modes, a, options.modes);
  modes.solver = "dense (" + why_dense + ")";
  return modes;
}

}  // namespace wheeltap::fem

#include "fem/beam/modal_analysis.hpp"

#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>
#include <Eigen/CholmodSupport>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include "base/eigen_solvers.hpp"
#include "fem/beam/assembly.hpp"
#include "fem/beam/lowest_modes.hpp"

namespace wheeltap::fem {
namespace {

using Sparse = Assembly<double>::Sparse;

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

/// The `count` lowest eigenvectors, in any order; std::nullopt if Spectra fails.
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

/// All eigenvectors, lowest first. M φ = μ (K - σ M) φ keeps the low modes accurate, because their
/// μ are the largest. In K φ = λ M φ, rounding of the highest λ would dominate.
Eigen::MatrixXd dense_vectors(const Assembly<double>& a, double shift) {
  const Eigen::MatrixXd mass(a.mass), shifted(a.stiffness - shift * a.mass);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(mass, shifted);
  return solver.eigenvectors().rowwise().reverse();
}

/// Converts start vectors to 106 bits.
std::vector<WidePencil::Vector> widened(const Eigen::MatrixXd& vectors) {
  std::vector<WidePencil::Vector> wide;
  for (const auto& column : vectors.colwise()) wide.emplace_back(column.cast<DoubleDouble>());
  return wide;
}

/// Rounds to double and fixes the sign of each shape.
Modes rounded(const LowestModes& lowest, const WidePencil& pencil) {
  const auto count = static_cast<Eigen::Index>(lowest.modes.size());
  Modes modes;
  modes.rigid_body_modes = static_cast<int>(pencil.rigid_modes().size());
  modes.certified = lowest.proven;
  modes.eigenvalues.resize(count);
  modes.shapes.resize(pencil.assembly().free_to_all.rows(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    modes.eigenvalues[i] = static_cast<double>(lowest.eigenvalues[k]);
    modes.shapes.col(i) = pencil.all_dofs(lowest.modes[k]).cast<double>();
  }
  for (auto shape : modes.shapes.colwise()) {
    const Eigen::VectorXd deflections = shape(Eigen::seq(0, Eigen::last, 2));
    // If several extremes are equal, as in antisymmetric shapes, the first determines the sign.
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

}  // namespace

Modes modal_analysis(const Beam& beam, const Defects& defects, const ModalOptions& options) {
  Assembly<double> a = assemble<double>(beam, defects);
  const Eigen::Index n = a.stiffness.rows();
  if (options.modes < 1 || options.modes > n)
    throw std::invalid_argument("modes = " + std::to_string(options.modes) +
                                ": must be between 1 and " + std::to_string(n) +
                                ", the number of free degrees of freedom of the mesh");
  // The lowest elastic eigenvalues are a few times this value, from bending and shear in series. In
  // this unit, 1 / (λ - σ) is near 1; Spectra would accept values below 4e-11 as converged.
  const double flexural = beam.material.young * beam.section.second_moment;
  const double shear =
      beam.section.shear_coefficient * beam.material.shear_modulus() * beam.section.area;
  const double square = beam.length * beam.length;
  const double unit = 10.0 * flexural /
                      (beam.material.density * beam.section.area * square * square *
                       (1.0 + 12.0 * flexural / (shear * square)));
  a.mass *= unit;
  constexpr double kShift = -1.0;  // below every eigenvalue

  WidePencil pencil(beam, defects);
  std::string solver;
  std::optional<LowestModes> lowest;
  const bool most = 3 * options.modes > n;
  if (!options.dense && !most) {
    const auto vectors = sparse_vectors(a, kShift, options.modes);
    if (vectors) lowest = finish(pencil, widened(*vectors));
    solver = "spectra";
    if (!lowest || !lowest->proven)
      solver =
          vectors ? "bisection (Spectra missed a mode)" : "bisection (Spectra did not converge)";
  } else {
    lowest = finish(pencil, widened(dense_vectors(a, kShift).leftCols(options.modes)));
    solver = options.dense ? "dense (requested)" : "dense (most modes of the mesh are requested)";
    if (!lowest || !lowest->proven) solver = "bisection (the dense solver missed a mode)";
  }
  if (!lowest || !lowest->proven) lowest = lowest_modes(beam, defects, options.modes, pencil);
  Modes modes = rounded(*lowest, pencil);
  modes.solver = solver;
  return modes;
}

}  // namespace wheeltap::fem

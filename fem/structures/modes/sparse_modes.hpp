// Computation of the lowest modes from sparse matrices, for a structure whose matrices are affine
// in its parameters.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/modes/parametric_structure.hpp"
#include "fem/structures/modes/sparse_factor.hpp"

namespace wheeltap::fem {

/// Computes the lowest modes of K(θ) φ = λ M(θ) φ, K = Σ q_t(θ) K_t, without a reduced basis. The
/// method is Lanczos' method for K⁻¹ M with full orthogonalisation (Saad 2011, section 6.6),
/// started from the modes at θ₀. Derivatives of shapes follow from Nelson's method (1976). The
/// constructor finds the positions of all nonzero entries in the sparse matrices and factors. A
/// solution therefore takes little more time than its arithmetic operations. A Sturm count at each
/// θ proves that no mode is missing.
///
/// The object is immutable after construction; each thread needs a separate workspace.
class SparseModes {
 public:
  /// `elastic` is the number of modes to compute, `massive` the number of all modes (`mode_count`).
  /// `start` holds modes at θ₀ as columns, `motions` the requested components of the shapes. K and
  /// M must be affine in θ. The structure must have no rigid-body motions and outlive this object.
  SparseModes(const ParametricStructure& structure, Eigen::Index massive, Eigen::Index elastic,
              const Eigen::MatrixXd& start, const std::vector<SparseRow>& motions);

  struct Workspace {
    Eigen::VectorXd stiffness_diagonal, mass_diagonal;  // diagonals at the last θ
    std::vector<double> stiffness, mass;                // below the diagonal
    Eigen::VectorXd matrices_diagonal;                  // terms that are given as matrices
    std::vector<double> matrices;
    SparseFactor::Values shifted, several;
    Eigen::MatrixXd modes;  // elastic modes, mass-normalised, in the order of the factor
    Eigen::VectorXd eigenvalues;
    Eigen::VectorXd residuals;  // η of each mode, as in ParametricModes
    Eigen::VectorXd mu;         // 1/λ, descending, then estimates of 1/λ for higher modes
    bool solved = false;
  };

  /// Computes the elastic modes at θ: eigenvalues [rad²/s²], ascending, and the requested
  /// components of the mass-normalised shapes (motions × modes). Returns false if the stiffness is
  /// not positive definite, or if a mode is missing.
  bool solve(const ParametricStructure::Point& point, Workspace& ws, Eigen::VectorXd& eigenvalues,
             Eigen::MatrixXd& shapes) const;

  /// Computes the derivatives ∂λ/∂θ (modes × parameters) and ∂shapes/∂θ_j (motions × modes, one
  /// matrix per parameter) at the θ of the last successful `solve`. The derivatives of shapes
  /// exclude rotations within the subspace of modes whose relative spacing is below `twin`.
  bool differentiate(Workspace& ws, double twin, Eigen::MatrixXd& eigenvalues,
                     std::vector<Eigen::MatrixXd>& shapes) const;

  /// The approximate number of multiplications in one solution with its derivatives.
  [[nodiscard]] double cost() const;

 private:
  /// A sparse symmetric matrix in the pattern of the factor.
  struct Entries {
    std::vector<std::size_t> diagonal_at, lower_at;
    std::vector<std::uint32_t> rows, columns;  // positions of `lower` in the matrix
    std::vector<double> diagonal, lower;
  };
  /// Entries of `lower` with their rows, column by column, and the first entry of each column.
  struct Columns {
    struct Entry {
      std::uint32_t entry, row;
    };
    std::vector<Entry> entries;
    std::vector<std::size_t> start;
  };
  [[nodiscard]] Entries entries(const Discretisation::Sparse& matrix) const;
  static void add(double factor, const Entries& entries, double* diagonal, double* lower);
  [[nodiscard]] Columns columns_of(const std::vector<char>& marked) const;
  /// Computes A u from the diagonal of A and those entries of `lower` that `columns` lists.
  void times(const double* diagonal, const double* lower, const Columns& columns, const double* u,
             double* out) const;
  void mass_times(const Workspace& ws, const double* u, double* out) const {
    times(ws.mass_diagonal.data(), ws.mass.data(), mass_columns_, u, out);
  }
  static void multiply(const Entries& entries, const double* u, const double* scale, double* out);
  [[nodiscard]] std::vector<std::size_t> pins(const Workspace& ws, Eigen::Index first,
                                              Eigen::Index last) const;
  bool factorise_at(Workspace& ws, const double* lambda,
                    const std::vector<std::size_t>* pinned) const;
  bool lanczos(Workspace& ws, Eigen::MatrixXd& locked, Eigen::VectorXd& mu, Eigen::VectorXd& beyond,
               Eigen::Index wanted, Eigen::Index round) const;
  [[nodiscard]] bool none_missing(Workspace& ws, const Eigen::VectorXd& mu, Eigen::Index k) const;
  [[nodiscard]] Eigen::MatrixXd stiffness_times(const ParametricStructure::Point& point,
                                                const Workspace& ws) const;
  bool rayleigh_ritz(const ParametricStructure::Point& point, Workspace& ws) const;
  [[nodiscard]] bool solves(const Workspace& ws, double lambda,
                            const std::vector<std::size_t>& pinned, const Eigen::VectorXd& x,
                            const Eigen::VectorXd& b) const;
  [[nodiscard]] Eigen::VectorXd dense_change(const Workspace& ws, double lambda,
                                             const std::vector<std::size_t>& pinned,
                                             const Eigen::VectorXd& b) const;

  const ParametricStructure& structure_;
  Eigen::Index n_, massive_, elastic_;
  SparseFactor factor_;
  std::vector<Entries> terms_, mass_slopes_;
  Entries mass_;
  std::vector<std::size_t> used_;                   // entries of `lower` that are not fill-in
  Columns stiffness_columns_, mass_columns_;        // entries that are nonzero for some θ
  std::vector<std::vector<std::size_t>> touching_;  // entries of `lower` in each row and column
  std::vector<SparseRow> motions_;                  // in the order of the factor
  std::vector<SparseRow> strains_;                  // in the order of the factor
  Eigen::MatrixXd start_;
};

}  // namespace wheeltap::fem

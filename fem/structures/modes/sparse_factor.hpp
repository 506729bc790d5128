// Simultaneous L D Lᵀ factorisation of several sparse symmetric matrices with one sparsity pattern.
#pragma once

#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/modes/sparse_kernel.hpp"

namespace wheeltap::fem {

/// The sparsity pattern of L for symmetric matrices with a given pattern, and the list of all
/// updates of a factorisation. The order of the unknowns keeps L sparse (approximate minimum
/// degree; Amestoy, Davis & Duff 1996). The object is immutable after construction.
///
/// `Values` and the vectors of `solve` hold W matrices or vectors together: entry i of matrix w has
/// index i W + w, so that one pass handles all W. All indices are computed at construction. For a
/// small structure, a search for indices would take more time than the arithmetic.
class SparseFactor {
 public:
  /// Throws std::invalid_argument if the matrix is not square. Only the pattern of the matrix is
  /// used.
  explicit SparseFactor(const Eigen::SparseMatrix<double>& pattern);
  // Not copyable, because `groups_` points into other members.
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;

  [[nodiscard]] std::size_t size() const { return to_.size(); }
  /// The number of entries of L below the diagonal.
  [[nodiscard]] std::size_t entries() const { return rows_.size(); }
  /// The number of multiplications of two entries in one factorisation.
  [[nodiscard]] std::size_t products() const { return products_; }
  /// The position of an unknown in the elimination order.
  [[nodiscard]] std::size_t position(std::size_t unknown) const { return to_[unknown]; }

  /// The diagonal, and the entries below the diagonal, column by column in the pattern of L. Before
  /// `factorise`, `Values` holds entries of A; afterwards, entries of D and L.
  struct Values {
    std::vector<double> diagonal, lower;
  };
  /// The index in `lower` of the entry of L in row max(a, b) and column min(a, b), for a != b.
  /// Throws std::out_of_range if L has no such entry.
  [[nodiscard]] std::size_t index(std::size_t a, std::size_t b) const;
  /// The row and the column of an entry of `lower`.
  [[nodiscard]] std::size_t row(std::size_t index) const { return rows_[index]; }
  [[nodiscard]] std::size_t column(std::size_t index) const { return columns_[index]; }

  /// Replaces W matrices A by their factors: D in `diagonal`, L in `lower`. There is no pivoting. A
  /// pivot of zero makes the values infinite or NaN; the caller checks `diagonal`.
  template <int W>
  void factorise(Values& values) const;
  /// Solves A x = b for W matrices with one right-hand side each, in place.
  template <int W>
  void solve(const Values& factor, double* x) const;
  /// Solves A x = b for R right-hand sides of one matrix, in place. Entry i of the right-hand side
  /// r is x[i R + r].
  template <int R>
  void solve_several(const Values& factor, double* x) const;

  /// Returns the sparsity pattern of L in the form that the kernels need.
  [[nodiscard]] detail::SparsePattern pattern() const;

 private:
  void group_columns();

  std::vector<std::size_t> to_;                // position of each unknown
  std::vector<std::size_t> start_;             // first entry of each column, and the end
  std::vector<std::uint32_t> rows_, columns_;  // the row and column of an entry
  std::size_t products_ = 0;
  std::vector<detail::ColumnGroup> groups_;  // groups that contain all columns
  std::vector<detail::Run> runs_;            // rows and targets of all groups
};

extern template void SparseFactor::factorise<1>(Values&) const;
extern template void SparseFactor::factorise<4>(Values&) const;
extern template void SparseFactor::solve<1>(const Values&, double*) const;
extern template void SparseFactor::solve<4>(const Values&, double*) const;
extern template void SparseFactor::solve_several<4>(const Values&, double*) const;

}  // namespace wheeltap::fem

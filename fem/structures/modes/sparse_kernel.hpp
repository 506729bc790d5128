// Loops over the entries of a sparse factor L D Lᵀ. Internal to SparseFactor.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wheeltap::fem::detail {

// The kernels read plain arrays. This header must not include library code: the linker could select
// a library function with AVX-512 instructions for every processor.

/// Largest number of columns that one step of a factorisation processes together.
inline constexpr std::size_t kMostColumns = 4;

/// A sequence of `length` consecutive positions that begins at `first`.
struct Run {
  std::uint32_t first, length;
};

/// Consecutive columns of L with entries in the same rows below the group. The entries of a column
/// group form a dense block.
struct ColumnGroup {
  std::uint32_t first, columns;  ///< the first column, and the number of columns
  std::uint32_t below;           ///< number of rows below the group
  const std::uint32_t* rows;     ///< these rows
  const Run* row_runs;           ///< the same rows as runs
  /// Positions in `lower` of the entries (a, b) of L, a > b, with a and b in `rows`, as sequences
  /// of type Run: all entries whose column b is the first number in `rows`, then those of the
  /// second, and so on.
  const Run* targets;
};

/// The pattern of L. The entries of a column are consecutive from start[column].
struct SparsePattern {
  std::size_t size;    ///< number of unknowns
  std::size_t groups;  ///< number of column groups
  const ColumnGroup* group;
  const std::size_t* start;
};

/// Functions compiled for one instruction set. The arrays interleave W = 1 or 4 matrices or
/// vectors: entry i of matrix w has the index i W + w.
struct SparseKernel {
  const char* name;
  void (*factorise)(const SparsePattern&, double* diagonal, double* lower);
  void (*factorise4)(const SparsePattern&, double* diagonal, double* lower);
  /// Solve A x = b for one matrix, with one right-hand side or with four.
  void (*solve)(const SparsePattern&, const double* diagonal, const double* lower, double* x);
  void (*solve_several4)(const SparsePattern&, const double* diagonal, const double* lower,
                         double* x);
  /// Solves A x = b for four matrices with one right-hand side each.
  void (*solve4)(const SparsePattern&, const double* diagonal, const double* lower, double* x);
};

extern const SparseKernel kBaselineSparse;
extern const SparseKernel kAvx2Sparse;
extern const SparseKernel kAvx512Sparse;

/// The kernels that this processor can run, largest SIMD width first; a null pointer ends the list.
[[nodiscard]] const SparseKernel* const* sparse_kernels();

}  // namespace wheeltap::fem::detail

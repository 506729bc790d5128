// Reading of sparse matrices from the MATLAB files and Matrix Market files of other programs.
#pragma once

#include <Eigen/SparseCore>

#include <filesystem>
#include <string>
#include <string_view>

#include "base/eigen.hpp"
#include "io/file_error.hpp"

namespace wheeltap::io {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Largest number of rows, and largest number of columns, of a matrix. A compressed sparse matrix
/// needs memory for each column, even for an empty column.
inline constexpr long long kMostMatrixRows = 10'000'000;
/// Largest number of stored entries of a matrix.
inline constexpr long long kMostMatrixEntries = 2'000'000'000;

/// Reads the matrix called `name` from a MATLAB file (v5 or v7.3, sparse or full, real), or from a
/// folder of Matrix Market files that contains NAME or NAME.mtx. Throws FileError (missing) if the
/// file or folder does not exist. Throws FileError (corrupt) if the file or folder does not contain
/// this matrix; the message lists the matrices that exist. Throws FileError (corrupt) if the matrix
/// is not real or has an index out of range. Also throws the same errors as `parse_matrix_market`.
[[nodiscard]] SparseMatrix read_sparse_matrix(const std::filesystem::path& path,
                                              const std::string& name);

/// Parses a Matrix Market text (Boisvert, Pozo & Remington 1996, NISTIR 5935):
///
///   %%MatrixMarket matrix coordinate|array real|integer|pattern general|symmetric
///   % comments
///   rows columns entries         (array: rows columns)
///   row column value             (from 1; pattern: no value, 1 is meant; array: a value, columns
///                                 first)
///
/// A symmetric matrix contains the diagonal and the entries below it. Entries with the same row and
/// column are summed. Throws FileError: foreign if the first line is missing; corrupt, with the
/// line number, for any other deviation from this format.
[[nodiscard]] SparseMatrix parse_matrix_market(std::string_view text,
                                               const std::filesystem::path& name);

}  // namespace wheeltap::io

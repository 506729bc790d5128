#include "io/matlab/sparse_matrix.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "io/bytes.hpp"
#include "io/tables/delimited_text.hpp"
#ifdef WHEELTAP_MATIO
#include <matio.h>

#include "io/matlab/matlab_elements.hpp"
#include "io/netcdf/hdf5_storage.hpp"
#include "io/netcdf/netcdf_library.hpp"
#include "io/read_apart.hpp"
#include "io/text/words.hpp"
#endif

namespace wheeltap::io {
namespace {

using Kind = FileError::Kind;
using Triplets = std::vector<Eigen::Triplet<double>>;

SparseMatrix assembled(long long rows, long long columns, const Triplets& entries) {
  SparseMatrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Iterates over the lines of a text, numbered from 1, and gives their words.
class Lines {
 public:
  Lines(std::string_view text, const std::filesystem::path& name) : text_(text), name_(name) {}

  /// The words of the next line that is neither empty nor a comment; empty at the end of the text.
  std::vector<std::string_view> next() {
    while (at_ < text_.size()) {
      const std::string_view line = take();
      if (!line.starts_with('%'))
        if (auto words = split(line); !words.empty()) return words;
    }
    return {};
  }
  std::vector<std::string_view> first() { return split(take()); }

  [[noreturn]] void fail(const std::string& reason, Kind kind = Kind::corrupt) const {
    throw FileError(kind, name_, {.line = line_}, reason);
  }

 private:
  std::string_view take() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    const std::string_view line = text_.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    return line;
  }
  static std::vector<std::string_view> split(std::string_view line) {
    static constexpr std::string_view kBlanks = " \t\r";
    std::vector<std::string_view> words;
    for (std::size_t from = line.find_first_not_of(kBlanks); from != std::string_view::npos;) {
      const std::size_t to = std::min(line.find_first_of(kBlanks, from), line.size());
      words.push_back(line.substr(from, to - from));
      from = line.find_first_not_of(kBlanks, to);
    }
    return words;
  }

  std::string_view text_;
  const std::filesystem::path& name_;
  std::size_t at_ = 0;
  std::ptrdiff_t line_ = 0;
};

/// Reads a whole number in [lowest, highest].
long long whole(const Lines& lines, std::string_view word, const std::string& what,
                long long lowest, long long highest) {
  const std::optional<double> x = parse_number(word);
  if (!x || std::trunc(*x) != *x || !(*x >= static_cast<double>(lowest)) ||
      !(*x <= static_cast<double>(highest)))
    lines.fail("the " + what + " '" + std::string(word) + "' must be a whole number from " +
               std::to_string(lowest) + " to " + std::to_string(highest));
  return static_cast<long long>(*x);
}

double real(const Lines& lines, std::string_view word) {
  const std::optional<double> x = parse_number(word);
  if (!x || !std::isfinite(*x)) lines.fail("'" + std::string(word) + "' must be a finite number");
  return *x;
}

#ifdef WHEELTAP_MATIO

template <class T>
std::vector<double> converted(const void* data, std::size_t count) {
  const auto* values = static_cast<const T*>(data);
  std::vector<double> out;
  out.reserve(count);
  for (std::size_t i = 0; i < count; ++i) out.push_back(static_cast<double>(values[i]));
  return out;
}

/// The elements of an array, in their stored order; std::nullopt if they are not numbers.
std::optional<std::vector<double>> numeric_values(const void* data, matio_types type,
                                                  std::size_t count) {
  if (count == 0) return std::vector<double>();
  if (data == nullptr) return {};
  if (type == MAT_T_DOUBLE) return converted<double>(data, count);
  if (type == MAT_T_SINGLE) return converted<float>(data, count);
  if (type == MAT_T_INT64) return converted<std::int64_t>(data, count);
  if (type == MAT_T_UINT64) return converted<std::uint64_t>(data, count);
  if (type == MAT_T_INT32) return converted<std::int32_t>(data, count);
  if (type == MAT_T_UINT32) return converted<std::uint32_t>(data, count);
  if (type == MAT_T_INT16) return converted<std::int16_t>(data, count);
  if (type == MAT_T_UINT16) return converted<std::uint16_t>(data, count);
  if (type == MAT_T_INT8) return converted<std::int8_t>(data, count);
  if (type == MAT_T_UINT8) return converted<std::uint8_t>(data, count);
  return {};
}

/// Context for reading one variable and for its error messages.
class MatlabMatrix {
 public:
  MatlabMatrix(const std::filesystem::path& path, const matvar_t& variable, const std::string& name)
      : path_(path), v_(variable), name_(name) {}

  [[nodiscard]] SparseMatrix read() const {
    if (v_.rank != 2) fail("has " + std::to_string(v_.rank) + " dimensions: must have 2");
    if (v_.isComplex) fail("is complex: must be real");
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}})
      if (v_.dims[axis] > static_cast<std::size_t>(kMostMatrixRows))
        fail("has " + std::to_string(v_.dims[axis]) + " rows or columns: too many");
    return v_.class_type == MAT_C_SPARSE ? sparse() : full();
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(Kind::corrupt, path_, "\"" + name_ + "\" " + reason);
  }
  void add(Triplets& entries, std::size_t row, std::size_t column, double value) const {
    if (!std::isfinite(value))
      fail("has an entry that is not finite at row " + std::to_string(row + 1) + ", column " +
           std::to_string(column + 1));
    if (value != 0.0) entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  }
  [[nodiscard]] SparseMatrix matrix(const Triplets& entries) const {
    return assembled(static_cast<long long>(v_.dims[0]), static_cast<long long>(v_.dims[1]),
                     entries);
  }

  /// Compressed columns: column j has the entries jc[j] … jc[j + 1] - 1; `ir` gives their rows.
  [[nodiscard]] SparseMatrix sparse() const {
    const auto* s = static_cast<const mat_sparse_t*>(v_.data);
    if (s == nullptr) fail("cannot be read");
    const std::size_t rows = v_.dims[0], columns = v_.dims[1];
    if (static_cast<std::size_t>(s->njc) != columns + 1 || s->jc == nullptr || s->jc[0] != 0)
      fail("is corrupt: its column starts do not match its size");
    const auto stored = static_cast<std::size_t>(s->jc[columns]);
    const auto values = numeric_values(s->data, v_.data_type, static_cast<std::size_t>(s->ndata));
    if (!values) fail("does not hold numbers");
    if (stored > values->size() || stored > static_cast<std::size_t>(s->nir))
      fail("is corrupt: it holds fewer entries than its columns have");
    Triplets entries;
    entries.reserve(stored);
    for (std::size_t j = 0; j < columns; ++j) {
      if (s->jc[j + 1] < s->jc[j]) fail("is corrupt: its column starts descend");
      if (static_cast<std::size_t>(s->jc[j + 1]) > stored)
        fail("is corrupt: its column starts do not match its size");
      for (auto k = static_cast<std::size_t>(s->jc[j]); k < static_cast<std::size_t>(s->jc[j + 1]);
           ++k) {
        const auto row = static_cast<std::size_t>(s->ir[k]);
        if (row >= rows)
          fail("is corrupt: row " + std::to_string(row + 1) + " of " + std::to_string(rows));
        add(entries, row, j, (*values)[k]);
      }
    }
    return matrix(entries);
  }

  [[nodiscard]] SparseMatrix full() const {
    const std::size_t rows = v_.dims[0], columns = v_.dims[1];
    const auto values = v_.data_size > 0
                            ? numeric_values(v_.data, v_.data_type,
                                             v_.nbytes / static_cast<std::size_t>(v_.data_size))
                            : std::nullopt;
    if (!values || v_.class_type == MAT_C_CHAR || v_.class_type == MAT_C_CELL ||
        v_.class_type == MAT_C_STRUCT)
      fail("is not a numeric matrix");
    if (values->size() != rows * columns) fail("is corrupt: its content does not match its size");
    Triplets entries;
    for (std::size_t j = 0; j < columns; ++j)
      for (std::size_t i = 0; i < rows; ++i) add(entries, i, j, (*values)[j * rows + i]);
    return matrix(entries);
  }

  const std::filesystem::path& path_;
  const matvar_t& v_;
  const std::string& name_;
};

SparseMatrix read_matrix_here(const std::filesystem::path& path, const std::string& name) {
  require_own_storage(path);
  const std::unique_ptr<mat_t, int (*)(mat_t*)> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY),
                                                     Mat_Close);
  if (!file) throw FileError(Kind::foreign, path, "is neither a MATLAB file nor a folder");
  (void)whole_matlab_elements(path);
  using Variable = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;
  // "s.K" is the field K of the structure s.
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('.', begin), name.size());
    parts.push_back(name.substr(begin, end - begin));
    begin = end + 1;
  }
  if (const Variable variable(Mat_VarRead(file.get(), parts[0].c_str()), Mat_VarFree); variable) {
    matvar_t* found = variable.get();
    for (std::size_t i = 1; found != nullptr && i < parts.size(); ++i)
      found = found->class_type == MAT_C_STRUCT
                  ? Mat_VarGetStructFieldByName(found, parts[i].c_str(), 0)
                  : nullptr;
    if (found != nullptr) return MatlabMatrix(path, *found, name).read();
  }
  std::string names;
  Mat_Rewind(file.get());
  for (;;) {
    const Variable variable(Mat_VarReadNextInfo(file.get()), Mat_VarFree);
    if (!variable) break;
    if (variable->name != nullptr)
      names += (names.empty() ? "" : ", ") + std::string(variable->name);
  }
  throw FileError(
      Kind::corrupt, path,
      "has no matrix \"" + name + "\"; its matrices: " + (names.empty() ? "none" : names));
}

/// A compressed matrix as bytes, for read_apart.
struct Carried {
  Eigen::Index rows = 0, columns = 0;
  std::vector<int> starts, inner;
  std::vector<double> values;
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, Carried>
void carry(Parcel& parcel, Of& matrix) {
  parcel(matrix.rows, matrix.columns, matrix.starts, matrix.inner, matrix.values);
}

SparseMatrix read_matlab_matrix(const std::filesystem::path& path, const std::string& name) {
  const NetcdfLock lock;  // a v7.3 file is an HDF5 file
  const auto carried = read_apart_as<Carried>(path, [&] {
    SparseMatrix m = read_matrix_here(path, name);
    m.makeCompressed();
    const auto n = m.nonZeros();
    return Carried{.rows = m.rows(),
                   .columns = m.cols(),
                   .starts = {m.outerIndexPtr(), m.outerIndexPtr() + m.outerSize() + 1},
                   .inner = {m.innerIndexPtr(), m.innerIndexPtr() + n},
                   .values = {m.valuePtr(), m.valuePtr() + n}};
  });
  return Eigen::Map<const SparseMatrix>(
      carried.rows, carried.columns, static_cast<Eigen::Index>(carried.values.size()),
      carried.starts.data(), carried.inner.data(), carried.values.data());
}

#else

SparseMatrix read_matlab_matrix(const std::filesystem::path& path, const std::string&) {
  throw FileError(Kind::missing, path, "this program was built without libmatio");
}

#endif

}  // namespace

SparseMatrix read_sparse_matrix(const std::filesystem::path& path, const std::string& name) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw FileError(Kind::missing, path, "no such file or folder");
  if (!std::filesystem::is_directory(path, ignored)) return read_matlab_matrix(path, name);
  for (const std::string& file : {name, name + ".mtx"}) {
    const std::filesystem::path one = path / file;
    if (std::filesystem::is_regular_file(one, ignored))
      return parse_matrix_market(read_bytes(one), one);
  }
  std::vector<std::string> there;
  for (const auto& entry : std::filesystem::directory_iterator(path, ignored))
    if (entry.path().extension() == ".mtx") there.push_back(entry.path().stem().string());
  std::ranges::sort(there);
  std::string names;
  for (const std::string& one : there) names += (names.empty() ? "" : ", ") + one;
  throw FileError(Kind::corrupt, path,
                  "has no file " + name + ".mtx; its files: " + (names.empty() ? "none" : names));
}

SparseMatrix parse_matrix_market(std::string_view text, const std::filesystem::path& name) {
  Lines lines(text, name);
  const auto banner = lines.first();
  if (banner.size() != 5 || lower(banner[0]) != "%%matrixmarket" || lower(banner[1]) != "matrix")
    lines.fail("is not a Matrix Market file: it must begin \"%%MatrixMarket matrix\"",
               Kind::foreign);
  const std::string format = lower(banner[2]), field = lower(banner[3]),
                    symmetry = lower(banner[4]);
  if (format != "coordinate" && format != "array")
    lines.fail("'" + format + "' must be coordinate or array");
  if (field != "real" && field != "integer" && !(field == "pattern" && format == "coordinate"))
    lines.fail("'" + field + "' must be real, integer or, in coordinate format, pattern");
  if (symmetry != "general" && symmetry != "symmetric")
    lines.fail("'" + symmetry + "' must be general or symmetric");
  const bool coordinates = format == "coordinate", symmetric = symmetry == "symmetric";

  const auto size = lines.next();
  if (size.size() != (coordinates ? 3U : 2U))
    lines.fail(coordinates ? "must be \"rows columns entries\"" : "must be \"rows columns\"");
  const long long rows = whole(lines, size[0], "number of rows", 1, kMostMatrixRows);
  const long long columns = whole(lines, size[1], "number of columns", 1, kMostMatrixRows);
  if (symmetric && rows != columns)
    lines.fail("a symmetric matrix must have as many rows as columns");
  Triplets entries;
  const auto add = [&](long long row, long long column, double value) {
    entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
    if (symmetric && row != column)
      entries.emplace_back(static_cast<int>(column), static_cast<int>(row), value);
  };
  const auto expect = [&](const std::vector<std::string_view>& words, std::size_t count,
                          long long read, long long wanted) {
    if (words.empty())
      lines.fail("ends after " + std::to_string(read) + " of " + std::to_string(wanted) +
                 " entries");
    if (words.size() != count)
      lines.fail("has " + std::to_string(words.size()) + " numbers: must have " +
                 std::to_string(count));
  };
  long long wanted = 0;
  if (coordinates) {
    wanted = whole(lines, size[2], "number of entries", 0, kMostMatrixEntries);
    const bool pattern = field == "pattern";
    for (long long k = 0; k < wanted; ++k) {
      const auto words = lines.next();
      expect(words, pattern ? 2 : 3, k, wanted);
      const long long row = whole(lines, words[0], "row", 1, rows) - 1;
      const long long column = whole(lines, words[1], "column", 1, columns) - 1;
      if (symmetric && row < column)
        lines.fail("lies above the diagonal: a symmetric file holds only entries on and below it");
      add(row, column, pattern ? 1.0 : real(lines, words[2]));
    }
  } else {
    if (rows > kMostMatrixEntries / columns) lines.fail("too many entries");
    wanted = symmetric ? rows * (rows + 1) / 2 : rows * columns;
    long long k = 0;
    for (long long j = 0; j < columns; ++j)
      for (long long i = symmetric ? j : 0; i < rows; ++i, ++k) {
        const auto words = lines.next();
        expect(words, 1, k, wanted);
        if (const double value = real(lines, words[0]); value != 0.0) add(i, j, value);
      }
  }
  if (!lines.next().empty())
    lines.fail("more entries than the " + std::to_string(wanted) + " declared");
  return assembled(rows, columns, entries);
}

}  // namespace wheeltap::io

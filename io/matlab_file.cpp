#include "io/matlab_file.hpp"

#ifdef WHEELTAP_MATIO
#include <matio.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "io/hdf5_storage.hpp"
#include "io/matlab_elements.hpp"
#include "io/netcdf_library.hpp"
#include "io/read_apart.hpp"
#include "io/text.hpp"
#endif

namespace wheeltap::io {

#ifdef WHEELTAP_MATIO

namespace {

template <class T>
std::vector<double> numbers(const void* data, std::size_t count) {
  const auto* from = static_cast<const T*>(data);
  std::vector<double> out;
  out.reserve(count);
  for (std::size_t i = 0; i < count; ++i) out.push_back(static_cast<double>(from[i]));
  return out;
}

/// Of an array of this class; empty for any that holds no numbers.
std::vector<double> numbers_of(matio_classes type, const void* data, std::size_t count) {
  if (data == nullptr) return {};
  switch (type) {
    case MAT_C_DOUBLE:
      return numbers<double>(data, count);
    case MAT_C_SINGLE:
      return numbers<float>(data, count);
    case MAT_C_INT64:
      return numbers<std::int64_t>(data, count);
    case MAT_C_INT32:
      return numbers<std::int32_t>(data, count);
    case MAT_C_INT16:
      return numbers<std::int16_t>(data, count);
    case MAT_C_INT8:
      return numbers<std::int8_t>(data, count);
    case MAT_C_UINT64:
      return numbers<std::uint64_t>(data, count);
    case MAT_C_UINT32:
      return numbers<std::uint32_t>(data, count);
    case MAT_C_UINT16:
      return numbers<std::uint16_t>(data, count);
    case MAT_C_UINT8:
      return numbers<std::uint8_t>(data, count);
    default:
      return {};
  }
}

/// A two-dimensional array of numbers, column by column.
struct Array {
  std::string name;
  std::size_t rows = 0, columns = 0;
  std::vector<double> values = {};

  [[nodiscard]] std::size_t longer() const { return std::max(rows, columns); }
};

/// Two-dimensional, and of numbers.
bool is_numeric(const matvar_t& variable) {
  return variable.rank == 2 && variable.class_type >= MAT_C_DOUBLE &&
         variable.class_type <= MAT_C_UINT64;
}

/// Deflate makes nothing smaller than this many times: what is announced beyond it is not there,
/// and libmatio would fill it with zeros.
constexpr double kMostInflated = 1032.0;
constexpr int kDeepest = 8;  // structures in structures

std::string class_name(const matvar_t& variable) {
  switch (variable.class_type) {
    case MAT_C_CELL:
      return "cell array";
    case MAT_C_STRUCT:
      return "structure array";
    case MAT_C_OBJECT:
    case MAT_C_OPAQUE:
      return "object";
    case MAT_C_CHAR:
      return "text";
    case MAT_C_SPARSE:
      return "sparse matrix";
    default:
      return std::to_string(variable.rank) + "-d array";
  }
}

bool is_structure(const matvar_t& variable) {
  return variable.class_type == MAT_C_STRUCT && variable.rank == 2 && variable.dims[0] == 1 &&
         variable.dims[1] == 1;
}

/// visit(name, variable) of a variable, or of the fields of a structure: "s.field".
template <class Visitor>
void for_each_array(const std::string& name, matvar_t& variable, int depth, const Visitor& visit) {
  if (!is_structure(variable) || depth == kDeepest) return visit(name, variable);
  const unsigned fields = Mat_VarGetNumberOfFields(&variable);
  char* const* names = Mat_VarGetStructFieldnames(&variable);
  for (unsigned i = 0; names != nullptr && i < fields; ++i)
    if (matvar_t* field = Mat_VarGetStructFieldByIndex(&variable, i, 0); field && names[i])
      for_each_array(name + "." + in_utf8(names[i]), *field, depth + 1, visit);
}

/// Adds it, of a complex one the real and the imaginary part. False where the values are not there.
bool take(const std::string& name, const matvar_t& variable, std::vector<Array>& arrays) {
  const std::size_t rows = variable.dims[0], columns = variable.dims[1], count = rows * columns;
  if (variable.data == nullptr || variable.data_size <= 0 ||
      variable.nbytes / static_cast<std::size_t>(variable.data_size) != count)
    return false;
  const auto add = [&](const char* part, const void* data) {
    Array out{name + part, rows, columns, numbers_of(variable.class_type, data, count)};
    const bool whole = out.values.size() == count;
    if (whole) arrays.push_back(std::move(out));
    return whole;
  };
  if (variable.isComplex == 0) return add("", variable.data);
  const auto& parts = *static_cast<const mat_complex_split_t*>(variable.data);
  return add(", real", parts.Re) && add(", imaginary", parts.Im);
}

/// The lengths of channels that the arrays may have, those that most numbers have first.
std::vector<std::size_t> lengths_of(const std::vector<Array>& arrays) {
  std::map<std::size_t, std::size_t> counts;
  for (const Array& a : arrays)
    if (a.values.size() > 1) counts[a.longer()] += a.values.size();
  std::vector<std::pair<std::size_t, std::size_t>> order;
  for (const auto& [length, count] : counts) order.emplace_back(count, length);
  std::ranges::sort(order, std::greater());
  std::vector<std::size_t> out;
  for (const auto& [count, length] : order) out.push_back(length);
  return out;
}

/// "X(:,2), real" of "X, real".
std::string indexed(const std::string& name, const std::string& index) {
  const std::size_t part = std::min(name.find(", "), name.size());
  return name.substr(0, part) + index + name.substr(part);
}

/// The channels of this length: a matrix's columns, or its rows where they have it.
void add_columns(const std::vector<Array>& arrays, std::size_t length, Columns& table) {
  for (const Array& a : arrays) {
    if (a.values.size() == 1 || (a.rows != length && a.columns != length)) continue;
    const bool down = a.rows == length;
    const std::size_t channels = down ? a.columns : a.rows;
    for (std::size_t c = 0; c < channels; ++c) {
      const std::string number = std::to_string(c + 1);
      const std::string name =
          channels == 1 ? a.name
                        : indexed(a.name, down ? "(:," + number + ")" : "(" + number + ",:)");
      Column column{.header = name, .name = name};
      column.values.reserve(length);
      for (std::size_t i = 0; i < length; ++i)
        column.values.push_back(a.values[down ? c * a.rows + i : i * a.rows + c]);
      table.columns.push_back(std::move(column));
    }
  }
}

/// An array of another length, and how a case names it.
std::string other_length(const Array& array) {
  Columns own;
  add_columns({array}, array.longer(), own);
  std::string names = "'" + own.columns.front().name + "'";
  if (own.columns.size() > 1) names += " to '" + own.columns.back().name + "'";
  return array.name + " (" + std::to_string(array.rows) + " x " + std::to_string(array.columns) +
         ", of another length: a case names " + names + ")";
}

/// The columns of the length that most numbers have; or of another, where more of those that are
/// wanted are of it.
void choose_columns(const std::vector<Array>& arrays, const Wanted& wanted, Columns& table) {
  std::size_t best = 0;
  std::optional<std::vector<Column>> chosen;
  for (const std::size_t length : lengths_of(arrays)) {
    table.columns.clear();
    add_columns(arrays, length, table);
    std::size_t count = 0;
    for (std::size_t c = 0; wanted && c < table.columns.size(); ++c) count += wanted(table, c);
    const bool all = count == table.columns.size();
    if (!chosen || count > best) {
      chosen = std::move(table.columns);
      best = count;
    }
    if (!wanted || all) break;
  }
  if (chosen) table.columns = std::move(*chosen);
}

Columns read_here(const std::filesystem::path& path, const Wanted& wanted) {
  require_own_storage(path);
  const std::unique_ptr<mat_t, int (*)(mat_t*)> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY),
                                                     Mat_Close);
  if (!file)
    throw FileError(FileError::Kind::missing, path,
                    "cannot be read as a MATLAB file: there is none, or it is damaged");
  Columns table{.file = path.string()};
  std::error_code ignored;
  const double most =
      kMostInflated * static_cast<double>(std::filesystem::file_size(path, ignored));
  constexpr std::size_t kMostNamed = 6;
  std::vector<Array> arrays;
  std::vector<std::string> others;  // what is there and cannot be taken
  const std::size_t stored = whole_matlab_elements(path);
  std::size_t seen = 0;
  for (;;) {
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable(Mat_VarReadNextInfo(file.get()),
                                                                  Mat_VarFree);
    if (!variable) break;
    ++seen;
    if (variable->name == nullptr) continue;
    const std::string name = in_utf8(variable->name);
    // Array by array: what else a structure holds is not read.
    for_each_array(name, *variable, 0, [&](const std::string& of, matvar_t& array) {
      if (!is_numeric(array)) {
        others.push_back(of + " (" + class_name(array) + ")");
        return;
      }
      if (static_cast<double>(array.dims[0]) * static_cast<double>(array.dims[1]) > most)
        throw FileError(FileError::Kind::corrupt, path,
                        of + " announces " + std::to_string(array.dims[0]) + " x " +
                            std::to_string(array.dims[1]) +
                            " numbers, more than a file of its size can hold");
      if (array.dims[0] == 0 || array.dims[1] == 0) return;
      if (Mat_VarReadDataAll(file.get(), &array) != 0 || !take(of, array, arrays))
        throw FileError(FileError::Kind::corrupt, path, of + " cannot be read: it is damaged");
    });
  }
  // After what it cannot read libmatio reads no more, and does not say so.
  if (seen < stored)
    throw FileError(FileError::Kind::corrupt, path,
                    "is damaged: of its " + std::to_string(stored) + " variables only the first " +
                        std::to_string(seen) + " can be read");
  for (const Array& a : arrays)
    if (a.values.size() == 1) table.scalars[a.name] = a.values[0];
  choose_columns(arrays, wanted, table);
  table.others = others;
  for (const Array& a : arrays)
    if (a.values.size() > 1 && a.rows != table.columns.front().values.size() &&
        a.columns != table.columns.front().values.size())
      table.others.push_back(other_length(a));
  if (table.columns.empty()) {
    std::string there;
    for (std::size_t i = 0; i < std::min(others.size(), kMostNamed); ++i)
      there += (i == 0 ? ": there are " : ", ") + others[i];
    if (others.size() > kMostNamed)
      there += " and " + std::to_string(others.size() - kMostNamed) + " more";
    throw FileError(FileError::Kind::corrupt, path,
                    seen > 0 ? "no arrays of numbers" + there
                             : "no variables: it is empty, cut off, or not written by MATLAB");
  }
  return table;
}

}  // namespace

Columns read_matlab_file(const std::filesystem::path& path, const Wanted& wanted) {
  const NetcdfLock lock;  // a v7.3 file is an HDF5 one
  auto table = read_apart_as<Columns>(path, [&] { return read_here(path, wanted); });
  for (std::size_t c = 0; wanted && c < table.columns.size(); ++c)
    if (!wanted(table, c)) table.columns[c].values = {};
  return table;
}

#else

Columns read_matlab_file(const std::filesystem::path& path, const Wanted&) {
  throw FileError(FileError::Kind::missing, path, "this program was built without libmatio");
}

#endif

}  // namespace wheeltap::io

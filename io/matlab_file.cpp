#include "io/matlab_file.hpp"

#ifdef WHEELTAP_MATIO
#include <matio.h>

#include <algorithm>
#include <cstdint>
#include <memory>
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
void append(const matvar_t& variable, std::vector<double>& out) {
  const auto* data = static_cast<const T*>(variable.data);
  const std::size_t count = variable.nbytes / static_cast<std::size_t>(variable.data_size);
  out.reserve(count);
  for (std::size_t i = 0; i < count; ++i) out.push_back(static_cast<double>(data[i]));
}

/// The values of a real numeric array, column by column; empty for anything else.
std::vector<double> real_values(const matvar_t& variable) {
  std::vector<double> values;
  if (variable.isComplex || variable.rank != 2 || variable.data == nullptr) return values;
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      append<double>(variable, values);
      break;
    case MAT_C_SINGLE:
      append<float>(variable, values);
      break;
    case MAT_C_INT64:
      append<std::int64_t>(variable, values);
      break;
    case MAT_C_INT32:
      append<std::int32_t>(variable, values);
      break;
    case MAT_C_INT16:
      append<std::int16_t>(variable, values);
      break;
    case MAT_C_INT8:
      append<std::int8_t>(variable, values);
      break;
    case MAT_C_UINT64:
      append<std::uint64_t>(variable, values);
      break;
    case MAT_C_UINT32:
      append<std::uint32_t>(variable, values);
      break;
    case MAT_C_UINT16:
      append<std::uint16_t>(variable, values);
      break;
    case MAT_C_UINT8:
      append<std::uint8_t>(variable, values);
      break;
    default:
      break;
  }
  return values;
}

/// Real, two-dimensional, and of numbers.
bool is_numeric(const matvar_t& variable) {
  return variable.rank == 2 && variable.isComplex == 0 && variable.class_type >= MAT_C_DOUBLE &&
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
      return variable.isComplex != 0 ? "complex" : std::to_string(variable.rank) + "-d array";
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

/// False where the values are not there.
bool take(const std::string& name, const matvar_t& variable, Columns& table) {
  const std::vector<double> values = real_values(variable);
  const std::size_t rows = variable.dims[0], columns = variable.dims[1];
  if (values.empty() || rows * columns != values.size()) return false;
  if (values.size() == 1) {
    table.scalars[name] = values[0];
    return true;
  }
  const bool is_vector = rows == 1 || columns == 1;
  const std::size_t length = is_vector ? values.size() : rows;
  for (std::size_t j = 0; j < (is_vector ? 1 : columns); ++j) {
    const std::string header = is_vector ? name : name + "(:," + std::to_string(j + 1) + ")";
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(j * length);
    table.columns.push_back({.header = header,
                             .name = header,
                             .values = {begin, begin + static_cast<std::ptrdiff_t>(length)}});
  }
  return true;
}

Columns read_here(const std::filesystem::path& path) {
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
      if (Mat_VarReadDataAll(file.get(), &array) != 0 || !take(of, array, table))
        throw FileError(FileError::Kind::corrupt, path, of + " cannot be read: it is damaged");
    });
  }
  // After what it cannot read libmatio reads no more, and does not say so.
  if (seen < stored)
    throw FileError(FileError::Kind::corrupt, path,
                    "is damaged: of its " + std::to_string(stored) + " variables only the first " +
                        std::to_string(seen) + " can be read");
  const int longest = table.rows();
  std::erase_if(table.columns, [&](const Column& c) {
    return c.values.size() != static_cast<std::size_t>(longest);
  });
  if (table.columns.empty()) {
    std::string there;
    for (std::size_t i = 0; i < std::min(others.size(), kMostNamed); ++i)
      there += (i == 0 ? ": there are " : ", ") + others[i];
    if (others.size() > kMostNamed)
      there += " and " + std::to_string(others.size() - kMostNamed) + " more";
    throw FileError(FileError::Kind::corrupt, path,
                    seen > 0 ? "no real numeric arrays" + there
                             : "no variables: it is empty, cut off, or not written by MATLAB");
  }
  return table;
}

}  // namespace

Columns read_matlab_file(const std::filesystem::path& path, const Wanted& wanted) {
  const NetcdfLock lock;  // a v7.3 file is an HDF5 one
  auto table = read_apart_as<Columns>(path, [&] { return read_here(path); });
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

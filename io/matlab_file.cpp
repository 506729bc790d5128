#include "io/matlab_file.hpp"

#ifdef WHEELTAP_MATIO
#include <matio.h>

#include <algorithm>
#include <cstdint>
#include <memory>
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

}  // namespace

Columns read_matlab_file(const std::filesystem::path& path, const Wanted& wanted) {
  const std::unique_ptr<mat_t, int (*)(mat_t*)> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY),
                                                     Mat_Close);
  if (!file) throw FileError(FileError::Kind::missing, path, "no such file, or no MATLAB file");
  Columns table{.file = path.string()};
  std::error_code ignored;
  const double most =
      kMostInflated * static_cast<double>(std::filesystem::file_size(path, ignored));
  for (;;) {
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable(Mat_VarReadNextInfo(file.get()),
                                                                  Mat_VarFree);
    if (!variable) break;
    if (!is_numeric(*variable)) continue;
    if (static_cast<double>(variable->dims[0]) * static_cast<double>(variable->dims[1]) > most)
      throw FileError(FileError::Kind::corrupt, path,
                      "announces " + std::to_string(variable->dims[0]) + " x " +
                          std::to_string(variable->dims[1]) +
                          " numbers, more than a file of its size can hold");
    if (Mat_VarReadDataAll(file.get(), variable.get()) != 0) continue;
    const std::vector<double> values = real_values(*variable);
    if (values.empty() || variable->name == nullptr) continue;
    const std::string name = variable->name;
    const std::size_t rows = variable->dims[0], columns = variable->dims[1];
    if (rows * columns != values.size()) continue;
    if (values.size() == 1) {
      table.scalars[name] = values[0];
      continue;
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
  }
  const int longest = table.rows();
  std::erase_if(table.columns, [&](const Column& c) {
    return c.values.size() != static_cast<std::size_t>(longest);
  });
  if (table.columns.empty())
    throw FileError(FileError::Kind::corrupt, path, "no real numeric arrays");
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

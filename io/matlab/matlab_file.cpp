#include "io/matlab/matlab_file.hpp"

#ifdef WHEELTAP_MATIO
#include <matio.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>

#include "io/matlab/matlab_elements.hpp"
#include "io/netcdf/hdf5_storage.hpp"
#include "io/netcdf/netcdf_library.hpp"
#include "io/read_apart.hpp"
#include "io/text/text.hpp"
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

/// Reads an array of the class `type`; empty for classes without numbers.
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

/// A numeric array, stored column by column.
struct Array {
  ArrayShape shape;
  std::vector<double> values = {};
};

constexpr int kMostDimensions = 4;

bool is_numeric(const matvar_t& variable) {
  return variable.rank >= 2 && variable.rank <= kMostDimensions &&
         variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64;
}

/// The largest compression ratio of deflate. If a file states a larger array, the data do not
/// exist, and libmatio would fill the array with zeros.
constexpr double kMostInflated = 1032.0;
constexpr int kDeepest = 8;               // levels of nested structures
constexpr std::size_t kMostCells = 1000;  // elements of a cell array or structure array

std::string class_name(const matvar_t& variable) {
  switch (variable.class_type) {
    case MAT_C_CELL:
      return "cell array";
    case MAT_C_STRUCT:
      return "structure";
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

std::size_t elements_of(const matvar_t& variable) {
  std::size_t count = variable.rank > 0 ? 1 : 0;
  for (int i = 0; i < variable.rank; ++i) {
    if (variable.dims[i] > kMostCells) return kMostCells + 1;
    count *= variable.dims[i];
    if (count > kMostCells) return kMostCells + 1;
  }
  return count;
}

/// Calls visit(name, variable) for a variable, for fields of structures ("s.field", "run(2).acc")
/// and for elements of cell arrays ("runs{2}").
template <class Visitor>
void for_each_array(const std::string& name, matvar_t& variable, int depth, const Visitor& visit) {
  const bool structure = variable.class_type == MAT_C_STRUCT;
  const std::size_t count = elements_of(variable);
  if ((!structure && variable.class_type != MAT_C_CELL) || depth == kDeepest ||
      count > kMostCells || variable.data == nullptr)
    return visit(name, variable);
  const unsigned fields = structure ? Mat_VarGetNumberOfFields(&variable) : 0;
  char* const* names = structure ? Mat_VarGetStructFieldnames(&variable) : nullptr;
  for (std::size_t k = 0; k < count; ++k) {
    const std::string number = std::to_string(k + 1);
    if (!structure) {
      if (matvar_t* cell = Mat_VarGetCell(&variable, static_cast<int>(k)))
        for_each_array(name + "{" + number + "}", *cell, depth + 1, visit);
      continue;
    }
    const std::string one = count == 1 ? name : name + "(" + number + ")";
    for (unsigned i = 0; names != nullptr && i < fields; ++i)
      if (matvar_t* field = Mat_VarGetStructFieldByIndex(&variable, i, k); field && names[i])
        for_each_array(one + "." + in_utf8(names[i]), *field, depth + 1, visit);
  }
}

ArrayShape shape_of(const std::string& name, const matvar_t& variable) {
  return {.name = name, .shape = {variable.dims, variable.dims + variable.rank}};
}

/// Adds an array; a complex array as real and imaginary part. Returns false if it has no values.
bool take(const std::string& name, const matvar_t& variable, std::vector<Array>& arrays) {
  const std::size_t count = shape_of(name, variable).size();
  if (variable.data == nullptr || variable.data_size <= 0 ||
      variable.nbytes / static_cast<std::size_t>(variable.data_size) != count)
    return false;
  const auto add = [&](const char* part, const void* data) {
    Array out{shape_of(name + part, variable), numbers_of(variable.class_type, data, count)};
    const bool whole = out.values.size() == count;
    if (whole) arrays.push_back(std::move(out));
    return whole;
  };
  if (variable.isComplex == 0) return add("", variable.data);
  const auto& parts = *static_cast<const mat_complex_split_t*>(variable.data);
  return add(", real", parts.Re) && add(", imaginary", parts.Im);
}

/// Returns the kind of an object, and advice how to save its numbers in a readable form.
std::string object_in_words(const std::string& name, const std::string& type) {
  std::string remedy = "save its numbers as arrays";
  if (type == "table" || type == "timetable")
    remedy = "save it as a structure, " + name +
             (type == "table" ? " = table2struct(" + name
                              : " = table2struct(timetable2table(" + name + ")") +
             ", 'ToScalar', true)";
  if (type == "datetime") remedy = "save seconds, " + name + " = posixtime(" + name + ")";
  if (type == "duration") remedy = "save seconds, " + name + " = seconds(" + name + ")";
  if (type == "string" || type == "categorical") remedy = "it holds text";
  return name + " (" + type + ": " + remedy + ")";
}

Columns read_here(const std::filesystem::path& path, const Wanted& wanted,
                  const ArrayLayout& layout) {
  require_own_storage(path);
  const std::unique_ptr<mat_t, int (*)(mat_t*)> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY),
                                                     Mat_Close);
  if (!file)
    throw FileError(FileError::Kind::missing, path,
                    "cannot be read as a MATLAB file: it is missing, corrupt or of another format");
  Columns table{.file = path.string()};
  std::error_code ignored;
  const double most =
      kMostInflated * static_cast<double>(std::filesystem::file_size(path, ignored));
  constexpr std::size_t kMostNamed = 6;
  std::vector<Array> arrays;
  std::vector<std::string> others;  // variables that cannot be read
  const MatlabElements stored = whole_matlab_elements(path);
  for (const MatlabObject& object : stored.objects)
    others.push_back(object_in_words(in_utf8(object.name), in_utf8(object.class_name)));
  std::size_t seen = 0;
  for (;;) {
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable(Mat_VarReadNextInfo(file.get()),
                                                                  Mat_VarFree);
    if (!variable) break;
    ++seen;
    if (variable->name == nullptr) continue;
    const std::string name = in_utf8(variable->name);
    // Read array by array, so that other members of a structure are not read.
    for_each_array(name, *variable, 0, [&](const std::string& of, matvar_t& array) {
      if (!is_numeric(array)) {
        others.push_back(of + " (" + class_name(array) + ")");
        return;
      }
      const ArrayShape shape = shape_of(of, array);
      if (static_cast<double>(shape.size()) > most)
        throw FileError(FileError::Kind::corrupt, path,
                        of + " declares " + shape.shape_in_words() +
                            " numbers, more than a file of its size can hold");
      if (shape.size() == 0) return;
      if (Mat_VarReadDataAll(file.get(), &array) != 0 || !take(of, array, arrays))
        throw FileError(FileError::Kind::corrupt, path,
                        of + " cannot be read: the file is corrupt");
    });
  }
  // libmatio silently stops at the first unreadable variable.
  if (seen < stored.count && stored.objects.empty())
    throw FileError(FileError::Kind::corrupt, path,
                    "is corrupt: of its " + std::to_string(stored.count) +
                        " variables only the first " + std::to_string(seen) + " can be read");
  std::vector<ArrayShape> shapes;
  for (const Array& a : arrays) {
    if (a.values.size() == 1) table.scalars[a.shape.name] = a.values[0];
    shapes.push_back(a.shape);
  }
  table.others = others;
  const ChosenColumns chosen = choose_columns(shapes, layout, wanted, table);
  fill_columns(
      chosen, wanted, [&](std::size_t i) { return arrays[i].values; }, table);
  if (table.columns.empty()) {
    std::string there;
    for (std::size_t i = 0; i < std::min(others.size(), kMostNamed); ++i)
      there += (i == 0 ? "; the file has " : ", ") + others[i];
    if (others.size() > kMostNamed)
      there += " and " + std::to_string(others.size() - kMostNamed) + " more";
    throw FileError(FileError::Kind::corrupt, path,
                    seen > 0 ? "no arrays of numbers" + there
                             : "no variables: it is empty, truncated, or not written by MATLAB");
  }
  return table;
}

}  // namespace

Columns read_matlab_file(const std::filesystem::path& path, const Wanted& wanted,
                         const ArrayLayout& layout) {
  const NetcdfLock lock;  // a v7.3 file is an HDF5 file
  return read_apart_as<Columns>(path, [&] { return read_here(path, wanted, layout); });
}

#else

Columns read_matlab_file(const std::filesystem::path& path, const Wanted&, const ArrayLayout&) {
  throw FileError(FileError::Kind::missing, path, "this program was built without libmatio");
}

#endif

}  // namespace wheeltap::io

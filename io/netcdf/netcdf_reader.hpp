// Reading of NetCDF-4 files with groups, with one call per variable.
#pragma once

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/file_error.hpp"
#include "io/netcdf/hdf5_storage.hpp"
#include "io/netcdf/netcdf_library.hpp"

namespace wheeltap::io {

/// The values of a variable as numbers; the index of the last dimension varies fastest.
struct NetcdfArray {
  std::vector<std::size_t> shape;
  std::vector<double> values;
  /// Number of values per combination of indices of the first `outer` dimensions.
  [[nodiscard]] std::size_t inner(std::size_t outer = 2) const {
    std::size_t n = 1;
    for (std::size_t i = outer; i < shape.size(); ++i) n *= shape[i];
    return n;
  }
};

/// A reader of one NetCDF-4 file. Throws FileError (missing) if the file does not exist. Throws
/// FileError (corrupt) if the file is truncated or otherwise corrupt, is not a NetCDF-4 file, or
/// stores its numbers in other files (require_own_storage). Throws FileError (foreign) if a
/// requested group or variable does not exist. The message of FileError (foreign) states the
/// expected kind of file as `what`: "a posterior of wheeltap".
class NetcdfReader {
 public:
  explicit NetcdfReader(const std::filesystem::path& path, std::string what = "the file expected")
      : path_(path), what_(std::move(what)) {
    if (!std::filesystem::exists(path))
      throw FileError(FileError::Kind::missing, path, "no such file");
    require_own_storage(path);
    opened(nc_open(path.c_str(), NC_NOWRITE, &file_.id));
  }
  /// Reads a file from memory; messages use `name` for the file.
  NetcdfReader(std::string bytes, const std::filesystem::path& name,
               std::string what = "the file expected")
      : path_(name), what_(std::move(what)), bytes_(std::move(bytes)) {
    require_own_storage(bytes_, path_);
    opened(nc_open_mem(path_.c_str(), NC_NOWRITE, bytes_.size(), bytes_.data(), &file_.id));
  }

  [[nodiscard]] int root() const { return file_.id; }
  [[nodiscard]] std::optional<int> group(const char* name) const {
    int id = 0;
    if (nc_inq_grp_ncid(file_.id, name, &id) != NC_NOERR) return {};
    return id;
  }
  [[nodiscard]] int required_group(const char* name) const {
    const auto id = group(name);
    if (!id) foreign(std::string("has no group \"") + name + "\"");
    return *id;
  }
  [[nodiscard]] std::vector<std::string> variables(int group) const {
    int n = 0;
    check(nc_inq_varids(group, &n, nullptr));
    std::vector<int> ids(static_cast<std::size_t>(n));
    check(nc_inq_varids(group, &n, ids.data()));
    std::vector<std::string> names;
    for (const int id : ids) {
      char name[NC_MAX_NAME + 1];
      check(nc_inq_varname(group, id, name));
      names.emplace_back(name);
    }
    return names;
  }
  [[nodiscard]] bool has(int group, const std::string& name) const {
    int id = 0;
    return nc_inq_varid(group, name.c_str(), &id) == NC_NOERR;
  }
  [[nodiscard]] NetcdfArray read(int group, const std::string& name) const {
    const int id = id_of(group, name);
    NetcdfArray out{.shape = shape_of(group, id), .values = {}};
    std::size_t size = 1;
    for (const std::size_t length : out.shape) size *= length;
    out.values.resize(size);
    check(nc_get_var_double(group, id, out.values.data()));
    return out;
  }
  /// Reads the values of a variable at every `step`-th index of the second dimension. This function
  /// needs memory for the result, and for all values at one index of the first dimension.
  [[nodiscard]] NetcdfArray read_every(int group, const std::string& name, std::size_t step) const {
    const int id = id_of(group, name);
    NetcdfArray out{.shape = shape_of(group, id), .values = {}};
    if (step <= 1 || out.shape.size() < 2) return read(group, name);
    std::vector<std::size_t> start(out.shape.size(), 0), count = out.shape;
    count[0] = 1;
    const std::size_t rows = out.shape[0], inner = out.inner();
    std::vector<double> row(out.shape[1] * inner);
    out.shape[1] = (out.shape[1] + step - 1) / step;
    out.values.reserve(rows * out.shape[1] * inner);
    for (start[0] = 0; start[0] < rows; ++start[0]) {
      check(nc_get_vara_double(group, id, start.data(), count.data(), row.data()));
      for (std::size_t i = 0; i < row.size(); i += step * inner)
        out.values.insert(out.values.end(), row.begin() + static_cast<std::ptrdiff_t>(i),
                          row.begin() + static_cast<std::ptrdiff_t>(i + inner));
    }
    return out;
  }
  [[nodiscard]] std::vector<std::size_t> shape(int group, const std::string& name) const {
    return shape_of(group, id_of(group, name));
  }
  /// Reads the values at index `which` of the last dimension, for all indices of the other
  /// dimensions.
  [[nodiscard]] std::vector<double> read_last(int group, const std::string& name,
                                              std::size_t which) const {
    const int id = id_of(group, name);
    std::vector<std::size_t> count = shape_of(group, id), start(count.size(), 0);
    if (count.empty() || which >= count.back()) foreign("has a \"" + name + "\" of another shape");
    start.back() = which;
    count.back() = 1;
    std::size_t size = 1;
    for (const std::size_t n : count) size *= n;
    std::vector<double> out(size);
    check(nc_get_vara_double(group, id, start.data(), count.data(), out.data()));
    return out;
  }
  [[nodiscard]] nc_type type(int group, const std::string& name) const {
    int id = 0;
    nc_type type = NC_NAT;
    if (nc_inq_varid(group, name.c_str(), &id) != NC_NOERR)
      foreign("has no variable \"" + name + "\"");
    check(nc_inq_vartype(group, id, &type));
    return type;
  }
  /// Reads a variable that NetcdfWriter::column has written; the result is empty if the variable
  /// does not exist. Throws FileError (foreign) for data of another type.
  template <class Sequence>
  [[nodiscard]] Sequence column(int group, const std::string& name) const {
    Sequence out;
    int id = 0, rank = 0, dimension = 0;
    if (nc_inq_varid(group, name.c_str(), &id) != NC_NOERR) return out;
    check(nc_inq_varndims(group, id, &rank));
    if (rank != 1 || type(group, name) != kNetcdfType<typename Sequence::value_type>)
      foreign("has another \"" + name + "\"");
    check(nc_inq_vardimid(group, id, &dimension));
    std::size_t length = 0;
    check(nc_inq_dimlen(group, dimension, &length));
    out.resize(length);
    check(nc_get_var(group, id, out.data()));
    return out;
  }
  /// Returns a global attribute, or an empty string if the attribute does not exist.
  [[nodiscard]] std::string text(const char* attribute) const {
    return attribute_of(file_.id, NC_GLOBAL, attribute);
  }
  /// Returns an attribute of a variable, or an empty string if the attribute does not exist.
  [[nodiscard]] std::string text(int group, const std::string& name, const char* attribute) const {
    int id = 0;
    if (nc_inq_varid(group, name.c_str(), &id) != NC_NOERR) return {};
    return attribute_of(group, id, attribute);
  }
  [[noreturn]] void foreign(const std::string& why) const {
    throw FileError(FileError::Kind::foreign, path_, why + ": not " + what_);
  }

 private:
  void opened(int status) {
    if (status != NC_NOERR)
      throw FileError(FileError::Kind::corrupt, path_,
                      std::string("is truncated or not a NetCDF-4 file: ") + nc_strerror(status));
    file_.opened();
  }
  [[nodiscard]] int id_of(int group, const std::string& name) const {
    int id = 0;
    if (nc_inq_varid(group, name.c_str(), &id) != NC_NOERR)
      foreign("has no variable \"" + name + "\"");
    return id;
  }
  [[nodiscard]] std::vector<std::size_t> shape_of(int group, int id) const {
    int rank = 0;
    check(nc_inq_varndims(group, id, &rank));
    std::vector<int> dimensions(static_cast<std::size_t>(rank));
    check(nc_inq_vardimid(group, id, dimensions.data()));
    std::vector<std::size_t> shape;
    for (const int d : dimensions) check(nc_inq_dimlen(group, d, &shape.emplace_back()));
    return shape;
  }
  void check(int status) const {
    if (status == NC_NOERR) return;
    throw FileError(FileError::Kind::corrupt, path_,
                    std::string("cannot be read, truncated or corrupt: ") + nc_strerror(status));
  }
  [[nodiscard]] static std::string attribute_of(int group, int variable, const char* attribute) {
    std::size_t length = 0;
    nc_type type = NC_NAT;
    if (nc_inq_att(group, variable, attribute, &type, &length) != NC_NOERR || type != NC_CHAR)
      return {};
    std::string value(length, '\0');
    return nc_get_att_text(group, variable, attribute, value.data()) == NC_NOERR ? value : "";
  }

  std::filesystem::path path_;
  std::string what_;
  std::string bytes_;  // declared before the handle, which must be closed first
  NetcdfHandle file_;
};

}  // namespace wheeltap::io

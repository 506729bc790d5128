// Writing of NetCDF-4 files with groups, with one call per variable.
#pragma once

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/date_of_files.hpp"
#include "io/file_error.hpp"
#include "io/netcdf/netcdf_library.hpp"

namespace wheeltap::io {

/// Writes a NetCDF-4 file in memory or on the disk (write_netcdf.hpp decides which). Messages use
/// `name` for the file. All functions throw io::FileError (unwritable).
class NetcdfWriter {
 public:
  explicit NetcdfWriter(const std::filesystem::path& name) : path_(name) {
    check(file_.create_in_memory());
  }
  NetcdfWriter(const std::filesystem::path& name, const std::filesystem::path& file) : path_(name) {
    check(file_.create(file.string()));
  }
  /// Closes the file in memory and returns its bytes.
  [[nodiscard]] std::string close() {
    std::string bytes;
    check(file_.close_in_memory(bytes));
    return bytes;
  }
  /// Closes the file on the disk.
  void finish() { check(file_.close()); }

  void check(int status) const {
    if (status == NC_NOERR) return;
    throw io::FileError(io::FileError::Kind::unwritable, path_, nc_strerror(status));
  }
  /// Writes the identifier of the run, and the attributes of ArviZ for program, version and
  /// creation time. Also throws the exceptions that date_of_files throws.
  void about(const std::string& version, const std::string& run) const {
    text(file_.id, NC_GLOBAL, "inference_library", "wheeltap");
    text(file_.id, NC_GLOBAL, "inference_library_version", version);
    text(file_.id, NC_GLOBAL, "run_id", run);
    const std::time_t t = date_of_files();
    std::tm utc{};
    gmtime_r(&t, &utc);
    char created[32];
    std::strftime(created, sizeof created, "%Y-%m-%dT%H:%M:%SZ", &utc);
    text(file_.id, NC_GLOBAL, "created_at", created);
  }
  [[nodiscard]] int root() const { return file_.id; }
  [[nodiscard]] int group(const char* name) const {
    int id = 0;
    check(nc_def_grp(file_.id, name, &id));
    return id;
  }
  void text(int group, int variable, const char* name, const std::string& value) const {
    check(nc_put_att_text(group, variable, name, value.size(), value.c_str()));
  }
  // Defines a dimension and its coordinate variable with the values `first`, `first` + 1, …
  [[nodiscard]] int dimension(int group, const char* name, std::size_t size, int first) const {
    int id = 0, variable = 0;
    check(nc_def_dim(group, name, size, &id));
    check(nc_def_var(group, name, NC_INT, 1, &id, &variable));
    std::vector<int> values(size);
    for (std::size_t i = 0; i < size; ++i) values[i] = first + static_cast<int>(i);
    check(nc_put_var_int(group, variable, values.data()));
    return id;
  }
  [[nodiscard]] int variable(int group, const std::string& name, nc_type type,
                             const std::vector<int>& dimensions) const {
    int id = 0;
    check(nc_def_var(group, name.c_str(), type, static_cast<int>(dimensions.size()),
                     dimensions.data(), &id));
    if (dimensions.size() > 1) check(nc_def_var_deflate(group, id, 1, 1, 1));
    return id;
  }
  int put(int group, const std::string& name, const std::vector<int>& dimensions,
          const std::vector<double>& values) const {
    const int id = variable(group, name, NC_DOUBLE, dimensions);
    check(nc_put_var_double(group, id, values.data()));
    return id;
  }
  int put(int group, const std::string& name, const std::vector<int>& dimensions,
          const std::vector<float>& values) const {
    const int id = variable(group, name, NC_FLOAT, dimensions);
    check(nc_put_var_float(group, id, values.data()));
    return id;
  }
  int put(int group, const std::string& name, const std::vector<int>& dimensions,
          const std::vector<int>& values, nc_type type = NC_INT) const {
    const int id = variable(group, name, type, dimensions);
    check(nc_put_var_int(group, id, values.data()));
    return id;
  }
  /// Writes a variable with dimensions (row, column[, …]) row by row: `fill(r, row)` appends the
  /// numbers of row r to an empty vector. A chunk holds the values of all columns for one row and
  /// one index of each further dimension. A reader can therefore read one chunk without the others.
  /// The function needs memory for one row only.
  template <class Number, class Fill>
  int put_rows(int group, const std::string& name, const std::vector<int>& dimensions,
               const Fill& fill, nc_type type = kNetcdfType<Number>) const {
    constexpr std::size_t kPiece = 1 << 16;
    const int id = variable(group, name, type, dimensions);
    std::vector<std::size_t> start(dimensions.size(), 0), count, pieces(dimensions.size(), 1);
    for (const int dimension : dimensions)
      check(nc_inq_dimlen(group, dimension, &count.emplace_back()));
    const std::size_t rows = std::exchange(count[0], 1);
    pieces[1] = std::min(kPiece, count[1]);
    check(nc_def_var_chunking(group, id, NC_CHUNKED, pieces.data()));
    // Almost no chunk cache is needed, because each chunk is written in one call.
    check(nc_set_var_chunk_cache(group, id, kPiece, 1, 1.0F));
    std::vector<Number> row;
    for (start[0] = 0; start[0] < rows; ++start[0]) {
      row.clear();
      fill(start[0], row);
      check(put_part(group, id, start, count, row));
    }
    return id;
  }
  /// Writes a sequence of numbers or characters without conversion, as a variable with its own
  /// dimension. Does not write a variable for an empty sequence.
  template <class Sequence>
  void column(int group, const std::string& name, const Sequence& values) const {
    if (values.empty()) return;
    int dimension = 0, id = 0;
    check(nc_def_dim(group, name.c_str(), values.size(), &dimension));
    check(nc_def_var(group, name.c_str(), kNetcdfType<typename Sequence::value_type>, 1, &dimension,
                     &id));
    check(nc_put_var(group, id, values.data()));
  }

 private:
  using Places = std::vector<std::size_t>;
  static int put_part(int group, int id, const Places& start, const Places& count,
                      const std::vector<double>& values) {
    return nc_put_vara_double(group, id, start.data(), count.data(), values.data());
  }
  static int put_part(int group, int id, const Places& start, const Places& count,
                      const std::vector<float>& values) {
    return nc_put_vara_float(group, id, start.data(), count.data(), values.data());
  }
  static int put_part(int group, int id, const Places& start, const Places& count,
                      const std::vector<int>& values) {
    return nc_put_vara_int(group, id, start.data(), count.data(), values.data());
  }

  std::filesystem::path path_;
  NetcdfHandle file_;
};

}  // namespace wheeltap::io

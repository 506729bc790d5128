#include "emulator/table_file.hpp"

#include <algorithm>
#include <cstdio>

#include "io/atomic_file.hpp"
#include "io/bytes.hpp"
#include "io/netcdf/netcdf_library.hpp"
#include "io/read_apart.hpp"

namespace wheeltap::emulator {
namespace {

namespace fs = std::filesystem;
using Kind = io::FileError::Kind;

constexpr const char* kFormatAttribute = "table_format";
constexpr const char* kFormatName = "wheeltap-table";
constexpr const char* kResponseName = "response_name";
constexpr const char* kChecksumAttribute = "table_checksum";
constexpr const char* kVersionAttribute = "table_format_version";
constexpr const char* kResponseDimension = "response";
constexpr const char* kRunDimension = "run";
constexpr std::string_view kParameterPrefix = "parameter_";
constexpr struct {
  const char* name;
  double HoldoutError::*member;
} kHoldoutVariables[] = {{"holdout_rmse", &HoldoutError::rmse},
                         {"holdout_max_error", &HoldoutError::max_error},
                         {"holdout_spread", &HoldoutError::spread},
                         {"holdout_q2", &HoldoutError::q2}};

/// The checksum covers the complete content, so that it detects any change of the file.
std::string checksum(const TableFile& file) {
  std::uint64_t hash = io::fnv1a("");
  const auto text = [&](std::string_view s) { hash = io::fnv1a("\n", io::fnv1a(s, hash)); };
  const auto numbers = [&](const double* first, std::ptrdiff_t count) {
    text({reinterpret_cast<const char*>(first), static_cast<std::size_t>(count) * sizeof(double)});
  };
  const auto texts = [&](const std::map<std::string, std::string>& map) {
    for (const auto& [key, value] : map) text(key), text(value);
  };
  texts(file.attributes);
  for (const auto& [name, t] : file.tables) {
    text(name);
    for (const Factor& f : t.factors) {
      text(f.name);
      text(f.unit);
      text(emulator::name(f.scale));
      numbers(f.levels.data(), static_cast<std::ptrdiff_t>(f.levels.size()));
    }
    text(t.response_name);
    text(t.response_unit);
    numbers(t.points.data(), t.points.size());
    numbers(t.values.data(), t.values.size());
    for (const HoldoutError& e : t.holdout)
      for (const auto& [unused, member] : kHoldoutVariables) numbers(&(e.*member), 1);
    texts(t.attributes);
    for (const auto& [key, matrix] : t.parameters) {
      text(key);
      numbers(matrix.data(), matrix.size());
    }
  }
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash));
  return digits;
}

// ---- writing ----------------------------------------------------------------------------------

struct Writer {
  const fs::path& path;  // final name, for messages

  void check(int status) const {
    if (status != NC_NOERR) throw io::FileError(Kind::unwritable, path, nc_strerror(status));
  }

  void text(int group, int variable, const char* name, const std::string& value) const {
    check(nc_put_att_text(group, variable, name, value.size(), value.c_str()));
  }

  /// A compressed variable of doubles.
  int variable(int group, const std::string& name, const std::vector<int>& dimensions) const {
    int id;
    check(nc_def_var(group, name.c_str(), NC_DOUBLE, static_cast<int>(dimensions.size()),
                     dimensions.data(), &id));
    check(nc_def_var_deflate(group, id, 1, 1, 1));
    return id;
  }

  int dimension(int group, const std::string& name, std::ptrdiff_t length) const {
    int id;
    check(nc_def_dim(group, name.c_str(), static_cast<std::size_t>(length), &id));
    return id;
  }

  void table(int file, const std::string& name, const Table& t) const {
    int group;
    check(nc_def_grp(file, name.c_str(), &group));
    std::vector<int> dimensions;
    if (!t.is_grid()) dimensions.push_back(dimension(group, kRunDimension, t.points.rows()));
    for (std::size_t j = 0; j < t.factors.size(); ++j) {
      const Factor& factor = t.factors[j];
      if (t.is_grid())
        dimensions.push_back(
            dimension(group, factor.name, static_cast<std::ptrdiff_t>(factor.levels.size())));
      const int id = variable(group, factor.name, {dimensions.back()});
      text(group, id, "units", factor.unit);
      text(group, id, "scale", std::string(emulator::name(factor.scale)));
      if (t.is_grid()) {
        check(nc_put_var_double(group, id, factor.levels.data()));
      } else {
        const Eigen::VectorXd column = t.points.col(static_cast<Eigen::Index>(j));
        check(nc_put_att_double(group, id, "levels", NC_DOUBLE, factor.levels.size(),
                                factor.levels.data()));
        check(nc_put_var_double(group, id, column.data()));
      }
    }
    const int response = dimension(group, kResponseDimension, t.values.cols());
    dimensions.push_back(response);
    const int id = variable(group, t.response_name, dimensions);
    text(group, id, "units", t.response_unit);
    check(nc_put_var_double(group, id, t.values.data()));
    for (const auto& [holdout_name, member] : kHoldoutVariables) {
      if (t.holdout.empty()) break;
      std::vector<double> column;
      for (const HoldoutError& e : t.holdout) column.push_back(e.*member);
      check(nc_put_var_double(group, variable(group, holdout_name, {response}), column.data()));
    }
    for (const auto& [key, matrix] : t.parameters) {
      const std::string full = std::string(kParameterPrefix) + key;
      const int rows = dimension(group, full + "_rows", matrix.rows());
      const int columns = dimension(group, full + "_columns", matrix.cols());
      check(nc_put_var_double(group, variable(group, full, {rows, columns}), matrix.data()));
    }
    // Stores the name of the response variable. Callers cannot set this attribute.
    text(group, NC_GLOBAL, kResponseName, t.response_name);
    for (const auto& [key, value] : t.attributes) text(group, NC_GLOBAL, key.c_str(), value);
  }
};

// ---- reading ----------------------------------------------------------------------------------

struct Reader {
  const fs::path& path;

  [[noreturn]] void fail(const std::string& reason) const {
    throw io::FileError(Kind::corrupt, path, reason);
  }

  void check(int status, const std::string& what) const {
    if (status != NC_NOERR) fail("corrupt table file: " + what + ": " + nc_strerror(status));
  }

  std::string text(int group, int variable, const char* name) const {
    nc_type type;
    std::size_t length = 0;
    check(nc_inq_att(group, variable, name, &type, &length), std::string("attribute ") + name);
    if (type != NC_CHAR) fail(std::string("attribute ") + name + " is not text");
    std::string value(length, '\0');
    check(nc_get_att_text(group, variable, name, value.data()), std::string("attribute ") + name);
    return value;
  }

  /// The text attributes of a group, without those of the format.
  std::map<std::string, std::string> texts(int file) const {
    std::map<std::string, std::string> found;
    int count = 0;
    check(nc_inq_natts(file, &count), "attributes");
    for (int i = 0; i < count; ++i) {
      char name[NC_MAX_NAME + 1] = {};
      nc_type type;
      check(nc_inq_attname(file, NC_GLOBAL, i, name), "attribute name");
      check(nc_inq_atttype(file, NC_GLOBAL, name, &type), name);
      const std::string_view own[] = {kFormatAttribute, kChecksumAttribute, kResponseName};
      if (type == NC_CHAR && std::ranges::count(own, std::string_view(name)) == 0)
        found[name] = text(file, NC_GLOBAL, name);
    }
    return found;
  }

  /// The values of a double variable, whose size must be `size`.
  void doubles(int group, int variable, std::size_t size, double* values) const {
    char name[NC_MAX_NAME + 1] = {};
    nc_type type;
    int rank = 0;
    int dimensions[NC_MAX_VAR_DIMS];
    check(nc_inq_var(group, variable, name, &type, &rank, dimensions, nullptr), "variable");
    std::size_t held = 1;
    for (int i = 0; i < rank; ++i) {
      std::size_t length = 0;
      check(nc_inq_dimlen(group, dimensions[i], &length), name);
      held *= length;
    }
    if (type != NC_DOUBLE || held != size)
      fail(std::string("variable ") + name + " is not double, or its dimensions do not match");
    check(nc_get_var_double(group, variable, values), std::string("variable ") + name);
  }

  std::size_t length(int group, int dimension) const {
    std::size_t n = 0;
    check(nc_inq_dimlen(group, dimension, &n), "dimension");
    return n;
  }

  std::vector<int> dimensions(int group, int variable) const {
    int rank = 0;
    check(nc_inq_varndims(group, variable, &rank), "variable");
    std::vector<int> ids(static_cast<std::size_t>(rank));
    check(nc_inq_vardimid(group, variable, ids.data()), "variable");
    return ids;
  }

  Factor factor(int group, int id, const char* name) const {
    return {.name = name,
            .unit = text(group, id, "units"),
            .levels = {},
            .scale = scale_named(text(group, id, "scale"))};
  }

  /// Levels of a factor of scattered runs, and its column of the points.
  void scattered_factor(int group, int id, const char* name, Table& t) const {
    Factor f = factor(group, id, name);
    std::size_t levels = 0;
    check(nc_inq_attlen(group, id, "levels", &levels), name);
    f.levels.resize(levels);
    check(nc_get_att_double(group, id, "levels", f.levels.data()), name);
    Eigen::VectorXd column(t.points.rows());
    doubles(group, id, static_cast<std::size_t>(column.size()), column.data());
    t.points.conservativeResize(Eigen::NoChange, t.points.cols() + 1);
    t.points.rightCols<1>() = column;
    t.factors.push_back(std::move(f));
  }

  Table table(int group) const {
    Table t;
    t.response_name = text(group, NC_GLOBAL, kResponseName);
    t.attributes = texts(group);
    int response;
    if (nc_inq_varid(group, t.response_name.c_str(), &response) != NC_NOERR)
      fail("no variable \"" + t.response_name + "\"");
    const std::vector<int> axes = dimensions(group, response);
    if (axes.size() < 2) fail("variable \"" + t.response_name + "\" has too few dimensions");
    t.response_unit = text(group, response, "units");

    std::size_t runs = 1;
    bool scattered = false;
    for (std::size_t j = 0; j + 1 < axes.size(); ++j) {
      char name[NC_MAX_NAME + 1] = {};
      check(nc_inq_dimname(group, axes[j], name), "dimension");
      runs *= length(group, axes[j]);
      if (name == std::string_view(kRunDimension)) {
        scattered = true;
        continue;
      }
      int id;
      if (nc_inq_varid(group, name, &id) != NC_NOERR)
        fail(std::string("no levels for the factor \"") + name + "\"");
      Factor f = factor(group, id, name);
      f.levels.resize(length(group, axes[j]));
      doubles(group, id, f.levels.size(), f.levels.data());
      t.factors.push_back(std::move(f));
    }
    if (scattered && axes.size() != 2) fail("a table of scattered points has grid dimensions");
    if (scattered) t.points.resize(static_cast<Eigen::Index>(runs), 0);
    const std::size_t responses = length(group, axes.back());
    t.values.resize(static_cast<Eigen::Index>(runs), static_cast<Eigen::Index>(responses));
    doubles(group, response, runs * responses, t.values.data());

    int variables = 0;
    check(nc_inq_nvars(group, &variables), "variables");
    for (int id = 0; id < variables; ++id) {
      char name[NC_MAX_NAME + 1] = {};
      check(nc_inq_varname(group, id, name), "variable");
      const std::vector<int> own = dimensions(group, id);
      if (std::string_view(name).starts_with(kParameterPrefix)) {
        if (own.size() != 2) fail(std::string("variable ") + name + " is not a matrix");
        RowMatrix matrix(static_cast<Eigen::Index>(length(group, own[0])),
                         static_cast<Eigen::Index>(length(group, own[1])));
        doubles(group, id, static_cast<std::size_t>(matrix.size()), matrix.data());
        t.parameters[name + kParameterPrefix.size()] = std::move(matrix);
      } else if (scattered && id != response && own.size() == 1 && own[0] == axes[0]) {
        scattered_factor(group, id, name, t);
      }
    }
    for (const auto& [name, member] : kHoldoutVariables) {
      int id;
      if (nc_inq_varid(group, name, &id) != NC_NOERR) continue;
      std::vector<double> column(responses);
      doubles(group, id, responses, column.data());
      t.holdout.resize(responses);
      for (std::size_t k = 0; k < responses; ++k) t.holdout[k].*member = column[k];
    }
    check_table("in the file", t);
    return t;
  }
};

/// Rejects files that do not start like NetCDF-4.
void check_beginning(const fs::path& path, std::string_view bytes) {
  if (!bytes.starts_with(io::kNetcdfMagic))
    throw io::FileError(Kind::foreign, path, "not a NetCDF-4 table file");
}

void check_open(const fs::path& path, int status) {
  if (status != NC_NOERR)
    Reader{path}.fail(std::string("truncated or corrupt NetCDF-4 file: ") + nc_strerror(status));
}

/// Reads an open file completely.
TableFile read(const fs::path& path, int id, const TableReadOptions& options) {
  const Reader in{path};
  std::size_t length = 0;
  nc_type type = NC_NAT;
  if (nc_inq_att(id, NC_GLOBAL, kFormatAttribute, &type, &length) != NC_NOERR || type != NC_CHAR ||
      in.text(id, NC_GLOBAL, kFormatAttribute) != kFormatName)
    throw io::FileError(Kind::foreign, path, "a NetCDF file, but not a table written by wheeltap");
  int version = 0;
  in.check(nc_get_att_int(id, NC_GLOBAL, kVersionAttribute, &version), kVersionAttribute);
  if (version != kTableFormatVersion)
    throw io::FileError(Kind::version, path,
                        "table format version " + std::to_string(version) +
                            "; this wheeltap reads " + std::to_string(kTableFormatVersion) +
                            ": compute the table again");

  TableFile file;
  file.attributes = in.texts(id);
  if (!options.expected_fingerprint.empty()) {
    const auto found = file.attributes.find("fingerprint");
    if (found == file.attributes.end() || found->second != options.expected_fingerprint)
      throw io::FileError(Kind::mismatch, path,
                          "this table was computed for another case (fingerprint " +
                              (found == file.attributes.end() ? "absent" : found->second) +
                              ", expected " + options.expected_fingerprint + ")");
  }
  int count = 0;
  in.check(nc_inq_grps(id, &count, nullptr), "groups");
  std::vector<int> groups(static_cast<std::size_t>(count));
  in.check(nc_inq_grps(id, &count, groups.data()), "groups");
  for (const int group : groups) {
    char name[NC_MAX_NAME + 1] = {};
    in.check(nc_inq_grpname(group, name), "group name");
    try {
      file.tables[name] = in.table(group);
    } catch (const io::FileError&) {
      throw;
    } catch (const std::exception& contradiction) {  // also std::bad_alloc for an invalid size
      in.fail("corrupt table file: group " + std::string(name) + ": " + contradiction.what());
    }
  }
  if (checksum(file) != in.text(id, NC_GLOBAL, kChecksumAttribute))
    in.fail("corrupt table file: its checksum does not match its content");
  for (const auto& [name, table] : file.tables)
    if (const Eigen::Index missing = table.missing_runs(); missing > 0 && !options.allow_incomplete)
      throw io::FileError(
          Kind::incomplete, path,
          std::to_string(missing) + " of the " + std::to_string(table.values.rows()) + " runs of " +
              name + " are missing: continue these runs with --resume, or merge the other parts");
  return file;
}

/// Reads the file in a child process first, because some corrupt files crash HDF5.
template <class Read>
TableFile twice(const fs::path& path, const Read& read_it) {
  const io::NetcdfLock lock;
  io::check_apart(path, [&] { (void)read_it(); });
  return read_it();
}

}  // namespace

void write_table_file(const fs::path& path, const TableFile& file) {
  for (const auto& [name, table] : file.tables) check_table(name, table);
  io::AtomicFile target(path);
  {
    const io::NetcdfLock lock;
    const Writer out{path};
    io::NetcdfHandle handle;
    out.check(handle.create_in_memory());
    out.text(handle.id, NC_GLOBAL, kFormatAttribute, kFormatName);
    out.check(
        nc_put_att_int(handle.id, NC_GLOBAL, kVersionAttribute, NC_INT, 1, &kTableFormatVersion));
    out.text(handle.id, NC_GLOBAL, kChecksumAttribute, checksum(file));
    for (const auto& [name, value] : file.attributes)
      out.text(handle.id, NC_GLOBAL, name.c_str(), value);
    for (const auto& [name, table] : file.tables) out.table(handle.id, name, table);
    std::string bytes;
    out.check(handle.close_in_memory(bytes));
    target.write(bytes);
  }
  target.commit();
}

TableFile parse_table_file(std::string bytes, const fs::path& name,
                           const TableReadOptions& options) {
  check_beginning(name, bytes);
  return twice(name, [&] {
    io::NetcdfHandle handle;
    check_open(name, nc_open_mem(name.c_str(), NC_NOWRITE, bytes.size(), bytes.data(), &handle.id));
    handle.opened();
    return read(name, handle.id, options);
  });
}

TableFile read_table_file(const fs::path& path, const TableReadOptions& options) {
  std::error_code error;
  if (!fs::exists(path, error)) throw io::FileError(Kind::missing, path, "no such file");
  check_beginning(path, io::first_bytes(path, sizeof io::kNetcdfMagic));
  return twice(path, [&] {
    io::NetcdfHandle handle;
    check_open(path, nc_open(path.c_str(), NC_NOWRITE, &handle.id));
    handle.opened();
    return read(path, handle.id, options);
  });
}

}  // namespace wheeltap::emulator

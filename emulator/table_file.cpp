#include "emulator/table_file.hpp"

#include <hdf5.h>
#include <netcdf.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <mutex>

namespace wheeltap::emulator {
namespace {

namespace fs = std::filesystem;
using Kind = FileError::Kind;

constexpr const char* kFormatAttribute = "table_format";
constexpr const char* kFormatName = "wheeltap-table";
constexpr const char* kVersionAttribute = "table_format_version";
constexpr const char* kResponseDimension = "response";
constexpr struct {
  const char* name;
  double HoldoutError::*member;
} kHoldoutVariables[] = {{"holdout_rmse", &HoldoutError::rmse},
                         {"holdout_max_error", &HoldoutError::max_error},
                         {"holdout_spread", &HoldoutError::spread},
                         {"holdout_q2", &HoldoutError::q2}};

/// The NetCDF and HDF5 C libraries keep global state without locks: hold one of these while in
/// them.
class LibraryLock {
 public:
  // HDF5 keeps its error printing a thread, and NetCDF turns it off in the first thread only.
  LibraryLock() : lock_(mutex()) { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

 private:
  static std::mutex& mutex() {
    static std::mutex mutex;
    return mutex;
  }
  std::lock_guard<std::mutex> lock_;
};

/// An open NetCDF file, closed when it goes out of scope.
class Handle {
 public:
  Handle() = default;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (open_) nc_close(id);
  }
  void opened() { open_ = true; }
  [[nodiscard]] int close() {
    open_ = false;
    return nc_close(id);
  }
  int id = -1;

 private:
  bool open_ = false;
};

// ---- writing ----------------------------------------------------------------------------------

struct Writer {
  const fs::path& path;  // the final name, for messages

  void check(int status) const {
    if (status != NC_NOERR) throw FileError(Kind::unwritable, path, nc_strerror(status));
  }

  void text(int group, int variable, const char* name, const std::string& value) const {
    check(nc_put_att_text(group, variable, name, value.size(), value.c_str()));
  }

  /// A compressed variable with a checksum a chunk, so that a damaged file is noticed when read.
  int variable(int group, const std::string& name, const std::vector<int>& dimensions) const {
    int id;
    check(nc_def_var(group, name.c_str(), NC_DOUBLE, static_cast<int>(dimensions.size()),
                     dimensions.data(), &id));
    check(nc_def_var_deflate(group, id, 1, 1, 1));
    check(nc_def_var_fletcher32(group, id, NC_FLETCHER32));
    return id;
  }

  void table(int file, const std::string& name, const Table& t) const {
    int group;
    check(nc_def_grp(file, name.c_str(), &group));
    std::vector<int> dimensions;
    std::string order;
    for (const Factor& factor : t.factors) {
      int dimension;
      check(nc_def_dim(group, factor.name.c_str(), factor.levels.size(), &dimension));
      const int id = variable(group, factor.name, {dimension});
      text(group, id, "units", factor.unit);
      text(group, id, "scale", std::string(emulator::name(factor.scale)));
      check(nc_put_var_double(group, id, factor.levels.data()));
      dimensions.push_back(dimension);
    }
    int response;
    check(nc_def_dim(group, kResponseDimension, static_cast<std::size_t>(t.values.cols()),
                     &response));
    dimensions.push_back(response);
    const int id = variable(group, t.response_name, dimensions);
    text(group, id, "units", t.response_unit);
    text(group, NC_GLOBAL, "response_name", t.response_name);
    check(nc_put_var_double(group, id, t.values.data()));
    for (const auto& [holdout_name, member] : kHoldoutVariables) {
      if (t.holdout.empty()) break;
      std::vector<double> column;
      for (const HoldoutError& e : t.holdout) column.push_back(e.*member);
      check(nc_put_var_double(group, variable(group, holdout_name, {response}), column.data()));
    }
  }
};

void check_table(const std::string& name, const Table& t) {
  const std::string who = "table \"" + name + "\"";
  check_factors(t.factors, 1);
  std::size_t runs = 1;
  for (const Factor& factor : t.factors) {
    if (factor.name == kResponseDimension || factor.name == t.response_name)
      throw std::invalid_argument(who + ": a factor may not be called \"" + factor.name + "\"");
    runs *= factor.levels.size();
  }
  if (t.response_name.empty()) throw std::invalid_argument(who + ": the response has no name");
  if (t.values.cols() < 1 || static_cast<std::size_t>(t.values.rows()) != runs)
    throw std::invalid_argument(who + ": values are " + std::to_string(t.values.rows()) + " x " +
                                std::to_string(t.values.cols()) + ", the grid has " +
                                std::to_string(runs) + " nodes");
  if (!t.holdout.empty() && t.holdout.size() != static_cast<std::size_t>(t.values.cols()))
    throw std::invalid_argument(who + ": " + std::to_string(t.holdout.size()) +
                                " holdout errors for " + std::to_string(t.values.cols()) +
                                " responses");
}

// ---- reading ----------------------------------------------------------------------------------

struct Reader {
  const fs::path& path;

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(Kind::corrupt, path, reason);
  }

  void check(int status, const std::string& what) const {
    if (status != NC_NOERR) fail("damaged table file: " + what + ": " + nc_strerror(status));
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

  std::map<std::string, std::string> global_texts(int file) const {
    std::map<std::string, std::string> texts;
    int count = 0;
    check(nc_inq_natts(file, &count), "attributes");
    for (int i = 0; i < count; ++i) {
      char name[NC_MAX_NAME + 1] = {};
      nc_type type;
      check(nc_inq_attname(file, NC_GLOBAL, i, name), "attribute name");
      check(nc_inq_atttype(file, NC_GLOBAL, name, &type), name);
      if (type == NC_CHAR && name != std::string(kFormatAttribute))
        texts[name] = text(file, NC_GLOBAL, name);
    }
    return texts;
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
      fail(std::string("variable ") + name + " has another type or size than its dimensions say");
    check(nc_get_var_double(group, variable, values), std::string("variable ") + name);
    for (std::size_t i = 0; i < size; ++i)
      if (std::isnan(values[i])) fail(std::string("variable ") + name + " holds NaN");
  }

  Table table(int group) const {
    Table t;
    t.response_name = text(group, NC_GLOBAL, "response_name");
    int response;
    if (nc_inq_varid(group, t.response_name.c_str(), &response) != NC_NOERR)
      fail("no variable \"" + t.response_name + "\"");
    int rank = 0;
    int dimensions[NC_MAX_VAR_DIMS];
    check(nc_inq_varndims(group, response, &rank), t.response_name);
    if (rank < 2) fail("variable \"" + t.response_name + "\" has too few dimensions");
    check(nc_inq_vardimid(group, response, dimensions), t.response_name);
    t.response_unit = text(group, response, "units");
    std::size_t runs = 1;
    for (int i = 0; i < rank - 1; ++i) {
      char name[NC_MAX_NAME + 1] = {};
      std::size_t length = 0;
      check(nc_inq_dim(group, dimensions[i], name, &length), "factor");
      int id;
      if (nc_inq_varid(group, name, &id) != NC_NOERR)
        fail(std::string("no levels for the factor \"") + name + "\"");
      Factor factor{.name = name,
                    .unit = text(group, id, "units"),
                    .levels = std::vector<double>(length),
                    .scale = scale_named(text(group, id, "scale"))};
      doubles(group, id, length, factor.levels.data());
      t.factors.push_back(std::move(factor));
      runs *= length;
    }
    std::size_t responses = 0;
    check(nc_inq_dimlen(group, dimensions[rank - 1], &responses), kResponseDimension);
    t.values.resize(static_cast<Eigen::Index>(runs), static_cast<Eigen::Index>(responses));
    doubles(group, response, runs * responses, t.values.data());
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

}  // namespace

std::string fingerprint(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash));
  return digits;
}

void write_table_file(const fs::path& path, const TableFile& file) {
  for (const auto& [name, table] : file.tables) check_table(name, table);
  const fs::path temporary = path.string() + ".part" + std::to_string(::getpid());
  // NetCDF reports a directory that is absent or closed as an HDF5 error; the system says it
  // better.
  if (!std::ofstream(temporary))
    throw FileError(Kind::unwritable, path,
                    "cannot be created: check that its directory exists "
                    "and may be written to");
  struct Remover {
    const fs::path& path;
    ~Remover() {
      std::error_code ignored;
      fs::remove(path, ignored);
    }
  } const remover{temporary};

  {
    const LibraryLock lock;
    const Writer out{path};
    Handle handle;
    out.check(nc_create(temporary.c_str(), NC_NETCDF4 | NC_CLOBBER, &handle.id));
    handle.opened();
    out.text(handle.id, NC_GLOBAL, kFormatAttribute, kFormatName);
    out.check(
        nc_put_att_int(handle.id, NC_GLOBAL, kVersionAttribute, NC_INT, 1, &kTableFormatVersion));
    for (const auto& [name, value] : file.attributes)
      out.text(handle.id, NC_GLOBAL, name.c_str(), value);
    for (const auto& [name, table] : file.tables) out.table(handle.id, name, table);
    out.check(handle.close());
  }
  std::error_code error;
  fs::rename(temporary, path, error);
  if (error) throw FileError(Kind::unwritable, path, error.message());
}

TableFile read_table_file(const fs::path& path, std::string_view expected_fingerprint) {
  std::error_code error;
  if (!fs::exists(path, error)) throw FileError(Kind::missing, path, "no such file");
  char magic[8] = {};
  std::ifstream stream(path, std::ios::binary);
  if (fs::is_directory(path, error) || !stream)
    throw FileError(Kind::missing, path, "cannot be read");
  stream.read(magic, sizeof magic);
  if (std::string_view(magic, sizeof magic) != std::string_view("\x89HDF\r\n\x1a\n", 8))
    throw FileError(Kind::foreign, path, "not a NetCDF-4 table file");
  stream.close();

  const LibraryLock lock;
  const Reader in{path};
  Handle handle;
  const int status = nc_open(path.c_str(), NC_NOWRITE, &handle.id);
  if (status != NC_NOERR)
    in.fail(std::string("truncated or damaged NetCDF-4 file: ") + nc_strerror(status));
  handle.opened();

  std::size_t length = 0;
  nc_type type = NC_NAT;
  if (nc_inq_att(handle.id, NC_GLOBAL, kFormatAttribute, &type, &length) != NC_NOERR ||
      type != NC_CHAR || in.text(handle.id, NC_GLOBAL, kFormatAttribute) != kFormatName)
    throw FileError(Kind::foreign, path, "a NetCDF file, but not a table written by wheeltap");
  int version = 0;
  in.check(nc_get_att_int(handle.id, NC_GLOBAL, kVersionAttribute, &version), kVersionAttribute);
  if (version != kTableFormatVersion)
    throw FileError(Kind::version, path,
                    "table format version " + std::to_string(version) + "; this wheeltap reads " +
                        std::to_string(kTableFormatVersion) + ": compute the table again");

  TableFile file;
  file.attributes = in.global_texts(handle.id);
  if (!expected_fingerprint.empty()) {
    const auto found = file.attributes.find("fingerprint");
    if (found == file.attributes.end() || found->second != expected_fingerprint)
      throw FileError(Kind::mismatch, path,
                      "this table was computed for another case (fingerprint " +
                          (found == file.attributes.end() ? "absent" : found->second) +
                          ", expected " + std::string(expected_fingerprint) + ")");
  }
  int count = 0;
  in.check(nc_inq_grps(handle.id, &count, nullptr), "groups");
  std::vector<int> groups(static_cast<std::size_t>(count));
  in.check(nc_inq_grps(handle.id, &count, groups.data()), "groups");
  for (const int group : groups) {
    char name[NC_MAX_NAME + 1] = {};
    in.check(nc_inq_grpname(group, name), "group name");
    try {
      file.tables[name] = in.table(group);
    } catch (const std::invalid_argument& contradiction) {
      in.fail("damaged table file: group " + std::string(name) + ": " + contradiction.what());
    }
  }
  return file;
}

}  // namespace wheeltap::emulator

#include "io/array_file.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "base/constants.hpp"
#include "io/netcdf_classic.hpp"
#include "io/netcdf_reader.hpp"
#include "io/read_apart.hpp"
#include "io/text.hpp"

namespace wheeltap::io {
namespace {

constexpr int kDeepest = 8;                   // groups within groups
constexpr std::size_t kMostColumns = 10'000;  // of one matrix

struct Found {
  std::string name;
  int group = 0, id = 0;
  std::vector<std::size_t> shape;

  [[nodiscard]] std::size_t size() const {
    constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
    std::size_t n = 1;
    for (const std::size_t d : shape) n = d != 0 && n > kMost / d ? kMost : n * d;
    return n;
  }
};

bool numeric(nc_type type) {
  return type == NC_BYTE || type == NC_UBYTE || type == NC_SHORT || type == NC_USHORT ||
         type == NC_INT || type == NC_UINT || type == NC_INT64 || type == NC_UINT64 ||
         type == NC_FLOAT || type == NC_DOUBLE;
}

void look(int group, const std::string& prefix, int depth, std::vector<Found>& out) {
  int count = 0;
  if (nc_inq_varids(group, &count, nullptr) != NC_NOERR) return;
  std::vector<int> ids(static_cast<std::size_t>(count));
  nc_inq_varids(group, &count, ids.data());
  for (const int id : ids) {
    char name[NC_MAX_NAME + 1] = {};
    nc_type type = NC_NAT;
    int rank = 0;
    if (nc_inq_var(group, id, name, &type, &rank, nullptr, nullptr) != NC_NOERR || !numeric(type) ||
        rank > 2)
      continue;
    std::vector<int> dimensions(static_cast<std::size_t>(rank));
    nc_inq_vardimid(group, id, dimensions.data());
    Found one{.name = prefix + in_utf8(name), .group = group, .id = id, .shape = {}};
    for (const int d : dimensions) {
      std::size_t length = 0;
      nc_inq_dimlen(group, d, &length);
      one.shape.push_back(length);
    }
    out.push_back(std::move(one));
  }
  if (depth == 0 || nc_inq_grps(group, &count, nullptr) != NC_NOERR) return;
  std::vector<int> groups(static_cast<std::size_t>(count));
  nc_inq_grps(group, &count, groups.data());
  for (const int inner : groups) {
    char name[NC_MAX_NAME + 1] = {};
    if (nc_inq_grpname(inner, name) == NC_NOERR)
      look(inner, prefix + in_utf8(name) + "/", depth - 1, out);
  }
}

std::optional<double> number(const Found& of, const char* attribute) {
  std::size_t length = 0;
  nc_type type = NC_NAT;
  double value = 0.0;
  if (nc_inq_att(of.group, of.id, attribute, &type, &length) != NC_NOERR || length != 1 ||
      !numeric(type) || nc_get_att_double(of.group, of.id, attribute, &value) != NC_NOERR)
    return {};
  return value;
}

std::string unit_of(const Found& of) {
  std::size_t length = 0;
  nc_type type = NC_NAT;
  if (nc_inq_att(of.group, of.id, "units", &type, &length) != NC_NOERR) return {};
  if (type == NC_STRING && length == 1) {
    char* text = nullptr;
    if (nc_get_att_string(of.group, of.id, "units", &text) != NC_NOERR) return {};
    std::string out = in_utf8(text != nullptr ? text : "");
    nc_free_string(1, &text);
    return out;
  }
  if (type != NC_CHAR || length > NC_MAX_NAME) return {};
  std::string out(length, '\0');
  if (nc_get_att_text(of.group, of.id, "units", out.data()) != NC_NOERR) return {};
  return in_utf8(std::string_view(out).substr(0, out.find('\0')));
}

std::vector<double> values_of(const std::filesystem::path& path, const Found& of) {
  std::error_code none;
  const std::uintmax_t bytes = std::filesystem::file_size(path, none);
  if (!none && static_cast<double>(of.size()) * sizeof(double) > most_bytes(bytes))
    throw FileError(FileError::Kind::corrupt, path,
                    "\"" + of.name + "\" announces " + std::to_string(of.size()) +
                        " numbers, more than are read of a file of its size (if it is sound and "
                        "merely compressed beyond measure, store it without)");
  std::vector<double> x(of.size());
  if (const int status = nc_get_var_double(of.group, of.id, x.data());
      status != NC_NOERR && status != NC_ERANGE)
    throw FileError(
        FileError::Kind::corrupt, path,
        "\"" + of.name + "\" cannot be read, truncated or damaged: " + nc_strerror(status));
  const double scale = number(of, "scale_factor").value_or(1.0),
               offset = number(of, "add_offset").value_or(0.0);
  for (const char* attribute : {"_FillValue", "missing_value"})
    if (const auto hole = number(of, attribute))
      for (double& v : x)
        if (v == *hole) v = kNaN;
  if (scale != 1.0 || offset != 0.0)
    for (double& v : x) v = scale * v + offset;
  return x;
}

/// Which of a variable's dimensions runs along the rows: of that length. -1: none.
int along(const Found& of, std::size_t rows) {
  if (of.shape.empty()) return -1;
  if (of.shape[0] == rows) return 0;
  return of.shape.size() == 2 && of.shape[1] == rows ? 1 : -1;
}

void require_whole(const std::filesystem::path& path) {
  std::ifstream bytes(path, std::ios::binary);
  const std::optional<std::uintmax_t> must = netcdf_classic_size(bytes);
  if (!must)
    throw FileError(FileError::Kind::corrupt, path,
                    "is truncated, damaged or was not closed by its writer: its header makes no "
                    "sense");
  std::error_code none;
  const std::uintmax_t is = std::filesystem::file_size(path, none);
  if (!none && is < *must)
    throw FileError(FileError::Kind::corrupt, path,
                    "is cut off: " + std::to_string(*must) + " bytes were written, " +
                        std::to_string(is) + " are there");
}

Columns read_here(const std::filesystem::path& path, const Wanted& wanted) {
  require_whole(path);
  const NetcdfReader file(path, "a record");
  std::vector<Found> all;
  look(file.root(), "", kDeepest, all);
  // The length that most numbers have.
  std::map<std::size_t, std::size_t> numbers;
  for (const Found& v : all)
    if (!v.shape.empty())
      numbers[v.shape.size() == 2 ? std::max(v.shape[0], v.shape[1]) : v.shape[0]] += v.size();
  std::size_t rows = 0, most = 0;
  for (const auto& [length, count] : numbers)
    if (length >= 2 && count >= most) {
      rows = length;
      most = count;
    }
  if (rows == 0) file.foreign("holds no vector of two numbers or more");
  Columns out{.file = path.string()};
  struct Source {
    const Found* variable;
    std::size_t first, step;
  };
  std::vector<Source> sources;
  for (const Found& v : all) {
    if (v.size() == 1) {
      out.scalars[v.name] = values_of(path, v)[0];
      continue;
    }
    const int dimension = along(v, rows);
    if (dimension < 0) continue;
    const std::string unit = unit_of(v);
    const auto add = [&](std::string name, std::size_t first, std::size_t step) {
      out.columns.push_back(
          {.header = unit.empty() ? name : name + " [" + unit + "]", .name = name, .unit = unit});
      sources.push_back({&v, first, step});
    };
    if (v.shape.size() == 1) {
      add(v.name, 0, 1);
      continue;
    }
    const std::size_t others = v.shape[dimension == 0 ? 1 : 0];
    if (others > kMostColumns)
      throw FileError(FileError::Kind::corrupt, path,
                      "\"" + v.name + "\" has " + std::to_string(others) +
                          " columns: must have at most " + std::to_string(kMostColumns));
    for (std::size_t c = 0; c < others; ++c) {
      const std::string index = std::to_string(c + 1);
      if (others == 1) {
        add(v.name, 0, 1);
      } else if (dimension == 0) {
        add(v.name + "(:," + index + ")", c, others);
      } else {
        add(v.name + "(" + index + ",:)", c * rows, 1);
      }
    }
  }
  const Found* held = nullptr;
  std::vector<double> values;
  for (std::size_t c = 0; c < out.columns.size(); ++c) {
    if (wanted && !wanted(out, c)) continue;
    if (held != sources[c].variable) {
      held = sources[c].variable;
      values = values_of(path, *held);
    }
    out.columns[c].values.resize(rows);
    for (std::size_t i = 0; i < rows; ++i)
      out.columns[c].values[i] = values[sources[c].first + i * sources[c].step];
  }
  return out;
}

}  // namespace

Columns read_array_file(const std::filesystem::path& path, const Wanted& wanted) {
  const NetcdfLock lock;
  return read_apart_as<Columns>(path, [&] { return read_here(path, wanted); });
}

}  // namespace wheeltap::io

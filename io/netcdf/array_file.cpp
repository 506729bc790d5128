#include "io/netcdf/array_file.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "base/constants.hpp"
#include "io/netcdf/netcdf_classic.hpp"
#include "io/netcdf/netcdf_reader.hpp"
#include "io/read_apart.hpp"
#include "io/text/text.hpp"

namespace wheeltap::io {
namespace {

constexpr int kDeepest = 8;  // largest depth of nested groups
constexpr int kMostDimensions = 4;

/// A part of a complex number as stored by h5py and others: a compound of two real numbers.
struct Part {
  std::size_t size = 0;    ///< size of the compound
  std::size_t offset = 0;  ///< offset within the compound
  nc_type type = NC_DOUBLE;
};

struct Found {
  ArrayShape array;
  int group = 0, id = 0;
  std::optional<Part> part = {};
};

bool numeric(nc_type type) {
  return type == NC_BYTE || type == NC_UBYTE || type == NC_SHORT || type == NC_USHORT ||
         type == NC_INT || type == NC_UINT || type == NC_INT64 || type == NC_UINT64 ||
         type == NC_FLOAT || type == NC_DOUBLE;
}

std::optional<double> number_in(const Found& of, const char* attribute) {
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

/// The real and imaginary part of a compound type; empty for any other type.
std::vector<Part> parts_of(int group, nc_type type) {
  std::size_t size = 0, fields = 0;
  int kind = 0;
  if (type <= NC_MAX_ATOMIC_TYPE ||
      nc_inq_user_type(group, type, nullptr, &size, nullptr, &fields, &kind) != NC_NOERR ||
      kind != NC_COMPOUND || fields != 2)
    return {};
  std::vector<Part> out(2, {.size = size});
  for (int i = 0; i < 2; ++i) {
    Part& part = out[static_cast<std::size_t>(i)];
    int rank = 0;
    if (nc_inq_compound_field(group, type, i, nullptr, &part.offset, &part.type, &rank, nullptr) !=
            NC_NOERR ||
        rank != 0 || (part.type != NC_FLOAT && part.type != NC_DOUBLE) ||
        part.offset + (part.type == NC_FLOAT ? sizeof(float) : sizeof(double)) > size)
      return {};
  }
  return out;
}

/// The name of the kind of a variable that is not a numeric array; empty for numeric arrays.
std::string other_kind(int group, nc_type type, int rank) {
  if (rank > kMostDimensions) return std::to_string(rank) + "-d array";
  if (numeric(type)) return {};
  if (type == NC_CHAR || type == NC_STRING) return "text";
  int kind = 0;
  if (nc_inq_user_type(group, type, nullptr, nullptr, nullptr, nullptr, &kind) == NC_NOERR &&
      kind == NC_COMPOUND)
    return "compound: save each member as a separate array";
  return "no numbers";
}

void look(int group, const std::string& prefix, int depth, std::vector<Found>& out,
          std::vector<std::string>& others) {
  int count = 0;
  if (nc_inq_varids(group, &count, nullptr) != NC_NOERR) return;
  std::vector<int> ids(static_cast<std::size_t>(count));
  nc_inq_varids(group, &count, ids.data());
  for (const int id : ids) {
    char name[NC_MAX_NAME + 1] = {};
    nc_type type = NC_NAT;
    int rank = 0;
    if (nc_inq_var(group, id, name, &type, &rank, nullptr, nullptr) != NC_NOERR) continue;
    const std::string shown = prefix + in_utf8(name);
    const std::vector<Part> parts = parts_of(group, type);
    if (const std::string kind = other_kind(group, type, rank);
        !kind.empty() && (parts.empty() || rank > kMostDimensions)) {
      others.push_back(shown + " (" + kind + ")");
      continue;
    }
    std::vector<int> dimensions(static_cast<std::size_t>(rank));
    nc_inq_vardimid(group, id, dimensions.data());
    Found one{.array = {.name = shown, .row_major = true}, .group = group, .id = id};
    for (const int d : dimensions) {
      std::size_t length = 0;
      nc_inq_dimlen(group, d, &length);
      one.array.shape.push_back(length);
    }
    one.array.unit = unit_of(one);
    if (parts.empty()) out.push_back(one);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      out.push_back(one);
      out.back().array.name += i == 0 ? ", real" : ", imaginary";
      out.back().part = parts[i];
    }
  }
  if (depth == 0 || nc_inq_grps(group, &count, nullptr) != NC_NOERR) return;
  std::vector<int> groups(static_cast<std::size_t>(count));
  nc_inq_grps(group, &count, groups.data());
  for (const int inner : groups) {
    char name[NC_MAX_NAME + 1] = {};
    if (nc_inq_grpname(inner, name) == NC_NOERR)
      look(inner, prefix + in_utf8(name) + "/", depth - 1, out, others);
  }
}

std::vector<double> values_of(const std::filesystem::path& path, const Found& of) {
  std::error_code none;
  const std::uintmax_t bytes = std::filesystem::file_size(path, none);
  if (!none && static_cast<double>(of.array.size()) * sizeof(double) > most_bytes(bytes))
    throw FileError(
        FileError::Kind::corrupt, path,
        "\"" + of.array.name + "\" declares " + std::to_string(of.array.size()) +
            " numbers, more than the limit for a file of its size (if the file is valid "
            "and only strongly compressed, store it without compression)");
  std::vector<double> x(of.array.size());
  std::string compounds(of.part ? of.part->size * x.size() : 0, '\0');
  if (const int status = of.part ? nc_get_var(of.group, of.id, compounds.data())
                                 : nc_get_var_double(of.group, of.id, x.data());
      status != NC_NOERR && status != NC_ERANGE)
    throw FileError(
        FileError::Kind::corrupt, path,
        "\"" + of.array.name + "\" cannot be read, truncated or corrupt: " + nc_strerror(status));
  for (std::size_t i = 0; of.part && i < x.size(); ++i) {
    const char* from = compounds.data() + i * of.part->size + of.part->offset;
    float single = 0.0F;
    if (of.part->type == NC_FLOAT) {
      std::memcpy(&single, from, sizeof single);
      x[i] = static_cast<double>(single);
    } else {
      std::memcpy(&x[i], from, sizeof x[i]);
    }
  }
  const double scale = number_in(of, "scale_factor").value_or(1.0),
               offset = number_in(of, "add_offset").value_or(0.0);
  for (const char* attribute : {"_FillValue", "missing_value"})
    if (const auto hole = number_in(of, attribute))
      for (double& v : x)
        if (v == *hole) v = kNaN;
  if (scale != 1.0 || offset != 0.0)
    for (double& v : x) v = scale * v + offset;
  return x;
}

void require_whole(const std::filesystem::path& path) {
  std::ifstream bytes(path, std::ios::binary);
  const std::optional<std::uintmax_t> must = netcdf_classic_size(bytes);
  if (!must)
    throw FileError(FileError::Kind::corrupt, path,
                    "is truncated, corrupt or was not closed by its writer: its header is invalid");
  std::error_code none;
  const std::uintmax_t is = std::filesystem::file_size(path, none);
  if (!none && is < *must)
    throw FileError(FileError::Kind::corrupt, path,
                    "is truncated: " + std::to_string(*must) + " bytes were written, " +
                        std::to_string(is) + " are there");
}

Columns read_here(const std::filesystem::path& path, const Wanted& wanted,
                  const ArrayLayout& layout) {
  require_whole(path);
  const NetcdfReader file(path, "a record");
  Columns out{.file = path.string()};
  std::vector<Found> all;
  look(file.root(), "", kDeepest, all, out.others);
  std::vector<ArrayShape> arrays;
  for (const Found& v : all) {
    if (v.array.size() == 1) out.scalars[v.array.name] = values_of(path, v)[0];
    arrays.push_back(v.array);
  }
  const ChosenColumns chosen = choose_columns(arrays, layout, wanted, out);
  if (out.columns.empty()) file.foreign("holds no vector with at least two numbers");
  fill_columns(
      chosen, wanted, [&](std::size_t i) { return values_of(path, all[i]); }, out);
  return out;
}

}  // namespace

Columns read_array_file(const std::filesystem::path& path, const Wanted& wanted,
                        const ArrayLayout& layout) {
  const NetcdfLock lock;
  return read_apart_as<Columns>(path, [&] { return read_here(path, wanted, layout); });
}

}  // namespace wheeltap::io

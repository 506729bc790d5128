// What the parts of the digest share: variables of posterior.nc, the draws in them, bins.
#pragma once

#include <netcdf.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/summary.hpp"
#include "io/file_error.hpp"

namespace wheeltap::apps {

inline constexpr double kCharted = 0.005;           // models with less probability have no charts
inline constexpr std::size_t kHistoryPoints = 400;  // a chain, in the histories

/// Five digits are more than a chart shows, and shorter to store.
[[nodiscard]] double compact(double x);

struct Variable {
  std::vector<std::size_t> shape;  // chain, draw, …
  std::vector<double> values;
  [[nodiscard]] std::size_t inner() const {
    std::size_t n = 1;
    for (std::size_t i = 2; i < shape.size(); ++i) n *= shape[i];
    return n;
  }
};

class PosteriorReader {
 public:
  explicit PosteriorReader(const std::filesystem::path& path) : path_(path) {
    if (!std::filesystem::exists(path)) {
      throw io::FileError(io::FileError::Kind::missing, path, "no such file");
    }
    if (const int status = nc_open(path.c_str(), NC_NOWRITE, &file_); status != NC_NOERR) {
      throw io::FileError(
          io::FileError::Kind::corrupt, path,
          std::string("is truncated or not a NetCDF-4 file: ") + nc_strerror(status));
    }
  }
  PosteriorReader(const PosteriorReader&) = delete;
  PosteriorReader& operator=(const PosteriorReader&) = delete;
  ~PosteriorReader() { nc_close(file_); }

  [[nodiscard]] std::optional<int> group(const char* name) const {
    int id = 0;
    if (nc_inq_grp_ncid(file_, name, &id) != NC_NOERR) return {};
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
  [[nodiscard]] Variable read(int group, const std::string& name) const {
    int id = 0, rank = 0;
    if (nc_inq_varid(group, name.c_str(), &id) != NC_NOERR) {
      foreign("has no variable \"" + name + "\"");
    }
    check(nc_inq_varndims(group, id, &rank));
    std::vector<int> dimensions(static_cast<std::size_t>(rank));
    check(nc_inq_vardimid(group, id, dimensions.data()));
    Variable out;
    std::size_t size = 1;
    for (const int d : dimensions) {
      std::size_t length = 0;
      check(nc_inq_dimlen(group, d, &length));
      out.shape.push_back(length);
      size *= length;
    }
    out.values.resize(size);
    check(nc_get_var_double(group, id, out.values.data()));
    return out;
  }
  // A global attribute; empty where there is none.
  [[nodiscard]] std::string text(const char* attribute) const {
    std::size_t length = 0;
    if (nc_inq_attlen(file_, NC_GLOBAL, attribute, &length) != NC_NOERR) return {};
    std::string value(length, '\0');
    return nc_get_att_text(file_, NC_GLOBAL, attribute, value.data()) == NC_NOERR ? value : "";
  }
  [[nodiscard]] std::string text(int group, const std::string& name, const char* attribute) const {
    int id = 0;
    std::size_t length = 0;
    if (nc_inq_varid(group, name.c_str(), &id) != NC_NOERR ||
        nc_inq_attlen(group, id, attribute, &length) != NC_NOERR) {
      return {};
    }
    std::string value(length, '\0');
    return nc_get_att_text(group, id, attribute, value.data()) == NC_NOERR ? value : "";
  }
  [[noreturn]] void foreign(const std::string& why) const {
    throw io::FileError(io::FileError::Kind::foreign, path_, why + ": not a posterior of wheeltap");
  }

 private:
  void check(int status) const {
    if (status == NC_NOERR) return;
    throw io::FileError(
        io::FileError::Kind::corrupt, path_,
        std::string("cannot be read, truncated or damaged: ") + nc_strerror(status));
  }
  std::filesystem::path path_;
  int file_ = -1;
};

struct Bins {
  double from = 0.0, width = 1.0;
  std::size_t n = 1;
  [[nodiscard]] std::size_t at(double x) const {
    const double position = (x - from) / width;
    return position <= 0.0 ? 0 : std::min(static_cast<std::size_t>(position), n - 1);
  }
  [[nodiscard]] Report json() const {
    return {{"from", compact(from)}, {"width", width}, {"n", n}};
  }
};

/// As many bins as the draws can fill: in proportion to the cube root of their number, as Freedman
/// & Diaconis's rule (1981) has it, but finer, since posteriors here are often several narrow
/// islands.
[[nodiscard]] std::size_t bins_for(std::size_t draws, double factor, std::size_t fewest,
                                   std::size_t most);
/// Bins over the draws; all alike where they are one value.
[[nodiscard]] Bins bins_over(const std::vector<double>& values, std::size_t n);
/// Cells of a two-dimensional histogram that hold anything: [i, j, density].
[[nodiscard]] Report cells(const std::vector<double>& x, const std::vector<double>& y,
                           const Bins& bx, const Bins& by, double total,
                           const std::vector<double>& weights = {});

/// An unknown of a model and the variable that holds its draws.
struct Series {
  std::string label;      ///< as in summary.json
  std::size_t slot = 0;   ///< of the variable's rows, 0-based
  std::string prior;      ///< where the case states it, a JSON pointer
  int ordered_among = 0;  ///< of so many exchangeable ones it is the (slot + 1)-th; 0: of none
  const Variable* variable = nullptr;

  [[nodiscard]] double at(std::size_t draw) const {
    return variable->values[draw * variable->inner() + slot];
  }
};

/// The draws of a run.
class StoredDraws {
 public:
  StoredDraws(const PosteriorReader& file, const Report& summary);
  [[nodiscard]] std::size_t chains() const { return chains_; }
  [[nodiscard]] std::size_t draws() const { return draws_; }
  [[nodiscard]] std::size_t model(std::size_t at) const { return model_[at]; }
  /// What a draw counts beside others, 1 on average.
  [[nodiscard]] double weight(std::size_t at) const { return weights_[at]; }
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] std::size_t size() const { return model_.size(); }
  [[nodiscard]] const Variable* find(const std::string& name) const;
  /// Those of a model, as summary.json lists them.
  [[nodiscard]] std::vector<Series> series(const std::string& model) const;

 private:
  Report unknowns_;
  std::map<std::string, Variable> variables_;
  std::size_t chains_ = 0, draws_ = 0;
  std::vector<std::size_t> model_;
  std::vector<double> weights_;
};

/// "unknowns" of a summary that was written before they were kept, from its labels.
[[nodiscard]] Report unknowns_of_older(const Report& summary);

/// Histogram, prior density and thinned history of each parameter of the models that matter, and
/// joint histograms of pairs, as "parameters" and "pairs" of `out`.
void digest_parameters(const StoredDraws& posterior, const Report& summary, Report& out);
/// Each response channel of a record: data and replicated band over time, spectra, frequency
/// responses to what drove it, autocorrelation of the residuals.
[[nodiscard]] Report digest_responses(const PosteriorReader& file);

}  // namespace wheeltap::apps

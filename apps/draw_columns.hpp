// The draws of a run as named columns: what the group `posterior` of posterior.nc holds, and what
// other programs are given.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "inference/posterior.hpp"
#include "io/netcdf_writer.hpp"

namespace wheeltap::apps {

/// One number a draw, or one a draw and slot (NaN in slots that a draw does not use), chain by
/// chain.
struct DrawColumn {
  std::string name;
  std::variant<std::vector<int>, std::vector<double>> values;
  std::string unit = {};
  std::string slot = {};  ///< name of the dimension of slots; empty where there are none
  std::size_t slots = 1;
  std::string names = {};  ///< what whole numbers stand for, joined by ";"
};

/// The variable of the group `posterior` that holds a parameter: its name, with "_" for what NetCDF
/// forbids.
[[nodiscard]] std::string variable_of(const std::string& parameter);

/// The model of each draw, as the column "model".
[[nodiscard]] DrawColumn model_column(const inference::Posterior& posterior);
/// A parameter of the space's table, NaN in draws of models that have it not.
[[nodiscard]] DrawColumn parameter_column(const inference::Posterior& posterior, int parameter,
                                          std::string name, std::string unit = {});
/// A column a parameter, after that of the model.
[[nodiscard]] std::vector<DrawColumn> parameter_columns(const inference::Posterior& posterior);

/// Writes the group `posterior`, dimensions chain and draw first.
void write_draws(const io::NetcdfWriter& file, const inference::Posterior& posterior,
                 const std::vector<DrawColumn>& columns);

}  // namespace wheeltap::apps

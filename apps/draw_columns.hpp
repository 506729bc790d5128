// Draws of a run as named columns, for the group `posterior` of posterior.nc and for other
// programs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "inference/diagnosis/posterior.hpp"
#include "io/netcdf/netcdf_writer.hpp"

namespace wheeltap::apps {

/// A column with one number per draw, or with a fixed number of slots per draw. Slots that a draw
/// does not use contain NaN. The values of a column are computed when they are needed, because all
/// columns of millions of draws would not fit into memory.
struct DrawColumn {
  std::string name;
  std::function<double(const inference::Chain&, std::size_t draw, std::size_t slot)> value;
  bool whole = false;  ///< true if all values are whole numbers
  std::string unit = {};
  std::string slot = {};  ///< name of the dimension of slots; empty: no slots
  std::size_t slots = 1;
  std::string names = {};  ///< meanings of the whole numbers 0, 1, …, joined by ";"

  /// Appends the values of a chain to a list, draw by draw.
  template <class Number>
  void append(const inference::Chain& chain, std::vector<Number>& to) const {
    to.reserve(to.size() + chain.size() * slots);
    for (std::size_t i = 0; i < chain.size(); ++i)
      for (std::size_t s = 0; s < slots; ++s) to.push_back(static_cast<Number>(value(chain, i, s)));
    chain.let_go();
  }
};

/// Name of a parameter's variable in the group `posterior`; "_" replaces characters that NetCDF
/// forbids.
[[nodiscard]] std::string variable_of(const std::string& parameter);

/// The model of each draw, as the column "model".
[[nodiscard]] DrawColumn model_column(const inference::Posterior& posterior);
/// The column of a parameter of the model space; NaN in draws of models without the parameter.
[[nodiscard]] DrawColumn parameter_column(const inference::Posterior& posterior, int parameter,
                                          std::string name, std::string unit = {});
/// The column of the model, then one column per parameter.
[[nodiscard]] std::vector<DrawColumn> parameter_columns(const inference::Posterior& posterior);

/// Writes the group `posterior`; the first dimensions of its variables are chain and draw.
void write_draws(const io::NetcdfWriter& file, const inference::Posterior& posterior,
                 const std::vector<DrawColumn>& columns);

}  // namespace wheeltap::apps

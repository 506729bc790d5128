// The draws of a run as named columns: what the group `posterior` of posterior.nc holds, and what
// other programs are given.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "inference/diagnosis/posterior.hpp"
#include "io/netcdf/netcdf_writer.hpp"

namespace wheeltap::apps {

/// One number a draw, or one a draw and slot (NaN in slots that a draw does not use). It holds none
/// of them: millions of draws have many columns.
struct DrawColumn {
  std::string name;
  std::function<double(const inference::Chain&, std::size_t draw, std::size_t slot)> value;
  bool whole = false;  ///< whole numbers
  std::string unit = {};
  std::string slot = {};  ///< name of the dimension of slots; empty where there are none
  std::size_t slots = 1;
  std::string names = {};  ///< what whole numbers stand for, joined by ";"

  /// Appends the numbers of a chain, draw by draw.
  template <class Number>
  void append(const inference::Chain& chain, std::vector<Number>& to) const {
    to.reserve(to.size() + chain.size() * slots);
    for (std::size_t i = 0; i < chain.size(); ++i)
      for (std::size_t s = 0; s < slots; ++s) to.push_back(static_cast<Number>(value(chain, i, s)));
    chain.let_go();
  }
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

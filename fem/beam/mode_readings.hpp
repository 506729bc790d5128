// Computes the gradients and shapes of one mode of the damaged beam. Internal to the reanalysis.
#pragma once

#include <span>
#include <vector>

#include "fem/beam/defect_columns.hpp"
#include "fem/beam/intact_modes.hpp"
#include "fem/beam/reanalysis.hpp"
#include "fem/root_search.hpp"

namespace wheeltap::fem::detail {

/// Throws std::invalid_argument unless `size` is 0 or the expected size.
void require_size(const char* name, std::size_t size, std::size_t expected);

/// Writes gradients and shapes into `Reanalysis::Results`, mode by mode; skips empty spans.
class ModeReadings {
 public:
  /// Throws std::invalid_argument if the size of a span does not fit.
  void set(const IntactModes& intact, const SecularKernel& kernel, const DefectColumns& columns,
           std::span<const Damage> damages, const Reanalysis::Results& results);

  /// False if only frequencies are requested.
  [[nodiscard]] bool wanted() const { return wanted_; }

  /// A mode of the secular problem.
  void read(const RootSearch& search, const RootSearch::Mode& mode);
  /// A rigid-body mode of the supported beam, or an intact mode if there is no defect.
  void read_unchanged(int root);

 private:
  void write(int root, double lambda);
  void write_shape(int root);

  const IntactModes* intact_ = nullptr;
  const SecularKernel* kernel_ = nullptr;
  const DefectColumns* columns_ = nullptr;
  std::span<const Damage> damages_;
  const Reanalysis::Results* results_ = nullptr;
  bool wanted_ = false;
  bool need_coordinates_ =
      false;  // of modes; true if results besides gradients of the defects are requested
  std::vector<double> column_strains_, coordinates_, element_strains_, point_rows_;
};

}  // namespace wheeltap::fem::detail

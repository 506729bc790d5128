// Computation of the gradients and the shape of one mode of the damaged beam. Internal to the
// reanalysis.
#pragma once

#include <span>
#include <vector>

#include "fem/beam/defect_columns.hpp"
#include "fem/beam/intact_modes.hpp"
#include "fem/beam/reanalysis.hpp"
#include "fem/root_search.hpp"

namespace wheeltap::fem::detail {

/// Throws std::invalid_argument unless `size` is 0 or `expected`.
void require_size(const char* name, std::size_t size, std::size_t expected);

/// Writes gradients and mode shapes into `Reanalysis::Results`, mode by mode. Empty spans are
/// skipped.
class ModeReadings {
 public:
  /// Throws std::invalid_argument if a span has the wrong size.
  void set(const IntactModes& intact, const SecularKernel& kernel, const DefectColumns& columns,
           std::span<const Damage> damages, const Reanalysis::Results& results);

  /// True if the caller requests results other than frequencies.
  [[nodiscard]] bool wanted() const { return wanted_; }

  /// Writes the results of a mode that is a root of the secular problem.
  void read(const RootSearch& search, const RootSearch::Mode& mode);
  /// Writes the results of a mode that the defects do not change: a rigid-body mode of the
  /// supported beam, or any intact mode if the beam has no defect.
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
      false;  // true if results other than the gradients for defects are requested
  std::vector<double> column_strains_, coordinates_, element_strains_, point_rows_;
};

}  // namespace wheeltap::fem::detail

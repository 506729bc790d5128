// Representation of the changes of a structure as columns of the secular problem. Internal to the
// reanalysis.
#pragma once

#include <vector>

#include "base/eigen.hpp"
#include "fem/secular.hpp"
#include "fem/structures/defects/structure_change.hpp"
#include "fem/structures/reanalysis/intact_structure.hpp"

namespace wheeltap::fem::detail {

/// The columns of the low-rank terms of a StructureChange: springs, added or removed masses, and
/// stiffness reductions (softenings). `DefectColumns` is the similar class for beams.
/// `ResidualModes` replace the modes that are not kept.
class ChangeColumns {
 public:
  /// Computes the columns of a change. Throws ImpossibleChange.
  void set(const IntactStructure& intact, const StructureChange& change,
           const SecularKernel& kernel);

  [[nodiscard]] int count() const {
    return stride == 0 ? 0 : static_cast<int>(columns.size() / stride);
  }
  /// Writes to `out` the displacement row · φ for each kept mode φ, then for each residual mode.
  void observe(const IntactStructure& intact, const SparseRow& row, double* out) const;
  /// Computes an upper bound of the relative error of a root. The root with residual modes exceeds
  /// the root of the whole structure by at most this bound; ∞ if no bound exists. `next` is the
  /// lowest eigenvalue of the omitted modes.
  [[nodiscard]] double bound(double found, int root, double next) const;

  std::vector<double> eigenvalues, scales, compliances;  // floating masses, kept, residual modes
  std::vector<double> columns;                           // count × stride, supports first
  int poles = 0, negative_poles = 0;  // numbers of floating masses, and of removed masses (which
                                      // come first)
  int supports = 0, held = 0;         // number of columns of springs and links, and number of rigid
                                      // ones
  int rigid = 0;                      // number of remaining rigid motions
  int extra = 0;                      // number of residual modes
  std::size_t stride = 0;
  double least_remaining = 1.0, added_stiffness = 0.0, residual_factor = 1.0;

 private:
  void set_residual_modes(const IntactStructure& intact, const StructureChange& change,
                          const std::vector<const StructureChange::Mass*>& masses);
  [[nodiscard]] int eigenvalues_below_at_most(double z, double next) const;

  std::vector<const StructureChange::Softening*> softenings_;
  std::vector<ResidualFlexibility::Form> forms_;  // one per spring, mass and softening
  Eigen::MatrixXd moments_[4];
  ResidualModes residual_;
  std::vector<double> raw_row_, mass_rows_;  // scratch
  Eigen::MatrixXd factor_;                   // L
};

}  // namespace wheeltap::fem::detail

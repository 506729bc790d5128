// Modes of a structure with parameters, damages and added masses, by reanalysis of one base
// structure.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "fem/beam/beam.hpp"
#include "fem/beam/reanalysis.hpp"
#include "fem/structures/mesh.hpp"
#include "fem/structures/modes/parametric_modes.hpp"
#include "fem/structures/reanalysis/scaled_structure.hpp"
#include "fem/structures/reanalysis/structure_reanalysis.hpp"
#include "identification/structural/defects/placed_defect.hpp"
#include "identification/structural/structure_family.hpp"

namespace wheeltap::identification {

/// A reanalysis represents unknown parameters as scales of the whole structure and as low-rank
/// changes (fem::ScaledStructure), in addition to the changes due to damages. Frequencies are
/// therefore as accurate as for known parameters: their relative error is 1e-9, or the error bound
/// of fem::StructureReanalysis. A beam whose parameters change only the scales is solved by
/// fem::Reanalysis.
///
/// The object is immutable; each thread needs a separate workspace.
class ReanalysedModes {
 public:
  /// `modes` is the largest number of elastic modes, `beam` the beam that the nominal structure
  /// represents (or null); `samples` holds parameter values of the model. Returns null if a
  /// reanalysis cannot represent these parameters. Throws fem::InvalidStructure,
  /// std::invalid_argument.
  [[nodiscard]] static std::shared_ptr<const ReanalysedModes> make(
      const std::shared_ptr<const StructureModel>& model, std::vector<DefectKind> kinds, int modes,
      const fem::Beam* beam, std::span<const std::vector<double>> samples);

  struct Workspace {
    std::optional<fem::Reanalysis::Workspace> beam = {};
    std::optional<fem::StructureReanalysis::Workspace> structure = {};
    fem::Defects placed = {};
    std::vector<double> frequencies = {}, shapes = {};
  };
  [[nodiscard]] Workspace make_workspace() const;

  struct Wanted {
    int modes = 1;                                            ///< number of elastic modes
    std::span<const fem::SparseRow> motions = {};             ///< displacements of the sensors
    std::span<const fem::StructureChange::Mass> masses = {};  ///< added masses
  };
  using Outcome = fem::ScaledStructure::Outcome;
  /// Computes eigenvalues and mode shapes for the parameter values `values` of the model.
  Outcome solve(std::span<const double> values, const std::vector<PlacedDefect>& defects,
                const Wanted& wanted, Workspace& workspace, fem::ParametricModes::Modes& out) const;

 private:
  using Scales = fem::ScaledStructure::Scales;

  ReanalysedModes(fem::ScaledStructure scaled, std::vector<DefectKind> kinds)
      : scaled_(std::move(scaled)), kinds_(std::move(kinds)) {}
  /// Computes frequencies [Hz] and shapes of the base beam or structure.
  Outcome solve_base(std::span<const double> values, const std::vector<PlacedDefect>& defects,
                     const Scales& scales, const Wanted& wanted, Workspace& workspace) const;

  fem::ScaledStructure scaled_;
  std::vector<DefectKind> kinds_;
  std::shared_ptr<const fem::Mesh> mesh_;  ///< mesh of the base structure; null without members
  std::optional<fem::Reanalysis> beam_;
  std::optional<fem::StructureReanalysis> structure_;
  int rigid_ = 0;
};

}  // namespace wheeltap::identification

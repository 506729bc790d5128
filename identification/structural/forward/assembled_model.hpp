// Forward model, by reanalysis, of a structure (members, chain or matrices) with a few defects.
#pragma once

#include "fem/structures/reanalysis/structure_reanalysis.hpp"
#include "identification/structural/forward/forward_model.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

class AssembledModel final : public ForwardModel {
 public:
  /// `modes` is the number of computed modes, including rigid-body modes. `motions` has the
  /// displacement that each sensor measures; it is empty if no shapes are needed. Throws
  /// fem::InvalidStructure, std::invalid_argument.
  AssembledModel(const AnyStructure& structure, std::vector<DefectKind> kinds, int modes,
                 int rigid_body_modes, std::vector<fem::SparseRow> motions = {});

  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override;

  [[nodiscard]] AllFrequencies all_frequencies() const override;

 private:
  class AssembledSolver;

  std::vector<DefectKind> kinds_;
  std::shared_ptr<const fem::Mesh> mesh_;  ///< mesh of a structure with members; null for other
                                           ///< structures
  fem::StructureReanalysis reanalysis_;
  std::size_t modes_, rigid_;
  std::vector<fem::SparseRow> motions_;
};

}  // namespace wheeltap::identification

// Predicted modes of the structure of a planned test, with and without defects.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identification/structural/damage/damage_case.hpp"
#include "identification/structural/forward/forward_model.hpp"
#include "identification/structural/modal_data.hpp"

namespace wheeltap::identification::planning {

/// A mass that is added to the structure for a second test configuration.
struct AddedMass {
  std::string name;        ///< "2 kg at B"
  AnyStructure structure;  ///< structure with the mass
};

/// Predicted values of the modes that a test measures.
struct TestModes {
  Eigen::VectorXd log_frequencies;  ///< ln f of each mode, identified by its shape
  Eigen::VectorXd in_order;         ///< ln f of the same number of modes, ascending
  /// Candidate sensors × modes, mass-normalised. Measured modes come first, then unmeasured modes
  /// that are close to a measured mode.
  Eigen::MatrixXd shapes;
  Eigen::MatrixXd with_mass;  ///< ln f with each mass, ascending (modes × added masses)
};

/// A possible location of a defect: one or several adjacent cells on the line of its kind.
struct TestPlace {
  int kind = 0;
  double location = 0.0;          ///< position on the kind's line at which the defect is predicted
  double from = 0.0, to = 0.0;    ///< interval on the kind's line
  int stretch = 0;                ///< index of the stretch of the line
  double start = 0.0, end = 0.0;  ///< [m] from the start of the site; 0 for points
  double prior = 0.0;             ///< P(location | one defect of the kind)
  std::string name = {};          ///< "beam at 0.25 m"
};

struct PlannedStructureOptions {
  /// Largest number of measured modes: the lowest elastic modes in the band
  int modes = 10;
  double low_hz = 0.0, high_hz = 1e300;  ///< frequency band
  std::vector<Sensor> candidates = {};
  std::vector<AddedMass> masses = {};
  int most_places = 120;  ///< if there are more locations, adjacent cells are joined
  /// Structure with unknown coefficients, each with a prior; null: all coefficients are known.
  std::shared_ptr<const StructureModel> unknown = {};
  bool uniform = false;  ///< true: all unknown coefficients act on the whole structure
};

/// Predicts by exact reanalysis (AssembledModel). Modes of a damaged structure are assigned to
/// modes of the intact structure by their shapes at the candidate sensors. The assignment minimises
/// Σ (1 - MAC + |Δ ln f| / 2). For closely spaced modes, only the frequencies are used, in
/// ascending order, because a small change of stiffness mixes their shapes (ModalLikelihood).
///
/// z are the standard normal coordinates of the priors of unknown coefficients; z = 0 means the
/// medians. Simulated tests use kDraws structures with z from a Latin hypercube (McKay, Beckman &
/// Conover 1979, Technometrics 21:239).
class PlannedStructure {
 public:
  /// Throws InvalidInput if no mode is in the band, if a kind of defect has an unknown extent or
  /// changes the stiffness of whole substructures, or if coefficients are unknown and the test adds
  /// masses.
  PlannedStructure(DamageCase damage_case, PlannedStructureOptions options);

  /// Working memory of one thread.
  class Solver {
   public:
    explicit Solver(const PlannedStructure& structure);
    /// Returns false if the structure is impossible with these defects. `draw` is the index of a
    /// draw of the unknown coefficients; -1: their medians.
    bool predict(const std::vector<PlacedDefect>& defects, TestModes& out, int draw = -1);

   private:
    std::vector<std::unique_ptr<ForwardModel::Solver>> draws_;  // null until first use
    const PlannedStructure& structure_;
    std::unique_ptr<ForwardModel::Solver> solver_;
    std::vector<std::unique_ptr<ForwardModel::Solver>> with_mass_;
    Prediction prediction_, frequencies_;
  };

  [[nodiscard]] const DamageCase& damage_case() const { return damage_case_; }
  [[nodiscard]] const std::vector<DefectKind>& kinds() const { return damage_case_.kinds; }
  [[nodiscard]] const std::vector<Sensor>& candidates() const { return options_.candidates; }
  [[nodiscard]] const std::vector<AddedMass>& masses() const { return options_.masses; }
  [[nodiscard]] const std::vector<TestPlace>& places() const { return places_; }
  /// Index of the TestPlace that contains a location; -1 if its prior probability is 0.
  [[nodiscard]] int place_of(int kind, double location) const;
  [[nodiscard]] const TestModes& intact() const { return intact_; }

  static constexpr int kDraws = 32;
  /// Number of unknown coefficients.
  [[nodiscard]] int unknowns() const;
  /// Returns the standard normal coordinates z of the unknown coefficients in one draw.
  [[nodiscard]] Eigen::VectorXd unknown_draw(int draw) const { return z_.col(draw); }
  /// Modes of the intact structure with one unknown coefficient at z = 1 and at z = -1.
  struct Steps {
    TestModes above, below;
  };
  [[nodiscard]] const std::vector<Steps>& steps() const { return steps_; }
  [[nodiscard]] const PlannedStructureOptions& options() const { return options_; }
  /// Candidate sensors × measured modes: shapes of the intact structure.
  [[nodiscard]] Eigen::MatrixXd intact_shapes() const { return intact_.shapes.leftCols(modes()); }
  /// Number of measured modes.
  [[nodiscard]] int modes() const { return static_cast<int>(chosen_.size()); }
  /// Indices of the measured modes among the elastic modes, from 0.
  [[nodiscard]] const std::vector<int>& chosen() const { return chosen_; }
  [[nodiscard]] std::vector<double> frequencies_hz() const;
  /// True if the shape of the mode is used; false for closely spaced modes.
  [[nodiscard]] bool has_shape(int mode) const {
    return close_[static_cast<std::size_t>(mode)] < 0;
  }
  /// Rotation of a mode by model errors towards another mode (-1: none), and the sd of the angle.
  struct Turn {
    int mode = -1;
    double tau = 0.0;
  };
  [[nodiscard]] const Turn& turn(int mode) const { return turns_[static_cast<std::size_t>(mode)]; }

 private:
  void choose_modes();
  void find_places();
  void draw_unknowns();
  [[nodiscard]] std::shared_ptr<const ForwardModel> model_at(const Eigen::VectorXd& z) const;
  void label(const fem::ParametricModes::Modes& modes, TestModes& out) const;

  DamageCase damage_case_;
  PlannedStructureOptions options_;
  std::shared_ptr<const ForwardModel> model_;
  int model_modes_ = 0;                  // number of computed modes
  std::vector<fem::SparseRow> motions_;  // displacements that the candidate sensors measure
  Eigen::MatrixXd z_;                    // unknowns × draws
  std::vector<std::shared_ptr<const ForwardModel>> draws_;
  std::vector<Steps> steps_;
  std::vector<std::shared_ptr<const ForwardModel>> with_mass_;
  std::vector<int> chosen_;
  std::vector<int> close_;  // group of modes without shapes; -1: has a shape
  std::vector<Turn> turns_;
  std::vector<int> neighbours_;  // unmeasured modes that are close to a measured mode
  std::vector<TestPlace> places_;
  std::vector<std::vector<int>> place_of_cell_;  // per kind
  TestModes intact_;
};

}  // namespace wheeltap::identification::planning

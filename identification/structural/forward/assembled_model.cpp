#include "identification/structural/forward/assembled_model.hpp"

#include <algorithm>
#include <stdexcept>
#include <variant>

#include "base/constants.hpp"
#include "identification/structural/elastic_modes.hpp"

namespace wheeltap::identification {
namespace {

std::shared_ptr<const fem::Mesh> mesh_of(const AnyStructure& structure) {
  const auto* members = std::get_if<fem::Structure>(&structure);
  return members == nullptr ? nullptr : std::make_shared<const fem::Mesh>(*members);
}

}  // namespace

class AssembledModel::AssembledSolver final : public Solver {
 public:
  explicit AssembledSolver(const AssembledModel& model)
      : model_(model),
        workspace_(model.reanalysis_.make_workspace()),
        all_(model.modes_),
        shapes_(model.modes_ * model.motions_.size()) {}

  bool predict(std::span<const double> /*theta*/, const std::vector<PlacedDefect>& defects,
               Quantity quantity, Prediction& out) override {
    if (quantity == Quantity::slopes) return false;
    if (quantity == Quantity::modes) {
      out.modes.resize(1);
      return solve_modes(defects, out.modes[0]);
    }
    if (!solve(defects, {.frequencies_hz = all_})) return false;
    const std::size_t first = first_elastic(all_, model_.rigid_);
    std::copy_n(all_.begin() + static_cast<std::ptrdiff_t>(first), out.frequencies_hz.size(),
                out.frequencies_hz.begin());
    return true;
  }

 private:
  bool solve_modes(const std::vector<PlacedDefect>& defects, fem::ParametricModes::Modes& out) {
    if (!solve(defects, {.frequencies_hz = all_, .shapes = shapes_, .motions = model_.motions_}))
      return false;
    const std::size_t first = first_elastic(all_, model_.rigid_);
    const std::size_t count = all_.size() - model_.rigid_, sensors = model_.motions_.size();
    out.eigenvalues.resize(static_cast<Eigen::Index>(count));
    out.shapes.resize(static_cast<Eigen::Index>(sensors), static_cast<Eigen::Index>(count));
    for (std::size_t i = 0; i < count; ++i) {
      const double omega = kTwoPi * all_[first + i];
      out.eigenvalues[static_cast<Eigen::Index>(i)] = omega * omega;
      for (std::size_t s = 0; s < sensors; ++s)
        out.shapes(static_cast<Eigen::Index>(s), static_cast<Eigen::Index>(i)) =
            shapes_[(first + i) * sensors + s];
    }
    return true;
  }

  bool solve(const std::vector<PlacedDefect>& defects,
             const fem::StructureReanalysis::Results& results) {
    try {
      model_.reanalysis_.solve(structure_change(model_.kinds_, defects, model_.mesh_.get()),
                               workspace_, results);
    } catch (const fem::ImpossibleChange&) {
      return false;
    }
    return true;
  }

  const AssembledModel& model_;
  fem::StructureReanalysis::Workspace workspace_;
  std::vector<double> all_, shapes_;
};

AssembledModel::AssembledModel(const AnyStructure& structure, std::vector<DefectKind> kinds,
                               int modes, int rigid_body_modes, std::vector<fem::SparseRow> motions)
    : kinds_(std::move(kinds)),
      mesh_(mesh_of(structure)),
      reanalysis_(std::make_shared<const fem::Discretisation>(mesh_ ? mesh_->discretisation()
                                                                    : discretise(structure)),
                  modes),
      modes_(static_cast<std::size_t>(motions.empty() ? modes : reanalysis_.modes())),
      rigid_(static_cast<std::size_t>(rigid_body_modes)),
      motions_(std::move(motions)) {}

std::unique_ptr<ForwardModel::Solver> AssembledModel::make_solver() const {
  return std::make_unique<AssembledSolver>(*this);
}

ForwardModel::AllFrequencies AssembledModel::all_frequencies() const {
  return [this, workspace = std::make_shared<fem::StructureReanalysis::Workspace>(
                    reanalysis_.make_workspace())](const std::vector<PlacedDefect>& defects) {
    std::vector<double> f(static_cast<std::size_t>(reanalysis_.modes()));
    try {
      reanalysis_.solve(structure_change(kinds_, defects, mesh_.get()), *workspace,
                        {.frequencies_hz = f});
    } catch (const std::invalid_argument&) {
      f.clear();
    }
    return f;
  };
}

}  // namespace wheeltap::identification

// Occam's window: selects the models to explore from a long list of nested models.
#pragma once

#include <vector>

#include "inference/exploration/model_exploration.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::inference {

/// The models of a nested list ordered by inclusion. Model a is one step within model b if the
/// parameters of a are a subset of the parameters of b and no third model lies between a and b.
class ModelLattice {
 public:
  explicit ModelLattice(const ModelSpace& space);

  /// `within`: models one step within m. `around`: models b such that m is one step within b.
  [[nodiscard]] const std::vector<int>& within(int m) const { return at(m).within; }
  [[nodiscard]] const std::vector<int>& around(int m) const { return at(m).around; }
  /// Smallest number of steps from m to a model that contains no nested model.
  [[nodiscard]] int level(int m) const { return at(m).level; }

 private:
  struct Place {
    std::vector<int> within{}, around{};
    int level = 0;
  };
  [[nodiscard]] const Place& at(int m) const { return places_[static_cast<std::size_t>(m)]; }
  std::vector<Place> places_;
};

/// The models of a nested list to explore next, in order of size; empty at the end. Nearly all of
/// the 2^n subsets of n terms lack a necessary term or contain a superfluous term. The search
/// therefore explores
///
/// - all models up to two steps from the smallest model, because some terms matter only in pairs;
/// - the models one step above or below each model whose probability is at least e^-12 (6e-6) of
///   the largest probability (Madigan & Raftery 1994, JASA 89:1535, section 3, in both directions);
/// - finally the largest model, whose maximum likelihood is at least as large as that of every
///   other model;
/// - the models one step within each explored model whose largest ln π exceeds that of the most
///   probable model by more than 10 nats.
[[nodiscard]] std::vector<int> next_in_window(const ModelSpace& space, const ModelLattice& lattice,
                                              const std::vector<ModelExploration>& explorations);

/// A starting point for model m: the best posterior mode of the most probable explored
/// model in around(m), without the parameters that m lacks. Empty if no model in around(m) was
/// explored.
[[nodiscard]] std::vector<double> start_from_around(
    const ModelSpace& space, const ModelLattice& lattice, int m,
    const std::vector<ModelExploration>& explorations);

}  // namespace wheeltap::inference

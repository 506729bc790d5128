// Which of very many nested models to look at: Occam's window.
#pragma once

#include <vector>

#include "inference/exploration/model_exploration.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::inference {

/// The models of a nested list by what they have: a model is one step within another where its
/// parameters are some of the other's and no third model lies between the two.
class ModelLattice {
 public:
  explicit ModelLattice(const ModelSpace& space);

  /// The models one step within m, and those that it is one step within.
  [[nodiscard]] const std::vector<int>& within(int m) const { return at(m).within; }
  [[nodiscard]] const std::vector<int>& around(int m) const { return at(m).around; }
  /// Steps from a model that none is within, at least.
  [[nodiscard]] int level(int m) const { return at(m).level; }

 private:
  struct Place {
    std::vector<int> within{}, around{};
    int level = 0;
  };
  [[nodiscard]] const Place& at(int m) const { return places_[static_cast<std::size_t>(m)]; }
  std::vector<Place> places_;
};

/// Models of a nested list that are to be looked at next, the smaller first; none when that is
/// done. Of n terms there are 2^n sets, and nearly all of them lack what the data ask for, or have
/// what they do not. So models are looked at
///
/// - up to two steps from the least: terms that show only together are pairs;
/// - one step, more or less, from each whose probability is within e^-12 (6e-6) of the likeliest's
///   (Madigan & Raftery 1994, JASA 89:1535, section 3, to both sides);
/// - at last the largest, for what all others may have missed: its likelihood's height is above
///   theirs. While one is higher than the likeliest model by 10 nats, the models one step within it
///   are looked at, too.
[[nodiscard]] std::vector<int> next_in_window(const ModelSpace& space, const ModelLattice& lattice,
                                              const std::vector<ModelExploration>& explorations);

/// The mode of the likeliest model one step around m, without what m lacks; empty where none of
/// these has been looked at.
[[nodiscard]] std::vector<double> start_from_around(
    const ModelSpace& space, const ModelLattice& lattice, int m,
    const std::vector<ModelExploration>& explorations);

}  // namespace wheeltap::inference

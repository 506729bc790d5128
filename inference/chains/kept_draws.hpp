// An evenly thinned subset of the draws of one Markov chain, of limited size for each model.
#pragma once

#include <vector>

#include <algorithm>

#include "inference/model/target.hpp"

namespace wheeltap::inference {

struct CheckpointFields;  // checkpoint.cpp

/// Stores between kKeep and 2 kKeep draws of each model, in order and at equal intervals. If a
/// model has more draws, every second draw is deleted and the thinning interval doubles.
class KeptDraws {
 public:
  struct OfModel {
    std::size_t dimension = 0;
    std::vector<double> z;  ///< draws × dimension, row after row
    /// Log posterior density with respect to dz (ModelPosterior)
    std::vector<double> log_posterior;
    long visits = 0, stride = 1;

    [[nodiscard]] std::size_t size() const { return log_posterior.size(); }
    [[nodiscard]] std::span<const double> row(std::size_t i) const {
      return {z.data() + i * dimension, dimension};
    }
  };

  explicit KeptDraws(const ModelSpace& space) : models_(static_cast<std::size_t>(space.size())) {
    for (int m = 0; m < space.size(); ++m)
      models_[static_cast<std::size_t>(m)].dimension = static_cast<std::size_t>(space[m].dimension);
  }

  void add(const State& state, double log_posterior) {
    OfModel& of = models_[static_cast<std::size_t>(state.model)];
    if (of.visits++ % of.stride != 0) return;
    of.z.insert(of.z.end(), state.z.begin(), state.z.end());
    of.log_posterior.push_back(log_posterior);
    if (of.size() < 2 * kKeep) return;
    const auto d = static_cast<std::ptrdiff_t>(of.dimension);
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(kKeep); ++i) {
      std::copy_n(of.z.begin() + 2 * i * d, d, of.z.begin() + i * d);
      of.log_posterior[static_cast<std::size_t>(i)] =
          of.log_posterior[static_cast<std::size_t>(2 * i)];
    }
    of.z.resize(kKeep * of.dimension);
    of.log_posterior.resize(kKeep);
    of.stride *= 2;
  }

  [[nodiscard]] const OfModel& of(int model) const {
    return models_[static_cast<std::size_t>(model)];
  }

 private:
  friend struct CheckpointFields;
  KeptDraws() = default;

  static constexpr std::size_t kKeep = 2000;
  std::vector<OfModel> models_;
};

}  // namespace wheeltap::inference

// The draws of one Markov chain over models and their parameters, and a view of one draw.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "inference/chains/draw_list.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::inference {

/// A view of one draw, valid as long as its chain and its model space exist.
struct Draw {
  const ModelSpace* space = nullptr;
  int model = 0;
  std::span<const double> theta;  ///< physical parameters of the model, in the layout of Model
  double log_prior = 0.0, log_likelihood = 0.0;

  [[nodiscard]] double log_posterior() const { return log_prior + log_likelihood; }
  /// Number of components of this kind in the model of the draw.
  [[nodiscard]] int count(int kind) const {
    return (*space)[model].counts[static_cast<std::size_t>(kind)];
  }
  /// The parameters of component c < count(kind).
  [[nodiscard]] std::span<const double> component(int kind, int c) const {
    return space->component(model, kind, c).of(theta);
  }
};

/// The kept draws of one chain. `theta` holds the parameters as draws × dimension, row by row. Rows
/// of models with fewer parameters are padded with NaN.
struct Chain {
  DrawList<int> model;
  DrawList<double> theta;      ///< physical parameters, in the layout of Model
  DrawList<double> log_prior;  ///< log prior density: ln P(model) + Σ ln p(x) + ln prior factor
  DrawList<double> log_likelihood;
  DrawList<std::int16_t> move;  ///< last attempted move, as an index into Posterior::moves
  DrawList<std::uint8_t> accepted;
  DrawList<float> prediction;  ///< draws × Posterior::predictions, or empty

  [[nodiscard]] std::size_t size() const { return model.size(); }
  /// Memory of all lists [bytes].
  [[nodiscard]] std::size_t bytes() const;
  /// Draw i < size() of the chain; `space` is its model space.
  [[nodiscard]] Draw draw(std::size_t i, const ModelSpace& space) const {
    const auto width = static_cast<std::size_t>(space.max_dimension());
    const auto own = static_cast<std::size_t>(space[model[i]].dimension);
    return {.space = &space,
            .model = model[i],
            .theta = std::span(theta).subspan(i * width, own),
            .log_prior = log_prior[i],
            .log_likelihood = log_likelihood[i]};
  }
  /// Removes all draws, but keeps the storage folder.
  void clear() { truncate(0); }
  /// Keeps only the first `draws` draws.
  void truncate(std::size_t draws);
  /// Appends the draws of `more`, a chain over the same model space.
  void append(const Chain& more);
  /// Stores large lists of draws in a file in `folder` instead of on the heap (DrawMemory).
  void keep_in(const std::filesystem::path& folder);
  /// Reserves memory for `draws` draws with `dimension` parameters and `predictions` predictions
  /// each.
  void reserve(std::size_t draws, std::size_t dimension, std::size_t predictions);
  /// Waits until all draws are written to disk. Throws DrawsLost if writing fails.
  void settle() const;
  /// Allows the operating system to move draws from memory to disk until the next access.
  void let_go() const;
};

}  // namespace wheeltap::inference

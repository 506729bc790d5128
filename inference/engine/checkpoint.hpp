// A run between two iterations as columns of numbers under names: what a file can hold.
#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "inference/engine/run_state.hpp"

namespace wheeltap::inference {

/// The columns of a RunState. A member of a structure is a column of its name,
/// "chains.lesson.steps", with one number a structure, in order; a list adds its length to "….size"
/// and its entries to the column of its name ("….each" where they are lists themselves), a matrix
/// its shape to "….rows" and "….columns". So there are as many columns as there are members,
/// however many chains, models or draws.
struct Checkpoint {
  /// Changes whenever a member does.
  static constexpr int kFormat = 7;

  using Column =
      std::variant<std::vector<double>, std::vector<float>, std::vector<std::int64_t>,
                   std::vector<std::int32_t>, std::vector<std::int16_t>, std::vector<std::uint8_t>>;
  std::map<std::string, Column> columns;
};

/// Columns that are no run of the problem that they are to be one of.
class CheckpointError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Without the first so many draws of each chain; empty: of none.
[[nodiscard]] Checkpoint checkpoint_of(const RunState& state,
                                       std::vector<std::size_t> without = {});

/// Draws first, …, last - 1 of a chain alone.
[[nodiscard]] Checkpoint draws_of(const Chain& chain, std::size_t first, std::size_t last);
/// Such draws. Throws CheckpointError where there are not `n`.
[[nodiscard]] Chain draws_in(const Checkpoint& part, std::size_t n);
/// The numbers of the parts that a run's checkpoint stands on: the first, and how many.
[[nodiscard]] std::pair<long, long> parts_of(const Checkpoint& checkpoint);

/// The run, to the last bit. What follows from the rest is left out of the columns and made again:
/// the space, the conditional proposals, what the last weighing found. Throws CheckpointError where
/// a column is missing, too short, too long or unknown, or speaks of another number of chains,
/// models or parameters.
[[nodiscard]] RunState state_of(const Checkpoint& checkpoint, const ModelSpace& space, int chains);

/// A chain and its draws for another rank of the same run, and back, to the last bit. No format for
/// files.
[[nodiscard]] std::string packed_state(const ChainState& chain, const Chain& draws);
void unpack(std::string_view bytes, ChainState& chain, Chain& draws);

}  // namespace wheeltap::inference

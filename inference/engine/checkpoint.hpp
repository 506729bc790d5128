// State of a run between two iterations, as named columns of numbers that a file can store.
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

/// The columns of a RunState. A member of a structure is a column of its name, e.g.
/// "chains.adaptation.steps", with one number per structure, in order. A list adds its length to
/// "….size" and its entries to the column of its name ("….each" if they are lists themselves). A
/// matrix adds its shape to "….rows" and "….columns". The number of columns therefore does not
/// depend on the number of chains, models or draws.
struct Checkpoint {
  /// Increased whenever a member changes.
  static constexpr int kFormat = 8;

  using Column =
      std::variant<std::vector<double>, std::vector<float>, std::vector<std::int64_t>,
                   std::vector<std::int32_t>, std::vector<std::int16_t>, std::vector<std::uint8_t>>;
  std::map<std::string, Column> columns;
};

/// Thrown if the columns do not describe a run of the given problem.
class CheckpointError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Without the first `without[c]` draws of each chain c; empty: with all draws.
[[nodiscard]] Checkpoint checkpoint_of(const RunState& state,
                                       std::vector<std::size_t> without = {});

/// Only the draws first, …, last - 1 of a chain.
[[nodiscard]] Checkpoint draws_of(const Chain& chain, std::size_t first, std::size_t last);
/// Reads these draws. Throws CheckpointError if there are not `n`.
[[nodiscard]] Chain draws_in(const Checkpoint& part, std::size_t n);
/// The parts that a run's checkpoint needs: the number of the first part, and how many.
[[nodiscard]] std::pair<long, long> parts_of(const Checkpoint& checkpoint);

/// Restores the run, bit for bit. The columns omit the parts that follow from the rest: the model
/// space, the conditional proposals and the results of the last evidence computation. Throws
/// CheckpointError if a column is missing, too short, too long or unknown, or belongs to another
/// number of chains, models or parameters.
[[nodiscard]] RunState state_of(const Checkpoint& checkpoint, const ModelSpace& space, int chains);

/// A chain and its draws, packed for another rank of the same run and unpacked bit for bit. Not a
/// file format.
[[nodiscard]] std::string packed_state(const ChainState& chain, const Chain& draws);
void unpack(std::string_view bytes, ChainState& chain, Chain& draws);

}  // namespace wheeltap::inference

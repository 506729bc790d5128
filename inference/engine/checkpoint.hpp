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

/// The columns of a RunState. Each data member of a struct becomes a column with the name of the
/// member, e.g. "chains.adaptation.steps", and one number per struct, in order. A list appends its
/// length to the column "….size" and its entries to the column of its name ("….each" if the entries
/// are lists). A matrix appends its size to the columns "….rows" and "….columns". The number of
/// columns therefore does not depend on the number of chains, models or draws.
struct Checkpoint {
  /// Version number of the format, increased whenever a member of the run state changes.
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

/// The state of a run as columns. The first `without[c]` draws of each chain c are omitted; if
/// `without` is empty, no draws are omitted.
[[nodiscard]] Checkpoint checkpoint_of(const RunState& state,
                                       std::vector<std::size_t> without = {});

/// The draws first, …, last - 1 of a chain as columns.
[[nodiscard]] Checkpoint draws_of(const Chain& chain, std::size_t first, std::size_t last);
/// Reads draws from columns. Throws CheckpointError if the number of draws is not `n`.
[[nodiscard]] Chain draws_in(const Checkpoint& part, std::size_t n);
/// The separately saved parts of the draws that a checkpoint needs: index of the first part, and
/// number of parts.
[[nodiscard]] std::pair<long, long> parts_of(const Checkpoint& checkpoint);

/// Restores the run, bit for bit. The columns omit whatever can be recomputed: the model space, the
/// conditional proposals and the results of the last evidence computation. Throws CheckpointError
/// if a column is missing, too short, too long or unknown, or if the columns belong to a different
/// number of chains, models or parameters.
[[nodiscard]] RunState state_of(const Checkpoint& checkpoint, const ModelSpace& space, int chains);

/// Packs a chain and its draws for another rank of the same run, which unpacks them bit for bit.
/// The packed bytes are not a file format.
[[nodiscard]] std::string packed_state(const ChainState& chain, const Chain& draws);
void unpack(std::string_view bytes, ChainState& chain, Chain& draws);

}  // namespace wheeltap::inference

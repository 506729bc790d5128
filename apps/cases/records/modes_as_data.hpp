// A modes.json as the data of a damage or an update case: {"from": "modal/modes.json"}.
#pragma once

#include "apps/cases/records/modes_file.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/modal_data.hpp"

namespace wheeltap::apps {

struct TakenModes {
  std::filesystem::path path = {};
  std::string name = {};  ///< as the case says it
  MeasuredModes file = {};
  std::vector<int> modes = {};     ///< rows of `file` that are taken, ascending
  std::vector<int> numbers = {};   ///< the row of the data that each becomes: 0 is mode 1
  std::vector<int> doubtful = {};  ///< rows of `file` that are left out because they are doubtful

  /// {"sensors": [...]}, each with its node and direction, as a case of the file's name: for
  /// messages.
  [[nodiscard]] CaseFile sensors_as_case() const;
};

/// What the data block at `where` takes from its "from": the modes that "modes" lists (their
/// numbers, or how many of the lowest), or all but the doubtful ones. Each keeps its number, or has
/// the one that "model_modes" gives. Throws Failure: 66 for a file that cannot be read, 65 for one
/// that is no modes.json, for keys that say again what it says, and for modes that it lacks.
[[nodiscard]] TakenModes take_modes(const CaseFile& file, const Pointer& where);

/// Frequencies with their covariance, and shapes as real lines with theirs, of the channels that
/// `out.sensors` are; see identification/modal/real_shape.hpp. Modes that are not taken leave gaps,
/// so that the others keep their numbers. Fewer than two channels leave no shapes. Throws Failure
/// (65), naming the modes.json, for covariances that are not positive definite.
void fill(const TakenModes& taken, const std::vector<Eigen::Index>& channels,
          identification::ModalData& out);

}  // namespace wheeltap::apps

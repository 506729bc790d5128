// A modes.json as the data of a damage or an update case: {"from": "modal/modes.json"}.
#pragma once

#include "apps/cases/records/modes_file.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/modal_data.hpp"

namespace wheeltap::apps {

struct TakenModes {
  std::filesystem::path path = {};
  std::string name = {};  ///< as written in the case
  MeasuredModes file = {};
  std::vector<int> modes = {};     ///< rows of `file` that are used, ascending
  std::vector<int> numbers = {};   ///< row of the data for each: 0 is mode 1
  std::vector<int> doubtful = {};  ///< doubtful rows of `file`, not used

  /// A case with the name of the file and {"sensors": [...]}, each with node and direction, for
  /// error messages.
  [[nodiscard]] CaseFile sensors_as_case() const;
};

/// Reads the modes.json that "from" of the data block at `where` names. Uses the modes of "modes"
/// (a list of numbers, or a count of the lowest), or all that are not doubtful. Each mode keeps its
/// number, or gets the number in "model_modes". Throws Failure: 66 for an unreadable file; 65 for
/// another type of file, for keys of the case that the file replaces, and for modes that the file
/// does not contain.
[[nodiscard]] TakenModes take_modes(const CaseFile& file, const Pointer& where);

/// Fills in frequencies and real shapes with their covariances, for the channels of `out.sensors`;
/// see identification/modal/real_shape.hpp. Modes that are not used leave gaps, so that the others
/// keep their numbers. With fewer than two channels there are no shapes. Throws Failure (65),
/// naming the modes.json, for covariances that are not positive definite.
void fill(const TakenModes& taken, const std::vector<Eigen::Index>& channels,
          identification::ModalData& out);

}  // namespace wheeltap::apps

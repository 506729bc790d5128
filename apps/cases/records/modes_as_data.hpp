// Use of a modes.json as the data of a damage or an update case: {"from": "modal/modes.json"}.
#pragma once

#include "apps/cases/records/modes_file.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/modal_data.hpp"

namespace wheeltap::apps {

struct TakenModes {
  std::filesystem::path path = {};
  std::string name = {};  ///< name of the file, as written in the case
  ModesFile file = {};
  std::vector<int> modes = {};     ///< rows of `file` that are used, ascending
  std::vector<int> numbers = {};   ///< row of each used mode in the data; row 0 is mode 1
  std::vector<int> doubtful = {};  ///< rows of `file` with doubtful modes, which are not used

  /// A CaseFile with the path of the modes.json and the content {"sensors": [...]}, for error
  /// messages. Each sensor has a node and a direction.
  [[nodiscard]] CaseFile sensors_as_case() const;
};

/// Reads the file modes.json that the key "from" in the data block at `where` names. The key
/// "modes" selects modes: a list of mode numbers, or the number of lowest modes. Without this key,
/// all modes that are not doubtful are used. Each mode keeps its number, or gets the number in
/// "model_modes". Throws Failure (66) for an unreadable file. Throws Failure (65) for another type
/// of file, for keys of the case that the file replaces, and for modes that the file does not
/// contain.
[[nodiscard]] TakenModes take_modes(const CaseFile& file, const Pointer& where);

/// Fills in frequencies and real shapes with their covariances, for the channels of `out.sensors`;
/// see identification/modal/real_shape.hpp. Rows of modes that are not used contain NaN, so that
/// the other modes keep their numbers. With fewer than two channels, `out` contains no shapes.
/// Throws Failure (65), naming the modes.json, for covariances that are not positive definite.
void fill(const TakenModes& taken, const std::vector<Eigen::Index>& channels,
          identification::ModalData& out);

}  // namespace wheeltap::apps

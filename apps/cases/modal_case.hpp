// A modal case file: which record, which of its channels, which band.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/cases/records/measured_file.hpp"
#include "apps/cases/records/modal_geometry.hpp"
#include "apps/cases/records/modes_file.hpp"
#include "apps/cases/records/record_reading.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "identification/modal/modal_record.hpp"
#include "signals/modal/merged_modes.hpp"
#include "signals/record.hpp"

namespace wheeltap::apps {

/// One record: sensors in their places.
struct SetUp : identification::ModalRecord {
  Pointer where{};                           ///< of its block in the case
  std::string name = {};                     ///< of its file
  std::vector<MeasuredSensor> sensors = {};  ///< a response channel each
  std::vector<int> which = {};               ///< among the sensors of all set-ups
  std::vector<Pointer> places = {};          ///< of their blocks in the case
  std::vector<std::string> oddities = {};    ///< of channels, in sentences
  std::vector<ChannelUse> channels = {};     ///< responses, then forces
  signals::Sampling sampling = {};
  std::optional<io::FoundLayout> layout = {};  ///< of a record in delimited text
  std::vector<std::string> inputs = {};        ///< of the frequency responses
};

struct ModalCaseFile {
  CaseFile file;
  std::string title = {};
  std::vector<SetUp> set_ups = {};
  std::vector<MeasuredSensor> sensors = {};  ///< of all set-ups, each once
  std::optional<Geometry> geometry = {};
  bool pre_merged = false;    ///< set-ups are merged before they are identified
  std::string quantity = {};  ///< of the shapes, as modes.json says it
  /// Of pre-merged set-ups: channels at the sensors that all have, in one order.
  std::vector<std::vector<int>> references = {};
};

/// What the records of a case gave.
struct IdentifiedModes {
  std::vector<signals::ModalResult> set_ups = {};   ///< one of all, where they are pre-merged
  std::optional<signals::MergedModes> merged = {};  ///< of several
};

/// Reads, checks and parses, and reads the records, or takes the one that is `given` in place of
/// the file of a single one. Throws Failure.
[[nodiscard]] ModalCaseFile parse_modal_case(CaseFile file,
                                             std::optional<signals::Record> given = {});

}  // namespace wheeltap::apps

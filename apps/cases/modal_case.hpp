// A modal case file: records, channels, band and method.
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

/// One record with its sensors.
struct SetUp : identification::ModalRecord {
  Pointer where{};                           ///< location of the record in the case
  std::string name = {};                     ///< name of the file
  std::vector<MeasuredSensor> sensors = {};  ///< sensor of each response channel
  std::vector<int> which = {};               ///< index of each sensor in ModalCaseFile::sensors
  std::vector<Pointer> places = {};          ///< locations of the sensors in the case
  std::vector<std::string> oddities = {};    ///< messages about faulty channels
  std::vector<ChannelUse> channels = {};     ///< response channels, then force channels
  signals::Sampling sampling = {};
  /// Layout of the file, if the record is delimited text
  std::optional<io::FoundLayout> layout = {};
  std::vector<std::string> inputs = {};  ///< inputs of the frequency response functions
};

struct ModalCaseFile {
  CaseFile file;
  std::string title = {};
  std::vector<SetUp> set_ups = {};
  std::vector<MeasuredSensor> sensors = {};  ///< sensors of all set-ups without repetition
  std::optional<Geometry> geometry = {};
  bool pre_merged = false;    ///< true if set-ups are merged before identification
  std::string quantity = {};  ///< quantity of the shapes, as in modes.json
  /// For pre-merged set-ups: the channels of each set-up at the sensors common to all set-ups.
  std::vector<std::vector<int>> references = {};
};

/// Modes identified from the records of a case.
struct IdentifiedModes {
  /// Result of each set-up; a single result if set-ups are pre-merged
  std::vector<signals::ModalResult> set_ups = {};
  /// Merged modes, if the case has several set-ups
  std::optional<signals::MergedModes> merged = {};
};

/// Validates and parses a case and reads its records. If `given` is set, this record replaces the
/// record that the case names. Throws Failure.
[[nodiscard]] ModalCaseFile parse_modal_case(CaseFile file,
                                             std::optional<signals::Record> given = {});

}  // namespace wheeltap::apps

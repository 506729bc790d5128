// A modal case file: which record, which of its channels, which band.
#pragma once

#include <string>
#include <vector>

#include "apps/case_file.hpp"
#include "apps/measured_file.hpp"
#include "apps/modes_file.hpp"
#include "signals/modal_identification.hpp"

namespace wheeltap::apps {

struct ModalCaseFile {
  CaseFile file;
  std::string title;
  std::vector<MeasuredSensor> sensors;  ///< a response channel each
  std::vector<Pointer> places;          ///< of their blocks in the case
  Eigen::MatrixXd records;              ///< a response a row
  std::vector<std::string> oddities;    ///< of channels, in sentences
  signals::ModalOptions options;
};

/// Reads, checks and parses, and reads the record. Throws Failure.
[[nodiscard]] ModalCaseFile parse_modal_case(CaseFile file);

}  // namespace wheeltap::apps

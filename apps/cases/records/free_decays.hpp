// Windows of free decays in a record.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

/// Parses the list at `where`: for each free decay, the samples [first, one past the last]. Refuses
/// a window that is empty or exceeds the `samples` of the record, and overlapping windows, whose
/// samples would count twice.
[[nodiscard]] std::vector<std::pair<Eigen::Index, Eigen::Index>> parse_decays(const CaseFile& file,
                                                                              const Pointer& where,
                                                                              Eigen::Index samples);

}  // namespace wheeltap::apps

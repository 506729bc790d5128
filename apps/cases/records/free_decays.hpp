// Windows of free decays in a record.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

/// Parses the list at `where`: for each free decay, the indices [first sample, one past the last
/// sample]. Rejects an empty window, a window beyond the `samples` of the record, and overlapping
/// windows, which would use samples twice.
[[nodiscard]] std::vector<std::pair<Eigen::Index, Eigen::Index>> parse_decays(const CaseFile& file,
                                                                              const Pointer& where,
                                                                              Eigen::Index samples);

}  // namespace wheeltap::apps

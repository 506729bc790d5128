// The record of a system-identification case, from a file or simulated.
#pragma once

#include "apps/cases/sid_case.hpp"
#include "signals/record.hpp"

namespace wheeltap::apps {

/// Reads `columns` of the file whose path is at `where`. If `columns` is empty, all columns except
/// `ignored` are read. The layout of the file is in the object that contains `where`. Throws
/// Failure.
[[nodiscard]] signals::Record read_record(const CaseFile& file, const Pointer& where,
                                          std::vector<std::string> columns = {},
                                          std::vector<std::string> ignored = {});

/// Reads or simulates the record and stores it in the case. Also stores remarks on the record, and
/// the initial states to be inferred. Throws Failure.
void load_record(SidCaseFile& parsed);

}  // namespace wheeltap::apps

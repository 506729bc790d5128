// The record that a system-identification case names, or simulates.
#pragma once

#include "apps/cases/sid_case.hpp"
#include "signals/record.hpp"

namespace wheeltap::apps {

/// These columns of the record whose path stands at `where`, all where none are named but those to
/// be ignored, in the layout that the block about it states. Throws Failure.
[[nodiscard]] signals::Record read_record(const CaseFile& file, const Pointer& where,
                                          std::vector<std::string> columns = {},
                                          std::vector<std::string> ignored = {});

/// Reads the record, or simulates it, and puts it into the case, its initial states where they are
/// to be inferred, and what it makes one doubt. Throws Failure.
void load_record(SidCaseFile& parsed);

}  // namespace wheeltap::apps

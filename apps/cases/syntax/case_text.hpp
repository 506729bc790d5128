// Parses a case from a text in memory.
#pragma once

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

/// Parses `text` as the content of `path`, like read_case. Throws Failure like read_case. Defined
/// in case_file.cpp.
[[nodiscard]] CaseFile parse_case(const std::filesystem::path& path, const std::string& text,
                                  const std::vector<std::string>& overrides = {});

}  // namespace wheeltap::apps

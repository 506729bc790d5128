// A case that is no file.
#pragma once

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

/// The case with this text, as if it stood in `path`: what read_case does once it has read. Throws
/// Failure as that does. Defined in case_file.cpp.
[[nodiscard]] CaseFile parse_case(const std::filesystem::path& path, const std::string& text,
                                  const std::vector<std::string>& overrides = {});

}  // namespace wheeltap::apps

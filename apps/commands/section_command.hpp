// `wheeltap section`: properties of a cross-section.
#pragma once

#include <string>

#include "apps/run_options.hpp"

namespace wheeltap::apps {

struct SectionOptions {
  std::string name;   ///< name of one section of the structure
  bool json = false;  ///< print JSON
};

/// Prints the properties of the section of a case, or of a file that contains one section and a
/// Poisson's ratio. If `common.output` is set, also writes a figure of the section into this file.
/// Throws Failure.
void run_section(const CommonOptions& common, const SectionOptions& options);

}  // namespace wheeltap::apps

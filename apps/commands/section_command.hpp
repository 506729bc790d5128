// `wheeltap section`: properties of a cross-section.
#pragma once

#include <string>

#include "apps/run_options.hpp"

namespace wheeltap::apps {

struct SectionOptions {
  std::string name;   ///< one of the structure's sections
  bool json = false;  ///< print JSON
};

/// Prints the properties of the section of a case, or of a file that holds one section and a
/// Poisson's ratio. Draws the section into `common.output` if that is given. Throws Failure.
void run_section(const CommonOptions& common, const SectionOptions& options);

}  // namespace wheeltap::apps

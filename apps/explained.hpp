// Conversion of library errors to error messages about the case.
#pragma once

#include "identification/invalid_input.hpp"

namespace wheeltap::apps {

/// Runs work(). `file` (DamageCaseFile, SidCaseFile) locates library errors in its case. Throws
/// Failure.
template <class File, class Work>
auto explained(const File& file, const Work& work) {
  try {
    return work();
  } catch (const identification::InvalidInput& error) {
    file.refuse(error);
  }
}

}  // namespace wheeltap::apps

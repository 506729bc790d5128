// Conversion of library errors to error messages about the case.
#pragma once

#include "identification/invalid_input.hpp"

namespace wheeltap::apps {

/// Runs work() and converts errors of the library to Failure. `file`, a DamageCaseFile or
/// SidCaseFile, gives the location of an error in the case.
template <class File, class Work>
auto explained(const File& file, const Work& work) {
  try {
    return work();
  } catch (const identification::InvalidInput& error) {
    file.refuse(error);
  }
}

}  // namespace wheeltap::apps

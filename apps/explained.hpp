// What the library complains about becomes a complaint about the case.
#pragma once

#include "identification/invalid_input.hpp"

namespace wheeltap::apps {

/// work(), where `file` knows the places of its case (DamageCaseFile, SidCaseFile). Throws Failure.
template <class File, class Work>
auto explained(const File& file, const Work& work) {
  try {
    return work();
  } catch (const identification::InvalidInput& error) {
    file.refuse(error);
  }
}

}  // namespace wheeltap::apps

// The beam of a damage case.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "fem/beam/beam.hpp"

namespace wheeltap::apps {

/// Parses the beam at /beam of a case. Throws Failure.
[[nodiscard]] fem::Beam parse_beam(const CaseFile& file);

}  // namespace wheeltap::apps

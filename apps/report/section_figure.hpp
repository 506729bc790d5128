// Figure of a cross-section: outline, triangles, centroid, principal axes and shear centre.
#pragma once

#include <string>

#include "apps/cases/structures/section_case.hpp"

namespace wheeltap::apps {

/// Returns an SVG document with y to the right and z upwards.
[[nodiscard]] std::string section_figure(const MeshedSection& section, const std::string& title);

}  // namespace wheeltap::apps

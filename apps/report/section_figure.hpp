// Figure of a cross-section: outline, triangles, centroid, principal axes and shear centre.
#pragma once

#include <string>

#include "apps/cases/structures/section_case.hpp"

namespace wheeltap::apps {

/// Returns an SVG document; y to the right, z up.
[[nodiscard]] std::string section_figure(const MeshedSection& section, const std::string& title);

}  // namespace wheeltap::apps

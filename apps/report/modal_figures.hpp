// Figures of measured mode shapes, as SVG without scripts.
#pragma once

#include <string>

#include "apps/cases/records/modes_file.hpp"

namespace wheeltap::apps {

/// Returns the modal assurance criterion of each pair of modes, over the sensors common to both
/// modes, as a table of shaded cells.
[[nodiscard]] std::string mac_figure(const ModesFile& modes);

/// Returns figures of the entries of each mode shape in the complex plane. Each shape is rotated in
/// phase to minimise its imaginary parts, so the entries of a real mode are on the horizontal axis.
[[nodiscard]] std::string complexity_figures(const ModesFile& modes);

/// Returns bar charts of the rotated entries of each mode shape by channel, with 95 % intervals if
/// there are covariances, and a legend of the channel numbers.
[[nodiscard]] std::string bar_figures(const ModesFile& modes);

}  // namespace wheeltap::apps

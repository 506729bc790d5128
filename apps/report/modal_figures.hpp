// Pictures of measured mode shapes, as SVG that needs no script.
#pragma once

#include <string>

#include "apps/cases/records/modes_file.hpp"

namespace wheeltap::apps {

/// The modal assurance criterion between all modes over the sensors that both have, as a table of
/// shaded cells.
[[nodiscard]] std::string mac_figure(const MeasuredModes& modes);

/// Of each mode its entries in the complex plane, turned to be as real as they can be: a mode that
/// is a standing wave lies along the horizontal axis.
[[nodiscard]] std::string complexity_figures(const MeasuredModes& modes);

/// Of each mode the entries that are turned so, as bars by channel, with 95 % intervals where
/// there are covariances; and which channel has which number.
[[nodiscard]] std::string bar_figures(const MeasuredModes& modes);

}  // namespace wheeltap::apps

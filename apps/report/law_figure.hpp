// Figure of a force law: its tension over one cycle of a given motion.
#pragma once

#include <string>

#include "dynamics/law_cycle.hpp"

namespace wheeltap::apps {

/// The motion in every figure: a sine with amplitude 0.01 m and frequency 5 Hz, as in the examples.
inline constexpr dynamics::Cycle kPictured{.amplitude = 0.01, .period = 0.2, .points = 121};

/// Returns an SVG document of the tension against the extension. If the tension depends on the rate
/// and has no memory, a second plot shows the tension against the rate. The coefficients are the
/// example values of the force law. The figure of a one-sided force law shows both sides.
[[nodiscard]] std::string law_figure(const dynamics::LawInfo& info);

/// Returns the file name of the figure, "law-coulomb.svg".
[[nodiscard]] std::string law_figure_name(const dynamics::LawInfo& info);

/// Returns the caption of the figure: the motion and the coefficients.
[[nodiscard]] std::string law_caption(const dynamics::LawInfo& info);

}  // namespace wheeltap::apps

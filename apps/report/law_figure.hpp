// The picture of a force law: its tension over one cycle of a given motion, drawn from the law
// itself.
#pragma once

#include <string>

#include "dynamics/law_cycle.hpp"

namespace wheeltap::apps {

/// The motion of every picture: a centimetre at 5 Hz, as in the examples.
inline constexpr dynamics::Cycle kPictured{.amplitude = 0.01, .period = 0.2, .points = 121};

/// Tension against extension, and beside it against the rate where it depends on that and on no
/// memory: an SVG document. Coefficients are the law's examples; a one-sided law has both sides.
[[nodiscard]] std::string law_figure(const dynamics::LawInfo& info);

/// "law-coulomb.svg".
[[nodiscard]] std::string law_figure_name(const dynamics::LawInfo& info);

/// What the picture shows, a sentence.
[[nodiscard]] std::string law_caption(const dynamics::LawInfo& info);

}  // namespace wheeltap::apps

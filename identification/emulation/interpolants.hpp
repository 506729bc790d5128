// The list of interpolants that a case may name. To add an interpolant, write a file in emulator/
// with the class and the InterpolantType, and add a line to interpolants.cpp.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "emulator/interpolant.hpp"

namespace wheeltap::identification {

using InterpolantTypes = std::span<const emulator::InterpolantType* const>;

/// All types of interpolants. The list includes Delaunay interpolation even if Wheeltap was built
/// without CGAL; in this case, training throws std::invalid_argument.
[[nodiscard]] InterpolantTypes interpolant_types();

/// The type of the interpolant with this name, or nullptr if there is no such interpolant.
[[nodiscard]] const emulator::InterpolantType* find_interpolant_type(
    std::string_view name, InterpolantTypes types = interpolant_types());

/// Quoted names of the interpolants for grids or for space-filling designs, as a list in words:
/// "multilinear", "cubic" and "monotone-cubic".
[[nodiscard]] std::string interpolant_names(emulator::InterpolantType::Runs runs,
                                            InterpolantTypes types = interpolant_types());

}  // namespace wheeltap::identification

// The list of interpolants that a case may name. To add one, write a file in emulator/ with its
// class and its InterpolantType, and add a line to interpolants.cpp.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "emulator/interpolant.hpp"

namespace wheeltap::identification {

using InterpolantTypes = std::span<const emulator::InterpolantType* const>;

/// All types, including Delaunay interpolation even if its library was not built; training it then
/// throws std::invalid_argument.
[[nodiscard]] InterpolantTypes interpolant_types();

/// Returns nullptr if no interpolant has this name.
[[nodiscard]] const emulator::InterpolantType* find_interpolant_type(
    std::string_view name, InterpolantTypes types = interpolant_types());

/// Quoted names of the interpolants for grids or for scattered runs, as a list in words:
/// "multilinear", "cubic" and "monotone-cubic".
[[nodiscard]] std::string interpolant_names(emulator::InterpolantType::Runs runs,
                                            InterpolantTypes types = interpolant_types());

}  // namespace wheeltap::identification

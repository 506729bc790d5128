// The list of interpolants that a case may name. A new one is a file in emulator/, with its class
// and its InterpolantType, and a line in interpolants.cpp.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "emulator/interpolant.hpp"

namespace wheeltap::identification {

using InterpolantTypes = std::span<const emulator::InterpolantType* const>;

/// Every type there is. Delaunay interpolation is among them where its library was not built, too:
/// training it then throws std::invalid_argument that says so.
[[nodiscard]] InterpolantTypes interpolant_types();

/// nullptr where there is none of this name.
[[nodiscard]] const emulator::InterpolantType* find_interpolant_type(
    std::string_view name, InterpolantTypes types = interpolant_types());

/// The names of those that take such runs: "multilinear", "cubic" and "monotone-cubic", with the
/// quotation marks.
[[nodiscard]] std::string interpolant_names(emulator::InterpolantType::Runs runs,
                                            InterpolantTypes types = interpolant_types());

}  // namespace wheeltap::identification

// What to write in place of a parameter that cannot stand where it does.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

/// Why `text`, where a number or the name of a parameter may stand, is neither: with the number
/// that it states, or the nearest of the `names`.
[[nodiscard]] std::string unknown_parameter(const std::string& text,
                                            const std::vector<std::string>& names);

/// "; write {"truncated_normal": [50, 10, 0, 110]}": the prior at `where` kept to [lower, upper],
/// of which either may be infinite. Empty where it lies within already.
[[nodiscard]] std::string kept_within(const CaseFile& file, const Pointer& where, double lower,
                                      double upper);

/// "; write [13.85, 55.4]": these frequencies in increasing order, or read with decimal commas
/// where that makes them increase ([13, 85, 55, 4] is 13.85 and 55.4).
[[nodiscard]] std::string increasing(const std::vector<double>& frequencies);

}  // namespace wheeltap::apps

// Corrections of invalid coefficients, priors and frequencies.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

/// The message about a `text` that is neither a number nor the name of a parameter. The message
/// suggests the number that the text contains, or the nearest name in `names`.
[[nodiscard]] std::string unknown_parameter(const std::string& text,
                                            const std::vector<std::string>& names);

/// Advice to truncate the prior at `where` to [lower, upper], e.g. "; write {"truncated_normal":
/// [50, 10, 0, 110]}". Either bound may be infinite. The proposed prior is within the bounds even
/// after rounding to few digits. The result is empty if the prior is already within the bounds, or
/// if no prior of the same family can meet the bounds.
[[nodiscard]] std::string kept_within(const CaseFile& file, const Pointer& where, double lower,
                                      double upper);

/// Advice to write the frequencies in increasing order, e.g. "; write [13.85, 55.4]". The commas of
/// [13, 85, 55, 4] may be decimal commas. If the numbers 13.85 and 55.4 increase, the advice
/// contains these numbers with decimal points.
[[nodiscard]] std::string increasing(const std::vector<double>& frequencies);

}  // namespace wheeltap::apps

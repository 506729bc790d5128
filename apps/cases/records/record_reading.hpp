// How a case says that a record's file is read, and what is said of how it was.
#pragma once

#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/report_json.hpp"
#include "signals/record.hpp"
#include "signals/units.hpp"

namespace wheeltap::apps {

/// How a channel's numbers were used.
struct ChannelUse {
  std::string column = {};  ///< its name
  bool is_force = false;
  signals::Conversion conversion = {};
};

/// decimal, separator, skip, header, units_row, time_format and sheet of the block at `where`.
/// Throws Failure.
[[nodiscard]] io::TextLayout parse_layout(const CaseFile& file, const Pointer& where);
/// rows_are_channels of the block at `where`.
[[nodiscard]] io::ArrayLayout parse_array_layout(const CaseFile& file, const Pointer& where);

/// Refuses the channel that names a column which the file of the record at `block` lacks.
[[noreturn]] void refuse_column(const CaseFile& file, const Pointer& block,
                                const io::NoSuchColumn& error);

/// "Columns are separated by semicolons, …": what was found in a text, a sentence.
[[nodiscard]] std::string layout_in_words(const io::FoundLayout& layout);
[[nodiscard]] Report layout_json(const io::FoundLayout& layout);

/// How times were read, a sentence; empty for times in seconds, whose header says so, at an even
/// step.
[[nodiscard]] std::string sampling_in_words(const signals::Sampling& sampling);
/// That time stamps jitter, a sentence; empty where they do not.
[[nodiscard]] std::string jitter_in_words(const signals::Sampling& sampling);
[[nodiscard]] Report sampling_json(const signals::Sampling& sampling);

/// {"unit", "factor", "si_unit", "basis"}: the unit of a channel's numbers, and how they were used.
[[nodiscard]] Report conversion_json(const signals::Conversion& conversion);
/// "g × 9.80665 = m/s^2", "m/s^2", "no unit: used as it is".
[[nodiscard]] std::string conversion_in_words(const signals::Conversion& conversion);

}  // namespace wheeltap::apps

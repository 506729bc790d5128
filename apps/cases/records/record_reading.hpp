// Layout of a record's file as given in the case, and sentences on the interpretation of the file.
#pragma once

#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/report_json.hpp"
#include "signals/record.hpp"
#include "signals/units.hpp"

namespace wheeltap::apps {

/// Use of a channel: its column and unit conversion.
struct ChannelUse {
  std::string column = {};  ///< name of the column
  bool is_force = false;
  signals::Conversion conversion = {};
};

/// Parses the keys decimal, separator, skip, header, units_row, time_format and sheet of the block
/// at `where`. Throws Failure.
[[nodiscard]] io::TextLayout parse_layout(const CaseFile& file, const Pointer& where);
/// Parses rows_are_channels of the block at `where`.
[[nodiscard]] io::ArrayLayout parse_array_layout(const CaseFile& file, const Pointer& where);

/// Throws Failure for a channel whose column does not exist in the file of the record at `block`.
[[noreturn]] void refuse_column(const CaseFile& file, const Pointer& block,
                                const io::NoSuchColumn& error);

/// A sentence on the layout that Wheeltap found in a text file: "Columns separated by semicolons,
/// …".
[[nodiscard]] std::string layout_in_words(const io::FoundLayout& layout);
[[nodiscard]] Report layout_json(const io::FoundLayout& layout);

/// A sentence on the interpretation of the time column; empty for times in seconds with a uniform
/// step.
[[nodiscard]] std::string sampling_in_words(const signals::Sampling& sampling);
/// A sentence on the jitter of time stamps; empty without jitter.
[[nodiscard]] std::string jitter_in_words(const signals::Sampling& sampling);
[[nodiscard]] Report sampling_json(const signals::Sampling& sampling);

/// Unit and conversion of a channel as JSON: {"unit", "factor", "si_unit", "basis"}.
[[nodiscard]] Report conversion_json(const signals::Conversion& conversion);
/// The conversion of a channel as text: "g × 9.80665 = m/s^2", "m/s^2", "no unit: used as it is".
[[nodiscard]] std::string conversion_in_words(const signals::Conversion& conversion);

}  // namespace wheeltap::apps

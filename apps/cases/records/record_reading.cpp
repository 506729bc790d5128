#include "apps/cases/records/record_reading.hpp"

#include <array>

#include "apps/words.hpp"
#include "base/number.hpp"
#include "io/text/text.hpp"
#include "io/text/time_stamp.hpp"

namespace wheeltap::apps {
namespace {

using Basis = signals::Conversion::Basis;
using TimeBasis = signals::Sampling::Basis;

std::string in_lines(int skipped) {
  return skipped == 1 ? "line 1 is" : "lines 1 to " + std::to_string(skipped) + " are";
}

const char* name(TimeBasis basis) {
  constexpr std::array<const char*, 8> kNames{
      "unit",    "scale",  "time stamps", "counts since 1970", "dates of a spreadsheet",
      "assumed", "header", "stated"};
  return kNames.at(static_cast<std::size_t>(basis));
}

/// The location in the block of a record that names a column: in a channel, or in the block itself.
Pointer column_pointer(const CaseFile& file, const Pointer& block, const std::string& column) {
  const Json& b = file.json.at(block);
  if (b.contains("channels")) {
    for (std::size_t i = 0; i < b.at("channels").size(); ++i)
      if (text_or_number(b.at("channels")[i].at("column")) == column)
        return block / "channels" / i / "column";
  }
  return b.contains("column") ? block / "column" : block / "file";
}

}  // namespace

io::TextLayout parse_layout(const CaseFile& file, const Pointer& where) {
  const Json& r = file.json.at(where);
  io::TextLayout out;
  if (!r.is_object()) return out;
  if (r.contains("decimal")) out.decimal = r["decimal"].get<std::string>().at(0);
  if (r.contains("separator")) {
    out.separator = io::parse_separator(r["separator"].get<std::string>());
    if (!out.separator)
      file.refuse(where / "separator",
                  "must be \",\", \";\", \"\\t\", \"|\" or \" \" (one or more blanks)");
  }
  if (out.decimal == ',' && out.separator == ',')
    file.refuse(where / "separator", "cannot be both the separator and the decimal mark");
  if (r.contains("skip")) out.skip = r["skip"].get<int>();
  if (r.contains("header")) out.header = r["header"].get<int>();
  if (r.contains("units_row")) out.units_row = r["units_row"].get<int>();
  if (r.contains("time_format")) {
    out.time_format = r["time_format"].get<std::string>();
    if (!io::parse_time_format(out.time_format))
      file.refuse(where / "time_format",
                  "must be \"day-first\", \"month-first\" or a pattern like \"%d.%m.%Y %H:%M:%S\"");
  }
  if (r.contains("sheet")) out.sheet = r["sheet"].get<std::string>();
  return out;
}

io::ArrayLayout parse_array_layout(const CaseFile& file, const Pointer& where) {
  const Json& r = file.json.at(where);
  io::ArrayLayout out;
  if (r.is_object() && r.contains("rows_are_channels"))
    out.rows_are_channels = r["rows_are_channels"].get<bool>();
  return out;
}

void refuse_column(const CaseFile& file, const Pointer& block, const io::NoSuchColumn& error) {
  const Pointer at = column_pointer(file, block, error.column());
  file.refuse(at, error.reason() + " in " + error.path().filename().string() +
                      (file.json.at(at).is_number() ? "; numbers count columns from 1" : ""));
}

std::string layout_in_words(const io::FoundLayout& layout) {
  const io::TextLayout& used = layout.used;
  std::string out;
  if (!used.sheet.empty())
    out = "Sheet \"" + used.sheet + "\"";
  else if (layout.columns == 1)
    out = "One column";
  else
    out = "Columns separated by " + std::string(io::separator_name(*used.separator));
  out += std::string(", decimal ") + (used.decimal == ',' ? "comma" : "point") + "; ";
  out += *used.header > 0 ? "names in line " + std::to_string(*used.header) : "no line of names";
  if (*used.units_row > 0) out += ", units in line " + std::to_string(*used.units_row);
  out += ", rows from line " + std::to_string(layout.first_row);
  if (used.skip.value_or(0) > 0) out += "; " + in_lines(*used.skip) + " not part of the table";
  if (layout.tail_from > 0)
    out += "; " +
           (layout.tail_from == layout.tail_to
                ? "line " + std::to_string(layout.tail_from) + " after the rows is"
                : "lines " + std::to_string(layout.tail_from) + " to " +
                      std::to_string(layout.tail_to) + " after the rows are") +
           " not part of the table";
  if (!layout.start.empty()) {
    out += "; time stamps";
    if (!used.time_format.empty()) out += " \"" + used.time_format + "\"";
    out += " from " + layout.start;
  }
  return out + ".";
}

Report layout_json(const io::FoundLayout& layout) {
  const io::TextLayout& used = layout.used;
  Report out = {{"separator", layout.columns == 1 || !used.sheet.empty()
                                  ? Report()
                                  : Report(std::string(1, *used.separator))},
                {"decimal", std::string(1, *used.decimal)},
                {"skip", used.skip.value_or(0)},
                {"header", *used.header},
                {"units_row", *used.units_row},
                {"first_row", layout.first_row}};
  if (!used.sheet.empty()) out["sheet"] = used.sheet;
  if (layout.tail_from > 0) out["left_out_behind"] = {layout.tail_from, layout.tail_to};
  if (!layout.start.empty()) {
    out["time_format"] = used.time_format;
    out["start"] = layout.start;
  }
  return out;
}

std::string sampling_in_words(const signals::Sampling& sampling) {
  switch (sampling.basis) {
    case TimeBasis::unit:
      return sampling.unit == "s" ? std::string() : "Times are in " + sampling.unit + ".";
    case TimeBasis::epoch:
      return "Times are counts of " + sampling.unit + " since 1970.";
    case TimeBasis::days:
      return "Times are dates of a spreadsheet, in days.";
    case TimeBasis::assumed:
      return std::string("Times are assumed to be in s, because the time column has no unit.") +
             (sampling.doubtful_unit
                  ? " The times are whole numbers: if they are in milliseconds, name the column "
                    "\"time "
                    "[ms]\" or give its channel \"role\": \"time\" and \"scale\": 0.001."
                  : "");
    case TimeBasis::header:
      return base::significant(sampling.rate_hz, 6) + " Hz, as stated in line " +
             std::to_string(sampling.line) + ".";
    default:
      return {};
  }
}

std::string jitter_in_words(const signals::Sampling& sampling) {
  if (!(sampling.jitter > 0.0)) return {};
  return "Time steps differ from the mean time step by up to " +
         base::significant(100.0 * sampling.jitter, 2) +
         " % and are treated as uniform; time stamps then deviate by up to " +
         base::significant(sampling.off_grid, 2) +
         " steps. To interpolate at a uniform rate instead, write \"resample\": true.";
}

Report sampling_json(const signals::Sampling& sampling) {
  Report out = {{"sample_rate_hz", sampling.rate_hz}, {"basis", name(sampling.basis)}};
  if (!sampling.unit.empty()) out["unit"] = sampling.unit;
  if (sampling.jitter > 0.0) {
    out["jitter"] = sampling.jitter;
    out["off_grid"] = sampling.off_grid;
  }
  return out;
}

Report conversion_json(const signals::Conversion& conversion) {
  Report out = {{"unit", conversion.unit.empty() ? Report() : Report(conversion.unit)},
                {"factor", conversion.factor}};
  const bool in_si = conversion.dimension && conversion.basis != Basis::foreign;
  out["si_unit"] = in_si ? Report(std::string(signals::si_unit(*conversion.dimension))) : Report();
  switch (conversion.basis) {
    case Basis::none:
      out["basis"] = "no unit: used unchanged";
      break;
    case Basis::unit:
      out["basis"] = "unit";
      break;
    case Basis::foreign:
      out["basis"] = "unknown unit: used unchanged";
      break;
    case Basis::stated_scale:
      out["basis"] = "scale of the case";
      break;
  }
  return out;
}

std::string conversion_in_words(const signals::Conversion& conversion) {
  switch (conversion.basis) {
    case Basis::none:
      return "no unit, used unchanged";
    case Basis::foreign:
      return io::printable(conversion.unit) + ", used unchanged";
    case Basis::stated_scale:
      return "times " + base::significant(conversion.factor, 6) + " as stated in the case";
    case Basis::unit:
      break;
  }
  const std::string si(signals::si_unit(*conversion.dimension));
  if (conversion.factor == 1.0) return si;
  return io::printable(conversion.unit) + ", times " + base::significant(conversion.factor, 6) +
         " in " + si;
}

}  // namespace wheeltap::apps

#include "apps/command_line_options.hpp"

#include <charconv>
#include <cmath>
#include <string>

#include "apps/whole_number.hpp"
#include "io/array_columns.hpp"
#include "io/text_layout.hpp"
#include "io/time_stamp.hpp"

namespace wheeltap::apps {
namespace {

// Numbers of which `allowed` is true, as `words` say; CLI::Range lets nan pass.
CLI::Validator number(const char* words, const char* name, bool (*allowed)(double)) {
  return CLI::Validator(
      [=](const std::string& text) -> std::string {
        double x = 0.0;
        const char* last = text.data() + text.size();
        const auto [end, error] = std::from_chars(text.data(), last, x);
        if (error == std::errc() && end == last && allowed(x)) return {};
        return text + ": must be " + words;
      },
      name);
}

}  // namespace

CLI::Validator whole(std::int64_t lowest, std::int64_t highest) {
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        if (const auto n = whole_number(text, lowest, highest)) {
          text = std::to_string(*n);
          return {};
        }
        return text + ": must be a whole number from " + std::to_string(lowest) + " to " +
               std::to_string(highest);
      },
      "INT in [" + std::to_string(lowest) + " - " + std::to_string(highest) + "]");
}

CLI::Validator positive() {
  return number("a positive number", "NUMBER > 0",
                [](double x) { return x > 0.0 && std::isfinite(x); });
}

CLI::Validator seconds() {
  return number("a number from 0 to 1e9", "NUMBER in [0 - 1e9]",
                [](double x) { return x >= 0.0 && x <= 1e9; });
}

void add_layout(CLI::App* command, io::TextLayout& layout, io::ArrayLayout& arrays) {
  const std::string rest = " of delimited text; detected unless given";
  command
      ->add_option_function<std::string>(
          "--decimal", [&layout](const std::string& text) { layout.decimal = text.at(0); },
          "the decimal mark" + rest)
      ->check(CLI::IsMember({".", ","}));
  command->add_option_function<std::string>(
      "--separator",
      [&layout](const std::string& text) {
        layout.separator = io::parse_separator(text);
        if (!layout.separator)
          throw CLI::ValidationError("--separator", text + ": must be ',', ';', tab, '|' or blank");
      },
      "what stands between the columns (or comma, semicolon, tab, bar, blank)" + rest);
  const auto add_line = [&](const std::string& names, std::optional<int>& into,
                            const std::string& what) {
    command
        ->add_option_function<int>(
            names, [&into](const int& line) { into = line; }, what + rest)
        ->transform(whole(0, 1'000'000'000));
  };
  add_line("--skip", layout.skip, "how many lines at the top are passed over");
  add_line("--header", layout.header, "the line of names, from 1; 0 where there is none");
  add_line("--units-row", layout.units_row, "the line of units, from 1; 0 where there is none");
  command->add_option_function<std::string>(
      "--time-format",
      [&layout](const std::string& text) {
        layout.time_format = text;
        if (!io::parse_time_format(text))
          throw CLI::ValidationError(
              "--time-format",
              text + ": must be day-first, month-first or a pattern like '%d.%m.%Y %H:%M:%S'");
      },
      "the form of time stamps: day-first, month-first or a pattern like '%d.%m.%Y %H:%M:%S'");
  command->add_option("--sheet", layout.sheet,
                      "the sheet of an Excel workbook; by default the first that is not hidden");
  command->add_option_function<bool>(
      "--rows-are-channels", [&arrays](const bool& rows) { arrays.rows_are_channels = rows; },
      "true or false: whether each row of a matrix is a channel, in MATLAB, NumPy, NetCDF and HDF5 "
      "files; by default the longer dimension runs along time");
}

}  // namespace wheeltap::apps

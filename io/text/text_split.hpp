// Splitting of a line of text into cells for one separator, and classification of the cells.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/text/text_layout.hpp"
#include "io/text/time_stamp.hpp"

namespace wheeltap::io {

/// Options for reading cells.
struct Reading {
  char decimal = '.';
  bool grouped = false;  ///< commas or points are known to separate thousands
  std::optional<TimeFormat> format = {};
};

/// The kind of a cell (number, time stamp or text); a date with an ambiguous order is a time stamp.
[[nodiscard]] CellKind kind_of(std::string_view cell, const Reading& reading);

/// A line split with one separator.
struct Split {
  std::vector<std::string> cells;
  std::size_t numbers = 0, stamps = 0, texts = 0;
  std::size_t trailing = 0;  ///< number of empty cells at the end

  [[nodiscard]] bool is_row() const { return texts == 0 && numbers + stamps > 0; }
};

[[nodiscard]] Split split(std::string_view line, char separator, const Reading& reading);

/// Measures how well a separator and a decimal mark explain the lines: the sum of one term per
/// line. If all cells of a line are numbers or time stamps, the term of the line is twice the
/// number of cells. For any other line, the term is the count of numbers and time stamps minus the
/// count of other cells.
[[nodiscard]] long explained_cells(std::span<const TextLine> lines, char separator,
                                   const Reading& reading);

/// The possible meanings of commas in rows of whole numbers.
enum class Commas { separate, decimal, unclear, mixed };

/// Determines the meaning of commas in rows like "0,1108", which contain either two whole numbers
/// or one number. `names` is the number of column names in the header, or 0 without a header.
[[nodiscard]] Commas commas_of(const std::vector<Split>& rows, std::size_t columns,
                               std::size_t names);

}  // namespace wheeltap::io

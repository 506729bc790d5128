// A line of text, split into cells in one way, and what the cells are.
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

/// How cells are understood.
struct Reading {
  char decimal = '.';
  bool grouped = false;  ///< that commas or points part thousands is stated or proven
  std::optional<TimeFormat> format = {};
};

/// What a cell is; an ambiguous date is a stamp.
[[nodiscard]] CellKind kind_of(std::string_view cell, const Reading& reading);

/// A line, split in one way.
struct Split {
  std::vector<std::string> cells;
  std::size_t numbers = 0, stamps = 0, texts = 0;
  std::size_t trailing = 0;  ///< how many of the last cells are empty

  [[nodiscard]] bool is_row() const { return texts == 0 && numbers + stamps > 0; }
};

[[nodiscard]] Split split(std::string_view line, char separator, const Reading& reading);

/// How well a separator and a decimal mark explain lines: twice the numbers and stamps of lines
/// that hold nothing else; of the others by how many they are more than the texts.
[[nodiscard]] long explained_cells(std::span<const TextLine> lines, char separator,
                                   const Reading& reading);

/// What commas in the cells of rows of whole numbers are.
enum class Commas { separate, decimal, unclear, mixed };

/// Rows "0,1108" may be two whole numbers or one number. `names`: columns that the header names; 0
/// where there is none.
[[nodiscard]] Commas commas_of(const std::vector<Split>& rows, std::size_t columns,
                               std::size_t names);

}  // namespace wheeltap::io

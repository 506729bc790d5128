// Workbooks of Excel and other spreadsheets (.xlsx).
#pragma once

#include "io/tables/columns.hpp"
#include "io/text/text_layout.hpp"

namespace wheeltap::io {

/// A sheet of a workbook (ECMA-376, part 1, SpreadsheetML in a ZIP archive), the one stated or the
/// first that is not hidden, read as the delimited text that it would be saved as
/// (io/tables/delimited_text.hpp): a row a line, dates and times of day by their number format as
/// time stamps, elapsed times ([h]:mm:ss) as seconds. Formulas have the values that were last
/// computed. Columns without any cell are left out. Other sheets are among the table's `others`.
/// Throws FileError as that does, with the sheet's row as line; foreign for what is no such
/// workbook (an older .xls, an encrypted one), corrupt for one that is cut off or damaged, or lacks
/// the sheet.
[[nodiscard]] Columns parse_workbook(std::string bytes, const std::filesystem::path& name,
                                     const Wanted& wanted, const TextLayout& stated);

}  // namespace wheeltap::io

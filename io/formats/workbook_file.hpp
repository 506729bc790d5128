// Workbooks of Excel and other spreadsheets (.xlsx).
#pragma once

#include "io/tables/columns.hpp"
#include "io/text/text_layout.hpp"

namespace wheeltap::io {

/// Reads a sheet of a workbook (ECMA-376, part 1, SpreadsheetML in a ZIP archive): the sheet that
/// `stated` names, or the first sheet that is not hidden. The rules for delimited text apply to the
/// rows of the sheet (io/tables/delimited_text.hpp). Dates and times of day are recognised by their
/// number format and become time stamps; elapsed times ([h]:mm:ss) become seconds. A cell with a
/// formula has the value that the workbook stores for the cell. Empty columns are skipped. Other
/// sheets are listed in the table's `others`. Throws the same errors as for delimited text, with
/// the row of the sheet as line number. Throws FileError: foreign for other formats (an older .xls
/// file, an encrypted workbook); corrupt if the file is truncated or invalid, or does not contain
/// the sheet.
[[nodiscard]] Columns parse_workbook(std::string bytes, const std::filesystem::path& name,
                                     const Wanted& wanted, const TextLayout& stated);

}  // namespace wheeltap::io

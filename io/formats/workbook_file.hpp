// Workbooks of Excel and other spreadsheets (.xlsx).
#pragma once

#include "io/tables/columns.hpp"
#include "io/text/text_layout.hpp"

namespace wheeltap::io {

/// Reads a sheet of a workbook (ECMA-376, part 1, SpreadsheetML in a ZIP archive): the given sheet,
/// or the first that is not hidden. The rules for delimited text apply to its rows
/// (io/tables/delimited_text.hpp). Dates and times of day are recognised by their number format and
/// become time stamps; elapsed times ([h]:mm:ss) become seconds. A formula has the value that the
/// workbook stores for it. Columns without any cell are skipped. Other sheets are listed in the
/// table's `others`. Throws FileError as for delimited text, with the sheet's row as line; foreign
/// for other files (an older .xls, an encrypted workbook); corrupt if the file is truncated or
/// damaged, or lacks the sheet.
[[nodiscard]] Columns parse_workbook(std::string bytes, const std::filesystem::path& name,
                                     const Wanted& wanted, const TextLayout& stated);

}  // namespace wheeltap::io

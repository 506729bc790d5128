// report.html: a finished run as one file that needs no network.
#pragma once

#include <filesystem>
#include <string>

#include "apps/summary.hpp"

namespace wheeltap::apps {

/// JSON that can stand inside a <script> element: no "<", and none of the two line separators that
/// older JavaScript refuses.
[[nodiscard]] std::string script_safe(const Report& json);

/// Text as HTML: & < > " ' become entities.
[[nodiscard]] std::string html_text(const std::string& text);

/// Writes DIRECTORY/report.html from DIRECTORY/summary.json and posterior.nc. Throws
/// io::FileError: missing where a file is not there, corrupt or foreign where it is not what
/// a run writes, unwritable.
void write_report(const std::filesystem::path& directory);

/// Writes the report's figures as SVG files into DIRECTORY/figures, drawn by the same scripts under
/// Node.js. Throws Failure (66) where there is no `node`, and as write_report does. Returns how
/// many.
int write_figures(const std::filesystem::path& directory);

struct ReportOptions {
  bool figures = false;  ///< SVG files too
};
/// `wheeltap report DIR`.
void run_report(const std::filesystem::path& directory, const ReportOptions& options);

}  // namespace wheeltap::apps

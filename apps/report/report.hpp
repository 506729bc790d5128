// report.html: a finished run as one file that needs no network.
#pragma once

#include <filesystem>
#include <string>

#include "apps/results/summary.hpp"

namespace wheeltap::io {
class NetcdfReader;
}

namespace wheeltap::apps {

/// JSON that can stand inside a <script> element: no "<", and none of the two line separators that
/// older JavaScript refuses.
[[nodiscard]] std::string script_safe(const Report& json);

/// Text as HTML: & < > " ' become entities.
[[nodiscard]] std::string html_text(const std::string& text);

/// report.html of the run in `directory` (for messages) with this summary and this posterior.nc;
/// without one, no pictures of draws. Throws io::FileError as write_report does.
[[nodiscard]] std::string report_page(const std::filesystem::path& directory, const Report& summary,
                                      const io::NetcdfReader* draws);

/// Writes DIRECTORY/report.html from DIRECTORY/summary.json and posterior.nc. Throws
/// io::FileError: missing where a file is not there, corrupt, foreign or mismatch where it is not
/// what the run wrote, unwritable.
void write_report(const std::filesystem::path& directory);

/// Writes the report's figures as SVG files into DIRECTORY/figures, drawn by the same scripts under
/// Node.js. Throws Failure (66) where there is no `node`, and as write_report does. Returns how
/// many.
int write_figures(const std::filesystem::path& directory);

}  // namespace wheeltap::apps

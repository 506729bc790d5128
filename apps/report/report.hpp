// report.html: a finished run as one self-contained file.
#pragma once

#include <filesystem>
#include <string>

#include "apps/results/summary.hpp"

namespace wheeltap::io {
class NetcdfReader;
}

namespace wheeltap::apps {

/// Returns JSON for use inside a <script> element: without "<" and without the two line separators
/// that older JavaScript rejects.
[[nodiscard]] std::string script_safe(const Report& json);

/// Returns text as HTML. The characters & < > " ' become entities.
[[nodiscard]] std::string html_text(const std::string& text);

/// Returns report.html of a run from its summary and posterior.nc. Messages use the name
/// `directory`. Without `draws`, the report has no charts of draws. Throws io::FileError as
/// write_report does.
[[nodiscard]] std::string report_page(const std::filesystem::path& directory, const Report& summary,
                                      const io::NetcdfReader* draws);

/// Writes DIRECTORY/report.html from DIRECTORY/summary.json and posterior.nc. Throws io::FileError:
/// missing or unwritable; corrupt, foreign or mismatch if a file does not belong to the run.
void write_report(const std::filesystem::path& directory);

/// Writes the figures of the report as SVG files into DIRECTORY/figures, by running the scripts of
/// the report with Node.js. Returns the number of figures. Throws Failure (66) if `node` is not
/// installed, and the same exceptions as write_report.
int write_figures(const std::filesystem::path& directory);

}  // namespace wheeltap::apps

// The files of the report, from apps/report and from Debian's libjs-vega, compiled into the
// program.
#pragma once

#include <string_view>

namespace wheeltap::apps::assets {

extern const std::string_view kTemplate;  ///< report.html
extern const std::string_view kStyle;     ///< report.css
extern const std::string_view kVega;      ///< defines `vega`
extern const std::string_view kCharts;    ///< charts.js: figures as Vega specifications
extern const std::string_view kPage;      ///< page.js: inserts the figures into the page
extern const std::string_view kShapes;    ///< shapes.js alone, for pages without charts
extern const std::string_view kExport;    ///< export.js for pages without charts
extern const std::string_view kFigures;   ///< figures.js: writes the figures as SVG under Node.js
extern const std::string_view kLicences;  ///< licences.txt

}  // namespace wheeltap::apps::assets

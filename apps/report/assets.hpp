// The parts of the report, as they stand in apps/report and as Debian's libjs-vega provides them,
// compiled into the program.
#pragma once

#include <string_view>

namespace wheeltap::apps::assets {

extern const std::string_view kTemplate;  ///< report.html
extern const std::string_view kStyle;     ///< report.css
extern const std::string_view kVega;      ///< defines `vega`
extern const std::string_view kCharts;    ///< charts.js: figures as Vega specifications
extern const std::string_view kPage;      ///< page.js: puts them into the page
extern const std::string_view kShapes;    ///< shapes.js alone, for pages without charts
extern const std::string_view kFigures;   ///< figures.js: writes them as SVG, under Node.js
extern const std::string_view kLicences;  ///< licences.txt

}  // namespace wheeltap::apps::assets

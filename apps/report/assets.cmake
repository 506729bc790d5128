# Turns apps/report/* and the modules of Debian's libjs-vega into the strings of assets.hpp.
set(report_dir "${CMAKE_CURRENT_LIST_DIR}")
find_path(WHEELTAP_VEGA_DIR vega-parser.min.js
  PATHS /usr/share/javascript/vega DOC "The modules of Vega 5 (libjs-vega)" REQUIRED)

# Charts are one script of several files, in this order.
set(CHART_FILES charts_kit.js charts_models.js charts_damage.js charts_chain.js charts_discovery.js
  charts_modes.js charts_records.js charts_sampling.js charts.js)
list(TRANSFORM CHART_FILES PREPEND CHARTS:)
foreach(part IN ITEMS TEMPLATE:report.html STYLE:report.css ${CHART_FILES} PAGE:export.js PAGE:shapes.js PAGE:page.js
    SHAPES:shapes.js EXPORT:export.js EXPORT:export_page.js FIGURES:figures.js LICENCES:licences.txt)
  string(REPLACE ":" ";" part "${part}")
  list(GET part 0 name)
  list(GET part 1 file)
  file(READ "${report_dir}/${file}" text)
  string(APPEND REPORT_${name} "${text}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${report_dir}/${file}")
endforeach()

# Debian ships Vega as CommonJS modules that require one another by name. Those that the charts use
# are put behind a require() of ten words and joined as the package `vega` joins them.
set(REPORT_VEGA "const vega = (() => {\nconst factories = {}, loaded = {};\n")
foreach(module IN ITEMS util format time loader statistics dataflow expression event-selector scale
    canvas scenegraph selection transforms view-transforms encode functions runtime parser view)
  file(READ "${WHEELTAP_VEGA_DIR}/vega-${module}.min.js" text)
  string(REGEX REPLACE "\n//# sourceMappingURL=[^\n]*" "" text "${text}")
  string(REPLACE "selection" "selections" name "${module}")
  string(APPEND REPORT_VEGA
    "factories['vega-${name}'] = function (exports, module, require) {\n${text}\n};\n")
endforeach()
string(APPEND REPORT_VEGA [=[
const require = (name) => {
  if (!(name in loaded)) {
    const module = { exports: {} };
    loaded[name] = module.exports;
    factories[name](module.exports, module, require);
    loaded[name] = module.exports;
  }
  return loaded[name];
};
const { transforms } = require('vega-dataflow');
for (const name of ['vega-transforms', 'vega-view-transforms', 'vega-encode'])
  Object.assign(transforms, require(name));
return { View: require('vega-view').View, parse: require('vega-parser').parse };
})();
]=])

configure_file("${report_dir}/assets.cpp.in"
  "${CMAKE_CURRENT_BINARY_DIR}/generated/apps/report/assets.cpp" @ONLY)
set(REPORT_ASSETS "${CMAKE_CURRENT_BINARY_DIR}/generated/apps/report/assets.cpp")

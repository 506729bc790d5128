# Turns apps/application/page/* and the report's scripts shapes.js and export.js (report/assets.cmake) into the strings of page_files.hpp.
set(page_dir "${CMAKE_CURRENT_LIST_DIR}/page")

set(PAGE_FILES "")
foreach(part IN ITEMS :index.html:text/html app.css:app.css:text/css shapes.js::text/javascript export.js::text/javascript
    app.js:app.js:text/javascript dom.js:dom.js:text/javascript server.js:server.js:text/javascript
    projects.js:projects.js:text/javascript editor.js:editor.js:text/javascript form.js:form.js:text/javascript
    schema.js:schema.js:text/javascript drawing.js:drawing.js:text/javascript table.js:table.js:text/javascript
    runs.js:runs.js:text/javascript poles.js:poles.js:text/javascript record.js:record.js:text/javascript
    plot.js:plot.js:text/javascript arrows.js:arrows.js:text/javascript sensors.js:sensors.js:text/javascript
    channels.js:channels.js:text/javascript series.js:series.js:text/javascript
    modes_case.js:modes_case.js:text/javascript trace.js:trace.js:text/javascript)
  string(REPLACE ":" ";" part "${part}")
  list(GET part 0 name)
  list(GET part 1 file)
  list(GET part 2 type)
  # Scripts of the report as modules.
  if(name STREQUAL "shapes.js")
    file(READ "${report_dir}/shapes.js" text)
    set(text "import { charts, element } from './dom.js';\n${text}\nexport { shapeView };\n")
  elseif(name STREQUAL "export.js")
    file(READ "${report_dir}/export.js" text)
    string(APPEND text "\nexport { exporting };\n")
  else()
    file(READ "${page_dir}/${file}" text)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${page_dir}/${file}")
  endif()
  string(APPEND PAGE_FILES
    "      PageFile{\"${name}\", \"${type}; charset=utf-8\", R\"embedded(${text})embedded\"},\n")
endforeach()

configure_file("${CMAKE_CURRENT_LIST_DIR}/page_files.cpp.in"
  "${CMAKE_CURRENT_BINARY_DIR}/generated/apps/application/page_files.cpp" @ONLY)
set(APP_PAGE_FILES "${CMAKE_CURRENT_BINARY_DIR}/generated/apps/application/page_files.cpp")

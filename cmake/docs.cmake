# The API reference, by Doxygen: `cmake --build build/release --target docs` writes build/release/docs/html. A
# public name without a comment is an error.
find_package(Doxygen QUIET)
if(NOT Doxygen_FOUND)
  stereotlm_target_without_tool(docs doxygen)
  return()
elseif(NOT Python3_Interpreter_FOUND)
  stereotlm_target_without_tool(docs python3)
  return()
endif()
# Doxygen reads the headers as they are installed, so that it shows how to include them.
set(DOXYGEN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/docs)
set(DOXYGEN_STRIP_FROM_PATH ${DOXYGEN_OUTPUT_DIRECTORY}/include/stereotlm)
set(DOXYGEN_STRIP_FROM_INC_PATH ${DOXYGEN_OUTPUT_DIRECTORY}/include)
set(DOXYGEN_FILE_PATTERNS *.h)
set(DOXYGEN_FILTER_PATTERNS
  "\"*.h=${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/cmake/doxygen_filter.py\"")
# Left out: what the modules use inside, and no user of them names.
set(DOXYGEN_EXCLUDE_PATTERNS */fpga/fast/* */fpga/record/* */core_control.h */core_stepper.h
  */core_datapath.h */frame_run.h */host_port.h */lane_control.h */match_control.h */result_control.h
  */port_cycles.h */blank_matcher.h */dma_channel.h */posted_writes.h */traffic_control.h
  */kernels/column_*.h */kernels/cost_columns.h */kernels/correlation_matcher.h */kernels/simd.h
  */trace_records.h */timeline_records.h)
set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
set(DOXYGEN_HAVE_DOT NO)
set(DOXYGEN_QUIET YES)
set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
doxygen_add_docs(docs ${DOXYGEN_STRIP_FROM_INC_PATH} cmake/reference.dox COMMENT "Writing docs/html")
add_custom_target(docs_headers VERBATIM
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${DOXYGEN_OUTPUT_DIRECTORY}
  COMMAND ${CMAKE_COMMAND} -Dsource=${PROJECT_SOURCE_DIR} -Dinclude=include --log-level=WARNING
    -DCMAKE_INSTALL_PREFIX=${DOXYGEN_OUTPUT_DIRECTORY} -P ${PROJECT_SOURCE_DIR}/cmake/install_headers.cmake)
add_dependencies(docs docs_headers)

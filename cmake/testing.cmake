# The tests, and what they are made with. Without the libraries that they need, the rest is built alone.
foreach(library GTest rapidcheck benchmark)
  find_package(${library} QUIET)
  if(NOT ${library}_FOUND)
    message(NOTICE "-- Tests are not built: ${library} is not installed. "
      "To have them: ./setup tests, then configure again.")
    return()
  endif()
endforeach()
include(GoogleTest)

set(STEREOTLM_TEST_OPTIONS "" CACHE STRING "Compiler options of the test programs, behind all others")

# Precompiles the headers that take longest to compile, for all test programs of a kind. Every source still
# includes what it uses; the preset debug, which has no unity builds, checks that if
# CMAKE_DISABLE_PRECOMPILE_HEADERS is set.
function(stereotlm_precompile_headers name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "HEADERS;LIBRARIES")
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(GENERATE OUTPUT ${source} CONTENT "")
  add_library(${name} OBJECT ${source})
  target_link_libraries(${name} PRIVATE ${arg_LIBRARIES} stereotlm_warnings)
  target_compile_options(${name} PRIVATE ${STEREOTLM_TEST_OPTIONS} -fpch-preprocess)  # ccache needs it
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
  set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
endfunction()

# The label of tests that name none; folders set another.
set(STEREOTLM_TEST_LABEL unit)

# stereotlm_add_test(NAME SOURCES file... LIBRARIES target... [LABELS label] [TIMEOUT seconds] [SYSTEMC])
# Adds one test program. ctest runs each of its cases in a process of its own, because SystemC elaborates once
# per process. SYSTEMC: the cases run inside sc_main, and a SystemC warning that a case did not announce fails
# it.
function(stereotlm_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "SYSTEMC" "TIMEOUT" "SOURCES;LIBRARIES;LABELS")
  if(NOT arg_LABELS)
    set(arg_LABELS ${STEREOTLM_TEST_LABEL})
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 60)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LIBRARIES} stereotlm_warnings)
  target_compile_options(${name} PRIVATE ${STEREOTLM_TEST_OPTIONS} -fpch-preprocess)
  if(arg_SYSTEMC)
    target_link_libraries(${name} PRIVATE stereotlm_systemc_test_main)
    target_precompile_headers(${name} REUSE_FROM stereotlm_systemc_test_headers)
  else()
    target_link_libraries(${name} PRIVATE GTest::gtest_main)
    target_precompile_headers(${name} REUSE_FROM stereotlm_test_headers)
  endif()
  if(arg_LABELS MATCHES "unit|integration")
    add_dependencies(sanitized_tests ${name})
  endif()
  if(arg_LABELS MATCHES "program|integration")
    add_dependencies(release_tests ${name})
  endif()
  # ctest begins with the tests of the greatest cost, which would else be left alone at the end.
  string(REGEX REPLACE "unit|program|nightly" 1 cost "${arg_LABELS}")
  string(REPLACE integration 10 cost "${cost}")
  gtest_discover_tests(${name} PROPERTIES LABELS "${arg_LABELS}" TIMEOUT ${arg_TIMEOUT} COST "${cost}"
    DISCOVERY_TIMEOUT 60)
endfunction()

add_subdirectory(${PROJECT_SOURCE_DIR}/tests ${PROJECT_BINARY_DIR}/tests)

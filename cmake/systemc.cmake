# Provides stereotlm::systemc, the SystemC library: that of the CMake package SystemCLanguage if there is one,
# else that of pkg-config (Debian's libsystemc-dev has no CMake package). Its headers are SYSTEM, so that the
# project's warnings do not apply to them.
#
# Sets STEREOTLM_SYSTEMC_VERSION, such as 2.3.4, and STEREOTLM_SYSTEMC_CXX, the C++ standard for which the
# library was built, such as 17. It links with programs of this standard only.
add_library(stereotlm_systemc INTERFACE IMPORTED)
add_library(stereotlm::systemc ALIAS stereotlm_systemc)
find_package(Threads REQUIRED)
find_package(SystemCLanguage 2.3.4 CONFIG QUIET)
if(SystemCLanguage_FOUND)
  target_link_libraries(stereotlm_systemc INTERFACE SystemC::systemc Threads::Threads)
  get_target_property(STEREOTLM_SYSTEMC_LIBRARY SystemC::systemc LOCATION)
else()
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(SYSTEMC REQUIRED systemc>=2.3.4)
  find_path(SYSTEMC_INCLUDE_DIR systemc HINTS ${SYSTEMC_INCLUDE_DIRS} REQUIRED)
  find_library(STEREOTLM_SYSTEMC_LIBRARY systemc HINTS ${SYSTEMC_LIBRARY_DIRS} REQUIRED)
  target_include_directories(stereotlm_systemc SYSTEM INTERFACE ${SYSTEMC_INCLUDE_DIR})
  target_link_libraries(stereotlm_systemc INTERFACE ${STEREOTLM_SYSTEMC_LIBRARY} Threads::Threads)
endif()
# SystemC enables dynamic processes only with this macro; TLM's convenience sockets need them.
target_compile_definitions(stereotlm_systemc INTERFACE SC_INCLUDE_DYNAMIC_PROCESSES)

# The library's symbols name both, such as sc_api_version_2_3_4_cxx201703L.
file(STRINGS ${STEREOTLM_SYSTEMC_LIBRARY} STEREOTLM_SYSTEMC_API LIMIT_COUNT 1
  REGEX "sc_api_version_[0-9]+_[0-9]+_[0-9]+_cxx[0-9]+L")
if(NOT STEREOTLM_SYSTEMC_API MATCHES "sc_api_version_([0-9]+)_([0-9]+)_([0-9]+)_cxx20([0-9][0-9])")
  message(FATAL_ERROR "${STEREOTLM_SYSTEMC_LIBRARY}: no symbol names the version of SystemC")
endif()
set(STEREOTLM_SYSTEMC_VERSION ${CMAKE_MATCH_1}.${CMAKE_MATCH_2}.${CMAKE_MATCH_3})
set(STEREOTLM_SYSTEMC_CXX ${CMAKE_MATCH_4})
# 2.3.4 needs SC_HAS_PROCESS, which is deprecated from 3.0 on.
if(STEREOTLM_SYSTEMC_VERSION VERSION_GREATER_EQUAL 3)
  target_compile_definitions(stereotlm_systemc INTERFACE SC_ALLOW_DEPRECATED_IEEE_API)
endif()
set_target_properties(stereotlm_systemc PROPERTIES
  STEREOTLM_VERSION "SystemC ${STEREOTLM_SYSTEMC_VERSION} for C++${STEREOTLM_SYSTEMC_CXX}")
message(STATUS "SystemC ${STEREOTLM_SYSTEMC_VERSION} for C++${STEREOTLM_SYSTEMC_CXX}: "
  "${STEREOTLM_SYSTEMC_LIBRARY}")
if(DEFINED CMAKE_CXX_STANDARD AND NOT CMAKE_CXX_STANDARD EQUAL STEREOTLM_SYSTEMC_CXX)
  message(FATAL_ERROR "CMAKE_CXX_STANDARD = ${CMAKE_CXX_STANDARD}: must be ${STEREOTLM_SYSTEMC_CXX}, for "
    "which ${STEREOTLM_SYSTEMC_LIBRARY} was built")
endif()

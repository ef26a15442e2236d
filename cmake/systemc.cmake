# Debian's libsystemc-dev has a pkg-config file but no CMake package: import it as stereotlm::systemc.
# Its headers are SYSTEM, so that the project's warnings do not apply to them.
find_package(PkgConfig REQUIRED)
pkg_check_modules(SYSTEMC REQUIRED systemc>=2.3.4)
find_path(SYSTEMC_INCLUDE_DIR systemc HINTS ${SYSTEMC_INCLUDE_DIRS} REQUIRED)
find_library(SYSTEMC_LIBRARY systemc HINTS ${SYSTEMC_LIBRARY_DIRS} REQUIRED)
find_package(Threads REQUIRED)

add_library(stereotlm_systemc INTERFACE IMPORTED)
add_library(stereotlm::systemc ALIAS stereotlm_systemc)
target_include_directories(stereotlm_systemc SYSTEM INTERFACE ${SYSTEMC_INCLUDE_DIR})
# SystemC enables dynamic processes only with this macro; TLM's convenience sockets need them.
target_compile_definitions(stereotlm_systemc INTERFACE SC_INCLUDE_DYNAMIC_PROCESSES)
target_link_libraries(stereotlm_systemc INTERFACE ${SYSTEMC_LIBRARY} Threads::Threads)

# The library links only with the C++ standard that it was built for.
include(CheckCXXSourceCompiles)
set(CMAKE_REQUIRED_INCLUDES ${SYSTEMC_INCLUDE_DIR})
set(CMAKE_REQUIRED_LIBRARIES ${SYSTEMC_LIBRARY} Threads::Threads)
check_cxx_source_compiles("#include <systemc>
int sc_main(int, char*[]) { return 0; }" STEREOTLM_SYSTEMC_FITS_CXX${CMAKE_CXX_STANDARD})
unset(CMAKE_REQUIRED_INCLUDES)
unset(CMAKE_REQUIRED_LIBRARIES)
if(NOT STEREOTLM_SYSTEMC_FITS_CXX${CMAKE_CXX_STANDARD})
  message(FATAL_ERROR
    "CMAKE_CXX_STANDARD = ${CMAKE_CXX_STANDARD}: must be that for which "
    "${SYSTEMC_LIBRARY} was built; Debian's is 17")
endif()

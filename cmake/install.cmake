# Installs the package stereotlm for other SystemC projects: libraries, headers that are included as
# <stereotlm/..>, the guides, and a CMake package that finds SystemC as this project does.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/stereotlm)
set(package_libraries kernels area arbitration models testing yaml config platform)

foreach(library ${package_libraries})
  set_target_properties(stereotlm_${library} PROPERTIES EXPORT_NAME ${library})
  target_compile_features(stereotlm_${library} PUBLIC cxx_std_17)
  install(TARGETS stereotlm_${library} EXPORT stereotlm_targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endforeach()
install(EXPORT stereotlm_targets NAMESPACE stereotlm:: FILE stereotlmTargets.cmake DESTINATION
  ${package_folder})

set(guides ${CMAKE_INSTALL_DATADIR}/doc/libstereotlm-dev)
install(CODE "set(source ${PROJECT_SOURCE_DIR})
  set(include ${CMAKE_INSTALL_INCLUDEDIR})
  set(guides ${guides})")
install(SCRIPT cmake/install_headers.cmake)
install(DIRECTORY tests/integration/package/project/ DESTINATION ${guides}/example)
install(SCRIPT cmake/install_guides.cmake)

set(STEREOTLM_GTEST_MAIN ${CMAKE_INSTALL_INCLUDEDIR}/stereotlm/models/testing/gtest_main.cpp)
configure_package_config_file(cmake/stereotlmConfig.cmake.in ${PROJECT_BINARY_DIR}/stereotlmConfig.cmake
  INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO PATH_VARS STEREOTLM_GTEST_MAIN)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/stereotlmConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/stereotlmConfig.cmake ${PROJECT_BINARY_DIR}/stereotlmConfigVersion.cmake
  cmake/systemc.cmake DESTINATION ${package_folder})

# Installs the package stereotlm for other SystemC projects: libraries, headers below include/stereotlm
# (include paths start there), and a CMake package that finds SystemC as this project does.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/stereotlm)
set(package_libraries kernels area arbitration models yaml config platform)

foreach(library ${package_libraries})
  set_target_properties(stereotlm_${library} PROPERTIES EXPORT_NAME ${library})
  target_compile_features(stereotlm_${library} PUBLIC cxx_std_17)
  install(TARGETS stereotlm_${library} EXPORT stereotlm_targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endforeach()
install(EXPORT stereotlm_targets NAMESPACE stereotlm:: FILE stereotlmTargets.cmake DESTINATION
  ${package_folder})

install(DIRECTORY models platform DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/stereotlm FILES_MATCHING PATTERN
  "*.h")

configure_package_config_file(cmake/stereotlmConfig.cmake.in ${PROJECT_BINARY_DIR}/stereotlmConfig.cmake
  INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/stereotlmConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/stereotlmConfig.cmake ${PROJECT_BINARY_DIR}/stereotlmConfigVersion.cmake
  cmake/systemc.cmake DESTINATION ${package_folder})

# Man pages, completion of shells, JSON Schemas, and Debian packages: `cmake --build build/release --target
# packages`.
#
# The packages are stereotlm (the program), libstereotlm-dev (libraries, headers, guides, example) and
# python3-stereotlm (the Python module). Man pages need help2man, completion needs Python; without them
# there are none, and no packages.
find_program(STEREOTLM_HELP2MAN help2man)
find_package(Python3 COMPONENTS Interpreter)

# A target that says which tool was not there when the build folder was configured.
function(stereotlm_target_without_tool target tool)
  add_custom_target(${target}
    COMMAND ${CMAKE_COMMAND} -E echo
      "${target}: ${tool} was not found. Install it (./setup packages), then configure again."
    COMMAND ${CMAKE_COMMAND} -E false VERBATIM)
endfunction()
set(manual ${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_MANDIR}/man1)
set(completion ${PROJECT_BINARY_DIR}/completion)

# The commands are those that the program lists, so the pages are made once it is built.
set(manual_of_program ${manual}/stereotlm.1.gz)
if(STEREOTLM_HELP2MAN)
  add_custom_command(OUTPUT ${manual_of_program} DEPENDS stereotlm cmake/manual.cmake
    COMMAND ${CMAKE_COMMAND} -DHELP2MAN=${STEREOTLM_HELP2MAN} -DPROGRAM=$<TARGET_FILE:stereotlm>
      -DFOLDER=${manual} -DVERSION=${PROJECT_VERSION} -P ${PROJECT_SOURCE_DIR}/cmake/manual.cmake
    VERBATIM)
  add_custom_target(stereotlm_manual ALL DEPENDS ${manual_of_program})
  install(DIRECTORY ${manual} DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program OPTIONAL)
endif()
if(Python3_Interpreter_FOUND)
  add_custom_command(OUTPUT ${completion}/stereotlm.bash DEPENDS stereotlm sw/cli/completion.py
    COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/sw/cli/completion.py $<TARGET_FILE:stereotlm>
      ${completion} VERBATIM)
  add_custom_target(stereotlm_completion ALL DEPENDS ${completion}/stereotlm.bash)
  install(FILES ${completion}/stereotlm.bash RENAME stereotlm COMPONENT program
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions OPTIONAL)
  install(FILES ${completion}/_stereotlm COMPONENT program
    DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions OPTIONAL)
  install(FILES ${completion}/stereotlm.fish COMPONENT program
    DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d OPTIONAL)
endif()
# The JSON Schemas of board files and plans, for editors.
set(schemas ${PROJECT_BINARY_DIR}/schemas)
file(MAKE_DIRECTORY ${schemas})
foreach(name board plan)
  set(schema ${schemas}/${name}.schema.json)
  add_custom_command(OUTPUT ${schema} DEPENDS stereotlm
    COMMAND stereotlm keys --schema ${name} > ${schema} VERBATIM)
  add_custom_target(stereotlm_schema_of_${name} ALL DEPENDS ${schema})
  install(FILES ${schema} DESTINATION ${CMAKE_INSTALL_DATADIR}/stereotlm/schemas COMPONENT program OPTIONAL)
endforeach()
# Debian's policy wants these two files in each package.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(package_and_component stereotlm/program libstereotlm-dev/development python3-stereotlm/python)
  cmake_path(GET package_and_component PARENT_PATH package)
  cmake_path(GET package_and_component FILENAME component)
  set(changelog ${PROJECT_BINARY_DIR}/packages/${package}/changelog)
  file(WRITE ${changelog} "${package} (${PROJECT_VERSION}) unstable; urgency=medium

  * See CHANGELOG.md.

 -- stereotlm maintainers <maintainers@users.noreply.github.com>  ${date}
")
  execute_process(COMMAND gzip -9nf ${changelog} COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${changelog}.gz cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package}
    COMPONENT ${component})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "stereotlm maintainers <maintainers@users.noreply.github.com>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "cycle-exact model of an FPGA stereo vision board")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development python)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME stereotlm)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS python3)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "python3-matplotlib, python3-pandas, python3-stereotlm")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "the program
 Simulates pairs of pictures on the board of Miyajima and Maruyama (FPL 2003),
 accounts for each cycle of its memory banks, and searches for allocations of
 buffers to banks.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libstereotlm-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libsystemc-dev, libfmt-dev, libyaml-cpp-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "libgtest-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "the SystemC modules
 Banks, arbiters, crossbars, PCI bus, bridge and the stages of the FPGA as
 SystemC/TLM-2.0 modules, and a test kit for SystemC modules.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-stereotlm)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "stereotlm (= ${PROJECT_VERSION}), python3 (>= 3.9), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-pandas)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS python3-tqdm)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  ${PROJECT_SOURCE_DIR}/cmake/python3-stereotlm/postinst ${PROJECT_SOURCE_DIR}/cmake/python3-stereotlm/prerm)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "the Python module
 Runs boards on arrays of numpy, and answers in tables of pandas who waits for
 whom, and what each change of a board would gain.")
include(CPack)
if(NOT STEREOTLM_HELP2MAN)
  stereotlm_target_without_tool(packages help2man)
  return()
elseif(NOT Python3_Interpreter_FOUND)
  stereotlm_target_without_tool(packages python3)
  return()
endif()
add_custom_target(packages
  DEPENDS stereotlm stereotlm_decoders stereotlm_calibration stereotlm_platform stereotlm_testing
    stereotlm_schema_of_board stereotlm_schema_of_plan stereotlm_manual stereotlm_completion
  COMMAND ${CMAKE_CPACK_COMMAND} --config ${PROJECT_BINARY_DIR}/CPackConfig.cmake -B
    ${PROJECT_BINARY_DIR}/packages
  WORKING_DIRECTORY ${PROJECT_BINARY_DIR} VERBATIM USES_TERMINAL)

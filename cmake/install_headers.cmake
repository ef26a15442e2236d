# Runs at installation: copies the public headers of `source`/models and platform to `include`/stereotlm.
# There they include each other as "stereotlm/..", so that no name of theirs can be one of the using project.
set(destination $ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${include}/stereotlm)
file(GLOB_RECURSE headers RELATIVE ${source} ${source}/models/*.h ${source}/platform/*.h)
# The inner loops of the kernels, the reader behind board_yaml.h, and what computer.h makes for fidelity fast.
list(FILTER headers EXCLUDE REGEX
  "_simd|simd_vectors|filter_arithmetic|board_draft|board_reader")
list(FILTER headers EXCLUDE REGEX "computer_loop|fast_board|loop_computer")
message(STATUS "Installing: ${destination}")
foreach(header IN LISTS headers ITEMS models/testing/gtest_main.cpp)
  file(READ ${source}/${header} text)
  string(REGEX REPLACE "#include \"(models|platform)/" "#include \"stereotlm/\\1/" text "${text}")
  file(WRITE ${destination}/${header} "${text}")
endforeach()

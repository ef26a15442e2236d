# Writes a man page of the program and of each of its commands into FOLDER: -DHELP2MAN=.. -DPROGRAM=..
# -DFOLDER=.. -DVERSION=..
execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE ";" "," help "${help}")  # it would divide a list
string(REGEX REPLACE ".*\nCommands:\n" "" commands "${help}")
string(REGEX REPLACE "\n\nExit status.*" "" commands "${commands}")
string(REGEX MATCHALL "(^|\n)  [a-z0-9-]+  +[^\n]*" commands "${commands}")

function(write_page name executable summary)
  execute_process(
    COMMAND ${HELP2MAN} --no-info --version-string=${VERSION} --name=${summary} "${executable}"
    OUTPUT_VARIABLE page COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE "(\n\\.SH NAME\n)[^\n]*( .- )" "\\1${name}\\2" page "${page}")
  file(WRITE ${FOLDER}/${name}.1 "${page}")
  execute_process(COMMAND gzip -9nf ${FOLDER}/${name}.1 COMMAND_ERROR_IS_FATAL ANY)
endfunction()

write_page(stereotlm "'${PROGRAM}'" "cycle-exact model of an FPGA stereo vision board")
foreach(line IN LISTS commands)
  string(REGEX MATCH "  ([a-z0-9-]+)  +([^\n]*)" unused "${line}")
  write_page(stereotlm-${CMAKE_MATCH_1} "'${PROGRAM}' ${CMAKE_MATCH_1}" "${CMAKE_MATCH_2}")
endforeach()

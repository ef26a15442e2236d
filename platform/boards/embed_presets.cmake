# cmake -DOUTPUT=presets.cpp -P embed_presets.cmake board.yaml...
# Writes the definition of stereotlm::platform::presets(): each board under the name of its file.
set(entries "")
math(EXPR last "${CMAKE_ARGC} - 1")
set(is_board FALSE)
foreach(i RANGE ${last})
  set(argument "${CMAKE_ARGV${i}}")
  if(is_board)
    get_filename_component(name "${argument}" NAME_WE)
    file(READ "${argument}" text)
    string(APPEND entries "      {\"${name}\", R\"yaml(${text})yaml\"},\n")
  elseif(argument MATCHES "embed_presets\\.cmake$")
    set(is_board TRUE)
  endif()
endforeach()

file(WRITE "${OUTPUT}" "#include \"platform/boards/presets.h\"

namespace stereotlm::platform {

const std::vector<Preset>& presets() {
  static const std::vector<Preset> all = {
${entries}  };
  return all;
}

}  // namespace stereotlm::platform
")

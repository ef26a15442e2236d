# cmake -DOUTPUT=page_text.cpp -DSCRIPTS=a.js;b.js -P assemble.cmake
# Writes the definition of stereotlm::report::page_text(). The scripts become one: without the lines that import
# from each other, and without `export`. Their names at the outermost level must therefore differ.
file(READ page.html page)
file(READ style.css style)
set(script "")
foreach(name ${SCRIPTS})
  file(READ ${name} text)
  string(REGEX REPLACE "import [^;]* from [^;]*;\n" "" text "${text}")
  string(REGEX REPLACE "\nexport " "\n" text "\n${text}")
  string(APPEND script "${text}")
endforeach()
string(REPLACE "STYLE_OF_THE_REPORT" "${style}" page "${page}")
string(REPLACE "SCRIPT_OF_THE_REPORT" "${script}" page "${page}")
file(WRITE "${OUTPUT}" "#include \"sw/report/page/page_text.h\"

namespace stereotlm::report {

std::string_view page_text() {
  static constexpr std::string_view text = R\"page_text(${page})page_text\";
  return text;
}

}  // namespace stereotlm::report
")

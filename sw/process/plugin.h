#pragma once

#include <string>

namespace stereotlm::process {

// The symbol that one of the program's own libraries exports. The library is installed with the program; the
// first call loads it, and OpenCV with it, and it stays loaded. Variables of the environment that configure
// OpenCV (OPENCV_..) are removed. Throws std::runtime_error if the library cannot be loaded; `what` completes
// the message "the library that ..".
const void* plugin_symbol(const std::string& library_name, const char* symbol, const std::string& what);

}  // namespace stereotlm::process

#pragma once

#include <string>

namespace stereotlm::process {

// The one symbol that a library of ours exports for us. It lies beside the program, as installed, and is
// loaded when it is first asked for, with OpenCV; it stays loaded. `what` it does is said if it fails:
// std::runtime_error. Settings of OpenCV in the environment (OPENCV_..) have no effect: they are removed.
const void* plugin_symbol(const std::string& library_name, const char* symbol, const std::string& what);

}  // namespace stereotlm::process

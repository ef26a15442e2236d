#include "sw/process/installation.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "models/fpga/core_config.h"

namespace stereotlm::process {
namespace {

// OpenCV reads variables of the environment when it is loaded, and an unreadable value ends the process. Only
// the variables that are set here remain, so that results do not depend on the environment.
void set_up_opencv() {
  const std::string beginning = "OPENCV_";
  std::vector<std::string> names;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    if (text.rfind(beginning, 0) == 0) names.push_back(text.substr(0, text.find('=')));
  }
  for (const std::string& name : names) unsetenv(name.c_str());
  // OpenCV refuses a larger picture before it decodes the pixels.
  setenv("OPENCV_IO_MAX_IMAGE_WIDTH", std::to_string(fpga::kWidthRule.max).c_str(), 1);
  setenv("OPENCV_IO_MAX_IMAGE_HEIGHT", std::to_string(fpga::kHeightRule.max).c_str(), 1);
}

}  // namespace

std::filesystem::path installed_path(const std::string& from_program) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  return (program.parent_path() / from_program).lexically_normal();
}

const void* plugin_symbol(const std::string& library_name, const char* symbol, const std::string& what) {
  const std::string path = installed_path(STEREOTLM_PLUGIN_FOLDER) / library_name;
  set_up_opencv();
  void* const library = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  const void* const found = library == nullptr ? nullptr : dlsym(library, symbol);
  if (found == nullptr) {
    throw std::runtime_error("the library that " + what + " cannot be loaded: " + dlerror());
  }
  return found;
}

}  // namespace stereotlm::process

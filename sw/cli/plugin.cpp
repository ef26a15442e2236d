#include "sw/cli/plugin.h"

#include <dlfcn.h>

#include <stdexcept>

#include "sw/cli/installed_path.h"

namespace stereotlm::cli {

const void* plugin_symbol(const std::string& library_name, const char* symbol, const std::string& what) {
  const std::string path = installed_path(STEREOTLM_PLUGIN_FOLDER) / library_name;
  void* const library = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  const void* const found = library == nullptr ? nullptr : dlsym(library, symbol);
  if (found == nullptr) {
    throw std::runtime_error("the library that " + what + " cannot be loaded: " + dlerror());
  }
  return found;
}

}  // namespace stereotlm::cli

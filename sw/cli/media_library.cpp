#include "sw/cli/media_library.h"

#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>

namespace stereotlm::cli {
namespace {

const MediaFunctions& load() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const std::string path = (program.parent_path() / STEREOTLM_MEDIA_LIBRARY).lexically_normal();
  void* const library = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  void* const functions = library == nullptr ? nullptr : dlsym(library, "stereotlm_media_functions");
  if (functions == nullptr) {
    throw std::runtime_error(std::string("the library that reads pictures cannot be loaded: ") + dlerror());
  }
  return *static_cast<const MediaFunctions*>(functions);
}

}  // namespace

const MediaFunctions& media_functions() {
  static const MediaFunctions& functions = load();
  return functions;
}

}  // namespace stereotlm::cli

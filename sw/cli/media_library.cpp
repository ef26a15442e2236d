#include "sw/cli/media_library.h"

#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>

namespace stereotlm::cli {
namespace {

// The functions are the one symbol that the library of this name exports for us.
template <typename Functions>
const Functions& load(const std::string& library_name, const char* symbol, const std::string& what) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const std::string path = (program.parent_path() / STEREOTLM_MEDIA_FOLDER / library_name).lexically_normal();
  void* const library = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  void* const functions = library == nullptr ? nullptr : dlsym(library, symbol);
  if (functions == nullptr) {
    throw std::runtime_error("the library that reads " + what + " cannot be loaded: " + dlerror());
  }
  return *static_cast<const Functions*>(functions);
}

}  // namespace

const MediaFunctions& media_functions() {
  static const auto& functions =
      load<MediaFunctions>("libstereotlm_pictures.so", "stereotlm_media_functions", "pictures");
  return functions;
}

const VideoFunctions& video_functions() {
  static const auto& functions =
      load<VideoFunctions>("libstereotlm_videos.so", "stereotlm_video_functions", "videos");
  return functions;
}

}  // namespace stereotlm::cli

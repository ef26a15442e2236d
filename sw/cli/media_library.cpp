#include "sw/cli/media_library.h"

#include "sw/cli/plugin.h"

namespace stereotlm::cli {

const MediaFunctions& media_functions() {
  static const auto& functions = *static_cast<const MediaFunctions*>(
      plugin_symbol("libstereotlm_pictures.so", "stereotlm_media_functions", "reads pictures"));
  return functions;
}

const VideoFunctions& video_functions() {
  static const auto& functions = *static_cast<const VideoFunctions*>(
      plugin_symbol("libstereotlm_videos.so", "stereotlm_video_functions", "reads videos"));
  return functions;
}

}  // namespace stereotlm::cli

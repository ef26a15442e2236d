#include "sw/runs/sources/media_library.h"

#include "sw/process/plugin.h"

namespace stereotlm::runs {

const MediaFunctions& media_functions() {
  static const auto& functions = *static_cast<const MediaFunctions*>(
      process::plugin_symbol("libstereotlm_pictures.so", "stereotlm_media_functions", "reads pictures"));
  return functions;
}

const VideoFunctions& video_functions() {
  static const auto& functions = *static_cast<const VideoFunctions*>(
      process::plugin_symbol("libstereotlm_videos.so", "stereotlm_video_functions", "reads videos"));
  return functions;
}

}  // namespace stereotlm::runs

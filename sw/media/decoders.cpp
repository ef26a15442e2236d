#include "sw/files/whole_file.h"
#include "sw/media/decode.h"
#include "sw/process/installation.h"

namespace stereotlm::media {

const Decoders& decoders() {
  static const auto& functions = *static_cast<const Decoders*>(process::plugin_symbol(
      "libstereotlm_decoders.so", "stereotlm_decoders", "decodes videos and the rarer formats of pictures"));
  return functions;
}

std::unique_ptr<Video> open_video(const std::string& path, const VideoSizeCheck& check) {
  files::check_regular_file(path);
  return decoders().open_video(path, check);
}

}  // namespace stereotlm::media

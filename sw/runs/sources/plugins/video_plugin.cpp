#include "sw/runs/sources/media_library.h"

// The only symbol that media_library.h looks up.
extern "C" {
extern const stereotlm::runs::VideoFunctions stereotlm_video_functions;
const stereotlm::runs::VideoFunctions stereotlm_video_functions = {stereotlm::media::open_video};
}

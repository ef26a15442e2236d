#include "sw/runs/sources/media_library.h"

// The one symbol of the library that media_library.h loads.
extern "C" {
extern const stereotlm::runs::VideoFunctions stereotlm_video_functions;
const stereotlm::runs::VideoFunctions stereotlm_video_functions = {stereotlm::media::open_video};
}

#include "sw/media/encode.h"
#include "sw/runs/sources/media_library.h"

// The only symbol that media_library.h looks up.
extern "C" {
extern const stereotlm::runs::MediaFunctions stereotlm_media_functions;
const stereotlm::runs::MediaFunctions stereotlm_media_functions = {
    stereotlm::media::load_gray,       stereotlm::media::load_truth,
    stereotlm::media::encode_png_gray, stereotlm::media::encode_disparity_color_png,
    stereotlm::media::encode_png_16,   stereotlm::media::encode_pfm};
}

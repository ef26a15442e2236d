#pragma once

#include <memory>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/media/video.h"
#include "sw/runs/sources/pair_source.h"
#include "sw/runs/sources/picture_source.h"

namespace stereotlm::runs {

// The pairs of `--video F [F2] --video-layout L`.
class VideoPairs : public PairSource {
 public:
  // Decodes each video once. Throws std::runtime_error if a video cannot be decoded, if its frames have
  // another size than the layout needs, or if two videos differ in their number of frames; the message does
  // not name the option. `board`: null if unknown; sizes are then not checked, and no pair may be requested.
  VideoPairs(const PictureSource::Video& options, const platform::BoardConfig* board);

  // Notes for standard error: videos with fewer frames than their headers state.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  host::StereoPair load(std::uint64_t index) override;

  std::vector<std::unique_ptr<media::Video>> videos_;
  std::vector<std::string> notes_;
  VideoLayout layout_;
};

}  // namespace stereotlm::runs

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
  // Decodes each video once. Throws std::runtime_error, without the name of the option, for the first one
  // that cannot be decoded or whose frames are not as large as the layout needs, and if two differ in their
  // number of frames. `board`: null if it is not known; the pairs are then of no use.
  VideoPairs(const PictureSource::Video& options, const platform::BoardConfig* board);

  // For standard error: videos of which fewer frames can be decoded than their headers say.
  const std::vector<std::string>& notes() const { return contents_.notes; }

 private:
  struct Contents {
    std::vector<std::unique_ptr<media::Video>> videos;
    std::vector<std::string> notes;
  };
  static Contents open(const PictureSource::Video& options, const platform::BoardConfig* board);

  VideoPairs(Contents contents, VideoLayout layout);
  host::StereoPair load(std::uint64_t index) override;

  Contents contents_;
  VideoLayout layout_;
};

}  // namespace stereotlm::runs

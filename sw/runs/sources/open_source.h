#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/host/frame_source.h"
#include "platform/config/board_config.h"
#include "sw/files/output_file.h"
#include "sw/media/truth.h"
#include "sw/process/problems.h"
#include "sw/runs/run_json.h"

namespace stereotlm::runs {

// Where a video has the two pictures of a pair.
enum class VideoLayout : std::uint8_t { kTwo, kSideBySide, kTopBottom };

// Names of the layouts on the command line, in the order of VideoLayout.
inline const std::vector<std::string> kVideoLayoutNames = {"two", "side_by_side", "top_bottom"};

// nullopt for an unknown name.
inline std::optional<VideoLayout> video_layout_of(const std::string& name) {
  const auto found = std::find(kVideoLayoutNames.begin(), kVideoLayoutNames.end(), name);
  if (found == kVideoLayoutNames.end()) return std::nullopt;
  return static_cast<VideoLayout>(found - kVideoLayoutNames.begin());
}

// The source of a run's pictures as the user names it. At most one member is set.
struct PictureSource {
  struct Pair {
    std::string left;
    std::string right;
  };
  struct Video {
    std::vector<std::string> files;  // two for kTwo, the left one first, else one
    VideoLayout layout = VideoLayout::kTwo;

    const std::string& layout_name() const { return kVideoLayoutNames[static_cast<std::size_t>(layout)]; }
  };
  std::optional<Pair> pair;
  std::optional<std::string> sequence;  // a folder
  std::optional<Video> video;
  std::optional<std::uint64_t> synthetic;  // the seed of a synthetic scene
};

// Supplies the pairs of a run: frame f shows pair f mod length(). A pair is loaded when it is requested. Only
// the kHeld pairs that were requested last are kept, so that memory does not grow with the length.
class PairSource : public host::FrameSource {
 public:
  static constexpr std::uint64_t kEndless = std::numeric_limits<std::uint64_t>::max();

  // The number of pairs, 1 or more.
  std::uint64_t length() const { return length_; }

  // The reference is valid until kHeld other pairs have been requested. Throws std::runtime_error with option
  // and path if a file has changed since the source was opened.
  static constexpr std::size_t kHeld = 4;
  const host::StereoPair& pair(std::uint64_t frame) final;

  // The truth of the pair that a frame shows; nullopt if unknown. It holds only for a run without
  // calibration.
  virtual std::optional<media::Truth> truth(std::uint64_t /*frame*/) const { return std::nullopt; }

 protected:
  // `option`: its name in error messages. `length`: 0 if set_length() follows.
  PairSource(std::string option, std::uint64_t length) : option_(std::move(option)), length_(length) {}
  void set_length(std::uint64_t length) { length_ = length; }

 private:
  // Loads pair `index`, 0 .. length()-1.
  virtual host::StereoPair load(std::uint64_t index) = 0;

  struct Held {
    std::uint64_t index = 0;
    host::StereoPair pair;
  };

  std::string option_;
  std::uint64_t length_;
  std::list<Held> held_;  // most recently requested first
};

using files::NamedFile;

// The result of open_source().
struct OpenedSource {
  std::unique_ptr<PairSource> pairs;  // null if it cannot be used
  std::vector<NamedFile> files;       // files that were named or found, usable or not
  std::vector<std::string> notes;     // for standard error
};

// Opens the source of pictures and checks all its pictures. Reports problems. Fills the fields of `described`
// that concern the pictures. `board`: null if unknown; the sizes of the pictures are then not checked.
OpenedSource open_source(const PictureSource& options, const platform::BoardConfig* board,
                         RecordedOptions& described, process::Problems& problems);

// Loads the ground truth and checks its size. Reports problems and returns nullopt if there are any. `board`:
// null if unknown; the size is then not checked.
std::optional<media::Truth> open_truth(const NamedFile& file, double scale,
                                       const platform::BoardConfig* board, process::Problems& problems);

}  // namespace stereotlm::runs

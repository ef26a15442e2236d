#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
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
#include "sw/media/fit.h"
#include "sw/media/load.h"
#include "sw/process/problems.h"
#include "sw/runs/run_json.h"

namespace stereotlm::runs {

// Where a video has the two pictures of a pair: names of the layouts on the command line.
inline const std::vector<std::string> kVideoLayoutNames = {"two", "side_by_side", "top_bottom"};

// The number of files of a video with this layout; 0 if there is no such layout.
inline std::size_t video_files(const std::string& layout) {
  const bool is_known =
      std::find(kVideoLayoutNames.begin(), kVideoLayoutNames.end(), layout) != kVideoLayoutNames.end();
  return layout == "two" ? 2 : is_known ? 1 : 0;
}

// Supplies the pairs of a run: frame f shows pair f mod length(). A pair is loaded when it is requested. Only
// the kHeld pairs that were requested last are kept, so that memory does not grow with the length.
class PairSource : public host::FrameSource {
 public:
  static constexpr std::uint64_t kEndless = std::numeric_limits<std::uint64_t>::max();
  // Loads pair `index`, 0 .. length()-1, and its truth.
  using Load = std::function<host::StereoPair(std::uint64_t index)>;
  using LoadTruth = std::function<media::Truth(std::uint64_t index)>;

  // `option`: its name in error messages. `length`: the number of pairs, 1 or more.
  PairSource(std::string option, std::uint64_t length, Load load, LoadTruth load_truth = nullptr)
      : option_(std::move(option)),
        length_(length),
        load_(std::move(load)),
        load_truth_(std::move(load_truth)) {}

  std::uint64_t length() const { return length_; }

  // The reference is valid until kHeld other pairs have been requested. Throws std::runtime_error with option
  // and path if a file has changed since the source was opened.
  static constexpr std::size_t kHeld = 4;
  const host::StereoPair& pair(std::uint64_t frame) override;

  // The truth of the pair that a frame shows, for a run without calibration; nullopt if unknown.
  std::optional<media::Truth> truth(std::uint64_t frame) const {
    return load_truth_ ? std::optional(load_truth_(frame % length_)) : std::nullopt;
  }

 private:
  struct Held {
    std::uint64_t index = 0;
    host::StereoPair pair;
  };

  std::string option_;
  std::uint64_t length_;
  Load load_;
  LoadTruth load_truth_;
  std::list<Held> held_;  // most recently requested first
};

// Black pictures, for runs without pixels.
std::unique_ptr<PairSource> blank_pairs(const platform::BoardConfig& board);

using files::NamedFile;

// The result of open_source().
struct OpenedSource {
  media::Fit fit;
  std::unique_ptr<PairSource> pairs;  // null if it cannot be used
  int truth_offset = 0;               // truth_offset() of the tables, set by the caller
  std::vector<media::Size> sizes;     // of the pairs before the fit, in turn; empty if they need none
  std::vector<NamedFile> files;       // files that were named or found, usable or not
  std::vector<std::string> notes;     // for standard error
};

// Opens the source of pictures, checks all its pictures, and reports problems. The caller names at most one
// source in `pictures`. The function makes its paths absolute, and adds the checksums of its files. `board`:
// null if unknown; the sizes of the pictures are then not checked. `has_calibration`: no message then
// recommends --fit.
OpenedSource open_source(InputPictures& pictures, const platform::BoardConfig* board,
                         process::Problems& problems, bool has_calibration = false);

// Takes the pairs of a client (process/client.h) as the source: its arrays `left` and `right`. The board must
// be known. Throws std::runtime_error if one is missing, or if their shapes do not fit each other or the
// board.
void open_arrays(OpenedSource& opened);

// Loads the ground truth of the pair that a frame shows, and checks its size. Reports problems and returns
// nullopt if there are any. `content`: as for media::load_truth().
std::optional<media::Truth> open_truth(const NamedFile& file, std::optional<double> scale,
                                       const OpenedSource& source, std::uint64_t frame,
                                       process::Problems& problems, const std::string* content = nullptr);

}  // namespace stereotlm::runs

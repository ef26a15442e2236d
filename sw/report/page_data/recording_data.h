#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "platform/config/board_config.h"
#include "platform/figures/statistics.h"

namespace stereotlm::report {

// The part `recording` of a page's data: the files that `run --out` records, as sums over the recorded frames
// and as a limited number of events, so that the page stays small however long the run is.
class RecordingData {
 public:
  // Values of all maps of stalls together, and of one map. Tiles are put together until a map has no more.
  static constexpr std::size_t kMostValues = 100'000;
  static constexpr std::size_t kMostTiles = 20'000;
  static constexpr std::size_t kMostEvents = 4000;  // about
  static constexpr std::size_t kMostLatencies = 1000;

  // `camera`: with the time line of a computer. `folder`: that of the files, for messages. `board` outlives
  // this object.
  RecordingData(const platform::BoardConfig& board, bool camera, const std::filesystem::path& folder = {});
  ~RecordingData();

  // Adds whole lines of one file, in their order; without a time line only of conflict files. Throws
  // std::runtime_error if something is not as `run` writes it: "PATH:LINE: column = value: rule".
  void add(const std::string& name, std::string_view text);
  // Adds the files of the folder, and checks their identities with the figures of the run, as far as its
  // frames are recorded. Throws as add() does. Returns false, and adds nothing, if they are not there.
  bool add_folder(const platform::Statistics& statistics);
  // Checks those identities.
  void check(const platform::Statistics& statistics) const;

  nlohmann::ordered_json json() const;

  // The camera frame that the last frame of the run shows. With a time line only.
  std::uint64_t last_camera_frame() const;

 private:
  std::filesystem::path folder_;
  std::unique_ptr<class ConflictData> conflicts_;
  std::unique_ptr<class TimelineData> timeline_;  // nullptr without a computer
};

}  // namespace stereotlm::report

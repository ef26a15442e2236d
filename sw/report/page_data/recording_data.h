#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "platform/config/board_config.h"
#include "sw/report/page_data/conflict_data.h"
#include "sw/report/page_data/timeline_data.h"

namespace stereotlm::report {

// The part `recording` of a page's data: the files that `run --record` writes, as sums and as a limited number
// of events, so that the page stays small however long the run is.
class RecordingData {
 public:
  // `camera`: with the time line of a computer. `folder`: that of the files, for messages. `board` outlives
  // this object.
  RecordingData(const platform::BoardConfig& board, bool camera, const std::filesystem::path& folder = {});

  // Whole lines of one of the files, in their order. Throws as CsvLines does.
  void add(const std::string& name, std::string_view text);
  // Adds the files of the folder, and checks their identities with the figures of the run. Throws as CsvLines
  // does. Returns false, and adds nothing, if they are not there.
  bool add_folder(const platform::Statistics& statistics);

  nlohmann::ordered_json json() const;

 private:
  std::filesystem::path folder_;
  ConflictData conflicts_;
  std::optional<TimelineData> timeline_;
};

}  // namespace stereotlm::report

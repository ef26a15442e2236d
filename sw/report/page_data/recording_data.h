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
  // `camera`: with the time line of a computer.
  RecordingData(const platform::BoardConfig& board, bool camera);

  // Whole lines of one of the files, in their order. Throws as CsvLines does.
  void add(const std::string& name, std::string_view text);
  // Adds the files of a result folder. Returns false, and adds nothing, if they are not there.
  bool add_folder(const std::filesystem::path& folder);

  nlohmann::ordered_json json() const;

 private:
  ConflictData conflicts_;
  std::optional<TimelineData> timeline_;
};

}  // namespace stereotlm::report

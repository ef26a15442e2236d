#include "sw/report/page_data/recording_data.h"

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace stereotlm::report {
namespace {

// Reads a file in pieces of whole lines, because rows.csv of a long run is large.
template <typename Take>
void read_in_pieces(const std::filesystem::path& path, Take take) {
  constexpr std::size_t kPiece = 1U << 20U;
  std::ifstream file(path, std::ios::binary);
  std::string text;
  while (file) {
    const std::size_t rest = text.size();
    text.resize(rest + kPiece);
    file.read(text.data() + rest, kPiece);
    text.resize(rest + static_cast<std::size_t>(file.gcount()));
    const std::size_t lines = file ? text.rfind('\n') + 1 : text.size();
    take(std::string_view(text).substr(0, lines));
    text.erase(0, lines);
  }
}

}  // namespace

RecordingData::RecordingData(const platform::BoardConfig& board, bool camera,
                             const std::filesystem::path& folder)
    : folder_(folder), conflicts_(board, folder) {
  if (camera) timeline_.emplace(board, folder);
}

void RecordingData::add(const std::string& name, std::string_view text) {
  if (name == "rows.csv") {
    conflicts_.add_rows(text);
  } else if (name == "conflicts.csv") {
    conflicts_.add_tiles(text);
  } else if (name == "timeline.csv") {
    timeline_.value().add_events(text);
  } else if (name == "latency.csv") {
    timeline_.value().add_latencies(text);
  } else {
    throw std::logic_error("no file of a recording: " + name);
  }
}

bool RecordingData::add_folder(const platform::Statistics& statistics) {
  std::vector<std::string> names = {"rows.csv", "conflicts.csv"};
  if (timeline_) names.insert(names.end(), {"timeline.csv", "latency.csv"});
  if (!std::all_of(names.begin(), names.end(), [this](const std::string& name) {
        std::error_code ignored;
        return std::filesystem::is_regular_file(folder_ / name, ignored);
      }))
    return false;
  for (const std::string& name : names)
    read_in_pieces(folder_ / name, [&](std::string_view lines) { add(name, lines); });
  conflicts_.check(statistics);
  if (timeline_) timeline_->check(statistics);
  return true;
}

nlohmann::ordered_json RecordingData::json() const {
  nlohmann::ordered_json json = conflicts_.json();
  if (timeline_) json.update(timeline_->json());
  return json;
}

}  // namespace stereotlm::report

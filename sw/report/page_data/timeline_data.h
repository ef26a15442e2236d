#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/statistics.h"
#include "platform/timeline_records.h"
#include "sw/report/page_data/csv_lines.h"

namespace stereotlm::report {

// What happens when in the computer, for a page: events and latencies of timeline.csv and latency.csv. The
// events of a long run are those of three periods; sums cover all of it.
class TimelineData {
 public:
  static constexpr std::size_t kMostEvents = 4000;  // in a page, about
  static constexpr std::size_t kMostLatencies = 1000;
  static constexpr std::size_t kBins = 300;  // of the overview

  // `folder`: that of the files, for messages. `board` outlives this object.
  TimelineData(const platform::BoardConfig& board, const std::filesystem::path& folder);

  // Whole lines of the files, in their order. They throw as CsvLines does.
  void add_events(std::string_view text);
  void add_latencies(std::string_view text);
  // Checks the identities of the whole files with the figures of their run. Throws as CsvLines does.
  void check(const platform::Statistics& statistics) const;
  // The parts `events`, `overview`, `waits` and `latency` of a recording.
  nlohmann::ordered_json json() const;

 private:
  using Period = std::pair<std::uint64_t, std::uint64_t>;  // ps
  using Latency =
      std::array<std::uint64_t, platform::kLatencyParts.size() + 4>;  // the columns of latency.csv

  platform::TimelineEvent event_of_line() const;
  std::uint64_t end_ps() const { return events_.empty() ? 0 : events_.back().end_ps; }
  std::vector<Period> periods() const;
  nlohmann::ordered_json events_json() const;
  nlohmann::ordered_json overview_json() const;
  nlohmann::ordered_json waits_json() const;
  nlohmann::ordered_json latency_json() const;

  CsvLines events_csv_;
  CsvLines latencies_csv_;
  const platform::BoardConfig& board_;
  std::vector<platform::TimelineEvent> events_;  // by their ends
  std::vector<Latency> latencies_;
};

}  // namespace stereotlm::report

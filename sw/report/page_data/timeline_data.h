#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

  TimelineData();

  // Whole lines of the files, in their order. They throw as CsvLines does.
  void add_events(std::string_view text);
  void add_latencies(std::string_view text);
  // The parts `events`, `overview`, `waits` and `latency` of a recording.
  nlohmann::ordered_json json() const;

 private:
  struct Event {
    // Indices of words_.
    std::size_t kind;
    std::size_t what;
    std::size_t why;
    // -1: none
    std::int64_t frame;
    std::int64_t camera_frame;
    std::uint64_t begin_ps;
    std::uint64_t end_ps;
    std::uint64_t words;
    std::uint64_t dropped_pixels;
  };
  using Period = std::pair<std::uint64_t, std::uint64_t>;  // ps
  using Latency =
      std::array<std::uint64_t, platform::kLatencyParts.size() + 4>;  // the columns of latency.csv

  std::size_t word(std::string_view text);
  std::uint64_t end_ps() const { return events_.empty() ? 0 : events_.back().end_ps; }
  std::vector<Period> periods() const;
  nlohmann::ordered_json events_json() const;
  nlohmann::ordered_json overview_json() const;
  nlohmann::ordered_json waits_json() const;
  nlohmann::ordered_json latency_json() const;

  CsvLines events_csv_;
  CsvLines latencies_csv_;
  std::vector<std::string> words_;
  std::vector<Event> events_;  // by their ends
  std::vector<Latency> latencies_;
};

}  // namespace stereotlm::report

#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "models/clock.h"
#include "platform/audit.h"
#include "platform/config/board_config.h"
#include "platform/statistics.h"
#include "platform/timeline_records.h"

namespace stereotlm::platform {

// Sums of the events of a time line, for their identities with the figures of the run.
class TimelineSums {
 public:
  explicit TimelineSums(const BoardConfig& board) : clock_(board.fpga.clock_mhz) {}

  // Events by their ends.
  void add(const TimelineEvent& event);
  // Checks the identities, once all events have been added.
  void check(const Statistics& statistics, Audit& audit) const;

 private:
  struct Sums {
    std::uint64_t events = 0;
    std::uint64_t words = 0;
    std::uint64_t dropped_pixels = 0;
  };
  // Something that works on one event at a time.
  using Resource = std::pair<EventKind, std::string_view>;
  static constexpr Resource kCore = {EventKind::kFrame, "core"};

  // Nothing for events that may overlap.
  static std::optional<Resource> resource_of(const TimelineEvent& event);
  Sums sums_of(EventKind kind, std::string_view what, std::string_view why = "") const;

  Clock clock_;
  std::map<std::tuple<EventKind, std::string_view, std::string_view>, Sums> sums_;
  std::map<Resource, std::uint64_t> busy_until_ps_;
  std::uint64_t overlaps_ = 0;
  std::uint64_t core_ps_ = 0;  // the core's frames and waits
  std::uint64_t cycles_ = 0;   // of the core's frames
};

}  // namespace stereotlm::platform

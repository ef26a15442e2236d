#pragma once

#include <array>
#include <map>
#include <string>

#include "platform/timeline_records.h"
#include "platform/trace_records.h"
#include "sw/trace/perfetto_tree.h"

namespace stereotlm::trace {

// The computer around the core: bursts of both buses, levels of queues, and the events of the time line.
class PerfettoComputer {
 public:
  explicit PerfettoComputer(PerfettoTree& tree);

  void burst(const platform::BusBurst& burst);
  void level(const platform::QueueLevel& level);
  void event(const platform::TimelineEvent& event);

 private:
  struct Bus {
    OverlappingTracks bursts;
    OverlappingTracks waits;
  };
  OverlappingTracks& track_of(const platform::TimelineEvent& event);

  PerfettoTree& tree_;
  std::array<Bus, 2> buses_;
  std::map<std::string, LazyTrack> queues_;
  std::map<std::string, OverlappingTracks> events_;
};

}  // namespace stereotlm::trace

#include "sw/trace/perfetto_computer.h"

#include <fmt/format.h>

#include <cstdint>
#include <optional>

namespace stereotlm::trace {

using platform::BusBurst;
using platform::EventKind;
using platform::TimelineEvent;

namespace {

constexpr std::uint64_t kPsPerNs = 1000;
constexpr std::size_t kFirstQueueRank = 3;  // behind those of the core

TrackGroup group_of(EventKind kind) {
  if (kind == EventKind::kCapture || kind == EventKind::kDrop) return TrackGroup::kCapture;
  return kind == EventKind::kFrame ? TrackGroup::kCore : TrackGroup::kSoftware;
}

// A number that is left out if it is 0.
std::optional<std::uint64_t> given(std::uint64_t number) {
  return number != 0 ? std::optional(number) : std::nullopt;
}

std::string track_name(const TimelineEvent& event) {
  switch (event.kind) {
    case EventKind::kCapture:
    case EventKind::kDrop:
      return event.what;
    case EventKind::kUpload:
      return "uploads";
    case EventKind::kReadBack:
      return "read-backs";
    case EventKind::kFrame:
      return "core";
    case EventKind::kInterrupt:
      return fmt::format("interrupt {}", event.what);
    case EventKind::kWait:
      return fmt::format("wait {}", event.what);
  }
  return "";
}

std::string slice_name(const TimelineEvent& event) {
  switch (event.kind) {
    case EventKind::kCapture:
      return "capture";
    case EventKind::kDrop:
      return fmt::format("drop: {}", event.why);
    case EventKind::kInterrupt:
      return fmt::format("interrupt {}", event.what);
    case EventKind::kWait:
      return fmt::format("{} waits: {}", event.what, event.why);
    case EventKind::kUpload:
    case EventKind::kReadBack:
    case EventKind::kFrame:
      return event.what;
  }
  return "";
}

}  // namespace

PerfettoComputer::PerfettoComputer(PerfettoTree& tree)
    : tree_(tree),
      buses_{
          Bus{{tree, TrackGroup::kBuses, 0, "pci"}, {tree, TrackGroup::kBuses, 1, "pci waits"}},
          Bus{{tree, TrackGroup::kBuses, 2, "local bus"}, {tree, TrackGroup::kBuses, 3, "local bus waits"}}} {
}

void PerfettoComputer::burst(const BusBurst& burst) {
  Bus& bus = buses_[static_cast<std::size_t>(burst.bus)];
  const std::uint64_t request = burst.request_ps / kPsPerNs;
  const std::uint64_t address = burst.address_ps / kPsPerNs;
  const std::uint64_t data = burst.data_ps / kPsPerNs;
  const std::uint64_t end = burst.end_ps / kPsPerNs;
  if (request < address)
    bus.waits.free_at(request).slice(request, address, fmt::format("{} waits", burst.master), {});
  PerfettoTrack& track = bus.bursts.free_at(address);
  track.begin(address, fmt::format("{} {} {}", burst.master, burst.write ? "writes" : "reads", burst.target),
              {{"address", burst.address}, {"words", burst.words}});
  track.slice(address, data, "address", {});
  if (data < end) track.slice(data, end, "data", {});
  track.end(end);
}

void PerfettoComputer::level(const platform::QueueLevel& level) {
  auto queue = queues_.find(level.queue);
  if (queue == queues_.end())
    queue = queues_
                .try_emplace(level.queue, tree_, TrackGroup::kQueues, kFirstQueueRank + queues_.size(),
                             level.queue, "words")
                .first;
  queue->second->count(level.time_ps / kPsPerNs, static_cast<double>(level.words));
}

void PerfettoComputer::event(const TimelineEvent& event) {
  const std::uint64_t begin = event.begin_ps / kPsPerNs;
  PerfettoTrack& track = track_of(event).free_at(begin);
  if (event.kind == EventKind::kDrop) {
    track.instant(begin, slice_name(event), {{"camera frame", event.camera_frame}});
    return;
  }
  track.slice(begin, event.end_ps / kPsPerNs, slice_name(event),
              {{"frame", event.frame},
               {"camera frame", event.camera_frame},
               {"words", given(event.words)},
               {"dropped pixels", given(event.dropped_pixels)}});
}

OverlappingTracks& PerfettoComputer::track_of(const TimelineEvent& event) {
  const std::string name = track_name(event);
  const std::size_t rank = 3 + static_cast<std::size_t>(event.kind);
  return events_.try_emplace(name, tree_, group_of(event.kind), rank, name).first->second;
}

}  // namespace stereotlm::trace

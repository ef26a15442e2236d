#include "platform/records/timeline_records.h"

#include "models/fpga/core_ports.h"
#include "platform/config/computer_parts.h"

namespace stereotlm::platform {

void TimelineSums::add(const TimelineEvent& event) {
  const std::string_view what = event.what;
  Sums& sums = sums_[{event.kind, what, event.why}];
  ++sums.events;
  sums.words += event.words;
  sums.dropped_pixels += event.dropped_pixels;
  if (event.kind == EventKind::kFrame && what != "strobe")
    cycles_ += clock_.edge_at_or_after(event.end_ps) - clock_.edge_at_or_after(event.begin_ps);
  const std::optional<Resource> resource = resource_of(event);
  if (!resource) return;
  if (resource == kCore) core_ps_ += event.end_ps - event.begin_ps;
  std::uint64_t& busy_until_ps = busy_until_ps_[*resource];
  if (event.begin_ps < busy_until_ps) ++overlaps_;
  busy_until_ps = event.end_ps;
}

std::optional<TimelineSums::Resource> TimelineSums::resource_of(const TimelineEvent& event) {
  switch (event.kind) {
    case EventKind::kCapture:
    case EventKind::kInterrupt:
      return Resource{event.kind, event.what};
    case EventKind::kUpload:
    case EventKind::kReadBack:
      return Resource{event.kind, ""};
    case EventKind::kFrame:
      return kCore;
    case EventKind::kWait:
      return event.what == kCore.second ? std::optional(kCore) : std::nullopt;
    case EventKind::kDrop:
      break;
  }
  return std::nullopt;
}

TimelineSums::Sums TimelineSums::sums_of(EventKind kind, std::string_view what, std::string_view why) const {
  const auto found = sums_.find({kind, what, why});
  return found == sums_.end() ? Sums{} : found->second;
}

void TimelineSums::check(const Statistics& statistics, Audit& audit) const {
  const ComputerStatistics& computer = *statistics.computer;
  for (std::size_t side = 0; side < kSideNames.size(); ++side) {
    const CameraStatistics& camera = computer.cameras[side];
    const std::string name = "recorded: camera " + camera.name + ": ";
    const Sums captures = sums_of(EventKind::kCapture, kSideNames[side]);
    audit.equal(name + "captures", captures.events, "captured_frames", camera.captured_frames);
    audit.equal(name + "dropped pixels", captures.dropped_pixels, "dropped_pixels", camera.dropped_pixels);
    audit.equal(name + "words", captures.words, "words of its PCI master",
                computer.pci_masters[side == 0 ? kLeftCapture : kRightCapture].words);
    const std::array<std::uint64_t, 3> dropped = {camera.dropped_not_armed, camera.dropped_busy,
                                                  camera.dropped_by_partner};
    for (std::size_t reason = 0; reason < dropped.size(); ++reason) {
      const std::string why = kDropReasons[reason];
      audit.equal(name + "dropped: " + why, sums_of(EventKind::kDrop, kSideNames[side], why).events,
                  "dropped_" + why, dropped[reason]);
    }
  }
  std::uint64_t dma_words = 0;
  for (const auto& [key, sums] : sums_) {
    const EventKind kind = std::get<EventKind>(key);
    if (kind == EventKind::kUpload || kind == EventKind::kReadBack) dma_words += sums.words;
  }
  audit.equal("recorded: words of transfers", dma_words, "dma_words", computer.dma_words);
  const Sums frames = sums_of(EventKind::kFrame, "cycles");
  audit.equal("recorded: frames of the core", frames.events, "frames", statistics.frames);
  audit.equal("recorded: words of results", frames.words, "grants of port result",
              statistics.ports[statistics.ports.size() - 2].grants);
  audit.equal(
      "recorded: cycles of frames", cycles_, "sum of frame_cycles",
      std::accumulate(statistics.frame_cycles.begin(), statistics.frame_cycles.end(), std::uint64_t{0}));
  audit.equal("recorded: interrupts of the core", sums_of(EventKind::kInterrupt, "core").events, "frames",
              statistics.frames);
  audit.equal("recorded: frames and waits of the core, ps", core_ps_, "end of its last frame",
              busy_until_ps_.count(kCore) == 0 ? 0 : busy_until_ps_.at(kCore));
  audit.equal("recorded: events of one resource that overlap", overlaps_, "allowed", 0);
}

}  // namespace stereotlm::platform

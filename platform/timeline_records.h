#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

namespace stereotlm::platform {

// What a Timeline records. Plain data. sw/report/README.md describes each kind and class.
enum class EventKind : std::uint8_t { kCapture, kDrop, kUpload, kReadBack, kFrame, kInterrupt, kWait };
inline constexpr std::array<const char*, 7> kEventKindNames = {"capture", "drop",      "upload", "read_back",
                                                               "frame",   "interrupt", "wait"};

struct TimelineEvent {
  EventKind kind = EventKind::kCapture;
  const char* what = "";                      // its class: the side, the buffer, or who waits
  std::optional<std::uint64_t> frame;         // number of the pair, and of its frame of the core
  std::optional<std::uint64_t> camera_frame;  // number of the camera frame of that pair
  std::uint64_t begin_ps = 0;
  std::uint64_t end_ps = 0;
  std::uint64_t words = 0;
  std::uint64_t dropped_pixels = 0;
  const char* why = "";  // of a drop or a wait
};

// The parts of the latency of a delivered frame, one after the other.
inline constexpr std::array<const char*, 8> kLatencyParts = {
    "capture", "wait_copy", "copy", "wait_core", "core", "wait_read_back", "read_back", "delivery"};

struct FrameLatency {
  std::uint64_t frame = 0;
  std::uint64_t camera_frame = 0;
  std::uint64_t begin_ps = 0;  // time of the first pixel
  std::array<std::uint64_t, kLatencyParts.size()> parts_ps{};

  std::uint64_t sum_ps() const { return std::accumulate(parts_ps.begin(), parts_ps.end(), std::uint64_t{0}); }
};

struct TimelineRecords {
  std::vector<TimelineEvent> events;  // by their ends
  std::vector<FrameLatency> latencies;
};

}  // namespace stereotlm::platform

#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "models/clock.h"
#include "platform/config/board_config.h"
#include "platform/figures/audit.h"
#include "platform/figures/statistics.h"

namespace stereotlm::platform {

// What a Timeline records. Plain data. sw/report/README.md describes each kind and class.
enum class EventKind : std::uint8_t { kCapture, kDrop, kUpload, kReadBack, kFrame, kInterrupt, kWait };
inline constexpr std::array<const char*, 7> kEventKindNames = {"capture", "drop",      "upload", "read_back",
                                                               "frame",   "interrupt", "wait"};

inline constexpr std::array<const char*, 2> kSideNames = {"left", "right"};
inline constexpr std::array<const char*, 3> kDropReasons = {"not_armed", "busy",
                                                            "partner"};  // [capture::DropReason]

// Every kind, its classes (TimelineEvent::what), and of a drop or a wait the reasons.
struct EventName {
  EventKind kind;
  const char* what;
  const char* why;
};
inline constexpr EventName kEventNames[] = {
    {EventKind::kCapture, "left", ""},          {EventKind::kCapture, "right", ""},
    {EventKind::kDrop, "left", "not_armed"},    {EventKind::kDrop, "left", "busy"},
    {EventKind::kDrop, "left", "partner"},      {EventKind::kDrop, "right", "not_armed"},
    {EventKind::kDrop, "right", "busy"},        {EventKind::kDrop, "right", "partner"},
    {EventKind::kUpload, "left_lut", ""},       {EventKind::kUpload, "right_lut", ""},
    {EventKind::kUpload, "left_image", ""},     {EventKind::kUpload, "right_image", ""},
    {EventKind::kReadBack, "disparity", ""},    {EventKind::kFrame, "strobe", ""},
    {EventKind::kFrame, "cycles", ""},          {EventKind::kFrame, "pipeline", ""},
    {EventKind::kInterrupt, "left", ""},        {EventKind::kInterrupt, "right", ""},
    {EventKind::kInterrupt, "core", ""},        {EventKind::kInterrupt, "upload", ""},
    {EventKind::kInterrupt, "read_back", ""},   {EventKind::kWait, "ring", "copy"},
    {EventKind::kWait, "ring", "input_buffer"}, {EventKind::kWait, "ring", "host"},
    {EventKind::kWait, "pair", "core"},         {EventKind::kWait, "pair", "output_buffer"},
    {EventKind::kWait, "pair", "host"},         {EventKind::kWait, "core", "upload"},
    {EventKind::kWait, "core", "camera"},       {EventKind::kWait, "core", "capture"},
    {EventKind::kWait, "core", "copy"},         {EventKind::kWait, "core", "output_buffer"},
    {EventKind::kWait, "core", "host"},         {EventKind::kWait, "result", "read_back"},
    {EventKind::kWait, "result", "host"},
};

// The activities that the program on the host starts. Number n of each is of pair n, and of its frame.
enum class Activity : std::uint8_t { kCapture, kCopy, kFrame, kReadBack };
inline constexpr std::size_t kActivities = 4;

// The end of an activity without which another one could not start.
struct Awaited {
  Activity activity;
  std::uint64_t number;
  const char* reason;  // why the other one waits for it, as in the time line
};

// Receives what the program on the host starts.
class DriverObserver {
 public:
  virtual ~DriverObserver() = default;
  // The program starts an activity with its next access. `awaited`: what it has waited for.
  virtual void starts(Activity activity, const std::vector<Awaited>& awaited) = 0;
};

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

// Sums of the events of a time line, for their identities with the figures of the run.
class TimelineSums {
 public:
  explicit TimelineSums(const BoardConfig& board) : clock_(board.fpga.clock_mhz) {}

  void add(const TimelineEvent& event);  // events by their ends
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

  static std::optional<Resource> resource_of(const TimelineEvent& event);  // none: it may overlap others
  Sums sums_of(EventKind kind, std::string_view what, std::string_view why = "") const;

  Clock clock_;
  std::map<std::tuple<EventKind, std::string_view, std::string_view>, Sums> sums_;
  std::map<Resource, std::uint64_t> busy_until_ps_;
  std::uint64_t overlaps_ = 0;
  std::uint64_t core_ps_ = 0;  // the core's frames and waits
  std::uint64_t cycles_ = 0;   // of the core's frames
};

}  // namespace stereotlm::platform

#include "platform/records/timeline.h"

#include <algorithm>

#include "models/pci/bridge_registers.h"
#include "platform/figures/audit.h"

namespace stereotlm::platform {
namespace {

namespace bridge_map = pci::bridge;

constexpr std::array<const char*, 5> kInterruptNames = {"left", "right", "core", "upload", "read_back"};
constexpr std::size_t kCoreInterrupt = 2;
constexpr std::size_t kDmaInterrupt = 3;  // of channel 0
constexpr unsigned kToBoard = 0;          // DMA channels of the driver
constexpr auto kCaptureIndex = static_cast<std::size_t>(Activity::kCapture);
constexpr auto kFrameIndex = static_cast<std::size_t>(Activity::kFrame);

// The activity of a DMA channel, but for the upload of the tables.
constexpr Activity activity_of(unsigned channel) {
  return channel == kToBoard ? Activity::kCopy : Activity::kReadBack;
}

// Everything that can differ between two events, ends first.
auto order_of(const TimelineEvent& event) {
  return std::tuple(event.end_ps, event.begin_ps, event.kind, std::string_view(event.what), event.frame,
                    event.camera_frame, std::string_view(event.why));
}

}  // namespace

Timeline::Timeline(const BoardConfig& board)
    : clock_(board.fpga.clock_mhz),
      sums_(board),
      kept_pairs_(std::max(board.allocation.left_image.size(), board.allocation.disparity.size())),
      buffers_(buffers(board)) {}

const char* Timeline::buffer_at(std::uint64_t local_address) const {
  for (const PlacedBuffer& placed : buffers_) {
    if (placed.range.contains(local_address)) return platform::name_of(placed.buffer);
  }
  return "";
}

// The two captures of a pair have the same number. The earlier call makes the pair.
void Timeline::CaptureSide::capture_begun(std::uint64_t frame, std::uint64_t begin_ps) {
  undecided_.reset();
  const std::uint64_t number = begun_++;
  if (number == timeline_.first_pair_ + timeline_.pairs_.size()) {
    Pair pair;
    pair.camera_frame = frame;
    pair.begins_ps[kCaptureIndex] = begin_ps;
    timeline_.pairs_.push_back(pair);
  }
}

TimelineEvent Timeline::event_of(EventKind kind, const char* what, std::optional<std::uint64_t> frame,
                                 std::uint64_t begin_ps) const {
  TimelineEvent event;
  event.kind = kind;
  event.what = what;
  event.frame = frame;
  if (frame) event.camera_frame = pair(*frame).camera_frame;
  event.begin_ps = begin_ps;
  return event;
}

void Timeline::CaptureSide::capture_ended(const capture::Capture& capture) {
  const std::uint64_t number = ended_++;
  TimelineEvent event = timeline_.event_of(EventKind::kCapture, kSideNames[side_], number, capture.begin_ps);
  event.end_ps = capture.end_ps;
  event.words = capture.words;
  event.dropped_pixels = capture.dropped_pixels;
  timeline_.ended_.push_back(event);
  words_ += capture.words;
  dropped_pixels_ += capture.dropped_pixels;
  std::uint64_t& captured_ps = timeline_.pair(number).ends_ps[kCaptureIndex];
  captured_ps = std::max(captured_ps, capture.end_ps);
  timeline_.begin_interrupt(side_, number, capture.end_ps);
}

TimelineEvent Timeline::CaptureSide::drop(std::uint64_t frame, std::uint64_t begin_ps,
                                          capture::DropReason reason) const {
  TimelineEvent event = timeline_.event_of(EventKind::kDrop, kSideNames[side_], std::nullopt, begin_ps);
  event.camera_frame = frame;
  event.end_ps = begin_ps;
  event.why = kDropReasons[static_cast<std::size_t>(reason)];
  return event;
}

void Timeline::CaptureSide::frame_begun(std::uint64_t frame, std::uint64_t begin_ps) {
  undecided_ = {frame, begin_ps};
}

void Timeline::CaptureSide::frame_dropped(std::uint64_t frame, std::uint64_t begin_ps,
                                          capture::DropReason reason) {
  undecided_.reset();
  timeline_.ended_.push_back(drop(frame, begin_ps, reason));
}

void Timeline::CaptureSide::end_now(const capture::CaptureControl::Stats& stats, std::uint64_t now_ps,
                                    std::vector<TimelineEvent>& events) const {
  if (undecided_)
    events.push_back(drop(undecided_->first, undecided_->second, capture::DropReason::kNotArmed));
  if (begun_ == ended_) return;
  TimelineEvent event = timeline_.event_of(EventKind::kCapture, kSideNames[side_], ended_,
                                           timeline_.pair(ended_).begin_ps(Activity::kCapture));
  event.end_ps = now_ps;
  event.words = stats.words - words_;
  event.dropped_pixels = stats.dropped_pixels - dropped_pixels_;
  events.push_back(event);
}

void Timeline::begin_interrupt(std::size_t interrupt, std::optional<std::uint64_t> frame,
                               std::uint64_t now_ps) {
  if (!interrupts_[interrupt])
    interrupts_[interrupt] = event_of(EventKind::kInterrupt, kInterruptNames[interrupt], frame, now_ps);
}

void Timeline::end_interrupt(std::size_t interrupt, std::uint64_t now_ps) {
  if (!interrupts_[interrupt]) return;
  interrupts_[interrupt]->end_ps = now_ps;
  ended_.push_back(*interrupts_[interrupt]);
  interrupts_[interrupt].reset();
}

void Timeline::interrupts_raised(std::uint64_t now_ps, std::uint32_t interrupts) {
  if ((interrupts & bridge_map::kDoorbell) != 0) begin_interrupt(kCoreInterrupt, frames_ended_ - 1, now_ps);
  for (unsigned channel = 0; channel < transfers_.size(); ++channel) {
    if ((interrupts & bridge_map::kDmaDone << channel) != 0) dma_done(channel, now_ps);
  }
}

void Timeline::interrupts_cleared(std::uint64_t now_ps, std::uint32_t interrupts) {
  if ((interrupts & bridge_map::kDoorbell) != 0) end_interrupt(kCoreInterrupt, now_ps);
  for (unsigned channel = 0; channel < transfers_.size(); ++channel) {
    if ((interrupts & bridge_map::kDmaDone << channel) != 0) end_interrupt(kDmaInterrupt + channel, now_ps);
  }
}

void Timeline::starts(Activity activity, const std::vector<Awaited>& awaited) {
  awaited_[static_cast<std::size_t>(activity)] = awaited;
}

Timeline::Reasons Timeline::reasons_of(Activity activity) const {
  Reasons reasons;
  for (const Awaited& awaited : awaited_[static_cast<std::size_t>(activity)])
    reasons.push_back({awaited.reason, pair(awaited.number).end_ps(awaited.activity)});
  return reasons;
}

std::uint64_t Timeline::begin(Activity activity, std::uint64_t now_ps) {
  const auto index = static_cast<std::size_t>(activity);
  const std::uint64_t number = begun_[index]++;
  pair(number).begins_ps[index] = now_ps;
  return number;
}

// The first DMA to the board uploads the tables, if the driver has started no copy.
void Timeline::dma_started(unsigned channel, std::uint64_t now_ps) {
  const Activity activity = activity_of(channel);
  if (awaited_[static_cast<std::size_t>(activity)].empty()) return;
  const std::uint64_t number = begin(activity, now_ps);
  const bool is_copy = activity == Activity::kCopy;
  wait(is_copy ? "ring" : "result", number,
       pair(number).end_ps(is_copy ? Activity::kCapture : Activity::kFrame), now_ps, reasons_of(activity));
  if (is_copy) fetch(Buffer::kLeftImage, now_ps);
}

// The DMA begins to fetch the descriptor of a picture of the pair that is copied.
void Timeline::fetch(Buffer picture, std::uint64_t now_ps) {
  transfers_[kToBoard] =
      event_of(EventKind::kUpload, platform::name_of(picture), begun(Activity::kCopy) - 1, now_ps);
}

void Timeline::dma_done(unsigned channel, std::uint64_t now_ps) {
  const Activity activity = activity_of(channel);
  std::optional<std::uint64_t> number;
  if (begun(activity) != 0) {
    number = begun(activity) - 1;
    pair(*number).ends_ps[static_cast<std::size_t>(activity)] = now_ps;
  } else {
    upload_end_ps_ = now_ps;
  }
  begin_interrupt(kDmaInterrupt + channel, number, now_ps);
}

void Timeline::transfer_begun(unsigned channel, std::uint64_t begin_ps, const pci::DmaDescriptor& moved) {
  const std::uint64_t number = begun(activity_of(channel));
  TimelineEvent event =
      event_of(moved.to_pci ? EventKind::kReadBack : EventKind::kUpload, buffer_at(moved.local_address),
               number != 0 ? std::optional(number - 1) : std::nullopt, begin_ps);
  event.words = moved.words;
  transfers_[channel] = event;
}

void Timeline::transfer_ended(unsigned channel, std::uint64_t now_ps) {
  TimelineEvent event = *std::exchange(transfers_[channel], std::nullopt);
  event.end_ps = now_ps;
  dma_words_ += event.words;
  ended_.push_back(event);
  if (event.what == std::string_view(platform::name_of(Buffer::kLeftImage)))
    fetch(Buffer::kRightImage, now_ps);
}

void Timeline::frame_begun(std::uint64_t strobe_ps) {
  const std::uint64_t number = begin(Activity::kFrame, strobe_ps);
  const Pair& times = pair(number);
  const std::uint64_t ready_ps = times.end_ps(times.last_to_buffers());
  const Reasons reasons = reasons_of(Activity::kFrame);
  wait("pair", number, ready_ps, strobe_ps, reasons);
  Reasons of_core = {{"upload", number == 0 ? upload_end_ps_ : 0},
                     {"camera", times.begin_ps(Activity::kCapture)},
                     {"capture", times.end_ps(Activity::kCapture)},
                     {"copy", ready_ps}};
  of_core.insert(of_core.end(), reasons.begin(), reasons.end());
  wait("core", number, number == 0 ? 0 : pair(number - 1).end_ps(Activity::kFrame), strobe_ps, of_core);
}

void Timeline::frame_ended(const fpga::FrameTimes& times) {
  const std::uint64_t number = frames_ended_++;
  TimelineEvent event = event_of(EventKind::kFrame, "", number, times.strobe_ps);
  const auto add = [this, &event](const char* what, std::uint64_t end_cycle, std::uint64_t words) {
    event.what = what;
    event.end_ps = clock_.edge_ps(end_cycle);
    event.words = words;
    ended_.push_back(event);
    event.begin_ps = event.end_ps;
  };
  add("strobe", times.first_cycle, 0);
  add("cycles", times.end_cycle, times.words);
  add("pipeline", times.done_cycle, 0);
  pair(number).ends_ps[kFrameIndex] = event.end_ps;
}

// Adds a wait as one event for each reason, one after the other: each ends at the time of its reason. The
// rest has the reason `host`: nothing is busy, the driver's accesses take the time.
void Timeline::wait(const char* who, std::uint64_t frame, std::uint64_t from_ps, std::uint64_t to_ps,
                    const Reasons& reasons) {
  TimelineEvent event = event_of(EventKind::kWait, who, frame, from_ps);
  const auto add = [this, &event, to_ps](const Reason& reason) {
    event.end_ps = std::min(reason.until_ps, to_ps);
    event.why = reason.why;
    if (event.end_ps <= event.begin_ps) return;
    ended_.push_back(event);
    event.begin_ps = event.end_ps;
  };
  for (const Reason& reason : reasons) add(reason);
  add({"host", to_ps});
}

void Timeline::deliver(const Delivery& delivery) {
  const std::uint64_t number = delivered_++;
  const Pair& times = pair(number);
  // The parts are the activities, and the waits between them.
  static_assert(kLatencyParts.size() == 2 * kActivities);
  std::array<std::uint64_t, kLatencyParts.size() + 1> moments{};
  for (std::size_t activity = 0; activity < kActivities; ++activity) {
    moments[2 * activity] = times.begins_ps[activity];
    moments[2 * activity + 1] = times.ends_ps[activity];
  }
  if (times.last_to_buffers() != Activity::kCopy) moments[2] = moments[3] = moments[1];
  moments.back() = delivery.host_ps;
  FrameLatency latency = {number, times.camera_frame, moments.front(), {}};
  for (std::size_t part = 0; part < kLatencyParts.size(); ++part)
    latency.parts_ps[part] = moments[part + 1] - moments[part];
  latencies_.push_back(latency);
  if (!std::is_sorted(moments.begin(), moments.end())) ++disordered_;
  latencies_ps_ += delivery.host_ps - delivery.capture_ps;
  delivered_ps_ = delivery.host_ps;
  complete_until_ps_ = moments.front();
  for (; first_pair_ + kept_pairs_ < delivered_; ++first_pair_) pairs_.pop_front();
}

// What begins at this very time is left out: it takes no time, and may come before or after the delivery.
void Timeline::mark_end(const ComputerCounters& counters) {
  last_ = ended_;
  for (std::size_t side = 0; side < boards_.size(); ++side)
    boards_[side].end_now(counters.cameras[side].capture, delivered_ps_, last_);
  std::uint64_t dma_words = counters.bridge.dma_words - dma_words_;
  const auto end_now = [this](TimelineEvent event) {
    event.end_ps = delivered_ps_;
    if (event.begin_ps < event.end_ps) last_.push_back(event);
  };
  for (const std::optional<TimelineEvent>& transfer : transfers_) {
    if (!transfer) continue;
    TimelineEvent event = *transfer;
    event.words = std::exchange(dma_words, 0);
    end_now(event);
  }
  for (const std::optional<TimelineEvent>& interrupt : interrupts_) {
    if (interrupt) end_now(*interrupt);
  }
}

TimelineRecords Timeline::take() {
  handed_out_until_ps_ = complete_until_ps_;
  const auto later = std::partition(ended_.begin(), ended_.end(), [this](const TimelineEvent& event) {
    return event.end_ps < handed_out_until_ps_;
  });
  std::vector<TimelineEvent> events(ended_.begin(), later);
  ended_.erase(ended_.begin(), later);
  return hand_out(std::move(events));
}

TimelineRecords Timeline::finish() {
  const auto is_handed_out = [this](const TimelineEvent& event) {
    return event.end_ps < handed_out_until_ps_;
  };
  last_.erase(std::remove_if(last_.begin(), last_.end(), is_handed_out), last_.end());
  return hand_out(std::exchange(last_, {}));
}

TimelineRecords Timeline::hand_out(std::vector<TimelineEvent> events) {
  std::sort(events.begin(), events.end(),
            [](const TimelineEvent& a, const TimelineEvent& b) { return order_of(a) < order_of(b); });
  for (const TimelineEvent& event : events) sums_.add(event);
  for (const FrameLatency& latency : latencies_) {
    ++latency_count_;
    parts_ps_ += latency.sum_ps();
  }
  return {std::move(events), std::exchange(latencies_, {})};
}

std::vector<std::string> Timeline::failed(const Statistics& statistics) const {
  Audit audit;
  sums_.check(statistics, audit);
  audit.equal("recorded: latencies", latency_count_, "frames", statistics.frames);
  audit.equal("recorded: parts of the latencies, ps", parts_ps_, "time from capture to host", latencies_ps_);
  audit.equal("recorded: frames with times out of order", disordered_, "allowed", 0);
  return audit.failed();
}

}  // namespace stereotlm::platform

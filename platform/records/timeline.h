#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/capture/capture_observer.h"
#include "models/clock.h"
#include "models/fpga/frame_run.h"
#include "models/pci/dma_channel.h"
#include "platform/config/board_config.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/collect.h"
#include "platform/records/timeline_records.h"

namespace stereotlm::platform {

// Records what happens in a computer: captures and dropped frames, DMA transfers, frames of the core,
// interrupts, and who waits for whom. The blocks report what they do, the same at every fidelity. The driver
// reports what each of its starts has waited for. Plain C++.
//
// Events are handed out in the order of their ends. The time line keeps only the events since the capture of
// the last frame that was delivered.
class Timeline : public pci::BridgeObserver, public fpga::FrameObserver, public DriverObserver {
 public:
  explicit Timeline(const BoardConfig& board);  // it has no events at first
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  // What the driver and the blocks do.
  void starts(Activity activity, const std::vector<Awaited>& awaited) override;
  void dma_started(unsigned channel, std::uint64_t now_ps) override;
  void transfer_begun(unsigned channel, std::uint64_t begin_ps, const pci::DmaDescriptor& moved) override;
  void transfer_ended(unsigned channel, std::uint64_t now_ps) override;
  void interrupts_raised(std::uint64_t now_ps, std::uint32_t interrupts) override;
  void interrupts_cleared(std::uint64_t now_ps, std::uint32_t interrupts) override;
  void frame_begun(std::uint64_t strobe_ps) override;
  void frame_ended(const fpga::FrameTimes& times) override;
  // The observer of a capture board. `side`: 0 left, 1 right.
  capture::CaptureObserver& capture_board(std::size_t side) { return boards_[side]; }

  // The next frame is delivered, now.
  void deliver(const Delivery& delivery);
  // To be called if the run may end with the last delivery, which is now. `counters` are of this time. Events
  // that are under way end now, for finish().
  void mark_end(const ComputerCounters& counters);

  // The records that are complete, each once. To be called regularly.
  TimelineRecords take();
  // All other records, up to the last mark_end(). To be called once.
  TimelineRecords finish();

  // The identities between all that was handed out and the figures of the run that do not hold. To be called
  // after finish().
  std::vector<std::string> failed(const Statistics& statistics) const;

 private:
  static constexpr std::size_t kInterrupts = 5;  // left, right, core, upload, read_back

  // The times of a pair and of its frame, as far as they are known.
  struct Pair {
    std::uint64_t camera_frame = 0;
    std::array<std::uint64_t, kActivities> begins_ps{};  // [Activity]; 0: not begun
    std::array<std::uint64_t, kActivities> ends_ps{};    // [Activity]; of a capture: of its later side

    std::uint64_t begin_ps(Activity activity) const { return begins_ps[static_cast<std::size_t>(activity)]; }
    std::uint64_t end_ps(Activity activity) const { return ends_ps[static_cast<std::size_t>(activity)]; }
    // The activity with whose end the pictures are in their input buffers.
    Activity last_to_buffers() const {
      return begin_ps(Activity::kCopy) != 0 ? Activity::kCopy : Activity::kCapture;
    }
  };
  // What holds a start back, and until when.
  struct Reason {
    const char* why;
    std::uint64_t until_ps;
  };
  using Reasons = std::vector<Reason>;

  class CaptureSide : public capture::CaptureObserver {
   public:
    CaptureSide(Timeline& timeline, std::size_t side) : timeline_(timeline), side_(side) {}
    void frame_begun(std::uint64_t frame, std::uint64_t begin_ps) override;
    void frame_dropped(std::uint64_t frame, std::uint64_t begin_ps, capture::DropReason reason) override;
    void capture_begun(std::uint64_t frame, std::uint64_t begin_ps) override;
    void capture_ended(const capture::Capture& capture) override;
    void interrupt_cleared(std::uint64_t now_ps) override { timeline_.end_interrupt(side_, now_ps); }
    // Adds what is under way.
    void end_now(const capture::CaptureControl::Stats& stats, std::uint64_t now_ps,
                 std::vector<TimelineEvent>& events) const;

   private:
    TimelineEvent drop(std::uint64_t frame, std::uint64_t begin_ps, capture::DropReason reason) const;

    Timeline& timeline_;
    std::size_t side_;
    std::optional<std::pair<std::uint64_t, std::uint64_t>> undecided_;  // camera frame, its beginning
    std::uint64_t begun_ = 0;
    std::uint64_t ended_ = 0;
    std::uint64_t words_ = 0;  // of the captures that have ended
    std::uint64_t dropped_pixels_ = 0;
  };

  // An event of a pair, if there is a pair.
  TimelineEvent event_of(EventKind kind, const char* what, std::optional<std::uint64_t> frame,
                         std::uint64_t begin_ps) const;
  void begin_interrupt(std::size_t interrupt, std::optional<std::uint64_t> frame, std::uint64_t now_ps);
  void end_interrupt(std::size_t interrupt, std::uint64_t now_ps);
  void fetch(Buffer picture, std::uint64_t now_ps);
  void dma_done(unsigned channel, std::uint64_t now_ps);
  // Begins the next activity of this kind, of the core or of the DMA. Returns its number.
  std::uint64_t begin(Activity activity, std::uint64_t now_ps);
  std::uint64_t begun(Activity activity) const { return begun_[static_cast<std::size_t>(activity)]; }
  void wait(const char* who, std::uint64_t frame, std::uint64_t from_ps, std::uint64_t to_ps,
            const Reasons& reasons);

  Pair& pair(std::uint64_t number) { return pairs_[static_cast<std::size_t>(number - first_pair_)]; }
  const Pair& pair(std::uint64_t number) const {
    return pairs_[static_cast<std::size_t>(number - first_pair_)];
  }
  // What the last start of an activity has waited for, and until when.
  Reasons reasons_of(Activity activity) const;
  const char* buffer_at(std::uint64_t local_address) const;
  TimelineRecords hand_out(std::vector<TimelineEvent> events);

  Clock clock_;
  TimelineSums sums_;       // of what has been handed out
  std::size_t kept_pairs_;  // delivered pairs for whose buffers a start may still have waited
  std::vector<PlacedBuffer> buffers_;
  std::array<CaptureSide, 2> boards_{CaptureSide(*this, 0), CaptureSide(*this, 1)};

  // The pairs under way, and earlier ones whose times are still needed.
  std::deque<Pair> pairs_;
  std::uint64_t first_pair_ = 0;
  std::array<std::vector<Awaited>, kActivities> awaited_;  // [Activity]: of its last start
  std::array<std::uint64_t, kActivities> begun_{};         // [Activity], but for captures
  std::uint64_t frames_ended_ = 0;
  std::uint64_t delivered_ = 0;
  std::uint64_t upload_end_ps_ = 0;
  std::uint64_t delivered_ps_ = 0;
  std::uint64_t latencies_ps_ = 0;  // those of the deliveries, summed
  std::uint64_t disordered_ = 0;    // frames whose times are not in order

  std::array<std::optional<TimelineEvent>, 2> transfers_;             // [channel]: under way
  std::uint64_t dma_words_ = 0;                                       // of the transfers that have ended
  std::array<std::optional<TimelineEvent>, kInterrupts> interrupts_;  // asserted

  std::vector<TimelineEvent> ended_;  // not handed out yet
  std::vector<TimelineEvent> last_;   // the events up to the last mark_end(), some of which are handed out
  // All events that end before this time are recorded. It is the beginning of the last delivered pair: what
  // is recorded later ends after it.
  std::uint64_t complete_until_ps_ = 0;
  std::uint64_t handed_out_until_ps_ = 0;  // all events that ended before are handed out
  std::vector<FrameLatency> latencies_;
  // Of the latencies that were handed out.
  std::uint64_t parts_ps_ = 0;
  std::uint64_t latency_count_ = 0;
};

}  // namespace stereotlm::platform

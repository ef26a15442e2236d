#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "models/capture/camera_link.h"
#include "models/capture/capture_config.h"
#include "models/capture/capture_fifo.h"
#include "models/capture/capture_observer.h"
#include "models/pci/pci_slot.h"
#include "models/time_ps.h"

namespace stereotlm::capture {

// The other board of a pair. Both boards take a camera frame, or neither does.
class CapturePartner {
 public:
  virtual ~CapturePartner() = default;
  // Whether this board can take this frame of its camera, which began at `begin_ps`. To be called after that
  // time. All calls for one frame return the same.
  virtual bool can_start(std::uint64_t frame, std::uint64_t begin_ps) = 0;
};

// The rules and the timing of a CaptureBoard: its registers, the decision whether it takes a frame, the words
// in its FIFO, its requests of the bus. Plain C++.
//
// Its steps are the decision, 1 ps after the beginning of each frame, and the end of a capture whose last
// pixels are dropped. Everything else happens in calls from its camera and from the bus.
class CaptureControl : public FrameReceiver,
                       public CapturePartner,
                       public pci::PciMasterIf,
                       public pci::PciTarget {
 public:
  // Each camera frame is counted as started, or as dropped for one reason. It is counted only 1 ps after it
  // begins.
  struct Stats {
    std::uint64_t started_frames = 0;      // frames that were taken
    std::uint64_t captured_frames = 0;     // captures that have ended
    std::uint64_t dropped_not_armed = 0;   // frames for which this board was not armed
    std::uint64_t dropped_busy = 0;        // frames that began while a capture was running
    std::uint64_t dropped_by_partner = 0;  // frames that the other board could not take
    std::uint64_t dropped_pixels = 0;      // pixels that found the FIFO full
    std::uint64_t bursts = 0;              // bursts granted
    std::uint64_t words = 0;               // words written
    std::uint64_t lost_words = 0;          // words of bursts that ended with an error
    std::uint64_t bus_errors = 0;          // bursts that ended with master abort or target error
    std::uint64_t refused_accesses = 0;    // refused register accesses

    // The sum of the three reasons.
    std::uint64_t dropped_frames() const { return dropped_not_armed + dropped_busy + dropped_by_partner; }
  };

  // Throws std::invalid_argument if the configuration has problems.
  explicit CaptureControl(const CaptureBoardConfig& config);

  // The neighbours outlive the board. Without a partner it decides alone. It may trigger any number of
  // cameras.
  void bind(pci::PciSlot& slot, FrameCamera& camera);
  void bind_partner(CapturePartner& partner) { partner_ = &partner; }
  void bind_triggered(FrameCamera& camera) { triggered_.push_back(&camera); }

  // `observer` outlives the board.
  void observe(CaptureObserver& observer) { observer_ = &observer; }
  void observe(FifoObserver& observer) { fifo_.observe(observer); }
  // The observer has received all words up to `now_ps` when this returns.
  void show_words(std::uint64_t now_ps) const {
    if (fifo_.now_ps() < now_ps) fifo_at(now_ps);
  }

  // The time at which step() is to be called next; kNever: a call may change it.
  std::uint64_t next_ps() const { return next_ps_; }
  // Whether step() decides about a frame, after all other effects of that time. Else it ends a capture.
  bool decides_next() const { return decision_ps_ <= finish_ps_; }
  void step(std::uint64_t now_ps);

  // An access to the registers. Refuses, and counts, one that is not one word of a register with this
  // direction. A write takes effect at `at_ps`, now or later.
  pci::PciAnswer access(std::uint64_t now_ps, const pci::PciAccess& access, std::uint64_t at_ps) override;
  // The level of the interrupt. Writes, steps and ends of bursts change it.
  bool interrupt() const { return done_ || words_lost_; }

  void begin_frame(const VideoFrame& frame) override;  // 1 ps later the board decides about it
  bool can_start(std::uint64_t frame, std::uint64_t begin_ps) override;
  // These throw std::logic_error for a grant that was not requested, or for a time before its request, and
  // for the end of a burst that does not run or cannot have this result.
  pci::PciBurst begin_burst(std::uint64_t address_clock_ps) override;
  void end_burst(const pci::BurstResult& result) override;

  bool capturing() const { return capturing_; }  // whether a capture is under way
  // Whether a frame has begun in this very ps, and is neither started nor dropped yet.
  bool undecided() const { return decision_ps_ != kNever; }
  // The last capture that has ended; none before the first one ends.
  const std::optional<Capture>& last_capture() const { return last_capture_; }
  // Counts up to `now_ps`.
  Stats stats(std::uint64_t now_ps) const;

 private:
  enum class Readiness : std::uint8_t { kNotEvaluated, kReady, kNotArmed, kBusy };
  enum class BusState : std::uint8_t { kIdle, kRequested, kBurst };

  // `address`: of a register that can be read, or written.
  std::uint32_t read_register(std::uint64_t address) const;
  void write_register(std::uint64_t time_ps, std::uint64_t address, std::uint32_t value);
  void arm(std::uint64_t time_ps);

  // These decide whether this board takes the frame that has begun.
  Readiness readiness();
  void decide(std::uint64_t now_ps);
  void start(std::uint64_t now_ps);
  void drop(DropReason reason, std::uint64_t& count);

  // These run the capture of a frame that was taken.
  void proceed(std::uint64_t now_ps);
  void finish(std::uint64_t now_ps);
  bool fits(const pci::BurstResult& result) const;
  CaptureFifo fifo_at(std::uint64_t now_ps) const;

  // The registers (capture_registers.h).
  std::uint32_t buffer_address_ = 0;
  bool armed_ = false;
  std::uint64_t armed_ps_ = 0;
  std::uint32_t armed_address_ = 0;
  bool capturing_ = false;
  bool done_ = false;
  bool words_lost_ = false;
  bool arm_refused_ = false;
  std::optional<Capture> last_capture_;

  CaptureFifo fifo_;
  pci::PciSlot* slot_ = nullptr;
  FrameCamera* camera_ = nullptr;
  CapturePartner* partner_ = nullptr;
  std::vector<FrameCamera*> triggered_;
  CaptureObserver* observer_ = nullptr;

  VideoFrame frame_;                                // the last frame that has begun; without timing: none
  Readiness readiness_ = Readiness::kNotEvaluated;  // for that frame
  std::uint64_t decision_ps_ = kNever;
  std::uint64_t finish_ps_ = kNever;
  std::uint64_t next_ps_ = kNever;  // the earlier of the two

  // The running capture. Until it ends, dropped_pixels and words are the sums over all earlier captures.
  Capture capture_;
  std::uint64_t address_ = 0;  // bus address of its buffer

  BusState bus_state_ = BusState::kIdle;
  std::uint64_t requested_ps_ = 0;  // the bus may be granted from this time on
  std::vector<std::uint32_t> burst_words_;
  Stats stats_;
};

}  // namespace stereotlm::capture

#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <optional>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/capture/camera_beats.h"
#include "models/capture/capture_fifo.h"
#include "models/capture/capture_register_file.h"
#include "models/capture/capture_registers.h"
#include "models/interrupt.h"
#include "models/pci/pci_slot_if.h"
#include "models/stream.h"

namespace stereotlm::capture {

// The other board of a pair. Both boards take a camera frame, or neither does.
class CapturePartnerIf : public virtual sc_core::sc_interface {
 public:
  // Whether this board can take this frame of its camera, which began at `begin_ps`. To be called after that
  // time. All calls for one frame return the same.
  virtual bool can_start(std::uint64_t frame, std::uint64_t begin_ps) = 0;
};

// A PXC200 (Bt848 family; contract section 3, "Capture board"). It takes a camera's frames into its FIFO and
// writes them by bus mastering. Its registers are described in capture_registers.h. Register accesses take no
// time; there is no DMI. Arming and triggering take effect at the annotated time of their access. Debug
// transport only reads.
//
// The board decides 1 ps after the beginning of a frame whether it takes the frame. By then all events at the
// time of the beginning have been processed, in whatever order. A word leaves the FIFO at the end of its data
// clock. The board requests the bus in advance, for the time at which the FIFO will need it. A burst, pixel
// or word therefore costs no event beside those of the bus.
//
// SC_REPORT_ERROR (type /stereotlm/capture_board) reports: a line that no capture expects; a grant that the
// board has not requested, or for a time before its request; the end of a burst that does not run; a result
// that the burst cannot have.
class CaptureBoard : public sc_core::sc_module, private pci::PciMasterIf, private CapturePartnerIf {
 public:
  // Each camera frame is counted as started, or as dropped for one reason. It is counted only 1 ps after it
  // begins.
  struct Stats {
    std::uint64_t started_frames = 0;
    std::uint64_t captured_frames = 0;     // captures that have ended
    std::uint64_t dropped_not_armed = 0;   // frames for which this board was not armed
    std::uint64_t dropped_busy = 0;        // frames that began while a capture was running
    std::uint64_t dropped_by_partner = 0;  // frames that the other board could not take
    std::uint64_t dropped_pixels = 0;
    std::uint64_t bursts = 0;            // bursts granted
    std::uint64_t words = 0;             // words written
    std::uint64_t lost_words = 0;        // words of bursts that ended with an error
    std::uint64_t bus_errors = 0;        // bursts that ended with master abort or target error
    std::uint64_t refused_accesses = 0;  // refused register accesses

    std::uint64_t dropped_frames() const { return dropped_not_armed + dropped_busy + dropped_by_partner; }
  };

  tlm_utils::simple_target_socket<CaptureBoard> registers{"registers"};
  pci::PciMasterPort pci{"pci"};
  InterruptOut interrupt{"interrupt"};
  StreamOut<TakeFrame> takes_out{"takes_out"};
  // Binds to any number of cameras, or none.
  sc_core::sc_port<StreamIf<Trigger>, 0, sc_core::SC_ZERO_OR_MORE_BOUND> triggers_out{"triggers_out"};
  // The two boards of a pair are bound to each other: `left.partner.bind(right.as_partner)` and vice versa.
  // An unbound board decides alone whether it takes a frame.
  sc_core::sc_port<CapturePartnerIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND> partner{"partner"};
  sc_core::sc_export<CapturePartnerIf> as_partner{"as_partner"};

 private:
  void take_frame(const VideoFrame& frame);
  void take_line(const VideoLine& line);

 public:
  StreamIn<VideoFrame, CaptureBoard, &CaptureBoard::take_frame> frames_in{"frames_in", this};
  StreamIn<VideoLine, CaptureBoard, &CaptureBoard::take_line> lines_in{"lines_in", this};

  // Throws std::invalid_argument if the configuration has problems.
  CaptureBoard(const sc_core::sc_module_name& name, const CaptureBoardConfig& config);

  // Counts up to the current time.
  Stats stats() const;
  // Whether a frame has begun in this very ps, and is neither started nor dropped yet.
  bool undecided() const { return undecided_; }
  // The last capture that has ended; none before the first one ends.
  const std::optional<Capture>& last_capture() const { return register_file_.last_capture(); }

 private:
  enum class Readiness : std::uint8_t { kReady, kNotArmed, kBusy };
  enum class BusState : std::uint8_t { kIdle, kRequested, kBurst };

  void access_registers(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  unsigned debug_registers(tlm::tlm_generic_payload& access) { return register_file_.debug(access); }

  // These decide at the beginning of a frame whether this board takes it.
  bool can_start(std::uint64_t frame, std::uint64_t begin_ps) override;
  Readiness readiness();
  void decide();
  void start();

  // These run the capture of a frame that was taken.
  void proceed();
  void finish(std::uint64_t now_ps);
  pci::PciBurst begin_burst(std::uint64_t address_clock_ps) override;
  void end_burst(const pci::BurstResult& result) override;
  bool fits(const pci::BurstResult& result) const;
  void leave(CaptureFifo& fifo, const pci::BurstResult& transferred) const;

  CaptureRegisterFile register_file_;
  CaptureFifo fifo_;
  sc_core::sc_event decision_{"decision"};
  sc_core::sc_event finish_due_{"finish_due"};

  std::optional<VideoFrame> frame_;     // the last frame that has begun
  std::optional<Readiness> readiness_;  // for that frame, once it has been evaluated
  bool undecided_ = false;

  Capture
      capture_;  // the running capture; until it ends, dropped_pixels is the sum over all earlier captures
  std::uint32_t address_ = 0;               // bus address of its buffer
  std::vector<const std::uint8_t*> lines_;  // [row]: pixels of its lines that have begun

  BusState bus_state_ = BusState::kIdle;
  std::uint64_t requested_ps_ = 0;  // the bus may be granted from this time on
  std::vector<LineWords> burst_;
  std::vector<std::uint32_t> burst_words_;
  Stats stats_;
};

}  // namespace stereotlm::capture

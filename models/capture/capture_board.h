#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <optional>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/capture/camera_beats.h"
#include "models/capture/capture_fifo.h"
#include "models/capture/capture_registers.h"
#include "models/interrupt.h"
#include "models/pci/pci_slot.h"
#include "models/stream.h"

namespace stereotlm::capture {

// The other board of a pair: both take a camera frame, or neither.
class CapturePartnerIf : public virtual sc_core::sc_interface {
 public:
  // Whether this side can start with the frame; asked after the time at which it begins. The answer stays the
  // same.
  virtual bool can_start(std::uint64_t frame, std::uint64_t begin_ps) = 0;
};

// A PXC200 (Bt848 family; contract section 3, "Capture board"): takes a camera's frames into its FIFO and
// writes them by bus mastering. Registers: capture_registers.h. Register accesses take no time and no DMI;
// arming and triggering count at the time that their access is annotated with. Errors, without effect, are
// those of fpga/register_file.h. Debug transport reads.
//
// Whether a frame is taken is decided 1 ps after its beginning, when everything that happens at that
// beginning has happened, in whatever order. Words leave the FIFO at the end of their data clock. The bus is
// asked in advance, for the time at which the FIFO will ask: no event per burst, pixel or word beside those
// of the bus.
//
// SC_REPORT_ERROR (type /stereotlm/capture_board): a line that no capture expects; a grant without request or
// from before it; the end of a burst that there is not, or that does not fit it.
class CaptureBoard : public sc_core::sc_module,
                     private pci::PciMasterIf,
                     private CapturePartnerIf,
                     private InterruptIf {
 public:
  // A capture that is done.
  struct Capture {
    std::uint64_t frame = 0;  // of the camera
    std::uint64_t begin_ps = 0;
    std::uint64_t end_ps = 0;
    std::uint64_t dropped_pixels = 0;
    std::uint64_t lost_words = 0;
  };
  // Each frame is started with or dropped for one reason; frames that wait for their first ps are in neither
  // count.
  struct Stats {
    std::uint64_t started_frames = 0;
    std::uint64_t captured_frames = 0;     // done
    std::uint64_t dropped_not_armed = 0;   // this side was not armed
    std::uint64_t dropped_busy = 0;        // the last capture was running
    std::uint64_t dropped_by_partner = 0;  // the other side could not start
    std::uint64_t dropped_pixels = 0;
    std::uint64_t bursts = 0;  // granted
    std::uint64_t words = 0;   // written
    std::uint64_t lost_words = 0;
    std::uint64_t bus_errors = 0;        // bursts that ended with master abort or target error
    std::uint64_t refused_accesses = 0;  // of registers

    std::uint64_t dropped_frames() const { return dropped_not_armed + dropped_busy + dropped_by_partner; }
  };

  tlm_utils::simple_target_socket<CaptureBoard> registers{"registers"};
  pci::PciMasterPort pci{"pci"};
  InterruptOut interrupt{"interrupt"};
  StreamOut<TakeFrame> takes_out{"takes_out"};
  // To any number of cameras, or none.
  sc_core::sc_port<StreamIf<Trigger>, 0, sc_core::SC_ZERO_OR_MORE_BOUND> triggers_out{"triggers_out"};
  // `left.partner.bind(right.as_partner)`, and the other way round. A board without partner decides alone.
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

  // Up to now.
  Stats stats() const;
  // A frame has begun in this very ps: it counts as neither started nor dropped yet.
  bool undecided() const { return undecided_; }
  // None before the first is done.
  const std::optional<Capture>& last_capture() const { return last_capture_; }

 private:
  enum class Readiness : std::uint8_t { kReady, kNotArmed, kBusy };
  enum class BusState : std::uint8_t { kIdle, kRequested, kBurst };

  void transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  unsigned debug(tlm::tlm_generic_payload& access);
  static tlm::tlm_response_status check(const tlm::tlm_generic_payload& access);
  std::uint32_t read(std::uint64_t address) const;
  void write(std::uint64_t address, std::uint32_t value, const sc_core::sc_time& delay);
  void arm(std::uint64_t time_ps);

  bool can_start(std::uint64_t frame, std::uint64_t begin_ps) override;
  Readiness readiness();
  void decide();
  void start();
  void proceed();  // with the bus idle: asks for it from when it must, or finishes then
  void finish(std::uint64_t now_ps);

  pci::PciBurst begin_burst(std::uint64_t address_clock_ps) override;
  void end_burst(const pci::BurstResult& result) override;
  bool fits(const pci::BurstResult& result) const;
  void leave(CaptureFifo& fifo, const pci::BurstResult& transferred) const;
  bool is_asserted() const override { return done_ || words_lost_; }
  const sc_core::sc_event& changed_event() const override { return interrupt_changed_; }

  CaptureFifo fifo_;
  sc_core::sc_event decision_{"decision"};
  sc_core::sc_event finish_due_{"finish_due"};
  sc_core::sc_event interrupt_changed_{"interrupt_changed"};

  std::uint32_t buffer_address_ = 0;
  bool armed_ = false;
  std::uint64_t armed_ps_ = 0;
  std::uint32_t armed_address_ = 0;
  bool done_ = false;
  bool words_lost_ = false;
  bool arm_refused_ = false;

  std::optional<VideoFrame> frame_;     // that began last
  std::optional<Readiness> readiness_;  // for it, once it has been asked for
  bool undecided_ = false;
  bool capturing_ = false;
  Capture capture_;  // that runs; its dropped_pixels: of all before
  std::uint32_t address_ = 0;
  std::vector<const std::uint8_t*> lines_;  // of the capture, as far as they have begun
  std::optional<Capture> last_capture_;

  BusState bus_state_ = BusState::kIdle;
  std::uint64_t requested_ps_ = 0;
  std::vector<LineWords> burst_;
  std::vector<std::uint32_t> burst_words_;
  Stats stats_;
};

}  // namespace stereotlm::capture

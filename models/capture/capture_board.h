#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <optional>
#include <systemc>
#include <tlm>

#include "models/capture/camera.h"
#include "models/capture/capture_control.h"
#include "models/capture/capture_registers.h"
#include "models/interrupt.h"
#include "models/pci/pci_slot_if.h"
#include "models/refusals.h"
#include "models/step_event.h"
#include "models/stream.h"

namespace stereotlm::capture {

class CapturePartnerIf : public virtual sc_core::sc_interface, public CapturePartner {};

// A PXC200 (Bt848 family; contract section 3, "Capture board"). It takes a camera's frames into its FIFO and
// writes them by bus mastering. Its registers are described in capture_registers.h. Register accesses take no
// time; there is no DMI and no debug transport. fpga/register_file.h lists what is refused. Arming and
// triggering take effect at the annotated time of their access.
//
// The board decides 1 ps after the beginning of a frame whether it takes the frame. By then all events at the
// time of the beginning have been processed, in whatever order. A word leaves the FIFO at the end of its data
// clock. The board requests the bus in advance, for the time at which the FIFO will need it. A burst, pixel
// or word therefore costs no event beside those of the bus.
//
// SC_REPORT_ERROR (type /stereotlm/capture_board) reports: a grant that the board has not requested, or for a
// time before its request; the end of a burst that does not run; a result that the burst cannot have.
class CaptureBoard : public sc_core::sc_module, private CapturePartnerIf, private InterruptIf {
 public:
  using Stats = CaptureControl::Stats;  // counts since time 0

  tlm_utils::simple_target_socket<CaptureBoard> registers{"registers"};  // capture_registers.h
  // A slot of the bus, which the board masters.
  pci::PciMasterPort pci{"pci", [this] { follow(); },
                         [this](const std::exception& error) { report(error.what()); }};
  InterruptOut interrupt{"interrupt"};               // INTA#
  sc_core::sc_port<FrameCameraIf> camera{"camera"};  // whose frames come in at frames_in
  // The cameras that the board triggers: any number, or none.
  sc_core::sc_port<FrameCameraIf, 0, sc_core::SC_ZERO_OR_MORE_BOUND> triggered{"triggered"};
  // The two boards of a pair are bound to each other: `left.partner.bind(right.as_partner)` and vice versa.
  // An unbound board decides alone whether it takes a frame.
  sc_core::sc_port<CapturePartnerIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND> partner{"partner"};
  sc_core::sc_export<CapturePartnerIf> as_partner{"as_partner"};

 private:
  void take_frame(const VideoFrame& frame);

 public:
  StreamIn<VideoFrame, CaptureBoard, &CaptureBoard::take_frame> frames_in{"frames_in", this};  // of `camera`

  // Throws std::invalid_argument if the configuration has problems.
  CaptureBoard(const sc_core::sc_module_name& name, const CaptureBoardConfig& config);

  CaptureControl& control() { return control_; }  // the rules behind the sockets
  // Counts up to the current time.
  Stats stats() const;
  // The last capture that has ended; none before the first one ends.
  const std::optional<Capture>& last_capture() const { return control_.last_capture(); }

 private:
  void end_of_elaboration() override;
  void access_registers(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  void step();
  void report(const std::string& text) const;
  // To be called after each call of the control that may change its next step or the interrupt.
  void follow();

  // The partner board calls this.
  bool can_start(std::uint64_t frame, std::uint64_t begin_ps) override {
    return control_.can_start(frame, begin_ps);
  }
  // The receiver of the interrupt calls these.
  bool is_asserted() const override { return control_.interrupt(); }
  const sc_core::sc_event& changed_event() const override { return interrupt_changed_; }

  CaptureControl control_;
  Refusals refusals_{*this};
  StepEvent step_due_{"step_due"};
  sc_core::sc_event interrupt_changed_{"interrupt_changed"};
  bool interrupt_before_ = false;
};

}  // namespace stereotlm::capture

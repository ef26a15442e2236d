#include "models/capture/capture_board.h"

#include <string>

#include "models/kernel_time.h"

namespace stereotlm::capture {

CaptureBoard::CaptureBoard(const sc_core::sc_module_name& name, const CaptureBoardConfig& config)
    : sc_module(name), control_(config) {
  kernel_time::check_resolution(*this);
  SC_HAS_PROCESS(CaptureBoard);
  SC_METHOD(step);
  sensitive << step_due_;
  dont_initialize();
  registers.register_b_transport(this, &CaptureBoard::access_registers);
  as_partner.bind(*this);
  interrupt.bind(*this);
}

void CaptureBoard::end_of_elaboration() {
  control_.bind(pci, *camera.operator->());
  for (int number = 0; number < triggered.size(); ++number) control_.bind_triggered(*triggered[number]);
  if (partner.size() > 0) control_.bind_partner(*partner.operator->());
}

CaptureBoard::Stats CaptureBoard::stats() const { return control_.stats(kernel_time::now_ps()); }

void CaptureBoard::report(const std::string& text) const {
  SC_REPORT_ERROR("/stereotlm/capture_board", (std::string(name()) + ": " + text).c_str());
}

void CaptureBoard::follow() {
  step_due_.set(control_.next_ps());
  if (control_.interrupt() == interrupt_before_) return;
  interrupt_before_ = control_.interrupt();
  interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
}

void CaptureBoard::step() {
  step_due_.taken();
  control_.step(kernel_time::now_ps());
  follow();
}

void CaptureBoard::access_registers(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  pci::access_registers(control_, registers::kEnd, access, delay, refusals_);
  follow();
}

void CaptureBoard::take_frame(const VideoFrame& frame) {
  control_.begin_frame(frame);
  follow();
}

}  // namespace stereotlm::capture

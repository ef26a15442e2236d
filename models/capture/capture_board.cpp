#include "models/capture/capture_board.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "models/kernel_time.h"
#include "models/kernels/words.h"
#include "models/register_access.h"

namespace stereotlm::capture {
namespace {

tlm::tlm_response_status check(const tlm::tlm_generic_payload& access) {
  const tlm::tlm_response_status status = check_register_access(access, registers::kEnd);
  if (status != tlm::TLM_OK_RESPONSE) return status;
  return CaptureRegisterFile::allows(access.is_write(), access.get_address())
             ? tlm::TLM_OK_RESPONSE
             : tlm::TLM_COMMAND_ERROR_RESPONSE;
}

}  // namespace

CaptureBoard::CaptureBoard(const sc_core::sc_module_name& name, const CaptureBoardConfig& config)
    : sc_module(name), control_(config) {
  SC_HAS_PROCESS(CaptureBoard);
  SC_METHOD(step);
  sensitive << step_due_;
  dont_initialize();
  registers.register_b_transport(this, &CaptureBoard::access_registers);
  registers.register_transport_dbg(this, &CaptureBoard::debug_registers);
  as_partner.bind(*this);
  interrupt.bind(*this);
  control_.bind(*this, *this);
  control_.bind_triggered(*this);
}

void CaptureBoard::end_of_elaboration() {
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
  const tlm::tlm_response_status status = check(access);
  access.set_response_status(status);
  if (status != tlm::TLM_OK_RESPONSE) {
    control_.count_refused_access();
    return;
  }
  std::uint32_t value = 0;
  if (access.is_read()) {
    value = control_.read(access.get_address());
    std::memcpy(access.get_data_ptr(), &value, 4);
  } else {
    std::memcpy(&value, access.get_data_ptr(), 4);
    control_.write(kernel_time::now_ps() + kernel_time::to_ps(delay), access.get_address(), value);
    follow();
  }
}

unsigned CaptureBoard::debug_registers(tlm::tlm_generic_payload& access) {
  if (!access.is_read() || check(access) != tlm::TLM_OK_RESPONSE) return 0;
  const std::uint32_t value = control_.read(access.get_address());
  std::memcpy(access.get_data_ptr(), &value, 4);
  return 4;
}

void CaptureBoard::take_frame(const VideoFrame& frame) {
  begun_ = frame;
  control_.begin_frame(frame);
  follow();
}

void CaptureBoard::take_line(const VideoLine& line) {
  if (!control_.capturing() || line.row != static_cast<int>(lines_.size())) {
    report("line " + std::to_string(line.row) + " came: no capture expects it");
    return;
  }
  lines_.push_back(line.pixels);
  next_line_ps_ =
      line.row + 1 < frame_.timing->height() ? frame_.begin_ps + frame_.timing->row_ps(line.row + 1) : kNever;
  pass_request();
}

void CaptureBoard::take(std::uint64_t number) {
  frame_ = begun_;
  lines_.clear();
  next_line_ps_ = frame_.begin_ps;
  takes_out->push({number});
}

void CaptureBoard::copy_words(int first, int count, std::uint32_t* to) const {
  const int words_per_line = frame_.timing->width() / kernels::kPixelsPerWord;
  int row = first / words_per_line;
  int word = first % words_per_line;
  while (count > 0) {
    const int here = std::min(count, words_per_line - word);
    const std::uint8_t* const line = lines_[static_cast<std::size_t>(row++)];
    kernels::words_of_pixels(line + std::ptrdiff_t{word} * kernels::kPixelsPerWord, here, to);
    to += here;
    count -= here;
    word = 0;
  }
}

void CaptureBoard::trigger(std::uint64_t begin_ps) {
  const sc_core::sc_time delay = kernel_time::to_time(begin_ps - kernel_time::now_ps());
  for (int camera = 0; camera < triggers_out.size(); ++camera) triggers_out[camera]->push({delay});
}

void CaptureBoard::request(pci::PciMasterIf& /*control*/, std::uint64_t from_ps) {
  request_ps_ = from_ps;
  pass_request();
}

// The control requests the bus in advance. A request that needs a line waits until the line has begun, which
// it never does if the camera is in error.
void CaptureBoard::pass_request() {
  if (request_ps_ >= next_line_ps_) return;
  pci->request(*this, std::exchange(request_ps_, kNever));
}

pci::PciBurst CaptureBoard::begin_burst(std::uint64_t address_clock_ps) {
  try {
    return control_.begin_burst(address_clock_ps);
  } catch (const std::logic_error& error) {
    report(error.what());
    return {};
  }
}

void CaptureBoard::end_burst(const pci::BurstResult& result) {
  try {
    control_.end_burst(result);
  } catch (const std::logic_error& error) {
    report(error.what());
  }
  follow();
}

}  // namespace stereotlm::capture

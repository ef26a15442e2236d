#include "models/capture/capture_register_file.h"

#include <cstring>

#include "models/capture/capture_registers.h"
#include "models/kernel_time.h"
#include "models/register_access.h"

namespace stereotlm::capture {

tlm::tlm_response_status CaptureRegisterFile::check(const tlm::tlm_generic_payload& access) {
  const std::uint64_t address = access.get_address();
  const tlm::tlm_response_status status = check_register_access(access, registers::kEnd);
  if (status != tlm::TLM_OK_RESPONSE) return status;
  const bool write_only = address == registers::kControl;
  const bool read_only = address >= registers::kFrameNumberLow;
  if (access.is_read() ? write_only : read_only) return tlm::TLM_COMMAND_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

bool CaptureRegisterFile::access(tlm::tlm_generic_payload& access, const sc_core::sc_time& delay) {
  const tlm::tlm_response_status status = check(access);
  access.set_response_status(status);
  if (status != tlm::TLM_OK_RESPONSE) return false;
  std::uint32_t value = 0;
  if (access.is_read()) {
    value = read(access.get_address());
    std::memcpy(access.get_data_ptr(), &value, 4);
    return false;
  }
  std::memcpy(&value, access.get_data_ptr(), 4);
  switch (access.get_address()) {
    case registers::kBufferAddress:
      buffer_address_ = value;
      return false;
    case registers::kStatus:
      clear(value);
      return false;
    default:
      if ((value & registers::kControlArm) != 0) arm(kernel_time::now_ps() + kernel_time::to_ps(delay));
      return (value & registers::kControlTrigger) != 0;
  }
}

unsigned CaptureRegisterFile::debug(tlm::tlm_generic_payload& access) const {
  if (!access.is_read() || check(access) != tlm::TLM_OK_RESPONSE) return 0;
  const std::uint32_t value = read(access.get_address());
  std::memcpy(access.get_data_ptr(), &value, 4);
  return 4;
}

std::uint32_t CaptureRegisterFile::read(std::uint64_t address) const {
  const Capture last = last_capture_.value_or(Capture{});
  switch (address) {
    case registers::kStatus:
      return (armed_ ? registers::kStatusArmed : 0U) | (capturing_ ? registers::kStatusCapturing : 0U) |
             (done_ ? registers::kStatusDone : 0U) | (words_lost_ ? registers::kStatusWordsLost : 0U) |
             (arm_refused_ ? registers::kStatusArmRefused : 0U);
    case registers::kBufferAddress:
      return buffer_address_;
    case registers::kFrameNumberLow:
      return static_cast<std::uint32_t>(last.frame);
    case registers::kFrameNumberHigh:
      return static_cast<std::uint32_t>(last.frame >> 32U);
    case registers::kDroppedPixels:
      return static_cast<std::uint32_t>(last.dropped_pixels);
    default:
      return static_cast<std::uint32_t>(last.lost_words);
  }
}

void CaptureRegisterFile::arm(std::uint64_t time_ps) {
  if (armed_ || buffer_address_ % 4 != 0) {
    arm_refused_ = true;
    return;
  }
  armed_ = true;
  armed_ps_ = time_ps;
  armed_address_ = buffer_address_;
}

void CaptureRegisterFile::clear(std::uint32_t status_bits) {
  done_ = done_ && (status_bits & registers::kStatusDone) == 0;
  words_lost_ = words_lost_ && (status_bits & registers::kStatusWordsLost) == 0;
  arm_refused_ = arm_refused_ && (status_bits & registers::kStatusArmRefused) == 0;
  interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
}

std::uint32_t CaptureRegisterFile::start() {
  armed_ = false;
  capturing_ = true;
  return armed_address_;
}

void CaptureRegisterFile::lose_words() {
  words_lost_ = true;
  interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
}

void CaptureRegisterFile::finish(const Capture& capture) {
  capturing_ = false;
  done_ = true;
  last_capture_ = capture;
  interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
}

}  // namespace stereotlm::capture

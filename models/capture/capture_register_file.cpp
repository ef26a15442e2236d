#include "models/capture/capture_register_file.h"

#include "models/capture/capture_registers.h"

namespace stereotlm::capture {

bool CaptureRegisterFile::write(std::uint64_t time_ps, std::uint64_t address, std::uint32_t value) {
  switch (address) {
    case registers::kBufferAddress:
      buffer_address_ = value;
      return false;
    case registers::kStatus:
      clear(value);
      return false;
    default:
      if ((value & registers::kControlArm) != 0) arm(time_ps);
      return (value & registers::kControlTrigger) != 0;
  }
}

bool CaptureRegisterFile::allows(bool write, std::uint64_t address) {
  const bool write_only = address == registers::kControl;
  const bool read_only = address >= registers::kFrameNumberLow;
  return write ? !read_only : !write_only;
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
}

std::uint32_t CaptureRegisterFile::start() {
  armed_ = false;
  capturing_ = true;
  return armed_address_;
}

void CaptureRegisterFile::finish(const Capture& capture) {
  capturing_ = false;
  done_ = true;
  last_capture_ = capture;
}

}  // namespace stereotlm::capture

#include "models/fpga/core_registers.h"

#include <cstddef>

namespace stereotlm::fpga {
namespace {

std::size_t frame_index(std::uint64_t address) {
  return static_cast<std::size_t>((address - registers::kLeftImageBase) / 4);
}

}  // namespace

bool CoreRegisters::allows(bool write, std::uint64_t address) {
  const bool write_only = address == registers::kControl;
  const bool read_only = address > registers::kControl && address < registers::kLeftImageBase;
  return write ? !read_only : !write_only;
}

std::uint32_t CoreRegisters::read(std::uint64_t address) const {
  switch (address) {
    case registers::kStatus:
      return (busy_ ? registers::kStatusBusy : 0U) | (done_ ? registers::kStatusDone : 0U) |
             (error_ ? registers::kStatusError : 0U);
    case registers::kFrameCyclesLow:
      return static_cast<std::uint32_t>(frame_cycles_);
    case registers::kFrameCyclesHigh:
      return static_cast<std::uint32_t>(frame_cycles_ >> 32U);
    default:
      return frame_[frame_index(address)];
  }
}

void CoreRegisters::write(std::uint64_t time_ps, std::uint64_t address, std::uint32_t value) {
  if (address != registers::kControl) {
    frame_[frame_index(address)] = value;
    return;
  }
  if ((value & registers::kControlAcknowledge) != 0) {
    done_ = false;
    error_ = false;
  }
  if ((value & registers::kControlStart) == 0) return;
  if (busy_) {
    error_ = true;
    return;
  }
  busy_ = true;
  FrameStart start;
  start.time_ps = time_ps;
  for (std::size_t group = 0; group < kCoreGroupCount; ++group)
    start.bases[group] = frame_[frame_index(kPortGroups[group].base_register)];
  const auto offset = [this](std::uint64_t its) { return static_cast<int>(frame_[frame_index(its)]); };
  start.joint_offsets = {{{offset(registers::kLeftColumns), offset(registers::kLeftRows)},
                          {offset(registers::kRightColumns), offset(registers::kRightRows)}}};
  starter_.start_frame(start);
}

void CoreRegisters::refuse_start() {
  busy_ = false;
  error_ = true;
}

void CoreRegisters::finish_frame(std::uint64_t frame_cycles, bool error) {
  busy_ = false;
  done_ = true;
  error_ = error_ || error;
  frame_cycles_ = frame_cycles;
}

}  // namespace stereotlm::fpga

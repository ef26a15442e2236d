#include "models/fpga/register_file.h"

#include <cstring>

#include "models/register_access.h"

namespace stereotlm::fpga {
namespace {

std::size_t frame_index(std::uint64_t address) {
  return static_cast<std::size_t>((address - registers::kLeftImageBase) / 4);
}

}  // namespace

RegisterFile::RegisterFile(const sc_core::sc_module_name& name) : sc_module(name) {
  SC_HAS_PROCESS(RegisterFile);
  SC_METHOD(drive_done);
  sensitive << done_changed_;
  dont_initialize();
  for (auto* socket : {&registers, &local_bus}) {
    socket->register_b_transport(this, &RegisterFile::transport);
    socket->register_transport_dbg(this, &RegisterFile::debug);
  }
}

tlm::tlm_response_status RegisterFile::check(const tlm::tlm_generic_payload& access) const {
  const std::uint64_t address = access.get_address();
  const tlm::tlm_response_status status = check_register_access(access, registers::kEnd);
  if (status != tlm::TLM_OK_RESPONSE) return status;
  const bool write_only = address == registers::kControl;
  const bool read_only = address > registers::kControl && address < registers::kLeftImageBase;
  if (access.is_read() ? write_only : read_only) return tlm::TLM_COMMAND_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

void RegisterFile::transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  const tlm::tlm_response_status status = check(access);
  access.set_response_status(status);
  if (status != tlm::TLM_OK_RESPONSE) {
    ++stats_.errors;
    return;
  }
  std::uint32_t value = 0;
  if (access.is_read()) {
    ++stats_.reads;
    value = read(access.get_address());
    std::memcpy(access.get_data_ptr(), &value, 4);
  } else {
    ++stats_.writes;
    std::memcpy(&value, access.get_data_ptr(), 4);
    write(access.get_address(), value, delay);
  }
}

unsigned RegisterFile::debug(tlm::tlm_generic_payload& access) {
  if (!access.is_read() || check(access) != tlm::TLM_OK_RESPONSE) return 0;
  const std::uint32_t value = read(access.get_address());
  std::memcpy(access.get_data_ptr(), &value, 4);
  return 4;
}

std::uint32_t RegisterFile::read(std::uint64_t address) const {
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

void RegisterFile::write(std::uint64_t address, std::uint32_t value, const sc_core::sc_time& delay) {
  if (address != registers::kControl) {
    frame_[frame_index(address)] = value;
    return;
  }
  if ((value & registers::kControlAcknowledge) != 0) {
    done_ = false;
    error_ = false;
    done_changed_.notify(sc_core::SC_ZERO_TIME);
  }
  if ((value & registers::kControlStart) != 0) start(delay);
}

void RegisterFile::start(const sc_core::sc_time& delay) {
  if (busy_) {
    error_ = true;
    return;
  }
  busy_ = true;
  FrameStart start;
  start.delay = delay;
  for (std::size_t port = 0; port < kCorePortCount; ++port)
    start.bases[port] = frame_[frame_index(kPorts[port].base_register)];
  const auto offset = [this](std::uint64_t address) {
    return static_cast<int>(frame_[frame_index(address)]);
  };
  start.joint_offsets = {{{offset(registers::kLeftColumns), offset(registers::kLeftRows)},
                          {offset(registers::kRightColumns), offset(registers::kRightRows)}}};
  start_out->push(start);
}

void RegisterFile::refuse_start() {
  busy_ = false;
  error_ = true;
}

void RegisterFile::finish_frame(std::uint64_t frame_cycles, bool error) {
  busy_ = false;
  done_ = true;
  error_ = error_ || error;
  frame_cycles_ = frame_cycles;
  done_changed_.notify(sc_core::SC_ZERO_TIME);
}

// A process of its own: the line then has one driver, whichever process changes the register.
void RegisterFile::drive_done() { done.write(done_); }

}  // namespace stereotlm::fpga

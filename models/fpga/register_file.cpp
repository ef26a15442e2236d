#include "models/fpga/register_file.h"

#include <cstring>

#include "models/access_rules.h"
#include "models/kernel_time.h"

namespace stereotlm::fpga {

RegisterFile::RegisterFile(const sc_core::sc_module_name& name) : sc_module(name) {
  kernel_time::check_resolution(*this);
  SC_HAS_PROCESS(RegisterFile);
  SC_METHOD(drive_done);
  sensitive << done_changed_;
  dont_initialize();
  for (auto* socket : {&registers, &local_bus}) socket->register_b_transport(this, &RegisterFile::transport);
}

void RegisterFile::transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  tlm::tlm_response_status status = check_access(access, registers_below(registers::kEnd));
  if (status == tlm::TLM_OK_RESPONSE && !CoreRegisters::allows(access.is_write(), access.get_address()))
    status = tlm::TLM_COMMAND_ERROR_RESPONSE;
  if (!refusals_.respond(access, status, registers_below(registers::kEnd),
                         "the register does not have this direction")) {
    ++stats_.errors;
    return;
  }
  std::uint32_t value = 0;
  if (access.is_read()) {
    ++stats_.reads;
    value = control_.read(access.get_address());
    std::memcpy(access.get_data_ptr(), &value, 4);
  } else {
    ++stats_.writes;
    std::memcpy(&value, access.get_data_ptr(), 4);
    control_.write(kernel_time::now_ps() + kernel_time::to_ps(delay), access.get_address(), value);
    done_changed_.notify(sc_core::SC_ZERO_TIME);
  }
}

void RegisterFile::finish_frame(std::uint64_t frame_cycles, bool error) {
  control_.finish_frame(frame_cycles, error);
  done_changed_.notify(sc_core::SC_ZERO_TIME);
}

// A process of its own: the line then has one driver, whichever process changes the register.
void RegisterFile::drive_done() { done.write(control_.done()); }

}  // namespace stereotlm::fpga

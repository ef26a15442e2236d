#include "platform/loop/fast_computer.h"

#include <utility>

#include "models/kernel_time.h"
#include "platform/assembly/computer.h"
#include "platform/config/device_map.h"

namespace stereotlm::platform {

FastComputer::FastComputer(const sc_core::sc_module_name& name, const BoardConfig& config,
                           std::uint64_t host_memory_bytes, host::Program& program,
                           capture::CameraSource& left, capture::CameraSource& right, Binder& binder,
                           fpga::Fidelity fidelity)
    : sc_module(name),
      host_memory("host_memory", host_memory_bytes),
      host_bridge("host_bridge"),
      cpu("cpu", {1, DeviceMap().host_memory}, program),
      loop_(config, host_memory.data(), host_memory_bytes, left, right, fidelity) {
  kernel_time::check_resolution(*this);
  binder.bind(cpu.bus, host_bridge.cpu, "cpu_to_host_bridge");
  binder.bind(cpu.host_memory, host_memory.port, "cpu_to_host_memory");
  host_bridge.pci.bind(*this);
  cpu.interrupts[0].bind(*this);
  SC_HAS_PROCESS(FastComputer);
  SC_THREAD(run);
}

void FastComputer::request(pci::PciMasterIf& master, std::uint64_t from_ps) {
  master_ = &master;
  loop_.host_slot().request(*this, from_ps);
}

void FastComputer::end_burst(const pci::BurstResult& result) {
  burst_has_ended_ = true;
  result_ = result;
  loop_.notice();
}

// Steps the loop whenever the program has done everything that it does at a time.
void FastComputer::run() {
  constexpr std::uint64_t kMostAheadPs = 10'000'000'000;  // 10 ms: the loop runs ahead of the kernel
  for (;;) {
    while (sc_core::sc_pending_activity_at_current_time()) wait(sc_core::SC_ZERO_TIME);
    loop_.run(kernel_time::now_ps() + kMostAheadPs);
    if (loop_.now_ps() > kernel_time::now_ps())
      wait(kernel_time::to_time(loop_.now_ps() - kernel_time::now_ps()));
    if (std::exchange(burst_has_ended_, false)) master_->end_burst(result_);
    if (loop_.interrupt()) interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
    wait(sc_core::SC_ZERO_TIME);
  }
}

std::unique_ptr<ComputerView> make_computer(const sc_core::sc_module_name& name, const BoardConfig& config,
                                            std::uint64_t host_memory_bytes, host::Program& program,
                                            capture::CameraSource& left, capture::CameraSource& right,
                                            Binder& binder, fpga::Fidelity fidelity) {
  if (fpga::steps_cycles(fidelity))
    return std::make_unique<Computer>(name, config, host_memory_bytes, program, left, right, binder,
                                      fidelity);
  return std::make_unique<FastComputer>(name, config, host_memory_bytes, program, left, right, binder,
                                        fidelity);
}

}  // namespace stereotlm::platform

#include "platform/loop/loop_computer.h"

#include <stdexcept>
#include <string>

#include "models/access_text.h"
#include "models/host/host_memory.h"
#include "platform/config/device_map.h"

namespace stereotlm::platform {
namespace {

struct EndsEarly {};

}  // namespace

LoopComputer::LoopComputer(const BoardConfig& config, std::uint64_t host_memory_bytes,
                           capture::CameraSource& left, capture::CameraSource& right, fpga::Fidelity fidelity)
    : host_memory_(host::kHostMemoryRule.required("host_memory_bytes", host_memory_bytes)),
      loop_(config, host_memory_.data(), host_memory_bytes, left, right, fidelity) {}

void LoopComputer::run(host::Program& program, const std::function<bool()>& go_on) try {
  go_on_ = go_on;
  program.run(*this);
} catch (const EndsEarly& /*end*/) {
  // as `go_on` wants it
}

// Steps the loop until the program sees something.
void LoopComputer::step() {
  constexpr std::uint64_t kPeriodPs = 10'000'000'000;
  loop_.run(next_ps_);
  if (loop_.now_ps() < next_ps_) return;
  next_ps_ += kPeriodPs;
  if (!go_on_()) throw EndsEarly();
}

void LoopComputer::end_burst(const pci::BurstResult& result) {
  burst_has_ended_ = true;
  result_ = result;
  loop_.notice();
}

std::uint32_t LoopComputer::access(bool write, std::uint64_t address, std::uint32_t value) {
  accessed_ = true;
  do {  // again after a retry
    word_ = {value};
    burst_ = {write, address, &word_};
    burst_has_ended_ = false;
    loop_.host_slot().request(*this, loop_.now_ps());
    while (!burst_has_ended_) step();
    if (is_error(result_.end)) {  // in the words of host::Cpu
      throw host::BusError((write ? "write of " : "read of ") + hex(address) +
                           (result_.end == pci::BurstEnd::kMasterAbort ? ": TLM_ADDRESS_ERROR_RESPONSE"
                                                                       : ": TLM_GENERIC_ERROR_RESPONSE"));
    }
  } while (result_.words == 0);
  return word_.front();
}

void LoopComputer::wait_for_interrupt() {
  if (loop_.interrupt() && !accessed_) throw std::logic_error(host::kNoAccessBetweenWaits);
  while (!loop_.interrupt()) step();
  accessed_ = false;
}

std::uint8_t* LoopComputer::memory(std::uint64_t address, std::uint64_t bytes) {
  constexpr std::uint64_t kBase = DeviceMap().host_memory;
  if (!host_memory_.holds(address - kBase, bytes))
    throw std::out_of_range(std::to_string(bytes) + " bytes at " + hex(address) + ": must be host memory");
  return host_memory_.data() + (address - kBase);
}

}  // namespace stereotlm::platform

#include "models/host/cpu.h"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <optional>
#include <string>

#include "models/access_text.h"

namespace stereotlm::host {
namespace {

constexpr int kStackBytes = 1 << 20;  // large, because the program is not written to run in a coroutine

}  // namespace

Cpu::Cpu(const sc_core::sc_module_name& name, const CpuConfig& config, Program& program)
    : sc_module(name),
      interrupts("interrupt", static_cast<std::size_t>(kInterruptCountRule.required(
                                  std::string(this->name()) + ": interrupts", config.interrupts))),
      config_(config),
      program_(program) {
  SC_HAS_PROCESS(Cpu);
  SC_THREAD(run);
  set_stack_size(kStackBytes);
}

void Cpu::run() {
  for (const auto& interrupt : interrupts) interrupts_change_ |= interrupt->changed_event();
  std::optional<std::string> problem;
  try {
    program_.run(*this);
    finished_ = true;
    finished_event_.notify(sc_core::SC_ZERO_TIME);
  } catch (const sc_core::sc_unwind_exception&) {
    throw;  // the SystemC kernel ends the process
  } catch (const sc_core::sc_report&) {
    throw;  // a model reported an error of its own
  } catch (const std::exception& exception) {
    problem = exception.what();
  } catch (...) {
    problem = "exception of an unknown type";
  }
  if (problem) SC_REPORT_ERROR("/stereotlm/cpu", (std::string(name()) + ": " + *problem).c_str());
}

std::uint32_t Cpu::read(std::uint64_t address) {
  sc_core::sc_time delay;
  const bool ok = access_.read(address, delay);
  const std::uint32_t word = access_.word();
  end_access(ok, "read", address, delay);
  return word;
}

void Cpu::write(std::uint64_t address, std::uint32_t value) {
  sc_core::sc_time delay;
  const bool ok = access_.write(address, value, delay);
  end_access(ok, "write", address, delay);
}

void Cpu::end_access(bool ok, const char* what, std::uint64_t address, const sc_core::sc_time& delay) {
  accessed_ = true;
  if (delay != sc_core::SC_ZERO_TIME) wait(delay);
  if (!ok) throw BusError(std::string(what) + " of " + hex(address) + ": " + access_.status_text());
}

bool Cpu::interrupted() const {
  return std::any_of(interrupts.begin(), interrupts.end(),
                     [](const InterruptIn& line) { return line->is_asserted(); });
}

void Cpu::wait_for_interrupt() {
  if (interrupted() && !accessed_) throw std::logic_error(kNoAccessBetweenWaits);
  while (!interrupted()) wait(interrupts_change_);
  accessed_ = false;
}

std::uint8_t* Cpu::memory(std::uint64_t address, std::uint64_t bytes) {
  const std::uint64_t offset = address - config_.memory_base;
  tlm::tlm_generic_payload request;
  request.set_command(tlm::TLM_WRITE_COMMAND);
  request.set_address(offset);
  tlm::tlm_dmi dmi;
  if (address < config_.memory_base || !host_memory->get_direct_mem_ptr(request, dmi) ||
      !dmi.is_read_write_allowed() || (bytes > 0 && bytes - 1 > dmi.get_end_address() - offset)) {
    throw std::out_of_range(std::to_string(bytes) + " bytes at " + hex(address) + ": must be host memory");
  }
  return dmi.get_dmi_ptr() + (offset - dmi.get_start_address());
}

}  // namespace stereotlm::host

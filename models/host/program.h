#pragma once

#include <cstdint>
#include <stdexcept>

// What a program on the host knows of the hardware; no SystemC, so that it can also run on a real machine
// (registers mapped with mmap, interrupts by UIO).
namespace stereotlm::host {

// An access that the hardware answered with an error.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The hardware, as a program reaches it. Addresses are bytes on the bus.
class HostBus {
 public:
  virtual ~HostBus() = default;
  // A 32-bit register, at a multiple of 4. Throws BusError.
  virtual std::uint32_t read(std::uint64_t address) = 0;
  virtual void write(std::uint64_t address, std::uint32_t value) = 0;
  // Waits until the interrupt line is asserted, which all devices share; at once if it is, for it is
  // level-sensitive. Throws std::logic_error if it is still asserted and the program has accessed no register
  // since the last return: a program that loops here would never let time pass.
  virtual void wait_for_interrupt() = 0;
  // Host memory that devices reach at the same address, for as long as the program runs. Throws
  // std::out_of_range unless all of it is memory.
  virtual std::uint8_t* memory(std::uint64_t address, std::uint64_t bytes) = 0;
};

// What runs on the host.
class Program {
 public:
  virtual ~Program() = default;
  // Called once; the program ends when it returns. `bus` is the caller's.
  virtual void run(HostBus& bus) = 0;
};

}  // namespace stereotlm::host

#pragma once

#include <cstdint>
#include <stdexcept>

// The interface between a program on the host and the hardware. It uses no SystemC: the same program can run
// on a real machine, with registers mapped by mmap and interrupts by UIO.
namespace stereotlm::host {

// Thrown if the hardware responds to an access with an error.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// What HostBus::wait_for_interrupt() throws.
inline constexpr const char* kNoAccessBetweenWaits =
    "wait_for_interrupt: the line is still asserted, and no register was accessed since it returned last";

// The bus and the memory that a program accesses. Addresses are byte addresses on the bus.
class HostBus {
 public:
  virtual ~HostBus() = default;
  // These access the 32-bit register at `address`, a multiple of 4. They throw BusError.
  virtual std::uint32_t read(std::uint64_t address) = 0;
  virtual void write(std::uint64_t address, std::uint32_t value) = 0;
  // Waits until the interrupt line that all devices share is asserted. The line is level-sensitive: while it
  // is asserted, the call returns immediately. Throws std::logic_error if the line is still asserted and the
  // program has accessed no register since the last return, because a program that loops here would stop
  // time.
  virtual void wait_for_interrupt() = 0;
  // Returns a pointer to host memory. `address` is the one at which devices reach it. The pointer stays valid
  // while the program runs. Throws std::out_of_range unless all of these bytes are memory.
  virtual std::uint8_t* memory(std::uint64_t address, std::uint64_t bytes) = 0;
};

// A program that runs on the host.
class Program {
 public:
  virtual ~Program() = default;
  // Runs the program from beginning to end. Called once. The caller owns `bus`.
  virtual void run(HostBus& bus) = 0;
};

}  // namespace stereotlm::host

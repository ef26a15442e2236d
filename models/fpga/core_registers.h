#pragma once

#include <array>
#include <cstdint>

#include "models/fpga/core_ports.h"
#include "models/fpga/register_map.h"
#include "models/kernels/joint_table.h"

namespace stereotlm::fpga {

// A start strobe, with the values of the registers at its time.
struct FrameStart {
  FrameBases bases{};                     // where the frame's buffers lie
  kernels::JointOffsets joint_offsets{};  // of joint tables; else without meaning
  std::uint64_t time_ps = 0;              // of the strobe, now or later
};

// The registers of register_map.h: start strobe, status, bases and offsets of a frame. Plain C++.
class CoreRegisters {
 public:
  // Receives the start strobes.
  class Starter {
   public:
    virtual ~Starter() = default;
    virtual void start_frame(const FrameStart& start) = 0;  // calls refuse_start() to refuse the strobe
  };

  // `starter` outlives this object.
  explicit CoreRegisters(Starter& starter) : starter_(starter) {}

  // Whether there is a register at this address that has this direction. The address is one of a word below
  // registers::kEnd.
  static bool allows(bool write, std::uint64_t address);
  // Accesses of registers that are allowed. A start strobe takes effect at `time_ps`, now or later.
  std::uint32_t read(std::uint64_t address) const;
  void write(std::uint64_t time_ps, std::uint64_t address, std::uint32_t value);

  void refuse_start();  // raises error; to be called within Starter::start_frame()
  // To be called when the frame has ended. `error`: memory refused an access, or the result may differ from
  // that at Fidelity::kCycle.
  void finish_frame(std::uint64_t frame_cycles, bool error);
  bool done() const { return done_; }  // the interrupt: high from the end of a frame until acknowledged

 private:
  Starter& starter_;
  // [(address - kLeftImageBase) / 4]: bases, then offsets
  std::array<std::uint32_t, (registers::kEnd - registers::kLeftImageBase) / 4> frame_{};
  bool busy_ = false;
  bool done_ = false;
  bool error_ = false;
  std::uint64_t frame_cycles_ = 0;
};

}  // namespace stereotlm::fpga

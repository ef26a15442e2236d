#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "models/clock.h"
#include "models/fpga/conflict_recorder.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/frame_geometry.h"
#include "platform/config/board_config.h"

namespace stereotlm::trace {

// What the writers need of a board.
struct TraceBoard {
  explicit TraceBoard(const platform::BoardConfig& board)
      : name(board.name),
        core(platform::core_config(board)),
        geometry(core),
        clock(board.fpga.clock_mhz),
        banks(board.banks) {}

  std::uint64_t ps(std::uint64_t cycle) const { return clock.edge_ps(cycle); }
  const std::string& bank_name(std::size_t bank) const { return banks[bank].name; }
  // The name of the slice of a wait.
  std::string wait_text(std::size_t requester, std::uint64_t cycles, std::size_t by, std::size_t bank) const {
    return fmt::format("{} waits {} cycle{} for {} on {}", fpga::requester_name(requester), cycles,
                       cycles == 1 ? "" : "s", fpga::requester_name(by), bank_name(bank));
  }
  // Whether two ports can be granted in one cycle: one that reads and one that writes.
  bool has_separate_ports(std::size_t bank) const { return memory::has_separate_ports(banks[bank].kind); }

  std::string name;
  fpga::CoreConfig core;
  fpga::FrameGeometry geometry;
  Clock clock;
  std::vector<platform::BankConfig> banks;
};

// The direction of all accesses of a requester.
constexpr bool writes(std::size_t requester) {
  if (requester < fpga::kCorePortCount) return fpga::kPorts[requester].write;
  return requester != fpga::requester_of(fpga::HostTraffic::kReadBack);
}

// The requester behind a port in a cycle.
constexpr std::size_t requester_of_port(std::size_t port, fpga::HostTraffic traffic) {
  return port == fpga::kHostPort ? fpga::requester_of(traffic) : port;
}

}  // namespace stereotlm::trace

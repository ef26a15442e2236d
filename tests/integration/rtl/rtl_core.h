#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace stereotlm::test {

inline constexpr std::size_t kRtlBanks = 6;
inline constexpr std::size_t kRtlPorts = 6;  // in the order of stereo_core.v; the last one is the host's

// The inputs of stereo_core in a cycle.
struct RtlInputs {
  bool reset = false;
  bool start = false;
  bool starts_at_end = false;  // `start` in the cycle in which the frame ends
  std::uint32_t policy = 0;
  std::uint32_t priority_list = 0;
  std::array<std::uint32_t, kRtlBanks> turnaround{};
  std::array<bool, kRtlBanks> latency_2{};
  std::array<std::uint32_t, kRtlPorts - 1> bases{};
  std::array<std::uint32_t, kRtlBanks> read_data{};
  bool host_request = false;
  bool host_write = false;
  std::uint32_t host_address = 0;  // as a base
  std::uint32_t host_write_data = 0;
};

// Its outputs in the same cycle.
struct RtlOutputs {
  struct Port {
    std::uint32_t state = 0;    // port_states.vh; of the host 0 or 2
    std::uint32_t address = 0;  // bank and word, as in a base register
    bool granted = false;
  };
  struct Bank {
    bool enable = false;
    bool write = false;
    std::uint32_t address = 0;
    std::uint32_t write_data = 0;
  };
  std::array<Port, kRtlPorts> ports;
  std::array<Bank, kRtlBanks> banks;
  std::uint32_t host_read_data = 0;
  bool ends = false;
  bool consumes = false;
  std::uint64_t cycles = 0;
};

// A verilated stereo_core, of any parameters.
class RtlCore {
 public:
  virtual ~RtlCore() = default;
  // The outputs in a cycle with these inputs. Then the clock rises.
  virtual const RtlOutputs& step(const RtlInputs& inputs) = 0;
};

// A core of each parameter set that the program has, by its name in sets.json.
using RtlCores = std::map<std::string, std::unique_ptr<RtlCore> (*)()>;
const RtlCores& rtl_cores();

}  // namespace stereotlm::test

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "models/fpga/core_ports.h"

namespace stereotlm::fpga {

// What a burst of the host is for. A read of a bank is a read-back. A write belongs to a capture if the
// capture boards write to its address; any other write is an upload.
enum class HostTraffic : std::uint8_t { kCapture, kUpload, kReadBack };
inline constexpr std::size_t kHostTraffics = 3;

// Who requests banks, or is to blame: the ports of the core, then the host's port for each HostTraffic. The
// turnaround can only be to blame.
inline constexpr std::size_t kRequesters = kCorePortCount + kHostTraffics;
inline constexpr std::size_t kTurnaroundToBlame = kRequesters;
constexpr std::size_t requester_of(HostTraffic traffic) {
  return kCorePortCount + static_cast<std::size_t>(traffic);
}
// "left_lut", "host capture", "turnaround".
constexpr const char* requester_name(std::size_t requester) {
  constexpr std::array<const char*, kHostTraffics + 1> kOthers = {"host capture", "host upload",
                                                                  "host read-back", "turnaround"};
  return requester < kCorePortCount ? kPorts[requester].name : kOthers[requester - kCorePortCount];
}
// The port of a requester.
constexpr memory::Port port_of_requester(std::size_t requester) {
  return requester < kCorePortCount ? requester : kHostPort;
}

}  // namespace stereotlm::fpga

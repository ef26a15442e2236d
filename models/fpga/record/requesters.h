#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "models/fpga/core_ports.h"

namespace stereotlm::fpga {

// What a burst of the host is for. A read of a bank is a read-back. A write belongs to a capture if the
// capture boards write to its address; any other write is an upload.
enum class HostTraffic : std::uint8_t { kCapture, kUpload, kReadBack };
inline constexpr std::size_t kHostTraffics = 3;

// Who requests banks, or is to blame: the ports of the core, then the host's port for each HostTraffic. The
// turnaround can only be to blame.
class Requesters {
 public:
  explicit Requesters(const CorePorts& ports) : ports_(ports) {}

  std::size_t size() const { return ports_.core_size() + kHostTraffics; }
  std::size_t turnaround() const { return size(); }
  std::size_t host(HostTraffic traffic) const {
    return ports_.core_size() + static_cast<std::size_t>(traffic);
  }
  // The requester behind a port, whose traffic this is if it is the host's.
  std::size_t of_port(memory::Port port, HostTraffic traffic) const {
    return port == ports_.host() ? host(traffic) : port;
  }
  // The port of a requester.
  memory::Port port_of(std::size_t requester) const {
    return requester < ports_.core_size() ? requester : ports_.host();
  }
  // The direction of all its accesses.
  bool writes(std::size_t requester) const {
    if (requester < ports_.core_size()) return ports_.group(requester).write;
    return requester != host(HostTraffic::kReadBack);
  }
  // "left_lut", "host capture", "turnaround".
  std::string name(std::size_t requester) const {
    constexpr std::array<const char*, kHostTraffics + 1> kOthers = {"host capture", "host upload",
                                                                    "host read-back", "turnaround"};
    return requester < ports_.core_size() ? ports_.name(requester) : kOthers[requester - ports_.core_size()];
  }
  const CorePorts& ports() const { return ports_; }

 private:
  CorePorts ports_;
};

}  // namespace stereotlm::fpga

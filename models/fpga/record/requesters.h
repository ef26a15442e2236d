#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "models/fpga/core_ports.h"
#include "models/memory/bank_arbiter.h"

namespace stereotlm::fpga {

// What a burst of the host is for. A read of a bank is a read-back. A write belongs to a capture if the
// capture boards write to its address; any other write is an upload.
enum class HostTraffic : std::uint8_t { kCapture, kUpload, kReadBack };
inline constexpr std::size_t kHostTraffics = 3;

// Who requests banks, or is to blame: the ports of the core, then the host's port for each HostTraffic. The
// causes behind them can only be to blame: the turnaround, and of sdram the rows and the refresh.
class Requesters {
 public:
  explicit Requesters(const CorePorts& ports) : ports_(ports) {}

  std::size_t size() const { return ports_.core_size() + kHostTraffics; }
  std::size_t causes() const { return size() + memory::kOtherCauses; }  // the requesters among them
  bool is_requester(std::size_t cause) const { return cause < size(); }
  std::size_t host(HostTraffic traffic) const {
    return ports_.core_size() + static_cast<std::size_t>(traffic);
  }
  // The requester behind a port, with this traffic if it is the host's; or the number of another cause.
  std::size_t of_port(std::size_t port, HostTraffic traffic) const {
    if (port >= memory::kTurnaround) return size() + (port - memory::kTurnaround);
    return port == ports_.host() ? host(traffic) : port;
  }
  memory::Port port_of(std::size_t requester) const {  // the port of a requester
    return requester < ports_.core_size() ? requester : ports_.host();
  }
  bool writes(std::size_t requester) const {  // the direction of all its accesses
    if (requester < ports_.core_size()) return ports_.group(requester).write;
    return requester != host(HostTraffic::kReadBack);
  }
  // "left_lut", "host capture", "turnaround".
  std::string name(std::size_t cause) const {
    constexpr std::array<const char*, kHostTraffics> kHost = {"host capture", "host upload",
                                                              "host read-back"};
    if (!is_requester(cause)) return memory::name_of_cause(memory::kTurnaround + (cause - size()));
    return cause < ports_.core_size() ? ports_.name(cause) : kHost[cause - ports_.core_size()];
  }
  const CorePorts& ports() const { return ports_; }

 private:
  CorePorts ports_;
};

}  // namespace stereotlm::fpga

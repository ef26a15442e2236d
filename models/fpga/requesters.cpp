#include "models/fpga/requesters.h"

#include <array>

namespace stereotlm::fpga {
namespace {

constexpr std::array<const char*, kHostTraffics> kTrafficNames = {"host capture", "host upload",
                                                                  "host read-back"};

}  // namespace

const char* requester_name(std::size_t requester) {
  if (requester == kTurnaroundToBlame) return "turnaround";
  return requester < kCorePortCount ? kPorts[requester].name : kTrafficNames[requester - kCorePortCount];
}

}  // namespace stereotlm::fpga

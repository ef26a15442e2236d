#pragma once

#include <unordered_map>

#include "models/testing/access_probe.h"

namespace stereotlm::test {

// A probe in front of a memory that knows what the memory holds: each byte that is read must be the byte that
// was written last, or read last. Accesses count in the order of their responses; so the link must be one on
// which they take effect in this order, such as that of a bank. A wrong byte is a failure (failure.h):
// "<scoreboard> at <time>: byte <address> = <value>: must be <value>". After a write whose process is killed
// or reset before the response, its bytes are unknown.
class Scoreboard : public AccessProbe {
 public:
  using AccessProbe::AccessProbe;  // knows no byte at first

  // The number of bytes that were compared.
  std::uint64_t compared() const { return compared_; }

  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) override;

 private:
  void ended(const tlm::tlm_generic_payload& payload, std::uint64_t address, const sc_core::sc_time& begin,
             const sc_core::sc_time& end) override;

  std::unordered_map<std::uint64_t, unsigned char> bytes_;  // [address]
  std::uint64_t compared_ = 0;
};

}  // namespace stereotlm::test

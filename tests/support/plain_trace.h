#pragma once

#include <cstddef>
#include <cstdint>

#include "tests/support/plain_clock.h"

// What the buses and the queues of the plain computer do.
namespace stereotlm::test {

struct PlainBusBurst {
  std::size_t source = 0;  // PCI bus: the master. Local bus: 0 posted, 1 read, 2 and 3 the DMA channels
  bool write = false;
  std::uint64_t word = 0;  // the first one, on the local bus; 0 on the PCI bus
  std::uint64_t words = 0;
  // The beginnings of clocks: the first one that could be granted, the address clock, the next one, and the
  // idle clock.
  PlainTime request_ps = 0;
  PlainTime address_ps = 0;
  PlainTime data_ps = 0;
  PlainTime end_ps = 0;
};

struct PlainLevel {
  PlainTime time_ps = 0;
  std::uint64_t words = 0;
};

}  // namespace stereotlm::test

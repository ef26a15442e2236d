#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "models/fpga/core_cycle.h"

namespace stereotlm::trace {

// Finds the longest wait of a port for a bank, and keeps the cycles around it: 30 before it, or those that there are,
// and behind it so many that there are 60 beside it. Of equal waits it takes the first one with 30 cycles before it.
class LongestWait {
 public:
  // Cycles in their order. One that is left out ends every wait.
  void add(const fpga::CoreCycle& cycle);

  // The number of its cycles; 0: no port waits.
  std::uint64_t cycles() const { return end_ - first_; }
  std::uint64_t first_cycle() const { return first_; }
  // The first one of the cycles around it, and the first one behind them.
  std::uint64_t begin_around() const { return lacks_cycles_before() ? first_added_ : first_ - kBefore; }
  std::uint64_t end_around() const { return begin_around() + cycles() + kBeside; }
  // Those of the cycles around it that were added. To be called once, behind the last one.
  std::deque<fpga::CoreCycle> take_kept();

 private:
  static constexpr std::uint64_t kBefore = 30;
  static constexpr std::uint64_t kBeside = 60;

  bool lacks_cycles_before() const { return first_ < first_added_ + kBefore; }

  std::uint64_t first_added_ = 0;
  std::uint64_t next_cycle_ = 0;                          // 0: none was added
  std::array<std::uint64_t, fpga::kPortCount> waited_{};  // [port]: cycles of the wait that is under way
  std::uint64_t first_ = 0;
  std::uint64_t end_ = 0;
  bool grows_ = false;                  // it is under way
  std::deque<fpga::CoreCycle> recent_;  // with those before the waits that are under way
  std::deque<fpga::CoreCycle> kept_;    // with those behind the longest wait, if that has ended
};

}  // namespace stereotlm::trace

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "tests/support/plain_clock.h"
#include "tests/support/plain_core.h"
#include "tests/support/plain_events.h"
#include "tests/support/reference_arithmetic.h"

// The FPGA and its banks with their words, as the local bus reaches them: contract sections 1 to 3, 7 and 8.
namespace stereotlm::test {

struct PlainBoardInput {
  PlainCycleInput core;  // on a side with a bank for its table, entries of nullopt are the identity
  PlainNumber clock_mhz;
  std::optional<ReferenceKernel> filter;
  std::optional<int> lr_tolerance;
  ReferenceCost cost{};
};

// The core's registers for the four coordinates X and Y of joint tables (contract 7.3).
enum class PlainMiddle { kLeftX, kLeftY, kRightX, kRightY };

// The one table for both sides. The input must have joint tables.
ReferenceJointTable plain_joint_table(const PlainCycleInput& input);

// The entries of a table; none for a side without table.
std::vector<std::uint32_t> plain_table(const PlainCycleInput& input, const std::optional<PlainBuffer>& buffer,
                                       const std::optional<std::vector<std::uint32_t>>& entries);

class PlainBoard {
 public:
  // `input` must outlive the board. Calls `frame_ends` at the end of each frame.
  PlainBoard(PlainEvents& events, const PlainBoardInput& input, std::function<void()> frame_ends);

  // The host requests this word of a bank, in each cycle that begins at or after `from_ps`, until granted. No
  // other word may wait. `traffic`: of the burst of the word. Calls `granted` with the begin of the cycle of
  // the grant and, for a read, the time from which `word` is usable.
  void host_asks(const PlainWord& at, bool write, PlainTraffic traffic, std::uint32_t& word,
                 PlainTime from_ps, std::function<void(PlainTime begin_ps, PlainTime usable_ps)> granted);
  // A write to one of these registers.
  void write_middle(PlainMiddle which, std::uint32_t value) {
    middles_[static_cast<std::size_t>(which)] = static_cast<int>(value);
  }
  // The local-bus clock that carries the start strobe ends now.
  void start_frame();

  const std::vector<std::uint64_t>& frame_cycles() const { return frame_cycles_; }
  PlainCycleResult core_result();  // up to now, while no frame runs

 private:
  struct HostWord {
    PlainWord at;
    bool write;
    PlainTraffic traffic;
    std::uint32_t* word;
    PlainTime from_ps;
    std::function<void(PlainTime, PlainTime)> granted;
  };

  void await_cycle();
  void run_cycle(std::uint64_t cycle);
  void grant_host(std::uint64_t cycle);
  void compute(int frame);
  std::uint32_t& word_at(const PlainWord& at);
  std::vector<std::uint32_t> words_at(const PlainParts& parts, int words_of_row);
  std::vector<std::uint8_t> pixels_at(const PlainParts& parts);
  std::optional<std::vector<std::uint32_t>> table_at(const PlainParts& parts);
  ReferenceJointTable joint_table();

  PlainEvents& events_;
  const PlainBoardInput& input_;
  std::function<void()> frame_ends_;
  PlainClock clock_;
  PlainPlaces places_;
  std::vector<std::vector<std::uint32_t>> banks_;
  PlainCore core_;
  std::array<int, 4> middles_{};
  std::optional<HostWord> host_;
  std::uint64_t next_cycle_ = 0;
  std::uint64_t first_cycle_ = 0;  // of the running frame
  std::vector<std::uint64_t> frame_cycles_;
};

}  // namespace stereotlm::test

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/fpga/core_cycle.h"
#include "sw/trace/perfetto_tree.h"
#include "sw/trace/slot_places.h"
#include "sw/trace/trace_board.h"

namespace stereotlm::trace {

// The cycles of a window: a slice for each access, and one for consecutive cycles in which a port waits for the
// same port, or is in the same other state.
class PerfettoCycles {
 public:
  PerfettoCycles(const TraceBoard& board, PerfettoTree& tree);

  void cycle(const fpga::CoreCycle& cycle);
  // The window has ended.
  void end();

 private:
  enum class State : std::uint8_t { kNone, kWaits, kPasses, kBlocked, kStarved };
  enum class Arrow : std::uint8_t { kToPixel, kToResult };
  // Consecutive cycles of a port in one state.
  struct PortRun {
    State state = State::kNone;
    std::size_t requester = 0;
    std::size_t bank = 0;  // of a wait, like `by`
    std::size_t by = 0;
    std::uint64_t first_cycle = 0;
    std::uint64_t flow = 0;  // of a wait: the arrow from the access of the winner
  };
  // Consecutive cycles in which a bank, or one direction of it, has one owner.
  struct BankRun {
    static constexpr std::size_t kNobody = fpga::kTurnaroundToBlame + 1;
    std::size_t owner = kNobody;  // requester, or kTurnaroundToBlame
    std::size_t next = kNobody;   // in the cycle that is written
    std::uint64_t first_cycle = 0;
    LazyTrack track;
  };

  static PortRun run_of(const fpga::CoreCycle& cycle, std::size_t port);
  void continue_or_begin(PortRun& run, PortRun wanted, const fpga::CoreCycle& cycle);
  void write_run(const PortRun& run, std::uint64_t end_cycle);
  void write_access(const fpga::CoreCycle& cycle, std::size_t port);
  void add_data_flows(const fpga::CoreCycle& cycle, std::size_t port);
  void set_owner(const fpga::CoreCycle& cycle, std::size_t port);
  void change_owner(BankRun& run, std::uint64_t cycle);
  void set_working(bool works, std::uint64_t cycle);
  void count_queues(const fpga::CoreCycle& cycle);
  std::uint64_t ns(std::uint64_t cycle) const { return board_.ps(cycle) / 1000; }

  const TraceBoard& board_;
  SlotPlaces slots_;
  std::vector<LazyTrack> ports_;  // [requester]
  LazyTrack matcher_;
  std::array<LazyTrack, 2> lanes_;  // [side]
  LazyTrack results_;
  std::vector<BankRun> banks_;  // [2 * bank + 1 if it writes to a bank with separate ports]
  std::vector<std::array<std::string, 2>> access_;  // [bank][write]: name of a slice
  std::array<PortRun, fpga::kPortCount> runs_{};
  std::optional<std::uint64_t> works_since_;
  std::optional<std::uint64_t> next_cycle_;  // the one behind the last cycle
  std::uint64_t waits_ = 0;
  std::array<std::vector<std::uint64_t>, fpga::kRequesters> flows_;  // [requester]: of its access
};

}  // namespace stereotlm::trace

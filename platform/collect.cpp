#include "platform/collect.h"

#include <numeric>
#include <utility>

#include "models/memory/memory_config.h"
#include "platform/audit.h"
#include "platform/bounds.h"
#include "platform/config/board_area.h"

namespace stereotlm::platform {
namespace {

using fpga::kPortCount;
using memory::ArbiterStats;
using memory::Port;

BankStatistics bank_statistics(const BankConfig& config, const ArbiterStats& arbiter, std::uint64_t cycles,
                               double clock_mhz) {
  BankStatistics bank;
  bank.name = config.name;
  bank.ports = memory::traits_of(config.kind).ports;
  bank.reads = arbiter.reads;
  bank.writes = arbiter.writes;
  bank.busy_cycles = arbiter.busy_cycles;
  bank.turnaround_cycles = arbiter.turnaround_cycles;
  bank.idle_cycles = arbiter.idle_cycles;
  bank.contended_cycles = arbiter.contended_cycles;
  if (cycles > 0) {
    bank.utilization = static_cast<double>(bank.busy_cycles) / static_cast<double>(cycles);
    bank.megabytes_per_second =
        4.0 * static_cast<double>(bank.reads + bank.writes) * clock_mhz / static_cast<double>(cycles);
  }
  return bank;
}

PortStatistics port_statistics(Port port, const fpga::PortCycles& cycles) {
  return {fpga::kPorts[port].name, cycles.granted(), cycles.stalled(), cycles.passed(),
          cycles.idle(),           cycles.blocked(), cycles.starved()};
}

// Returns the stall cycles that are not 0, sorted by port, bank and cause. The last cause is turnaround.
std::vector<BlameRow> blame_rows(const BoardConfig& config, const BoardCounters& counters) {
  std::vector<BlameRow> rows;
  for (std::size_t victim = 0; victim < kPortCount; ++victim) {
    for (std::size_t bank = 0; bank < counters.banks.size(); ++bank) {
      for (std::size_t by = 0; by <= ArbiterStats::kTurnaround; ++by) {
        const std::uint64_t cycles = counters.banks[bank].arbiter.blame[victim][by];
        if (cycles == 0) continue;
        rows.push_back({fpga::kPorts[victim].name, config.banks[bank].name,
                        by == ArbiterStats::kTurnaround ? "turnaround" : fpga::kPorts[by].name, cycles});
      }
    }
  }
  return rows;
}

void audit_ports(const BoardCounters& counters, std::uint64_t cycles, Audit& audit) {
  for (std::size_t index = 0; index < kPortCount; ++index) {
    const fpga::PortCycles& port = counters.ports[index];
    const std::string name = std::string("port ") + fpga::kPorts[index].name;
    std::uint64_t blamed = 0;
    std::uint64_t granted = 0;
    for (const BoardCounters::Bank& bank : counters.banks) {
      const auto& row = bank.arbiter.blame[index];
      blamed = std::accumulate(row.begin(), row.end(), blamed);
      granted += bank.arbiter.grants[index];
    }
    audit.equal(name + ": sum of its states", port.sum(), "cycles", cycles);
    audit.equal(name + ": stall_cycles", port.stalled(), "blamed by the arbiters", blamed);
    audit.equal(name + ": grants", port.granted(), "given by the arbiters", granted);
  }
}

void audit_banks(const BoardConfig& config, const BoardCounters& counters, std::uint64_t cycles,
                 Audit& audit) {
  for (std::size_t index = 0; index < counters.banks.size(); ++index) {
    const BoardCounters::Bank& bank = counters.banks[index];
    const ArbiterStats& stats = bank.arbiter;
    const std::string name = "bank " + config.banks[index].name;
    audit.equal(name + ": busy + turnaround + idle cycles",
                stats.busy_cycles + stats.turnaround_cycles + stats.idle_cycles, "cycles", cycles);
    audit.equal(name + ": accesses", bank.accesses, "granted by its arbiter",
                stats.reads + stats.writes + bank.uncounted_grants);
  }
}

void audit_flow(const fpga::FrameGeometry& geometry, const BoardCounters& counters, Audit& audit) {
  const std::uint64_t slots = counters.frames * geometry.slots;
  const std::uint64_t words = counters.frames * geometry.result_words;
  audit.equal("left lane: slots consumed", counters.left.consumed, "slots of the sequence", slots);
  audit.equal("right lane: slots consumed", counters.right.consumed, "slots of the sequence", slots);
  audit.equal("left lane: slots issued", counters.left.issued, "slots of the sequence", slots);
  audit.equal("right lane: slots issued", counters.right.issued, "slots of the sequence", slots);
  audit.equal("result packer: words", counters.packed_words, "words of the images", words);
  audit.equal("result writer: words", counters.written_words, "words of the images", words);
}

// No frame takes fewer cycles than its bound. Reports the first that does.
void audit_frames(const std::vector<std::uint64_t>& frame_cycles, const std::vector<ResourceBound>& turn,
                  Audit& audit) {
  for (std::size_t frame = 0; frame < frame_cycles.size(); ++frame) {
    const ResourceBound& bound = turn[frame % turn.size()];
    if (frame_cycles[frame] >= bound.cycles) continue;
    return audit.at_most("bound of " + bound.resource, bound.cycles, fmt::format("frame_cycles[{}]", frame),
                         frame_cycles[frame]);
  }
}

}  // namespace

BoardCounters counters_of(const fpga::FrameRun& frames, const std::vector<memory::BankArbiter>& arbiters) {
  BoardCounters counters;
  counters.frames = frames.frame_cycles().size();
  for (std::size_t port = 0; port < kPortCount; ++port)
    counters.ports[port] = frames.control().port_cycles(port);
  counters.banks.reserve(arbiters.size());
  for (const memory::BankArbiter& arbiter : arbiters)
    counters.banks.push_back({arbiter.stats(), arbiter.uncounted_accesses(), 0});
  counters.left.consumed = frames.control().lane(fpga::Side::kLeft).consumed();
  counters.right.consumed = frames.control().lane(fpga::Side::kRight).consumed();
  return counters;
}

BoardCounters counters_of(const Board& board) {
  const fpga::StereoCore& core = board.core;
  const fpga::CoreDatapath& datapath = core.datapath();
  BoardCounters counters = counters_of(core.frames(), core.crossbar().arbiters());
  for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
    const memory::SsramBank::Stats& stats = board.banks[bank].stats();
    counters.banks[bank].accesses =
        stats.reads + stats.writes + stats.errors + core.crossbar().direct_accesses(bank);
  }
  counters.left.issued = datapath.sequencer().stats(fpga::Side::kLeft).slots;
  counters.right.issued = datapath.sequencer().stats(fpga::Side::kRight).slots;
  counters.packed_words = datapath.result_packer().stats().words;
  counters.written_words = datapath.result_writer().stats().writes;
  return counters;
}

Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board,
                              const BoardCounters& counters) {
  const bool is_cycle = board.core.fidelity() == fpga::Fidelity::kCycle;
  return collect_statistics(config, tables, is_cycle ? "cycle" : "fast", board.core.frames().frame_cycles(),
                            counters);
}

Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const std::string& fidelity,
                              const std::vector<std::uint64_t>& frame_cycles, const BoardCounters& counters) {
  Statistics statistics;
  statistics.board = config.name;
  statistics.fidelity = fidelity;
  statistics.frames = counters.frames;
  const auto first = frame_cycles.begin();
  statistics.frame_cycles.assign(first, first + static_cast<std::ptrdiff_t>(counters.frames));
  const std::uint64_t all_cycles =
      std::accumulate(statistics.frame_cycles.begin(), statistics.frame_cycles.end(), std::uint64_t{0});
  const auto pipeline = static_cast<std::uint64_t>(config.fpga.pipeline_latency_cycles);
  statistics.cycles = all_cycles - statistics.frames * pipeline;
  for (std::size_t bank = 0; bank < config.banks.size(); ++bank) {
    statistics.banks.push_back(bank_statistics(config.banks[bank], counters.banks[bank].arbiter,
                                               statistics.cycles, config.fpga.clock_mhz));
  }
  for (std::size_t port = 0; port < kPortCount; ++port) {
    statistics.ports.push_back(port_statistics(port, counters.ports[port]));
  }
  statistics.blame = blame_rows(config, counters);
  statistics.area = area_of(config);

  Audit audit;
  audit_ports(counters, statistics.cycles, audit);
  audit_banks(config, counters, statistics.cycles, audit);
  audit_flow(fpga::FrameGeometry(core_config(config)), counters, audit);
  if (statistics.frames > 0) {
    statistics.frames_per_second.core = config.fpga.clock_mhz * 1e6 * static_cast<double>(statistics.frames) /
                                        static_cast<double>(all_cycles);
    const FrameAccesses accesses = frame_accesses(config, tables);
    statistics.bound = core_bound(config, accesses);
    audit_frames(statistics.frame_cycles, turn_bounds(config, accesses), audit);
  }
  statistics.failed = std::move(audit).failed();
  return statistics;
}

}  // namespace stereotlm::platform

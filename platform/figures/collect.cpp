#include "platform/figures/collect.h"

#include <fmt/format.h>

#include <algorithm>

#include "models/words_by_range.h"
#include "platform/config/buffer_layout.h"
#include "platform/config/computer_parts.h"
#include "platform/figures/audit.h"
#include "platform/figures/proven_rate.h"

namespace stereotlm::platform {
namespace {

using memory::ArbiterStats;

// Their names and shares follow from derive_figures().
BankStatistics bank_statistics(const ArbiterStats& arbiter) {
  return {"",
          arbiter.reads(),
          arbiter.writes(),
          arbiter.busy_cycles(),
          arbiter.turnaround_cycles(),
          arbiter.idle_cycles(),
          arbiter.contended_cycles(),
          0,
          0,
          1,
          arbiter.row_cycles(),
          arbiter.refresh_cycles(),
          BankEnergyStatistics{0, arbiter.rows_opened(), arbiter.refreshes()}};
}

PortStatistics port_statistics(const fpga::PortCycles& cycles) {
  return {"",
          cycles.granted(),
          cycles.stalled(),
          cycles.passed(),
          cycles.idle(),
          cycles.blocked(),
          cycles.starved()};
}

// Adds what happens outside frames to the work in the counted cycles, without the words counted early.
void add_uncounted_work(const BoardConfig& config, const ComputerCounters& counters, Statistics& statistics) {
  const AddressRange& ahead = counters.board.ahead;
  WordsByRange early(buffer_ranges(config));
  early.add(ahead.first, (ahead.end - ahead.first) / 4);
  for (std::size_t bank = 0; bank < counters.board.banks.size(); ++bank) {
    std::optional<BankEnergyStatistics>& energy = statistics.banks[bank].energy;
    if (!energy) continue;
    const ArbiterStats& arbiter = counters.board.banks[bank].arbiter;
    energy->accesses += arbiter.uncounted_accesses();
    if (bank == memory::bank_of_address(ahead.first)) energy->accesses -= early.total();
    if (energy->refreshes) *energy->refreshes += arbiter.uncounted_refreshes();
  }
  std::vector<BufferStatistics>& of_buffers = statistics.energy.buffers;
  const std::vector<PlacedBuffer> all = buffers(config);
  for (std::size_t i = 0; i < all.size(); ++i) {
    of_buffers[static_cast<std::size_t>(all[i].buffer)].bytes +=
        4 * (counters.words.granted[i] - early.words()[i]);
  }
  // The host reads nothing else.
  of_buffers[static_cast<std::size_t>(Buffer::kDisparity)].bytes += 4 * counters.local_bus.words_read;
}

// Returns the stall cycles that are not 0, sorted by port, bank and cause. The causes that are no ports come
// last.
std::vector<BlameRow> blame_rows(const BoardConfig& config, const BoardCounters& counters) {
  std::vector<BlameRow> rows;
  const fpga::CorePorts ports = core_ports(config);
  for (std::size_t victim = 0; victim < ports.size(); ++victim) {
    for (std::size_t bank = 0; bank < counters.banks.size(); ++bank) {
      const auto add = [&](std::size_t by, const std::string& name) {
        const std::uint64_t cycles = counters.banks[bank].arbiter.blame(victim, by);
        if (cycles != 0) rows.push_back({ports.name(victim), config.banks[bank].name, name, cycles});
      };
      for (std::size_t by = 0; by < ports.size(); ++by) add(by, ports.name(by));
      for (std::size_t by = memory::kTurnaround; by <= memory::kRefresh; ++by)
        add(by, memory::name_of_cause(by));
    }
  }
  return rows;
}

void audit_arbiters(const BoardConfig& config, const BoardCounters& counters, Audit& audit) {
  const fpga::CorePorts ports = core_ports(config);
  for (std::size_t port = 0; port < ports.size(); ++port) {
    std::uint64_t granted = 0;
    for (const BoardCounters::Bank& bank : counters.banks) granted += bank.arbiter.grants(port);
    audit.equal("port " + ports.name(port) + ": grants", counters.ports[port].granted(),
                "given by the arbiters", granted);
  }
  for (std::size_t index = 0; index < counters.banks.size(); ++index) {
    const BoardCounters::Bank& bank = counters.banks[index];
    audit.equal("bank " + config.banks[index].name + ": accesses", bank.accesses, "granted by its arbiter",
                bank.arbiter.reads() + bank.arbiter.writes() + bank.arbiter.uncounted_accesses());
  }
}

void audit_flow(const fpga::FrameGeometry& geometry, const BoardCounters& counters, Audit& audit) {
  const std::uint64_t slots = counters.frames * geometry.slots;
  const std::uint64_t words = counters.frames * geometry.result_words;
  audit.equal("left lane: slots consumed", counters.consumed[0], "slots of the sequence", slots);
  audit.equal("right lane: slots consumed", counters.consumed[1], "slots of the sequence", slots);
  audit.equal("left lane: slots issued", counters.issued[0], "slots of the sequence", slots);
  audit.equal("right lane: slots issued", counters.issued[1], "slots of the sequence", slots);
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

// A frame that begins just when the run ends counts as dropped (not armed), because no capture has taken it.
CameraStatistics camera_statistics(const char* name, const ComputerCounters::Camera& camera) {
  const capture::CaptureControl::Stats& capture = camera.capture;
  const std::uint64_t not_armed = capture.dropped_not_armed + std::uint64_t{camera.undecided};
  return {name,
          camera.frames,
          capture.started_frames,
          not_armed + capture.dropped_busy + capture.dropped_by_partner,
          capture.dropped_pixels,
          not_armed,
          capture.dropped_busy,
          capture.dropped_by_partner};
}

void audit_words(const BoardConfig& config, const ComputerCounters::Words& words, Audit& audit) {
  std::vector<std::string> names;
  for (const PlacedBuffer& buffer : buffers(config)) names.push_back(buffer.path());
  names.emplace_back("no buffer");
  for (std::size_t i = 0; i < names.size(); ++i) {
    audit.equal("bytes written into the bridge for " + names[i], 4 * words.into_bridge[i],
                "granted on the host port and still in the bridge",
                4 * (words.granted[i] + words.on_bus[i] + words.in_bridge[i]));
  }
}

void audit_host_port(const ComputerCounters& counters, Audit& audit) {
  std::uint64_t grants = 0;
  for (const BoardCounters::Bank& bank : counters.board.banks) {
    grants += bank.arbiter.uncounted_accesses() + bank.arbiter.grants(counters.board.ports.size() - 1);
  }
  audit.equal("port host: grants in and between frames", grants, "words of the local bus",
              counters.local_bus.words_read + counters.local_bus.words_written);
}

void audit_captures(const ComputerStatistics& computer, const ComputerCounters& counters, Audit& audit) {
  for (std::size_t side = 0; side < computer.cameras.size(); ++side) {
    const std::size_t master = side == 0 ? kLeftCapture : kRightCapture;
    audit.equal("camera " + computer.cameras[side].name + ": words written",
                counters.cameras[side].capture.words, "words of its PCI master",
                counters.pci.masters[master].words);
  }
}

// The frames from power-up need not be whole turns of the lists. Their rate is compared with the bounds of
// just these frames. The words of captures do not count where they lose pixels.
void audit_rates(const BoardConfig& config, const FrameAccesses& accesses, bool whole_pictures,
                 const Statistics& statistics, Audit& audit) {
  const auto bound_of = [&](Bound bound, const std::optional<std::uint64_t>& frames) {
    constexpr double kRoundingFactor = 1 + 1e-9;  // rates are rounded quotients
    add_system_bound(config, accesses, whole_pictures, bound, frames);
    return *bound.system * kRoundingFactor;
  };
  const std::string lossy = whole_pictures ? "" : ", without the words of captures";
  const FramesPerSecond& rate = statistics.frames_per_second;
  audit.at_most("frames_per_second.system", *rate.system, "the bound of these frames" + lossy,
                bound_of(statistics.bound, statistics.frames));
  if (!rate.steady) return;
  audit.at_most("frames_per_second.steady - steady_uncertainty",
                rate.steady->frames_per_second - rate.steady->uncertainty, "the bound of whole turns" + lossy,
                bound_of(core_bound(config, accesses), std::nullopt));
}

}  // namespace

BoardCounters counters_of(const fpga::FrameRun& frames, const memory::Arbitration& arbitration,
                          const fpga::HostPort* host, std::uint64_t end_cycle) {
  BoardCounters counters;
  if (host != nullptr) counters.ahead = host->counted_ahead_of(end_cycle);
  counters.frames = frames.frame_cycles().size();
  const fpga::CoreControl& control = frames.control();
  for (std::size_t port = 0; port < control.ports().size(); ++port)
    counters.ports.push_back(control.port_cycles(port));
  const fpga::DirectCounts& direct = frames.direct_counts();
  for (std::size_t bank = 0; bank < arbitration.banks(); ++bank)
    counters.banks.push_back({arbitration.stats(bank, end_cycle), direct.accesses[bank]});
  counters.issued = direct.slots;
  counters.packed_words = direct.packed_words;
  counters.written_words = direct.written_words;
  for (std::size_t lane = 0; lane < control.lanes().size(); ++lane)
    counters.consumed[fpga::index_of(control.side_of(lane))] += control.lane(lane).consumed();
  return counters;
}

Statistics collect_statistics(const BoardConfig& config, const FrameAccesses& accesses,
                              const std::string& fidelity, const std::vector<std::uint64_t>& frame_cycles,
                              const BoardCounters& counters) {
  Statistics statistics;
  statistics.fidelity = fidelity;
  const auto first = frame_cycles.begin();
  statistics.frame_cycles.assign(first, first + static_cast<std::ptrdiff_t>(counters.frames));
  for (const BoardCounters::Bank& bank : counters.banks)
    statistics.banks.push_back(bank_statistics(bank.arbiter));
  for (const fpga::PortCycles& port : counters.ports) statistics.ports.push_back(port_statistics(port));
  statistics.blame = blame_rows(config, counters);
  derive_figures(config, statistics);
  derive_energy(config, statistics);

  Audit audit;
  audit_core(statistics, audit);
  audit_arbiters(config, counters, audit);
  audit_flow(fpga::FrameGeometry(core_config(config)), counters, audit);
  if (statistics.frames > 0) {
    statistics.bound = core_bound(config, accesses, statistics.frames);
    audit_frames(statistics.frame_cycles, turn_bounds(config, accesses), audit);
  }
  statistics.failed = audit.failed();
  return statistics;
}

std::uint64_t words_for_results(const pci::PciBusControl::Stats& bus) {
  std::uint64_t words = 0;
  for (std::size_t master = 0; master < kTrafficGenerator; ++master) words += bus.masters[master].words;
  return words;
}

Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const std::string& fidelity,
                              const std::vector<std::uint64_t>& frame_cycles,
                              const ComputerCounters& counters, const std::vector<Delivery>& deliveries) {
  const FrameAccesses accesses = frame_accesses(config, tables);
  Statistics statistics = collect_statistics(config, accesses, fidelity, frame_cycles, counters.board);
  const bool whole_pictures =
      counters.cameras[0].capture.dropped_pixels + counters.cameras[1].capture.dropped_pixels == 0;
  ComputerStatistics& around = statistics.computer.emplace();
  around.pci_clocks = counters.pci.clocks;
  around.pci_busy_clocks = counters.pci.busy_clocks;
  for (const pci::PciBusControl::MasterStats& master : counters.pci.masters) {
    around.pci_masters.push_back({master.name, master.transactions, master.words, master.wait_clocks});
  }
  around.posted_words = counters.bridge.posted_words;
  around.dma_words = counters.bridge.dma_words;
  around.local_clocks = counters.local_bus.clocks;
  around.local_busy_clocks = counters.local_bus.busy_clocks;
  around.cameras = {camera_statistics("left", counters.cameras[0]),
                    camera_statistics("right", counters.cameras[1])};
  derive_delivery_figures(deliveries, allocation_period_frames(config), statistics);
  add_uncounted_work(config, counters, statistics);
  derive_energy(config, statistics);
  Bound of_turns = core_bound(config, accesses);
  add_system_bound(config, accesses, true, of_turns);
  statistics.bound.system = of_turns.system;
  statistics.bound.system_limited_by = of_turns.system_limited_by;
  if (whole_pictures)
    statistics.frames_per_second.proven =
        proven_rate(config, accesses, statistics.frame_cycles, *of_turns.system);

  Audit audit;
  audit.equal("frames delivered", deliveries.size(), "frames of the core", statistics.frames);
  audit_words(config, counters.words, audit);
  audit_energy(statistics, audit);
  audit_host_port(counters, audit);
  audit_computer(around, audit);
  audit_captures(around, counters, audit);
  audit_rates(config, accesses, whole_pictures, statistics, audit);
  for (const std::string& failed : audit.failed()) statistics.failed.push_back(failed);
  return statistics;
}

}  // namespace stereotlm::platform

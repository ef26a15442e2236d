#include "platform/collect_computer.h"

#include <algorithm>
#include <string>
#include <utility>

#include "platform/audit.h"
#include "platform/bounds.h"
#include "platform/computer_parts.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures.h"

namespace stereotlm::platform {
namespace {

// A frame that begins just when the run ends counts as dropped (not armed), because no capture has taken it.
CameraStatistics camera_statistics(const char* name, const ComputerCounters::Camera& camera) {
  const capture::CaptureControl::Stats& capture = camera.capture;
  CameraStatistics statistics;
  statistics.name = name;
  statistics.frames = camera.frames;
  statistics.captured_frames = capture.started_frames;
  statistics.dropped_not_armed = capture.dropped_not_armed + std::uint64_t{camera.undecided};
  statistics.dropped_busy = capture.dropped_busy;
  statistics.dropped_by_partner = capture.dropped_by_partner;
  statistics.dropped_frames =
      statistics.dropped_not_armed + statistics.dropped_busy + statistics.dropped_by_partner;
  statistics.dropped_pixels = capture.dropped_pixels;
  return statistics;
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
    grants += bank.uncounted_grants + bank.arbiter.grants[fpga::kHostPort];
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

// The frames from power-up need not be whole turns of the lists. Their rate is compared with the bounds of just
// these frames.
void audit_rates(const BoardConfig& config, const FrameAccesses& accesses, bool whole_pictures,
                 const Statistics& statistics, Audit& audit) {
  constexpr double kRoundingFactor = 1 + 1e-9;  // rates are rounded quotients
  const std::vector<ResourceBound> turn = turn_bounds(config, accesses);
  std::uint64_t cycles = 0;
  for (std::uint64_t frame = 0; frame < statistics.frames; ++frame)
    cycles += turn[frame % turn.size()].cycles;
  const double frames = static_cast<double>(statistics.frames);
  double bound = config.fpga.clock_mhz * 1e6 * frames / static_cast<double>(cycles);
  for (const RateBound& part : computer_bounds(config, accesses, whole_pictures, statistics.frames))
    bound = std::min(bound, part.frames_per_second);
  const FramesPerSecond& rate = statistics.frames_per_second;
  audit.at_most("frames_per_second.system", *rate.system, "the bound of these frames",
                bound * kRoundingFactor);
  if (!rate.steady) return;
  audit.at_most("frames_per_second.steady - steady_uncertainty",
                rate.steady->frames_per_second - rate.steady->uncertainty, "bound.system",
                *statistics.bound.system * kRoundingFactor);
}

}  // namespace

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
  add_system_bound(config, accesses, whole_pictures, statistics.bound);

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

  Audit audit;
  audit.equal("frames delivered", deliveries.size(), "frames of the core", statistics.frames);
  audit_words(config, counters.words, audit);
  audit_host_port(counters, audit);
  audit_computer(around, audit);
  audit_captures(around, counters, audit);
  audit_rates(config, accesses, whole_pictures, statistics, audit);
  for (std::string& failed : std::move(audit).failed()) statistics.failed.push_back(std::move(failed));
  return statistics;
}

}  // namespace stereotlm::platform

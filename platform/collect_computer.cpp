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

constexpr double kPsPerSecond = 1e12;
constexpr double kPsPerMs = 1e9;

double seconds(std::uint64_t ps) { return static_cast<double>(ps) / kPsPerSecond; }

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

// Percentiles by nearest rank, in milliseconds.
Percentiles percentiles(std::vector<std::uint64_t> values_ps) {
  std::sort(values_ps.begin(), values_ps.end());
  const auto rank = [&values_ps](std::size_t percent) {
    const std::size_t place = (values_ps.size() * percent + 99) / 100;
    return static_cast<double>(values_ps[std::max<std::size_t>(place, 1) - 1]) / kPsPerMs;
  };
  return {rank(0), rank(50), rank(95), rank(99), rank(100)};
}

std::uint64_t latency_ps(const Delivery& delivery) { return delivery.host_ps - delivery.capture_ps; }

// `turn`: L of SteadyRate.
std::optional<SteadyRate> steady_rate(const std::vector<Delivery>& deliveries, std::uint64_t turn) {
  if (deliveries.size() < 2 * turn) return std::nullopt;
  SteadyRate steady;
  steady.frames = (deliveries.size() - turn) / turn * turn;
  const auto before = deliveries.end() - 1 - static_cast<std::ptrdiff_t>(steady.frames);
  const auto [least, greatest] =
      std::minmax_element(before, deliveries.end(),
                          [](const Delivery& a, const Delivery& b) { return latency_ps(a) < latency_ps(b); });
  const std::uint64_t window_ps = deliveries.back().host_ps - before->host_ps;
  steady.frames_per_second = static_cast<double>(steady.frames) / seconds(window_ps);
  steady.uncertainty = steady.frames_per_second *
                       static_cast<double>(latency_ps(*greatest) - latency_ps(*least)) /
                       static_cast<double>(window_ps);
  return steady;
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
  for (const RateBound& part : computer_bounds(config, whole_pictures))
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

void derive_delivery_figures(const BoardConfig& config, const std::vector<Delivery>& deliveries,
                             Statistics& statistics) {
  statistics.frames_per_second.system =
      static_cast<double>(deliveries.size()) / seconds(deliveries.back().host_ps);
  statistics.frames_per_second.steady = steady_rate(deliveries, allocation_period_frames(config));
  std::vector<std::uint64_t> latencies_ps;
  latencies_ps.reserve(deliveries.size());
  for (const Delivery& delivery : deliveries) latencies_ps.push_back(latency_ps(delivery));
  statistics.computer->capture_to_host_ms = percentiles(std::move(latencies_ps));
}

Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const std::string& fidelity,
                              const std::vector<std::uint64_t>& frame_cycles,
                              const ComputerCounters& counters, const std::vector<Delivery>& deliveries) {
  Statistics statistics = collect_statistics(config, tables, fidelity, frame_cycles, counters.board);
  const bool whole_pictures =
      counters.cameras[0].capture.dropped_pixels + counters.cameras[1].capture.dropped_pixels == 0;
  add_system_bound(config, whole_pictures, statistics.bound);

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
  derive_delivery_figures(config, deliveries, statistics);

  Audit audit;
  audit.equal("frames delivered", deliveries.size(), "frames of the core", statistics.frames);
  audit_words(config, counters.words, audit);
  audit_host_port(counters, audit);
  audit_computer(around, audit);
  audit_captures(around, counters, audit);
  audit_rates(config, frame_accesses(config, tables), whole_pictures, statistics, audit);
  for (std::string& failed : std::move(audit).failed()) statistics.failed.push_back(std::move(failed));
  return statistics;
}

}  // namespace stereotlm::platform

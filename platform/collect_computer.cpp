#include "platform/collect_computer.h"

#include <algorithm>
#include <string>
#include <utility>

#include "platform/audit.h"
#include "platform/bounds.h"
#include "platform/computer_parts.h"
#include "platform/config/buffer_layout.h"

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

void audit_cameras(const ComputerStatistics& computer, const ComputerCounters& counters, Audit& audit) {
  for (const CameraStatistics& camera : computer.cameras) {
    audit.equal("camera " + camera.name + ": frames", camera.frames, "captured and dropped",
                camera.captured_frames + camera.dropped_frames);
  }
  for (std::size_t side = 0; side < computer.cameras.size(); ++side) {
    const std::size_t master = side == 0 ? kLeftCapture : kRightCapture;
    audit.equal("camera " + computer.cameras[side].name + ": words written",
                counters.cameras[side].capture.words, "words of its PCI master",
                counters.pci.masters[master].words);
  }
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
  Statistics statistics = collect_statistics(config, tables, fidelity, frame_cycles, counters.board);
  const double delivered = static_cast<double>(deliveries.size());
  const Delivery& first = deliveries.front();
  const Delivery& last = deliveries.back();
  statistics.frames_per_second.system = delivered / seconds(last.host_ps);
  if (deliveries.size() > 1)
    statistics.frames_per_second.steady = (delivered - 1) / seconds(last.host_ps - first.host_ps);
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
  std::vector<std::uint64_t> latencies_ps;
  latencies_ps.reserve(deliveries.size());
  for (const Delivery& delivery : deliveries) latencies_ps.push_back(delivery.host_ps - delivery.capture_ps);
  around.capture_to_host_ms = percentiles(std::move(latencies_ps));

  Audit audit;
  audit.equal("frames delivered", deliveries.size(), "frames of the core", statistics.frames);
  audit_words(config, counters.words, audit);
  audit_host_port(counters, audit);
  audit_cameras(around, counters, audit);
  audit.at_most("frames_per_second.system", *statistics.frames_per_second.system, "bound.system",
                *statistics.bound.system);
  for (std::string& failed : std::move(audit).failed()) statistics.failed.push_back(std::move(failed));
  return statistics;
}

}  // namespace stereotlm::platform

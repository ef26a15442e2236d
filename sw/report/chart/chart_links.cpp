#include "sw/report/chart/chart_links.h"

#include <cstddef>
#include <cstdint>

#include "models/capture/camera_timing.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/derived_figures.h"

namespace stereotlm::report {
namespace {

constexpr double kBytesPerWord = 4;

// `words` in the time of `clocks` clocks of `mhz`.
double rate_of(std::uint64_t words, std::uint64_t clocks, double mhz) {
  return clocks == 0 ? 0 : kBytesPerWord * static_cast<double>(words) * mhz / static_cast<double>(clocks);
}

std::vector<ChartLink> links_around(const ChartView& view) {
  const platform::BoardConfig& board = view.board;
  const auto run = view.run == nullptr ? platform::ComputerStatistics() : *view.run->computer;
  const auto words = [&run](const std::string& master) {
    std::uint64_t sum = 0;
    for (const platform::PciMasterStatistics& each : run.pci_masters)
      sum += each.name == master ? each.words : 0;
    return sum;
  };
  const auto on_pci = [&](std::uint64_t moved) {
    return rate_of(moved, run.pci_clocks, board.pci.clock_mhz);
  };
  const double camera =
      capture::CameraTiming::peak_pixels_per_second(
          {board.image.width, board.image.height, board.cameras.frame_rate_hz, board.cameras.trigger}) /
      1e6;
  const double pci = kBytesPerWord * board.pci.clock_mhz * board.pci.width_bits / 32;
  const double local = kBytesPerWord * board.bridge.local_clock_mhz;
  const bool to_host = board.capture.destination == platform::CaptureDestination::kHostMemory;
  const std::uint64_t of_ring = to_host ? words("left_capture") + words("right_capture") : 0;
  const double at_board =
      rate_of(run.posted_words + run.dma_words, run.local_clocks, board.bridge.local_clock_mhz);
  std::vector<ChartLink> links = {
      {"part-left_camera", "part-left_capture", true, false, camera, on_pci(words("left_capture"))},
      {"part-right_camera", "part-right_capture", true, false, camera, on_pci(words("right_capture"))},
      {"part-left_capture", "part-pci", true, false, pci, on_pci(words("left_capture"))},
      {"part-right_capture", "part-pci", true, false, pci, on_pci(words("right_capture"))},
      {"part-cpu", "part-pci", true, true, pci, on_pci(words("host"))},
      {"part-pci", "part-host_memory", true, true, pci, on_pci(words("bridge") + of_ring)}};
  if (board.pci.load) links.push_back({"part-load", "part-pci", true, true, pci, on_pci(words("load"))});
  links.push_back({"part-pci", "part-bridge", true, false, pci, on_pci(run.posted_words)});
  links.push_back({"part-bridge", "part-pci", true, true, pci, on_pci(words("bridge"))});
  links.push_back({"part-bridge", "part-local_bus", true, true, local, at_board});
  links.push_back({"part-local_bus", "port-host", true, true, local, at_board});
  return links;
}

}  // namespace

std::string ChartLink::id() const { return "edge-" + name_of_block(from) + "-" + name_of_block(to); }

std::string name_of_block(const std::string& id) { return id.substr(id.find('-') + 1); }

std::vector<ChartLink> chart_links(const ChartView& view) {
  const platform::BoardConfig& board = view.board;
  const double peak = kBytesPerWord * board.fpga.clock_mhz;
  const auto rate = [&](std::uint64_t accesses) {
    return rate_of(accesses, view.run->cycles, board.fpga.clock_mhz);
  };
  const fpga::CorePorts ports = platform::core_ports(board);
  const auto accesses = view.run == nullptr ? std::vector<std::vector<std::uint64_t>>()
                                            : platform::core_accesses(board, *view.run);
  const auto accesses_of = [&](std::size_t group, std::size_t bank) {
    std::uint64_t sum = 0;
    for (std::size_t port = 0; port < accesses.size(); ++port)
      sum += group == ports.group_of(port) || group == fpga::kHostGroup ? accesses[port][bank] : 0;
    return sum;
  };
  std::vector<ChartLink> links;
  if (view.in_computer) links = links_around(view);
  for (std::size_t group = 0; group < fpga::kGroupCount; ++group) {
    const bool is_host = group == fpga::kHostGroup;
    if (is_host && !view.in_computer) continue;
    for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
      const std::string& name = board.banks[bank].name;
      ChartLink link{std::string("port-") + fpga::kPortGroups[group].name, "bank-" + name, false, false,
                     peak};
      // The host writes pictures and tables, and reads results; the ports of the core do the opposite.
      for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
        const bool is_result = buffer.buffer == platform::Buffer::kDisparity;
        if (buffer.bank == name &&
            (is_host || fpga::kPortGroups[group].buffer == std::string(platform::name_of(buffer.buffer))))
          (is_result == is_host ? link.back : link.there) = true;
      }
      if (!link.there && !link.back) continue;
      if (view.run != nullptr) {
        const std::uint64_t of_core = accesses_of(group, bank);
        link.rate =
            rate(is_host ? view.run->banks[bank].reads + view.run->banks[bank].writes - of_core : of_core);
      }
      links.push_back(link);
    }
  }
  return links;
}

}  // namespace stereotlm::report

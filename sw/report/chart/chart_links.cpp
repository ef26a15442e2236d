#include "sw/report/chart/chart_links.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "models/capture/camera_timing.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures.h"
#include "sw/report/chart/chart_text.h"
#include "sw/stats/console_table.h"

namespace stereotlm::report {
namespace {

using platform::BoardConfig;
using platform::Buffer;

constexpr double kBytesPerWord = 4;

void add_parts_around(const BoardConfig& board, std::vector<ChartLink>& links) {
  const double camera =
      capture::CameraTiming::peak_pixels_per_second(
          {board.image.width, board.image.height, board.cameras.frame_rate_hz, board.cameras.trigger}) /
      1e6;
  const double pci = kBytesPerWord * board.pci.clock_mhz * board.pci.width_bits / 32;
  const double local = kBytesPerWord * board.bridge.local_clock_mhz;
  links.push_back({"part-left_camera", "part-left_capture", true, false, camera});
  links.push_back({"part-right_camera", "part-right_capture", true, false, camera});
  links.push_back({"part-left_capture", "part-pci", true, false, pci});
  links.push_back({"part-right_capture", "part-pci", true, false, pci});
  links.push_back({"part-cpu", "part-pci", true, true, pci});
  links.push_back({"part-pci", "part-host_memory", true, true, pci});
  if (board.pci.load) links.push_back({"part-load", "part-pci", true, true, pci});
  links.push_back({"part-pci", "part-bridge", true, false, pci});
  links.push_back({"part-bridge", "part-pci", true, true, pci});
  links.push_back({"part-bridge", "part-local_bus", true, true, local});
  links.push_back({"part-local_bus", "port-host", true, true, local});
}

// The host writes pictures and tables, and reads results.
void add_host_port(const BoardConfig& board, std::vector<ChartLink>& links) {
  for (const platform::BankConfig& bank : board.banks) {
    ChartLink link{"port-host", "bank-" + bank.name, false, false, kBytesPerWord * board.fpga.clock_mhz};
    for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
      if (buffer.bank == bank.name) (buffer.buffer == Buffer::kDisparity ? link.back : link.there) = true;
    }
    if (link.there || link.back) links.push_back(link);
  }
}

using platform::Statistics;

// `words` in the time of `clocks` clocks of `mhz`.
double rate(std::uint64_t words, std::uint64_t clocks, double mhz) {
  return clocks == 0 ? 0 : 4.0 * static_cast<double>(words) * mhz / static_cast<double>(clocks);
}

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

class TrafficReader {
 public:
  TrafficReader(const platform::BoardConfig& board, const Statistics& stats) : board_(board), stats_(stats) {}

  ChartTraffic read() {
    if (stats_.computer) traffic_.extent = ChartExtent::kComputer;
    read_ports();
    if (stats_.computer) read_parts_around(*stats_.computer);
    const std::string& resource =
        stats_.computer ? stats_.bound.system_limited_by : stats_.bound.core_limited_by;
    if (!resource.empty()) add_limit(resource);
    read_summary();
    return std::move(traffic_);
  }

 private:
  void set(const std::string& from, const std::string& to, double megabytes_per_second) {
    traffic_.megabytes_per_second[ChartLink{from, to}.id()] = megabytes_per_second;
  }

  double core_rate(std::uint64_t words) const { return rate(words, stats_.cycles, board_.fpga.clock_mhz); }

  // The links of the ports, and what the banks and the ports do. The host has the accesses of a bank that no
  // other port makes.
  void read_ports() {
    for (const platform::PortStatistics& port : stats_.ports)
      traffic_.waits_percent["port-" + port.name] = percent(port.stall_cycles, stats_.cycles);
    const auto accesses = platform::core_accesses(board_, stats_);
    std::map<std::string, double> rates;
    for (std::size_t index = 0; index < stats_.banks.size(); ++index) {
      const platform::BankStatistics& bank = stats_.banks[index];
      traffic_.busy_percent["bank-" + bank.name] = 100 * bank.utilization;
      std::uint64_t of_host = bank.reads + bank.writes;
      for (std::size_t port = 0; port < accesses.size(); ++port) {
        of_host -= accesses[port][index];
        rates[ChartLink{"port-" + stats_.ports[port].name, "bank-" + bank.name}.id()] =
            core_rate(accesses[port][index]);
      }
      rates[ChartLink{"port-host", "bank-" + bank.name}.id()] = core_rate(of_host);
    }
    for (const ChartLink& link : chart_links(board_, traffic_.extent)) {
      if (const auto found = rates.find(link.id()); found != rates.end())
        traffic_.megabytes_per_second.insert(*found);
    }
  }

  void read_parts_around(const platform::ComputerStatistics& computer) {
    const auto words = [&](const std::string& name) {
      for (const platform::PciMasterStatistics& master : computer.pci_masters) {
        if (master.name == name) return master.words;
      }
      return std::uint64_t{0};
    };
    const auto on_pci = [&](std::uint64_t moved) {
      return rate(moved, computer.pci_clocks, board_.pci.clock_mhz);
    };
    for (const char* side : {"left", "right"}) {
      const std::string board = fmt::format("{}_capture", side);
      const double captured = on_pci(words(board));
      set(fmt::format("part-{}_camera", side), "part-" + board, captured);
      set("part-" + board, "part-pci", captured);
    }
    const bool to_host = board_.capture.destination == platform::CaptureDestination::kHostMemory;
    const std::uint64_t captured = to_host ? words("left_capture") + words("right_capture") : 0;
    set("part-cpu", "part-pci", on_pci(words("host")));
    set("part-pci", "part-host_memory", on_pci(words("bridge") + captured));
    if (board_.pci.load) set("part-load", "part-pci", on_pci(words("load")));
    traffic_.busy_percent["part-pci"] = percent(computer.pci_busy_clocks, computer.pci_clocks);

    set("part-pci", "part-bridge", on_pci(computer.posted_words));
    set("part-bridge", "part-pci", on_pci(words("bridge")));
    const double local = rate(computer.posted_words + computer.dma_words, computer.local_clocks,
                              board_.bridge.local_clock_mhz);
    set("part-bridge", "part-local_bus", local);
    set("part-local_bus", "port-host", local);
    traffic_.busy_percent["part-local_bus"] = percent(computer.local_busy_clocks, computer.local_clocks);
  }

  void add_limit(const std::string& resource) {
    const auto begins = [&resource](const std::string& word) {
      return resource.compare(0, word.size(), word) == 0;
    };
    if (resource == "camera") {
      traffic_.limiting.insert({"part-left_camera", "part-right_camera"});
    } else if (begins("bank ") || begins("port ")) {
      traffic_.limiting.insert(resource.substr(0, 4) + "-" + resource.substr(5));
    } else {
      traffic_.limiting.insert((resource == "matcher" ? "stage-" : "part-") + resource);
    }
  }

  void read_summary() {
    const platform::FramesPerSecond& rates = stats_.frames_per_second;
    const platform::Bound& bound = stats_.bound;
    std::string text = rate_text(rates.core) + " frames/s, core only";
    if (rates.system) text = rate_text(*rates.system) + " frames/s, from power-up";
    if (rates.steady) {
      text = fmt::format("{} frames/s, steady; {} from power-up", rate_text(rates.steady->frames_per_second),
                         rate_text(*rates.system));
    }
    traffic_.summary = {fmt::format("{}; {} frame{}", text, stats_.frames, stats_.frames == 1 ? "" : "s")};
    traffic_.summary.push_back(
        fmt::format("bound {} frames/s, set by {}", rate_text(bound.system.value_or(bound.core)),
                    stats::resource_words(bound.system ? bound.system_limited_by : bound.core_limited_by)));
  }

  const platform::BoardConfig& board_;
  const Statistics& stats_;
  ChartTraffic traffic_;
};

}  // namespace

std::string ChartLink::id() const { return "edge-" + name_of_block(from) + "-" + name_of_block(to); }

std::string name_of_block(const std::string& id) { return id.substr(id.find('-') + 1); }

std::vector<std::string> banks_of(const BoardConfig& board, const fpga::CorePort& port) {
  std::vector<std::string> banks;
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
    if (std::string(platform::name_of(buffer.buffer)) == port.buffer) banks.push_back(buffer.bank);
  }
  return banks;
}

std::vector<ChartLink> chart_links(const BoardConfig& board, ChartExtent extent) {
  std::vector<ChartLink> links;
  if (extent == ChartExtent::kComputer) add_parts_around(board, links);
  for (const fpga::CorePort& port : fpga::kPorts) {
    const std::vector<std::string> used = banks_of(board, port);
    for (const platform::BankConfig& bank : board.banks) {
      if (std::find(used.begin(), used.end(), bank.name) == used.end()) continue;
      links.push_back({std::string("port-") + port.name, "bank-" + bank.name, port.write, !port.write,
                       kBytesPerWord * board.fpga.clock_mhz});
    }
  }
  if (extent == ChartExtent::kComputer) add_host_port(board, links);
  return links;
}

ChartTraffic chart_traffic(const platform::BoardConfig& board, const Statistics& statistics) {
  return TrafficReader(board, statistics).read();
}

}  // namespace stereotlm::report

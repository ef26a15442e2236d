#include "sw/report/chart/chart_contents.h"

#include <fmt/format.h>

#include <algorithm>

#include "platform/config/board_keys.h"
#include "platform/config/buffer_layout.h"
#include "sw/report/chart/chart_text.h"

namespace stereotlm::report {
namespace {

using platform::BoardConfig;

// "512K", "2M", "307,200".
std::string count_text(std::uint64_t count) {
  constexpr std::uint64_t kKilo = 1024;
  if (count > 0 && count % (kKilo * kKilo) == 0) return fmt::format("{}M", count / (kKilo * kKilo));
  if (count > 0 && count % kKilo == 0) return fmt::format("{}K", count / kKilo);
  return grouped(count);
}

std::string busy_text(const ChartTraffic* traffic, const std::string& block) {
  return traffic == nullptr ? "" : fmt::format(", busy {} %", measured(traffic->busy_percent.at(block)));
}

}  // namespace

BankLines bank_lines(const BoardConfig& board, const platform::BankConfig& bank,
                     const ChartTraffic* traffic) {
  BankLines lines;
  lines.words = static_cast<std::uint64_t>(bank.words);
  std::uint64_t used = 0;
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
    if (buffer.bank != bank.name) continue;
    const std::uint64_t words = platform::buffer_words(buffer, board.image);
    const bool is_joint = board.fpga.joint_tables && buffer.buffer == platform::Buffer::kLeftLut;
    const auto port =
        std::find_if(fpga::kPorts.begin(), fpga::kPorts.end(), [&buffer](const fpga::CorePort& each) {
          return std::string(platform::name_of(buffer.buffer)) == each.buffer;
        });
    lines.buffers.push_back({is_joint ? "left_lut, right_lut" : buffer.label(), port->name, words});
    used += words;
  }
  const memory::BankTraits& traits = memory::traits_of(bank.kind);
  lines.size = fmt::format("{} of {} words", grouped(used), count_text(lines.words));
  lines.kind = traits.name;
  if (traits.has_turnaround) lines.kind += fmt::format(", {} lost", bank.turnaround_cycles);
  lines.bandwidth = short_number(4 * traits.ports * board.fpga.clock_mhz) + " MB/s";
  if (traffic == nullptr) return lines;
  lines.busy_percent = traffic->busy_percent.at("bank-" + bank.name);
  double sum = 0;
  for (const ChartLink& link : chart_links(board, traffic->extent)) {
    if (link.to == "bank-" + bank.name) sum += traffic->megabytes_per_second.at(link.id());
  }
  lines.bandwidth = fmt::format("{} of {}", measured(sum), lines.bandwidth);
  return lines;
}

std::vector<std::string> ports_from_top(const BoardConfig& board, ChartExtent extent) {
  std::vector<std::string> order = {"host", "left_lut", "left_pixel", "right_pixel", "right_lut", "result"};
  if (board.fpga.joint_tables) order = {"host", "left_pixel", "left_lut", "right_pixel", "result"};
  const auto is_missing = [&](const std::string& name) {
    if (name == fpga::kPorts[fpga::kHostPort].name) return extent == ChartExtent::kBoard;
    return std::none_of(fpga::kPorts.begin(), fpga::kPorts.end(), [&](const fpga::CorePort& port) {
      return port.name == name && !banks_of(board, port).empty();
    });
  };
  order.erase(std::remove_if(order.begin(), order.end(), is_missing), order.end());
  return order;
}

ChartLines port_lines(const BoardConfig& board, const std::string& port, const ChartTraffic* traffic) {
  const bool has_cache = board.fpga.pixel_cache == fpga::PixelCache::kWord;
  const std::string table = board.fpga.joint_tables ? "table of both sides" : "rectification table";
  const std::string pixels = has_cache ? "pixels, word cache" : "pixels";
  ChartLines lines = {port, port == "host"                           ? "from the local bus"
                            : port == "result"                       ? "disparities"
                            : port.find("_lut") != std::string::npos ? table
                                                                     : pixels};
  if (traffic == nullptr) return lines;
  const double waits = traffic->waits_percent.at("port-" + port);
  lines.push_back(waits == 0 ? "never waits" : fmt::format("waits {} %", measured(waits)));
  return lines;
}

ChartLines lane_lines(const BoardConfig& board, const std::string& side) {
  const platform::MatcherConfig& matcher = board.matcher;
  const int slots = board.fpga.lane_fifo_slots;
  ChartLines lines = {side + " lane", fmt::format("{} slot{}", slots, slots == 1 ? "" : "s")};
  if (matcher.filter) lines.push_back(fmt::format("filter {0}x{0}", matcher.filter->size));
  if (matcher.cost.kind == kernels::CostKind::kCensus)
    lines.push_back(fmt::format("census {0}x{0}", matcher.cost.census_size));
  if (matcher.fetch == fpga::Fetch::kLineBuffer) lines.emplace_back("line buffer");
  return lines;
}

ChartLines matcher_lines(const BoardConfig& board) {
  const platform::MatcherConfig& matcher = board.matcher;
  const int units = matcher.units.value_or(matcher.disparities);
  ChartLines lines = {"matcher",
                      fmt::format("{0} {1}x{1}", kernels::name_of(matcher.cost.kind), matcher.window),
                      fmt::format("{} disparities", matcher.disparities), fmt::format("{} modules", units)};
  const int passes = fpga::passes_of(matcher.disparities, units);
  if (passes > 1) lines.push_back(fmt::format("{} passes", passes));
  if (matcher.rows > 1) lines.push_back(fmt::format("{} rows at once", matcher.rows));
  return lines;
}

ChartLines lr_check_lines(const BoardConfig& board) {
  const std::optional<int>& tolerance = board.matcher.lr_tolerance;
  return {"L-R check", tolerance ? fmt::format("tolerance {}", *tolerance) : "off"};
}

ChartLines result_queue_lines(const BoardConfig& board) {
  const int words = board.fpga.result_fifo_words;
  return {"result queue", fmt::format("{} word{}", words, words == 1 ? "" : "s")};
}

std::string fpga_line(const BoardConfig& board) {
  return fmt::format("FPGA {}: {} MHz", board.fpga.device, board.fpga.clock_mhz);
}

ChartLines arbitration_lines(const BoardConfig& board) {
  std::vector<std::string> names;
  for (const memory::Port port : board.fpga.arbiter.priority) names.emplace_back(fpga::kPorts[port].name);
  return {"each bank: " + board.fpga.arbiter.policy, fmt::format("{}", fmt::join(names, ", "))};
}

ChartLines camera_lines(const BoardConfig& board, const std::string& side) {
  const bool is_free = board.cameras.trigger == platform::CameraTrigger::kFreeRunning;
  return {side + " camera", fmt::format("{}x{}", board.image.width, board.image.height),
          fmt::format("{} Hz", board.cameras.frame_rate_hz), is_free ? "free running" : "on demand"};
}

ChartLines capture_lines(const BoardConfig& board, const std::string& side) {
  const platform::CaptureConfig& capture = board.capture;
  return {side + " capture", fmt::format("FIFO {} words", capture.fifo_words),
          fmt::format("request at {}", capture.fifo_trigger_words)};
}

ChartLines cpu_lines() { return {"host CPU", "runs the driver"}; }

ChartLines host_memory_lines(const BoardConfig& board) {
  ChartLines lines = {"host memory", "tables, results"};
  if (board.capture.destination == platform::CaptureDestination::kHostMemory) {
    const int pairs = board.capture.host_frames;
    lines.push_back(fmt::format("ring: {} pair{}", pairs, pairs == 1 ? "" : "s"));
  }
  return lines;
}

ChartLines load_lines(const BoardConfig& board) {
  const platform::PciLoadConfig& load = board.pci.load.value();
  ChartLines lines = {"PCI load", fmt::format("{} words", load.burst_words)};
  lines.push_back(load.interval_us > 0 ? fmt::format("every {} us", load.interval_us) : "at once again");
  return lines;
}

ChartLines bridge_lines(const BoardConfig& board) {
  return {"PCI bridge", fmt::format("{} posted words", board.bridge.posted_words),
          fmt::format("2 DMA channels, bursts of {}", board.bridge.dma_burst_words)};
}

std::string pci_line(const BoardConfig& board, const ChartTraffic* traffic) {
  return fmt::format("PCI bus: {} bit, {} MHz, {} MB/s{}", board.pci.width_bits, board.pci.clock_mhz,
                     short_number(board.pci.clock_mhz * board.pci.width_bits / 8),
                     busy_text(traffic, "part-pci"));
}

ChartLines local_bus_lines(const BoardConfig& board, const ChartTraffic* traffic) {
  return {"local bus", fmt::format("32 bit, {} MHz{}", board.bridge.local_clock_mhz,
                                   busy_text(traffic, "part-local_bus"))};
}

ChartLines subtitle_lines(const BoardConfig& board, ChartExtent extent, const ChartTraffic* traffic) {
  const std::size_t banks = board.banks.size();
  ChartLines lines = {fmt::format("{0}x{1}, window {2}x{2}, {3} disparities, {4} bank{5}", board.image.width,
                                  board.image.height, board.matcher.window, board.matcher.disparities, banks,
                                  banks == 1 ? "" : "s")};
  if (extent == ChartExtent::kBoard) lines.front() += "; pictures, tables and results move in no time";
  if (traffic != nullptr) lines.insert(lines.end(), traffic->summary.begin(), traffic->summary.end());
  return lines;
}

ChartLines legend_lines(ChartExtent extent, const ChartTraffic* traffic) {
  if (traffic == nullptr) return {"Numbers at the links: peak MB/s (million bytes/s)"};
  ChartLines lines = {"Links: MB/s (million bytes/s), width by MB/s",
                      "Bars of a bank: % of cycles busy; words of buffers",
                      "Colour: % of the peak of a link, % busy of a bank"};
  lines.emplace_back("No number: nothing was moved");
  lines.emplace_back("Thick outline: sets the bound of the frame rate");
  lines.emplace_back(extent == ChartExtent::kBoard ? "While the core works on a frame"
                                                   : "Banks, ports: while the core works on a frame");
  if (extent == ChartExtent::kComputer) lines.emplace_back("Buses, captures: since power-up");
  return lines;
}

}  // namespace stereotlm::report

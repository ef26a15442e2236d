#include "sw/report/chart/chart_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "platform/config/board_keys.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::report {
namespace {

constexpr std::string_view kEllipsis = "\u2026";

// Advance widths of the characters from space to '~', in thousandths of the font size.
using Widths = std::array<std::uint16_t, 95>;
constexpr Widths kRegular = {318,  401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337,
                             636,  636, 636, 636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531,
                             1000, 684, 686, 698, 770, 632, 575, 775, 752, 295, 295, 656, 557, 863, 748, 787,
                             603,  787, 695, 635, 611, 732, 684, 989, 685, 611, 685, 390, 337, 390, 838, 500,
                             500,  613, 635, 550, 635, 615, 352, 635, 634, 278, 278, 579, 278, 974, 634, 612,
                             635,  635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838};
constexpr Widths kBold = {348,  456, 521, 838, 696, 1002, 872, 306,  457, 457, 523, 838, 380, 415,  380, 365,
                          696,  696, 696, 696, 696, 696,  696, 696,  696, 696, 400, 400, 838, 838,  838, 580,
                          1000, 774, 762, 734, 830, 683,  683, 821,  837, 372, 372, 775, 637, 995,  837, 850,
                          733,  850, 770, 720, 682, 812,  774, 1103, 771, 724, 725, 457, 365, 457,  838, 500,
                          500,  675, 716, 593, 716, 678,  435, 716,  712, 343, 343, 665, 343, 1042, 712, 687,
                          716,  716, 493, 595, 478, 712,  652, 924,  645, 652, 582, 712, 365, 712,  838};
constexpr double kOtherWidth = 1.25;  // of all other characters, in font sizes: that of an emoji

// The characters of a UTF-8 text, each with its bytes.
std::vector<std::string_view> characters(std::string_view text) {
  std::vector<std::string_view> all;
  while (!text.empty()) {
    std::size_t length = 1;
    while (length < text.size() && (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80) ++length;
    all.push_back(text.substr(0, length));
    text.remove_prefix(length);
  }
  return all;
}

double width_of(std::string_view character, bool bold) {
  const char letter = character.front();
  if (letter < ' ' || letter > '~') return kOtherWidth;
  return (bold ? kBold : kRegular)[static_cast<std::size_t>(letter - ' ')] / 1000.0;
}

using platform::BoardConfig;

// "512K", "2M", "307,200".
std::string count_text(std::uint64_t count) {
  constexpr std::uint64_t kKilo = 1024;
  if (count > 0 && count % (kKilo * kKilo) == 0) return fmt::format("{}M", count / (kKilo * kKilo));
  if (count > 0 && count % kKilo == 0) return fmt::format("{}K", count / kKilo);
  return grouped(count);
}

// "1 word", "2 words".
std::string count_of(int count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string busy_text(const ChartTraffic* traffic, const std::string& block) {
  return traffic == nullptr ? "" : fmt::format(", busy {} %", measured(traffic->busy_percent.at(block)));
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
  ChartLines lines = {side + " lane", count_of(board.fpga.lane_fifo_slots, "slot")};
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

void add_parts(const BoardConfig& board, const ChartTraffic* traffic,
               std::map<std::string, ChartLines>& lines) {
  const bool is_free = board.cameras.trigger == platform::CameraTrigger::kFreeRunning;
  for (const std::string side : {"left", "right"}) {
    lines["part-" + side + "_camera"] = {
        side + " camera", fmt::format("{}x{}", board.image.width, board.image.height),
        fmt::format("{} Hz", board.cameras.frame_rate_hz), is_free ? "free running" : "on demand"};
    lines["part-" + side + "_capture"] = {side + " capture",
                                          fmt::format("FIFO {} words", board.capture.fifo_words),
                                          fmt::format("request at {}", board.capture.fifo_trigger_words)};
  }
  lines["part-cpu"] = {"host CPU", "runs the driver"};
  ChartLines& memory = lines["part-host_memory"] = {"host memory", "tables, results"};
  if (board.capture.destination == platform::CaptureDestination::kHostMemory)
    memory.push_back("ring: " + count_of(board.capture.host_frames, "pair"));
  if (const auto& load = board.pci.load) {
    lines["part-load"] = {
        "PCI load", fmt::format("{} words", load->burst_words),
        load->interval_us > 0 ? fmt::format("every {} us", load->interval_us) : "at once again"};
  }
  lines["part-bridge"] = {"PCI bridge", fmt::format("{} posted words", board.bridge.posted_words),
                          fmt::format("2 DMA channels, bursts of {}", board.bridge.dma_burst_words)};
  lines["part-pci"] = {fmt::format(
      "PCI bus: {} bit, {} MHz, {} MB/s{}", board.pci.width_bits, board.pci.clock_mhz,
      short_number(board.pci.clock_mhz * board.pci.width_bits / 8), busy_text(traffic, "part-pci"))};
  lines["part-local_bus"] = {"local bus", fmt::format("32 bit, {} MHz{}", board.bridge.local_clock_mhz,
                                                      busy_text(traffic, "part-local_bus"))};
}

}  // namespace

double text_width(std::string_view text, double size, bool bold) {
  double width = 0;
  for (const std::string_view character : characters(text)) width += width_of(character, bold);
  return width * size;
}

std::string fitted(const std::string& text, double size, bool bold, double width) {
  if (text_width(text, size, bold) <= width) return text;
  const std::vector<std::string_view> all = characters(text);
  std::string begin;
  std::string end;
  double free = width - kOtherWidth * size;
  for (std::size_t taken = 0; taken < all.size(); ++taken) {
    const bool at_begin = taken % 2 == 0;
    const std::string_view next = at_begin ? all[taken / 2] : all[all.size() - 1 - taken / 2];
    free -= width_of(next, bold) * size;
    if (free < 0) break;
    if (at_begin) {
      begin += next;
    } else {
      end.insert(0, next);
    }
  }
  return begin + std::string(kEllipsis) + end;
}

std::string xml_text(std::string_view text) {
  std::string result;
  for (const std::string_view character : characters(text)) {
    const bool is_noncharacter = character == "\uFFFE" || character == "\uFFFF";
    const std::string_view escaped = character == "&"    ? "&amp;"
                                     : character == "<"  ? "&lt;"
                                     : character == ">"  ? "&gt;"
                                     : character == "\"" ? "&quot;"
                                     : character == "'"  ? "&#39;"
                                                         : character;
    result += is_noncharacter ? "\uFFFD" : escaped;
  }
  return result;
}

std::string short_number(double value) {
  if (value > 0 && value < 0.005) return "<0.01";
  std::string text = fmt::format("{:.2f}", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string measured(double value) {
  if (value == 0) return "0";
  return value < 0.05 ? "<0.1" : fmt::format("{:.1f}", value);
}

std::string rate_text(double frames_per_second) {
  return fmt::format("{:.{}f}", frames_per_second, frames_per_second < 100 ? 2 : 1);
}

std::string grouped(std::uint64_t count) {
  std::string text = std::to_string(count);
  if (count < 10000) return text;
  for (std::size_t place = text.size() - 3; place > 0; place -= std::min<std::size_t>(place, 3))
    text.insert(place, ",");
  return text;
}

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

std::map<std::string, ChartLines> block_lines(const BoardConfig& board, ChartExtent extent,
                                              const ChartTraffic* traffic) {
  std::map<std::string, ChartLines> lines;
  for (const std::string& port : ports_from_top(board, extent))
    lines["port-" + port] = port_lines(board, port, traffic);
  for (const std::string side : {"left", "right"}) lines["stage-" + side + "_lane"] = lane_lines(board, side);
  lines["stage-matcher"] = matcher_lines(board);
  const std::optional<int>& tolerance = board.matcher.lr_tolerance;
  lines["stage-lr_check"] = {"L-R check", tolerance ? fmt::format("tolerance {}", *tolerance) : "off"};
  lines["stage-result_queue"] = {"result queue", count_of(board.fpga.result_fifo_words, "word")};
  if (extent == ChartExtent::kComputer) add_parts(board, traffic, lines);
  return lines;
}

std::string fpga_line(const BoardConfig& board) {
  return fmt::format("FPGA {}: {} MHz", board.fpga.device, board.fpga.clock_mhz);
}

ChartLines arbitration_lines(const BoardConfig& board) {
  std::vector<std::string> names;
  for (const memory::Port port : board.fpga.arbiter.priority) names.emplace_back(fpga::kPorts[port].name);
  return {"each bank: " + board.fpga.arbiter.policy, fmt::format("{}", fmt::join(names, ", "))};
}

ChartLines subtitle_lines(const BoardConfig& board, ChartExtent extent, const ChartTraffic* traffic) {
  ChartLines lines = {fmt::format("{0}x{1}, window {2}x{2}, {3} disparities, {4}", board.image.width,
                                  board.image.height, board.matcher.window, board.matcher.disparities,
                                  count_of(static_cast<int>(board.banks.size()), "bank"))};
  if (extent == ChartExtent::kBoard) lines.front() += "; pictures, tables and results move in no time";
  if (traffic != nullptr) lines.insert(lines.end(), traffic->summary.begin(), traffic->summary.end());
  return lines;
}

ChartLines legend_lines(ChartExtent extent, const ChartTraffic* traffic) {
  if (traffic == nullptr) return {"Numbers at the links: peak MB/s (million bytes/s)"};
  ChartLines lines = {"Links: MB/s (million bytes/s), width by MB/s",
                      "Bars of a bank: % of cycles busy; words of buffers",
                      "Colour: % of the peak of a link, % busy of a bank", "No number: nothing was moved",
                      "Thick outline: sets the bound of the frame rate"};
  if (extent == ChartExtent::kBoard) {
    lines.emplace_back("While the core works on a frame");
  } else {
    lines.insert(lines.end(),
                 {"Banks, ports: while the core works on a frame", "Buses, captures: since power-up"});
  }
  return lines;
}

}  // namespace stereotlm::report

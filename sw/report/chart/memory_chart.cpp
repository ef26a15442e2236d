#include "sw/report/chart/memory_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "platform/config/board_keys.h"
#include "platform/config/buffer_layout.h"
#include "sw/report/chart/chart_text.h"
#include "sw/stats/console_table.h"

// Lengths are in pixels, y grows downwards. Colours are names of kColors.
namespace stereotlm::report {
namespace {

using platform::BoardConfig;
using platform::Statistics;

struct Color {
  const char* name;  // of the CSS variable: --mc-NAME
  const char* light;
  const char* dark;
};
constexpr std::array kColors = {
    Color{"page", "#ffffff", "#0d1117"},     Color{"ink", "#1f2328", "#e6edf3"},
    Color{"faint", "#59636e", "#9aa4af"},    Color{"line", "#59636e", "#9aa4af"},
    Color{"frame", "#afb8c1", "#4a535e"},    Color{"memory", "#f1ebfb", "#2c2440"},
    Color{"logic", "#ddf4ff", "#12324f"},    Color{"bus", "#e6eaef", "#2b323b"},
    Color{"computer", "#dafbe1", "#173d24"}, Color{"free", "#ffffff", "#0d1117"},
    Color{"used", "#8b96a1", "#7d8792"},     Color{"load0", "#b3bcc5", "#59636e"},
    Color{"load1", "#86b6dd", "#3d74a8"},    Color{"load2", "#2f7fc1", "#5aa5e6"},
    Color{"load3", "#e08a1e", "#e8a33d"},    Color{"load4", "#c4302b", "#ff6b5e"},
};
constexpr std::array<double, 4> kLoadSteps = {1, 25, 50, 90};  // % of the peak, where load1 to load4 begin

struct Style {
  double size;
  bool bold;
  const char* color;
};
constexpr Style kNote = {11, false, "faint"};
constexpr Style kPlain = {11, false, "ink"};
constexpr Style kName = {13, true, "ink"};
constexpr Style kHeading = {18, true, "ink"};
constexpr double kNameStep = 16;  // from a name to the line below it
constexpr double kNoteStep = 14;

constexpr double kMargin = 16;
constexpr double kPadding = 7;  // in a block, above and below its text
constexpr double kThinEdge = 1.5;
constexpr double kWidestEdge = 12;
constexpr double kShortEdge = 36;    // length of an edge between blocks that stand one above the other
constexpr double kBetweenEdges = 1;  // of one port, side by side
constexpr double kHalo = 1;          // on each side of an edge, where it crosses another

constexpr double kBankWidth = 256;
constexpr double kBankRight = kMargin + kBankWidth;
constexpr double kBankPadding = 9;  // at both sides
constexpr double kBusyWidth = 146;  // of "busy 100.0 %, 100.0 % mJ"
constexpr double kBetweenBanks = 10;
constexpr double kLabelHeight = kNote.size * kLetterHeight;
constexpr double kLabelFromBank = 18;
constexpr double kBendsFromBank = 70;  // where the edges of banks begin to bend
constexpr double kBendWidth = 150;

constexpr double kPortWidth = 128;
constexpr double kBetweenPorts = 22;
constexpr double kFpgaPadding = 14;
constexpr double kFpgaTitle = 32;
constexpr double kFpgaFoot = 20 + 2 * kNoteStep;
constexpr double kLaneWidth = 112;
constexpr double kMatcherWidth = 120;
constexpr double kCheckWidth = 112;
constexpr double kBetweenStages = 28;
constexpr double kFpgaWidth =
    2 * kFpgaPadding + kPortWidth + kLaneWidth + kMatcherWidth + kCheckWidth + 3 * kBetweenStages;

constexpr double kBetweenParts = 14;
constexpr double kBusHeight = 26;
constexpr double kBridgeWidth = 232;

struct Point {
  double x = 0;
  double y = 0;
};

struct Box {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;

  double right() const { return x + width; }
  double bottom() const { return y + height; }
  double middle_x() const { return x + width / 2; }
  double middle_y() const { return y + height / 2; }
};

// A length: at most two decimals.
double px(double value) { return std::round(value * 100) / 100 + 0.0; }

// The class and, for viewers without CSS variables, the attribute.
std::string paint(const std::string& property, const std::string& name) {
  const auto* const color =
      std::find_if(kColors.begin(), kColors.end(), [&name](const Color& each) { return each.name == name; });
  return fmt::format(" class=\"{0}-{1}\" {0}=\"{2}\"", property, name, color->light);
}

std::string rect_element(const Box& box, double radius, const std::string& paints) {
  return fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{}\"{}/>\n", px(box.x),
                     px(box.y), px(box.width), px(box.height), radius, paints);
}

// The frame of a box, which covers nothing.
std::string frame_element(const Box& box, double radius, const std::string& color, double width) {
  return rect_element(box, radius,
                      paint("stroke", color) + fmt::format(" fill=\"none\" stroke-width=\"{}\"", width));
}

// A line of text, cut to this width. `x`: of its `anchor`: start, middle or end.
std::string text_element(const std::string& text, const Style& style, double x, double y, double width,
                         const char* anchor = "start") {
  constexpr double kBaseline = 0.93;  // below the top of the line, in font sizes
  return fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\"{}{}>{}</text>\n", px(x),
                     px(y + kBaseline * style.size), style.size, anchor,
                     style.bold ? " font-weight=\"bold\"" : "", paint("fill", style.color),
                     xml_text(fitted(text, style.size, style.bold, width)));
}

std::string title_element(const std::string& text) { return "<title>" + xml_text(text) + "</title>\n"; }

// A way of horizontal and vertical pieces, and of bends between horizontal ones.
std::string line_element(const std::vector<Point>& way, double width, const std::string& color) {
  std::string text = fmt::format("M{} {}", px(way.front().x), px(way.front().y));
  for (std::size_t i = 1; i < way.size(); ++i) {
    const auto& [x, y] = way[i];
    const double middle = px((way[i - 1].x + x) / 2);
    text += way[i - 1].x == x || way[i - 1].y == y
                ? fmt::format(" L{} {}", px(x), px(y))
                : fmt::format(" C{0} {1} {0} {3} {2} {3}", middle, px(way[i - 1].y), px(x), px(y));
  }
  return fmt::format("<path d=\"{}\" stroke-width=\"{}\" fill=\"none\" stroke-linejoin=\"round\"{}/>\n", text,
                     px(width), paint("stroke", color));
}

// The tip at the end of a way, which is made shorter by it.
std::string tip_element(std::vector<Point>& way, double width, const std::string& color) {
  const double length = 6.5 + width / 3;
  const double half = 3 + width / 2;  // of its width
  const Point end = way.back();
  const Point before = way[way.size() - 2];
  const double whole = std::abs(end.x - before.x) + std::abs(end.y - before.y);
  const Point along{(end.x - before.x) / whole, (end.y - before.y) / whole};
  const Point foot{end.x - length * along.x, end.y - length * along.y};
  way.back() = {foot.x + along.x, foot.y + along.y};
  return fmt::format("<path d=\"M{} {} L{} {} L{} {} z\"{}/>\n", px(end.x), px(end.y),
                     px(foot.x - half * along.y), px(foot.y + half * along.x), px(foot.x + half * along.y),
                     px(foot.y - half * along.x), paint("fill", color));
}

std::string arrow_element(std::vector<Point> way, bool there, bool back, double width,
                          const std::string& color) {
  std::string tips;
  if (there) tips += tip_element(way, width, color);
  std::reverse(way.begin(), way.end());
  if (back) tips += tip_element(way, width, color);
  return line_element(way, width, color) + tips;
}

// The straight way between two boxes, from the middle of the smaller one, or `beside` it.
std::vector<Point> way_between(const Box& from, const Box& to, double beside = 0) {
  if (from.right() <= to.x || to.right() <= from.x) {
    const double y = (from.height < to.height ? from : to).middle_y();
    return {{from.x < to.x ? from.right() : from.x, y}, {from.x < to.x ? to.x : to.right(), y}};
  }
  const double x = (from.width < to.width ? from : to).middle_x() + beside;
  return {{x, from.y < to.y ? from.bottom() : from.y}, {x, from.y < to.y ? to.y : to.bottom()}};
}

std::string colors_css(const char* Color::*theme) {
  std::string text;
  for (const Color& each : kColors) text += fmt::format(" --mc-{}: {};", each.name, each.*theme);
  return text;
}

// Viewers without CSS variables ignore the style, and use the attributes. A page forces a theme by the class
// `light` or `dark` on the chart.
std::string style_element() {
  const std::string dark = colors_css(&Color::dark);
  std::string text =
      "<style>\n@supports (color: var(--mc-ink)) {\n.memory-chart {" + colors_css(&Color::light) + " }\n";
  text += "@media (prefers-color-scheme: dark) { .memory-chart:not(.light) {" + dark + " } }\n";
  text += "@media print { .memory-chart:not(.dark) {" + colors_css(&Color::light) + " } }\n";
  text += ".memory-chart.dark {" + dark + " }\n";
  for (const Color& each : kColors) {
    for (const char* property : {"fill", "stroke"})
      text += fmt::format(".memory-chart .{0}-{1} {{ {0}: var(--mc-{1}) }}\n", property, each.name);
  }
  return text + "}\n</style>\n";
}

// "1 word", "2 words".
std::string count_of(int count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

// The lines of text in a block; the first one is its name.
using Lines = std::vector<std::string>;

Lines lane_lines(const BoardConfig& board, const std::string& side) {
  const platform::MatcherConfig& matcher = board.matcher;
  Lines lines = {side + " lane", count_of(board.fpga.lane_fifo_slots, "slot")};
  if (matcher.filter) lines.push_back(fmt::format("filter {0}x{0}", matcher.filter->size));
  if (matcher.cost.kind == kernels::CostKind::kCensus)
    lines.push_back(fmt::format("census {0}x{0}", matcher.cost.census_size));
  if (matcher.fetch == fpga::Fetch::kLineBuffer) lines.emplace_back("line buffer");
  return lines;
}

Lines matcher_lines(const BoardConfig& board) {
  const platform::MatcherConfig& matcher = board.matcher;
  const int units = matcher.units.value_or(matcher.disparities);
  Lines lines = {"matcher", fmt::format("{0} {1}x{1}", kernels::name_of(matcher.cost.kind), matcher.window),
                 fmt::format("{} disparities", matcher.disparities), fmt::format("{} modules", units)};
  const int folds = fpga::folds_of(matcher.disparities, units);
  if (folds > 1) lines.push_back(fmt::format("{} folds", folds));
  if (matcher.rows > 1) lines.push_back(fmt::format("{} rows at once", matcher.rows));
  return lines;
}

void add_core(const BoardConfig& board, const Statistics* run, std::map<std::string, Lines>& lines) {
  const bool has_cache = board.fpga.pixel_cache == fpga::PixelCache::kWord;
  const std::string table = board.fpga.joint_tables ? "table of both sides" : "rectification table";
  const std::string pixels = has_cache ? "pixels, word cache" : "pixels";
  const fpga::CorePorts ports = platform::core_ports(board);
  for (std::size_t group = 0; group < fpga::kGroupCount; ++group) {
    const std::string name = fpga::kPortGroups[group].name;
    const bool is_lut = fpga::kPortGroups[group].stage == fpga::PortStage::kLutReader;
    const bool has_lanes = ports.lanes() > 1 && group < fpga::kResultGroup;
    Lines& its = lines["port-" + name] = {name, name == "host"     ? "from the local bus"
                                                : name == "result" ? "disparities"
                                                                   : (is_lut ? table : pixels)};
    if (has_lanes) its.push_back(count_of(board.fpga.lanes, "lane"));
    if (run == nullptr) continue;
    std::uint64_t stalls = 0;
    for (memory::Port port = 0; port < ports.size(); ++port)
      stalls += ports.group_of(port) == group ? run->ports[port].stall_cycles : 0;
    const std::uint64_t cycles = run->cycles * (has_lanes ? ports.lanes() : 1);
    its.push_back(stalls == 0 ? "never waits" : fmt::format("waits {} %", measured(percent(stalls, cycles))));
  }
  for (const std::string side : {"left", "right"}) lines["stage-" + side + "_lane"] = lane_lines(board, side);
  lines["stage-matcher"] = matcher_lines(board);
  const std::optional<int>& tolerance = board.matcher.lr_tolerance;
  lines["stage-lr_check"] = {"L-R check", tolerance ? fmt::format("tolerance {}", *tolerance) : "off"};
  lines["stage-result_queue"] = {"result queue", count_of(board.fpga.result_fifo_words, "word")};
}

void add_parts(const BoardConfig& board, const Statistics* run, std::map<std::string, Lines>& lines) {
  const auto busy = [run](std::uint64_t busy_clocks, std::uint64_t clocks) {
    return run == nullptr ? "" : fmt::format(", busy {} %", measured(percent(busy_clocks, clocks)));
  };
  const auto around = run == nullptr ? platform::ComputerStatistics() : *run->computer;
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
  Lines& memory = lines["part-host_memory"] = {"host memory", "tables, results"};
  if (board.capture.destination == platform::CaptureDestination::kHostMemory)
    memory.push_back("ring: " + count_of(board.capture.host_frames, "pair"));
  if (const auto& load = board.pci.load) {
    lines["part-load"] = {
        "PCI load", fmt::format("{} words", load->burst_words),
        load->interval_us > 0 ? fmt::format("every {} us", load->interval_us) : "at once again"};
  }
  lines["part-bridge"] = {"PCI bridge", fmt::format("{} posted words", board.bridge.posted_words),
                          fmt::format("2 DMA channels, bursts of {}", board.bridge.dma_burst_words)};
  lines["part-pci"] = {fmt::format("PCI bus: {} bit, {} MHz, {} MB/s{}", board.pci.width_bits,
                                   board.pci.clock_mhz,
                                   short_number(board.pci.clock_mhz * board.pci.width_bits / 8),
                                   busy(around.pci_busy_clocks, around.pci_clocks))};
  lines["part-local_bus"] = {"local bus", fmt::format("32 bit, {} MHz{}", board.bridge.local_clock_mhz,
                                                      busy(around.local_busy_clocks, around.local_clocks))};
}

// Below the name of the board.
Lines subtitle_of(const ChartView& view) {
  const BoardConfig& board = view.board;
  Lines lines = {fmt::format("{0}x{1}, window {2}x{2}, {3} disparities, {4}", board.image.width,
                             board.image.height, board.matcher.window, board.matcher.disparities,
                             count_of(static_cast<int>(board.banks.size()), "bank"))};
  if (!view.in_computer) lines.front() += "; pictures, tables and results move in no time";
  if (view.run == nullptr) return lines;
  const platform::FramesPerSecond& rates = view.run->frames_per_second;
  const platform::Bound& bound = view.run->bound;
  std::string text = rate_text(rates.core) + " frames/s, core only";
  if (rates.system) text = rate_text(*rates.system) + " frames/s, from power-up";
  if (rates.steady) {
    text = fmt::format("{} frames/s, steady; {} from power-up", rate_text(rates.steady->frames_per_second),
                       rate_text(*rates.system));
  }
  text += stats::rate_remark(0, 0, platform::lost_pixels(*view.run));
  lines.push_back(fmt::format("{}; {}", text, count_of(static_cast<int>(view.run->frames), "frame")));
  const platform::EnergyStatistics& energy = view.run->energy;
  lines.push_back(fmt::format("{} mJ and {} MB a frame, {} mW: {}", measured(energy.memory_mj_per_frame),
                              measured(energy.megabytes_per_frame), measured(energy.memory_mw),
                              platform::kEnergyIsOf));
  lines.push_back(
      fmt::format("bound {} frames/s{}, set by {}", rate_text(bound.system.value_or(bound.core)),
                  stats::whole_text(*view.run),
                  stats::resource_words(bound.system ? bound.system_limited_by : bound.core_limited_by)));
  return lines;
}

// What the numbers mean.
Lines legend_of(const ChartView& view) {
  if (view.run == nullptr) return {"Numbers at the links: peak MB/s (million bytes/s)"};
  Lines lines = {"Links: MB/s (million bytes/s), width by MB/s",
                 "Bars of a bank: % of cycles busy; words of buffers; % mJ: of all banks",
                 "Colour: % of the peak of a link, % busy of a bank", "No number: nothing was moved",
                 "Thick outline: sets the bound of the frame rate"};
  if (!view.in_computer) {
    lines.emplace_back("While the core works on a frame");
  } else {
    lines.insert(lines.end(),
                 {"Banks, ports: while the core works on a frame", "Buses, captures: since power-up"});
  }
  return lines;
}

// The ids of the blocks that set the bound of the rate.
std::set<std::string> limiting_blocks(const ChartView& view) {
  if (view.run == nullptr) return {};
  const platform::Bound& bound = view.run->bound;
  const std::string& resource = view.in_computer ? bound.system_limited_by : bound.core_limited_by;
  const std::string kind = resource.substr(0, 5);
  if (resource == "camera") return {"part-left_camera", "part-right_camera"};
  if (kind == "bank " || kind == "port ") return {kind.substr(0, 4) + "-" + resource.substr(5)};
  return {(resource == "matcher" ? "stage-" : "part-") + resource};
}

// "512K", "2M", "307,200".
std::string words_text(std::uint64_t count) {
  constexpr std::uint64_t kKilo = 1024;
  if (count > 0 && count % (kKilo * kKilo) == 0) return fmt::format("{}M", count / (kKilo * kKilo));
  if (count > 0 && count % kKilo == 0) return fmt::format("{}K", count / kKilo);
  return grouped(count);
}

class Chart {
 public:
  explicit Chart(const ChartView& view)
      : view_(view), board_(view.board), run_(view.run), limiting_(limiting_blocks(view)) {
    add_core(board_, run_, lines_);
    if (view.in_computer) add_parts(board_, run_, lines_);
    make_edges();
    measure_banks();
  }

  std::string svg() {
    const double width = fpga_.right() - kMargin;
    blocks_ += text_element(board_.name, kHeading, kMargin, kMargin, width);
    const double top = draw_notes(subtitle_of(view_), kMargin, kMargin + 24, width) + 12;
    fpga_.y = view_.in_computer ? draw_computer(top) : top;
    place_ports();
    place_banks(top);
    for (const Bank& bank : banks_) draw_bank(bank);
    draw_core();
    connect_parts();
    if (!view_.in_computer) draw_legend({fpga_.x, fpga_.bottom() + 12});
    const double height = std::max({legend_bottom_, fpga_.bottom(), banks_.back().box.bottom()}) + kMargin;
    const Box page{0, 0, fpga_.right() + kMargin, height};
    return fmt::format(
               "{2} class=\"memory-chart\" role=\"img\" width=\"{0}\" height=\"{1}\" "
               "viewBox=\"0 0 {0} {1}\"\n font-family=\"system-ui, -apple-system, 'Segoe UI', "
               "Helvetica, Arial, sans-serif\">\n",
               px(page.width), px(page.height), kChartMark) +
           title_element("Memory chart of " + board_.name) + style_element() +
           rect_element(page, 0, paint("fill", "page")) + frame_element(fpga_, 8, "frame", 1) + flows_ +
           edge_elements() + blocks_ + "</svg>\n";
  }

 private:
  struct Edge {
    ChartLink link;
    double width = kThinEdge;
    std::string color = "line";
    std::string label;
    std::string title;
    std::vector<Point> way;  // from link.from to link.to
  };
  struct Held {  // a buffer in a bank
    std::string label;
    std::string key;   // in a board file: allocation.left_image[0]
    std::string port;  // that accesses it
    std::uint64_t words = 0;
    double y = 0;  // of its line, below the top of the bank
  };
  struct Bank {
    std::string name;
    std::vector<Held> buffers;                   // those of one port follow each other
    std::vector<std::pair<Edge*, double>> ends;  // and where they leave the bank, below its top
    Box box;
  };

  void make_edges() {
    const std::vector<ChartLink> links = chart_links(view_);
    double most = 0;
    for (const ChartLink& link : links) most = std::max(most, link.peak);
    for (const ChartLink& link : links) {
      Edge edge;
      edge.link = link;
      const std::string from = name_of_block(link.from);
      const std::string to = name_of_block(link.to);
      const bool is_to_bank = link.to.compare(0, 5, "bank-") == 0;
      const std::string ends = fmt::format("{} - {}", from, is_to_bank ? platform::bank_text(to) : to);
      edge.label = short_number(link.peak);
      edge.title = fmt::format("{}: peak {} MB/s", ends, edge.label);
      if (run_ != nullptr) {
        edge.width = std::max(1.0, kWidestEdge * link.rate / most);
        edge.color = load_colour(link.rate, link.peak);
        edge.title = fmt::format("{}: {} of {} MB/s ({} %)", ends, measured(link.rate), edge.label,
                                 measured(100 * link.rate / link.peak));
        edge.label = link.rate == 0 ? "" : measured(link.rate);
      }
      edges_.push_back(std::move(edge));
    }
  }

  double height_of(const std::string& block) const {
    return 2 * kPadding + kNameStep + kNoteStep * static_cast<double>(lines_.at(block).size() - 1);
  }

  // A link leaves a bank at the buffers that it carries. The link of the host, which carries all, leaves at
  // its name. The distances of the buffers leave room for the links.
  void measure_banks() {
    for (const platform::BankConfig& config : board_.banks) {
      Bank bank;
      bank.name = config.name;
      for (const platform::PlacedBuffer& buffer : platform::buffers(board_)) {
        if (buffer.bank != bank.name) continue;
        const bool is_joint = board_.fpga.joint_tables && buffer.buffer == platform::Buffer::kLeftLut;
        for (const fpga::PortGroup& port : fpga::kPortGroups) {
          if (port.buffer != std::string(platform::name_of(buffer.buffer))) continue;
          bank.buffers.push_back({is_joint ? "left_lut, right_lut" : buffer.label(), buffer.path(), port.name,
                                  platform::buffer_words(buffer, board_.image)});
        }
      }
      leave(bank, "host", kPadding + kNameStep / 2);
      double y = kPadding + kNameStep + (run_ == nullptr ? 1 : 2) * kNoteStep + 10;
      std::string port;
      for (Held& buffer : bank.buffers) {
        if (buffer.port != port) y = leave(bank, buffer.port, y + kNoteStep / 2) - kNoteStep / 2;
        port = buffer.port;
        buffer.y = y;
        y += kNoteStep;
      }
      bank.box = {kMargin, 0, kBankWidth, y + (bank.buffers.empty() ? kNoteStep : 0) + kPadding};
      banks_.push_back(std::move(bank));
    }
  }

  // Lets the link of the port leave the bank at `y` below its top, or lower if the link above and the label
  // between them need the room. Returns where.
  double leave(Bank& bank, const std::string& port, double y) {
    for (Edge& edge : edges_) {
      if (edge.link.from != "port-" + port || edge.link.to != "bank-" + bank.name) continue;
      if (!bank.ends.empty()) {
        const auto& [above, above_y] = bank.ends.back();
        y = std::max(y, above_y + (above->width + edge.width) / 2 + kLabelHeight + 8);
      }
      bank.ends.emplace_back(&edge, y);
    }
    return y;
  }

  // Places the ports that exist one below the other: the tables beside the pixel ports that they serve. The
  // links of a port begin side by side, in the order of the banks.
  void place_ports() {
    Lines names = {"host", "left_lut", "left_pixel", "right_pixel", "right_lut", "result"};
    if (board_.fpga.joint_tables) names = {"host", "left_pixel", "left_lut", "right_pixel", "result"};
    double y = fpga_.y + kFpgaTitle;
    for (const std::string& name : names) {
      const std::string id = "port-" + name;
      std::vector<Edge*> edges;
      double bundle = 0;
      for (Edge& edge : edges_) {
        if (edge.link.from != id) continue;
        edges.push_back(&edge);
        bundle += edge.width + kBetweenEdges;
      }
      if (edges.empty()) continue;
      const bool is_pixel = name == "left_pixel" || name == "right_pixel";
      const double lane = is_pixel ? height_of("stage-" + name.substr(0, name.find('_')) + "_lane") : 0;
      const Box box{fpga_.x + kFpgaPadding, y, kPortWidth, std::max({height_of(id), bundle + 12, lane})};
      double end = box.middle_y() - bundle / 2;
      for (Edge* const edge : edges) {
        end += edge->width / 2;
        edge->way = {{box.x, end}, {fpga_.x, end}};
        end += edge->width / 2 + kBetweenEdges;
      }
      ports_.push_back(id);
      boxes_[id] = box;
      y = box.bottom() + kBetweenPorts;
    }
    fpga_.height = y - kBetweenPorts + kFpgaFoot - fpga_.y;
  }

  // As low as the ports, unless they need more room. Their links go straight out of the bank, below their
  // label, then in a bend.
  void place_banks(double top) {
    double height = -kBetweenBanks;
    for (const Bank& bank : banks_) height += bank.box.height + kBetweenBanks;
    double y = std::max(top + kNameStep + 4, fpga_.bottom() - height);
    blocks_ += text_element(fmt::format("SSRAM: {} MHz, one access a cycle", board_.fpga.clock_mhz), kNote,
                            kMargin, y - kNameStep - 4, kBankWidth);
    for (Bank& bank : banks_) {
      bank.box.y = y;
      for (const auto& [edge, end] : bank.ends)
        edge->way.insert(edge->way.end(), {{kBankRight + kBendsFromBank, y + end}, {kBankRight, y + end}});
      y = bank.box.bottom() + kBetweenBanks;
    }
  }

  // Opens the group of a block, and draws its box.
  void open_block(const std::string& id, const std::string& title, const Box& box, const std::string& fill) {
    const bool limits = limiting_.count(id) > 0;
    blocks_ += fmt::format("<g id=\"{}\" class=\"block{}\">\n", xml_text(id), limits ? " limits" : "") +
               title_element(title) + rect_element(box, 4, paint("fill", fill)) +
               frame_element(box, 4, limits ? "ink" : "line", limits ? 3 : 1);
  }

  // Notes one below the other. Returns where the next one begins.
  double draw_notes(const Lines& lines, double x, double y, double width) {
    for (const std::string& line : lines) {
      blocks_ += text_element(line, kNote, x, y, width);
      y += kNoteStep;
    }
    return y;
  }

  // A line of a bank: a text at each of its ends. The left one is cut to the room that the right one leaves.
  void draw_bank_line(const Box& bank, double y, const std::string& left, const Style& style,
                      const std::string& right) {
    const double width = bank.width - 2 * kBankPadding;
    blocks_ +=
        text_element(left, style, bank.x + kBankPadding, y,
                     width - text_width(right, kNote.size, kNote.bold) - 8) +
        text_element(right, kNote, bank.right() - kBankPadding, y + style.size - kNote.size, width, "end");
  }

  void draw_bank(const Bank& bank) {
    const auto index = static_cast<std::size_t>(&bank - banks_.data());
    const platform::BankConfig& config = board_.banks[index];
    const memory::BankTraits& traits = memory::traits_of(config.kind);
    const auto all_words = static_cast<std::uint64_t>(config.words);
    const std::string name = platform::bank_text(bank.name);
    std::uint64_t used = 0;
    std::string held;
    for (const Held& buffer : bank.buffers) {
      used += buffer.words;
      held += fmt::format("\n{}: {} words", buffer.label, grouped(buffer.words));
    }
    const std::string size = fmt::format("{} of {} words", grouped(used), words_text(all_words));
    std::string kind = traits.name;
    if (traits.has_turnaround) kind += fmt::format(", {} lost", config.turnaround_cycles);
    std::string rate = short_number(4 * traits.ports * board_.fpga.clock_mhz) + " MB/s";
    if (run_ != nullptr)
      rate = fmt::format("{} of {}", measured(run_->banks[index].megabytes_per_second), rate);
    open_block("bank-" + bank.name, fmt::format("{}: {}\n{}, {}{}", name, rate, size, kind, held), bank.box,
               run_ == nullptr ? "memory" : "free");
    Box bar{bank.box.x + kBankPadding, bank.box.y + kPadding + kNameStep, bank.box.width - 2 * kBankPadding,
            6};
    if (run_ == nullptr) {
      draw_bank_line(bank.box, bank.box.y + kPadding, name, kName, rate);
    } else {
      const double busy = 100 * run_->banks[index].utilization;
      const std::string load = paint("fill", load_colour(busy, 100));
      const std::optional<platform::BankEnergyStatistics>& energy = run_->banks[index].energy;
      const std::string share = energy ? fmt::format(", {} % mJ", measured(energy->energy_percent)) : "";
      const Box shares{bar.x + kBusyWidth + 4, bar.y + 2.5, bar.width - kBusyWidth - 4, 8};
      blocks_ += rect_element(bank.box, 4, load + " fill-opacity=\"0.2\"");
      draw_bank_line(bank.box, bank.box.y + kPadding, name, kName, rate);
      blocks_ +=
          text_element(fmt::format("busy {} %{}", measured(busy), share), kNote, bar.x, bar.y, kBusyWidth) +
          rect_element(shares, 2, paint("fill", "free")) +
          rect_element({shares.x, shares.y, shares.width * busy / 100, 8}, 2, load) +
          frame_element(shares, 2, "line", 0.75);
      bar.y += kNoteStep;
    }
    draw_bank_line(bank.box, bar.y, size, kNote, kind);
    bar.y += kNoteStep + 2;
    blocks_ += rect_element(bar, 2, paint("fill", "free"));
    Box part = bar;
    for (const Held& buffer : bank.buffers) {
      part.width = bar.width * static_cast<double>(buffer.words) / static_cast<double>(all_words);
      blocks_ += rect_element(part, 0, paint("fill", "used")) + frame_element(part, 0, "memory", 1);
      blocks_ += fmt::format("<g class=\"buffer\" data-key=\"{}\">\n", xml_text(buffer.key));
      draw_bank_line(bank.box, bank.box.y + buffer.y, buffer.label, kPlain, grouped(buffer.words));
      blocks_ += "</g>\n";
      part.x = part.right();
    }
    if (bank.buffers.empty()) blocks_ += text_element("no buffer", kNote, bar.x, bar.y + 8, bar.width);
    blocks_ += frame_element(bar, 2, "line", 0.75) + "</g>\n";
  }

  // A block with its lines in its middle.
  void draw_block(const std::string& id, const Box& box, const std::string& fill = "logic") {
    const Lines& lines = lines_.at(id);
    boxes_[id] = box;
    open_block(id, fmt::format("{}", fmt::join(lines, "\n")), box, fill);
    double y = box.middle_y() - height_of(id) / 2 + kPadding;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      blocks_ += text_element(lines[i], i == 0 ? kName : kNote, box.middle_x(), y, box.width - 8, "middle");
      y += i == 0 ? kNameStep : kNoteStep;
    }
    blocks_ += "</g>\n";
  }

  // A block of the height of its lines.
  void draw_stage(const std::string& id, double x, double middle_y, double width) {
    draw_block(id, {x, middle_y - height_of(id) / 2, width, height_of(id)});
  }

  // Blocks of equal size beside each other.
  void draw_row(const Lines& ids, Box box, const std::string& fill) {
    for (const std::string& id : ids) {
      draw_block(id, box, id == "part-host_memory" ? "memory" : fill);
      box.x = box.right() + kBetweenParts;
    }
  }

  // The way of pixels and results inside the FPGA. It carries no words of the memories.
  void draw_flow(const std::string& from, const std::string& to) {
    flows_ +=
        fmt::format("<g id=\"flow-{}-{}\" class=\"flow\">\n{}</g>\n", name_of_block(from), name_of_block(to),
                    arrow_element(way_between(boxes_.at(from), boxes_.at(to)), true, false, 1, "line"));
  }

  void draw_core() {
    for (const std::string& port : ports_) draw_block(port, boxes_.at(port));
    const double lane_x = fpga_.x + kFpgaPadding + kPortWidth + kBetweenStages;
    const double matcher_x = lane_x + kLaneWidth + kBetweenStages;
    const double check_x = matcher_x + kMatcherWidth + kBetweenStages;
    const Box& left = boxes_.at("port-left_pixel");
    const Box& right = boxes_.at("port-right_pixel");
    const Box matcher{matcher_x, left.y, kMatcherWidth,
                      std::max(right.bottom() - left.y, height_of("stage-matcher"))};
    draw_stage("stage-left_lane", lane_x, left.middle_y(), kLaneWidth);
    draw_stage("stage-right_lane", lane_x, right.middle_y(), kLaneWidth);
    draw_block("stage-matcher", matcher);
    draw_stage("stage-lr_check", check_x, matcher.middle_y(), kCheckWidth);
    draw_stage("stage-result_queue", check_x, boxes_.at("port-result").middle_y(), kCheckWidth);
    for (const std::string side : {"left", "right"}) {
      const std::string pixels = "port-" + side + "_pixel";
      const std::string lane = "stage-" + side + "_lane";
      const std::string table = board_.fpga.joint_tables ? "port-left_lut" : "port-" + side + "_lut";
      draw_flow(pixels, lane);
      draw_flow(lane, "stage-matcher");
      if (boxes_.count(table) > 0) draw_flow(table, pixels);
    }
    draw_flow("stage-matcher", "stage-lr_check");
    draw_flow("stage-lr_check", "stage-result_queue");
    draw_flow("stage-result_queue", "port-result");

    blocks_ += text_element(fmt::format("FPGA {}: {} MHz", board_.fpga.device, board_.fpga.clock_mhz), kName,
                            fpga_.right() - kFpgaPadding, fpga_.y + 7, kFpgaWidth / 2, "end");
    Lines priority;
    for (const memory::Port each : board_.fpga.arbiter.priority)
      priority.emplace_back(fpga::kPortGroups[each].name);
    draw_notes({"each bank: " + board_.fpga.arbiter.policy, fmt::format("{}", fmt::join(priority, ", "))},
               fpga_.x + kFpgaPadding, fpga_.bottom() - kFpgaFoot + 10, kFpgaWidth - 2 * kFpgaPadding);
  }

  // Draws what is around the board, above the FPGA. Returns where the FPGA begins.
  double draw_computer(double top) {
    // The parts at the PCI bus. None has more lines than the capture boards.
    Lines parts = {"part-left_capture", "part-right_capture", "part-cpu", "part-host_memory"};
    if (board_.pci.load) parts.emplace_back("part-load");
    const double left = fpga_.x;
    const auto count = static_cast<double>(parts.size());
    const double width = (kFpgaWidth - (count - 1) * kBetweenParts) / count;
    const Box camera{left, top, width, height_of("part-left_camera")};
    const Box part{left, camera.bottom() + kShortEdge, width, height_of("part-left_capture")};
    const Box pci{left, part.bottom() + kShortEdge, kFpgaWidth, kBusHeight};
    const Box bridge{left, pci.bottom() + kShortEdge, kBridgeWidth, height_of("part-bridge")};
    const Box local{left, bridge.bottom() + kShortEdge, kBridgeWidth, height_of("part-local_bus")};
    draw_row(parts, part, "computer");
    draw_row({"part-left_camera", "part-right_camera"}, camera, "computer");
    draw_block("part-pci", pci, "bus");
    draw_block("part-bridge", bridge, "computer");
    draw_block("part-local_bus", local, "bus");
    draw_legend({left + kBridgeWidth + 24, pci.bottom() + 14});
    return local.bottom() + kShortEdge;
  }

  // The links around the board. The two between PCI bus and bridge lie side by side.
  void connect_parts() {
    for (Edge& edge : edges_) {
      if (!edge.way.empty()) continue;  // that of a bank
      const std::string id = edge.link.id();
      const double beside = kBridgeWidth / 5;
      edge.way = way_between(boxes_.at(edge.link.from), boxes_.at(edge.link.to),
                             id == "edge-pci-bridge"   ? -beside
                             : id == "edge-bridge-pci" ? beside
                                                       : 0);
    }
  }

  void draw_legend(const Point& at) {
    double y = at.y;
    for (const std::string& line : legend_of(view_)) {
      y = draw_notes({line}, at.x, y, fpga_.right() - at.x);
      if (line.find("Colour") == std::string::npos) continue;
      constexpr double kSwatch = 56;
      for (std::size_t step = 0; step <= kLoadSteps.size(); ++step) {
        const double x = at.x + kSwatch * static_cast<double>(step);
        const std::string text = step == 0 ? fmt::format("below {}", kLoadSteps.front())
                                           : fmt::format("from {}", kLoadSteps[step - 1]);
        blocks_ += rect_element({x, y + 2, kSwatch - 4, 8}, 1, paint("fill", fmt::format("load{}", step))) +
                   text_element(text, kNote, x, y + 12, kSwatch - 4);
      }
      y += 15 + kNoteStep;
    }
    legend_bottom_ = y;
  }

  // The label of an edge: beside it, or on it where it leaves a bank.
  static std::string label_element(const Edge& edge) {
    const Point& begin = edge.way.front();
    const Point& end = edge.way.back();
    if (edge.label.empty()) return "";
    Point at{end.x + kLabelFromBank, end.y - edge.width / 2 - 1 - kLabelHeight};
    if (begin.x == end.x) {
      // That to the host ends inside the FPGA; its label is outside.
      const double middle = edge.link.to == "port-host" ? begin.y + kShortEdge / 2 : (begin.y + end.y) / 2;
      at = {end.x + std::max(edge.width / 2, 4.5) + 4, middle - kLabelHeight / 2};
    }
    return text_element(edge.label, kPlain, at.x, at.y, 100);
  }

  std::string edge_elements() const {
    std::string text;
    for (const Edge& edge : edges_) {
      const ChartLink& link = edge.link;
      const std::string rate = run_ == nullptr ? "" : fmt::format(" data-mbps=\"{}\"", link.rate);
      text += line_element(edge.way, edge.width + 2 * kHalo, "page") +
              fmt::format("<g id=\"{}\" class=\"edge\" data-from=\"{}\" data-to=\"{}\" data-peak=\"{}\"{}>\n",
                          xml_text(link.id()), xml_text(link.from), xml_text(link.to), link.peak, rate) +
              title_element(edge.title) +
              arrow_element(edge.way, link.there, link.back, edge.width, edge.color) + label_element(edge) +
              "</g>\n";
    }
    return text;
  }

  const ChartView& view_;
  const BoardConfig& board_;
  const Statistics* run_;
  std::set<std::string> limiting_;
  std::map<std::string, Lines> lines_;  // of each block but the banks, by its id
  std::map<std::string, Box> boxes_;    // of those that are placed
  std::vector<Edge> edges_;             // in the order of chart_links()
  std::vector<Bank> banks_;             // in the order of the board
  std::vector<std::string> ports_;      // their ids, from top to bottom
  Box fpga_{kBankRight + kBendsFromBank + kBendWidth, 0, kFpgaWidth, 0};
  double legend_bottom_ = 0;
  std::string flows_;  // SVG
  std::string blocks_;
};

}  // namespace

std::string load_colour(double load, double peak) {
  const auto steps = std::count_if(kLoadSteps.begin(), kLoadSteps.end(),
                                   [&](double percent) { return 100 * load >= percent * peak; });
  return fmt::format("load{}", steps);
}

std::string memory_chart_svg(const ChartView& view) { return Chart(view).svg(); }

}  // namespace stereotlm::report

#include "sw/report/chart/chart_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "sw/report/chart/chart_text.h"

namespace stereotlm::report {
namespace {

constexpr double kBetweenTracks = 10;
constexpr double kBetweenEdges = 1;  // that run side by side
constexpr double kClearance = 6;     // between edges of different ports, where there is room
constexpr double kPlayStep = 1.5;
constexpr long kBendCost = 2;  // in crossings: of an edge that does not run straight
constexpr long kNearCost = 5;

// An edge in the channel between the banks, on its left, and the ports, on its right. It runs from its bank
// to `track_x`, there up or down, and on to its port.
struct ChannelEdge {
  double bank_y = 0;
  double port_y = 0;
  double width = 0;
  double track_x = 0;  // result of route_channel()
};

// The edges of one port.
struct ChannelNet {
  std::vector<ChannelEdge> edges;
  double play = 0;      // the port's ends may be moved by so much, up or down
  bool spread = false;  // the edges run side by side, else on top of each other
};

bool is_between(double y, const ChannelEdge& edge) {
  return y > std::min(edge.bank_y, edge.port_y) && y < std::max(edge.bank_y, edge.port_y);
}

bool is_straight(const ChannelEdge& edge) { return edge.bank_y == edge.port_y; }

// Whether the horizontal pieces of the edges, at these heights, would be too near to each other.
bool touch(double y, double width, double other_y, double other_width) {
  return std::abs(y - other_y) < (width + other_width) / 2 + kClearance;
}

// Crossings of two nets if `left` has its tracks to the left of those of `right`. The pieces of `left` to its
// port pass the tracks of `right`, the pieces of `right` to its banks those of `left`.
long cost(const ChannelNet& left, const ChannelNet& right) {
  long sum = 0;
  for (const ChannelEdge& a : left.edges) {
    for (const ChannelEdge& b : right.edges) {
      sum += (is_between(b.bank_y, a) ? 1 : 0) + (is_between(a.port_y, b) ? 1 : 0);
      if (touch(a.port_y, a.width, b.bank_y, b.width)) sum += kNearCost;
    }
  }
  return sum;
}

// The order of the tracks from left to right, and its cost.
struct TrackOrder {
  std::vector<std::size_t> nets;
  long cost = std::numeric_limits<long>::max();
};

TrackOrder best_order(const std::vector<ChannelNet>& nets) {
  std::vector<std::size_t> order(nets.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::vector<long>> costs(nets.size(), std::vector<long>(nets.size()));
  for (std::size_t a = 0; a < nets.size(); ++a) {
    for (std::size_t b = 0; b < nets.size(); ++b) costs[a][b] = cost(nets[a], nets[b]);
  }
  long bends = 0;
  for (const ChannelNet& net : nets)
    bends += kBendCost * std::count_if(net.edges.begin(), net.edges.end(), std::not_fn(is_straight));
  TrackOrder best;
  do {
    long sum = bends;
    for (std::size_t a = 0; a < order.size(); ++a) {
      for (std::size_t b = a + 1; b < order.size(); ++b) sum += costs[order[a]][order[b]];
    }
    if (sum < best.cost) best = {order, sum};
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

// Moves the ends of one port after the other to where the best order of the tracks costs least: by steps of
// its play, or so that an edge runs straight.
TrackOrder move_ends(std::vector<ChannelNet>& nets) {
  TrackOrder order = best_order(nets);
  for (ChannelNet& net : nets) {
    const ChannelNet centred = net;
    std::vector<double> shifts;
    for (double shift = kPlayStep; shift <= net.play; shift += kPlayStep)
      shifts.insert(shifts.end(), {shift, -shift});
    for (const ChannelEdge& edge : net.edges) {
      if (std::abs(edge.bank_y - edge.port_y) <= net.play) shifts.push_back(edge.bank_y - edge.port_y);
    }
    ChannelNet best = net;
    for (const double shift : shifts) {
      for (std::size_t i = 0; i < net.edges.size(); ++i)
        net.edges[i].port_y = centred.edges[i].port_y + shift;
      TrackOrder found = best_order(nets);
      if (found.cost >= order.cost) continue;
      order = std::move(found);
      best = net;
    }
    net = best;
  }
  return order;
}

// Places the edges that go up, or those that go down, side by side: the one with the farthest bank has the
// rightmost track, so that they do not cross each other. Returns their width.
double place(std::vector<ChannelEdge*> edges, const ChannelNet& net, double left_x) {
  std::sort(edges.begin(), edges.end(), [](const ChannelEdge* a, const ChannelEdge* b) {
    return std::abs(a->bank_y - a->port_y) < std::abs(b->bank_y - b->port_y);
  });
  double width = 0;
  for (ChannelEdge* edge : edges) {
    if (!net.spread) width = 0;
    edge->track_x = left_x + width + edge->width / 2;
    width += edge->width + kBetweenEdges;
  }
  return width;
}

// Chooses the tracks, from `left_x` on, so that few edges cross and edges of different ports never run on top
// of each other. Moves the ends at the ports where that helps. Returns the right end of the last track.
double route_channel(std::vector<ChannelNet>& nets, double left_x) {
  for (const std::size_t number : move_ends(nets).nets) {
    ChannelNet& net = nets[number];
    std::vector<ChannelEdge*> up;
    std::vector<ChannelEdge*> down;
    for (ChannelEdge& edge : net.edges) {
      edge.track_x = left_x;
      if (!is_straight(edge)) (edge.bank_y < edge.port_y ? up : down).push_back(&edge);
    }
    const double width = std::max(place(up, net, left_x), place(down, net, left_x));
    if (width > 0) left_x += width + kBetweenTracks;
  }
  return left_x;
}

constexpr double kMargin = 16;
constexpr double kNameSize = 13;
constexpr double kNoteSize = 11;
constexpr double kNameStep = 16;  // from a name to the line below it
constexpr double kNoteStep = 14;
constexpr double kPadding = 7;  // in a block, above and below its text
constexpr double kLabelHeight = kNoteSize * kLetterHeight;
constexpr double kAboveLabel = 8;  // free, up to the next link of the bank
constexpr double kThinEdge = 1.5;
constexpr double kWidestEdge = 12;
constexpr double kShortEdge = 36;  // length of an edge between blocks that stand one above the other

constexpr double kBankWidth = 256;
constexpr double kBetweenBanks = 10;
constexpr double kWordsBar = 6;  // heights of the bars
constexpr double kBusyBar = 8;
constexpr double kLabelFromBank = 18;
constexpr double kTracksFromBank = 70;

constexpr double kPortWidth = 128;
constexpr double kBetweenPorts = 22;
constexpr double kLeastPlay = 9;
constexpr double kFpgaPadding = 14;
constexpr double kFpgaTitle = 26;
constexpr double kLaneWidth = 112;
constexpr double kMatcherWidth = 120;
constexpr double kCheckWidth = 112;
constexpr double kBetweenStages = 28;
constexpr double kFpgaWidth =
    2 * kFpgaPadding + kPortWidth + kLaneWidth + kMatcherWidth + kCheckWidth + 3 * kBetweenStages;

constexpr double kBetweenParts = 14;
constexpr double kBusHeight = 26;
constexpr double kBridgeWidth = 232;

constexpr std::array<double, 4> kLoadSteps = {1, 25, 50, 90};  // % of the peak, where load1 to load4 begin
constexpr double kBarOutline = 0.75;

double block_height(const ChartLines& lines) {
  return 2 * kPadding + kNameStep + kNoteStep * static_cast<double>(lines.size() - 1);
}

bool is_around_board(const ChartLink& link) { return link.from.compare(0, 5, "part-") == 0; }

ChartText text_at(const std::string& text, double x, double y, ChartAnchor anchor, double width,
                  double size = kNoteSize, bool bold = false) {
  ChartText line;
  line.text = fitted(text, size, bold, width);
  line.size = size;
  line.bold = bold;
  line.anchor = anchor;
  line.faint = !bold;
  const double taken = text_width(line.text, size, bold);
  const double before = anchor == ChartAnchor::kStart    ? 0
                        : anchor == ChartAnchor::kMiddle ? taken / 2
                                                         : taken;
  line.box = {x - before, y, taken, size * kLetterHeight};
  return line;
}

class Layout {
 public:
  Layout(const platform::BoardConfig& board, ChartExtent extent, const ChartTraffic* traffic)
      : board_(board),
        extent_(extent),
        traffic_(traffic),
        ports_(ports_from_top(board, extent)),
        lines_(block_lines(board, extent, traffic)) {}

  MemoryChart make() {
    chart_.title = "Memory chart of " + board_.name;
    make_edges();
    measure_banks();
    measure_ports();
    const double below_heading = heading_bottom();
    place_down(below_heading);
    route();
    add_banks();
    add_core();
    if (is_computer()) add_computer(below_heading);
    add_labels();
    add_heading();
    add_legend();
    chart_.width = chart_.fpga.right() + kMargin;
    return std::move(chart_);
  }

 private:
  struct Bank {
    BankLines lines;
    std::vector<std::size_t> edges;  // from top to bottom
    std::vector<double> ends;        // where they leave the bank, below its top
    std::vector<double> rows;        // tops of the buffers' lines, below its top
    ChartBox box;                    // x is kMargin
  };
  struct Port {
    std::vector<std::size_t> edges;  // in the order of the banks
    double bundle = 0;               // width of its edges side by side
    double height = 0;
    double y = 0;
  };

  bool is_computer() const { return extent_ == ChartExtent::kComputer; }

  ChartEdge& edge(const std::string& id) {
    return *std::find_if(chart_.edges.begin(), chart_.edges.end(),
                         [&id](const ChartEdge& each) { return each.link.id() == id; });
  }

  void make_edges() {
    double most = 0;
    const std::vector<ChartLink> links = chart_links(board_, extent_);
    for (const ChartLink& link : links) most = std::max(most, link.peak);
    for (const ChartLink& link : links) {
      ChartEdge edge;
      edge.link = link;
      edge.width = kThinEdge;
      const std::string ends = fmt::format("{} - {}", name_of_block(link.from), name_of_block(link.to));
      std::string number = short_number(link.peak);
      edge.title = fmt::format("{}: peak {} MB/s", ends, number);
      if (traffic_ != nullptr) {
        const double value = traffic_->megabytes_per_second.at(link.id());
        edge.megabytes_per_second = value;
        edge.width = std::max(1.0, kWidestEdge * value / most);
        edge.colour = load_colour(value, link.peak);
        edge.title = fmt::format(
            "{}: {} of {} MB/s ({} %)\n{}", ends, measured(value), number, measured(100 * value / link.peak),
            is_around_board(link) ? "mean since power-up" : "mean while the core works on a frame");
        number = value == 0 ? "" : measured(value);
      }
      edge.label = text_at(number, 0, 0, ChartAnchor::kStart, 100);
      edge.label.faint = false;
      chart_.edges.push_back(std::move(edge));
    }
  }

  // The height that an edge takes at a bank: its label stands on it.
  static double slot_of(const ChartEdge& edge) {
    return edge.width + kAboveLabel + (edge.label.text.empty() ? 0 : kLabelHeight);
  }

  // A link leaves a bank at the buffers that it carries, that of the host, which carries all, at its name.
  // The lines of the buffers are as far apart as the links need.
  void measure_banks() {
    for (const platform::BankConfig& config : board_.banks) {
      Bank bank;
      bank.lines = bank_lines(board_, config, traffic_);
      if (is_computer()) leave(bank, config.name, "host", kPadding + kNameStep / 2);
      double y = kPadding + kNameStep + (traffic_ == nullptr ? 0 : kNoteStep) + kNoteStep + kWordsBar + 4;
      const std::vector<BankLines::Held>& buffers = bank.lines.buffers;
      for (auto first = buffers.begin(); first != buffers.end();) {
        const auto end = std::find_if(
            first, buffers.end(), [&first](const BankLines::Held& held) { return held.port != first->port; });
        const double half = kNoteStep * static_cast<double>(end - first) / 2;
        y = leave(bank, config.name, first->port, y + half) - half;
        for (; first != end; ++first, y += kNoteStep) bank.rows.push_back(y);
      }
      bank.box = {kMargin, 0, kBankWidth, y + (buffers.empty() ? kNoteStep : 0) + kPadding};
      banks_.push_back(std::move(bank));
    }
  }

  // Lets the link of the port leave the bank, at `y` below its top or as far below as the link above needs.
  // Returns where.
  double leave(Bank& bank, const std::string& name, const std::string& port, double y) {
    const auto found = std::find_if(chart_.edges.begin(), chart_.edges.end(), [&](const ChartEdge& each) {
      return each.link.from == "port-" + port && each.link.to == "bank-" + name;
    });
    if (found == chart_.edges.end()) return y;
    if (!bank.ends.empty()) {
      const double above = chart_.edges[bank.edges.back()].width / 2;
      y = std::max(y, bank.ends.back() + above + slot_of(*found) - found->width / 2);
    }
    bank.edges.push_back(static_cast<std::size_t>(found - chart_.edges.begin()));
    bank.ends.push_back(y);
    return y;
  }

  void measure_ports() {
    for (const std::string& name : ports_) {
      Port port;
      for (const Bank& bank : banks_) {
        for (const std::size_t i : bank.edges) {
          if (chart_.edges[i].link.from != "port-" + name) continue;
          port.edges.push_back(i);
          port.bundle = traffic_ == nullptr ? kThinEdge : port.bundle + chart_.edges[i].width + 1;
        }
      }
      port.height = std::max(height_of("port-" + name), port.bundle + 2 * kLeastPlay);
      port_by_name_[name] = std::move(port);
    }
  }

  // The bottom of the heading.
  double heading_bottom() const {
    return kMargin + 24 + kNoteStep * static_cast<double>(subtitle_lines(board_, extent_, traffic_).size()) +
           12;
  }

  double height_of(const std::string& block) const { return block_height(lines_.at(block)); }

  double above_fpga() const {
    if (!is_computer()) return 0;
    return height_of("part-left_camera") + parts_height() + kBusHeight + height_of("part-bridge") +
           height_of("part-local_bus") + 5 * kShortEdge;
  }

  // No part at the PCI bus has more lines than the capture boards.
  double parts_height() const { return height_of("part-left_capture"); }

  // Chooses all y of banks, ports and the FPGA.
  void place_down(double top) {
    const double lane = height_of("stage-left_lane");
    chart_.fpga.y = top + above_fpga();
    double y = chart_.fpga.y + kFpgaTitle + 6;
    for (const std::string& name : ports_) {
      Port& port = port_by_name_.at(name);
      // The lane is as high as its pixel port, or higher.
      const bool has_lane = name == "left_pixel" || name == "right_pixel";
      const double extra = has_lane ? std::max(0.0, (lane - port.height) / 2 - 4) : 0;
      port.y = y + extra;
      y = port.y + port.height + extra + kBetweenPorts;
    }
    const double core_bottom = y - kBetweenPorts;
    chart_.fpga.height = core_bottom + 10 + 2 * kNoteStep + 10 - chart_.fpga.y;
    chart_.fpga.width = kFpgaWidth;

    double height = -kBetweenBanks;
    for (const Bank& bank : banks_) height += bank.box.height + kBetweenBanks;
    const double first = port_by_name_.at(ports_.front()).y;
    const double centred = (first + core_bottom - height) / 2;
    double bank_y = std::max(top + kNameStep + 4, std::min(centred, chart_.fpga.bottom() - height));
    banks_top_ = bank_y;
    for (Bank& bank : banks_) {
      bank.box.y = bank_y;
      bank_y = bank.box.bottom() + kBetweenBanks;
    }
    chart_.height = std::max(chart_.fpga.bottom(), bank_y - kBetweenBanks) + kMargin;
  }

  // Chooses the way of each edge between ports and banks, and x of the FPGA.
  void route() {
    std::map<std::size_t, double> bank_y;  // by edge
    for (const Bank& bank : banks_) {
      for (std::size_t i = 0; i < bank.edges.size(); ++i) bank_y[bank.edges[i]] = bank.box.y + bank.ends[i];
    }
    std::vector<ChannelNet> nets;
    for (const std::string& name : ports_) {
      const Port& port = port_by_name_.at(name);
      ChannelNet net;
      net.spread = traffic_ != nullptr;
      net.play = (port.height - port.bundle) / 2 - 3;
      double y = port.y + (port.height - port.bundle) / 2;
      for (const std::size_t i : port.edges) {
        const double width = chart_.edges[i].width;
        net.edges.push_back({bank_y.at(i), y + width / 2, width});
        if (net.spread) y += width + 1;
      }
      nets.push_back(std::move(net));
    }
    const double bank_right = kMargin + kBankWidth;
    const double tracks_end = route_channel(nets, bank_right + kTracksFromBank);
    chart_.fpga.x = std::max(tracks_end + 4, bank_right + kTracksFromBank + 24);
    for (std::size_t n = 0; n < ports_.size(); ++n) {
      const Port& port = port_by_name_.at(ports_[n]);
      for (std::size_t e = 0; e < port.edges.size(); ++e) {
        const ChannelEdge& routed = nets[n].edges[e];
        ChartEdge& edge = chart_.edges[port.edges[e]];
        edge.way = {{port_x(), routed.port_y}};
        if (routed.port_y != routed.bank_y) {
          edge.way.push_back({routed.track_x, routed.port_y});
          edge.way.push_back({routed.track_x, routed.bank_y});
        }
        edge.way.push_back({bank_right, routed.bank_y});
      }
    }
  }

  double port_x() const { return chart_.fpga.x + kFpgaPadding; }
  ChartBox port_box(const std::string& name) const {
    const Port& port = port_by_name_.at(name);
    return {port_x(), port.y, kPortWidth, port.height};
  }

  void add_banks() {
    chart_.texts.push_back(text_at(fmt::format("SSRAM: {} MHz, one access a cycle", board_.fpga.clock_mhz),
                                   kMargin, banks_top_ - kNameStep - 4, ChartAnchor::kStart, kBankWidth,
                                   kNoteSize));
    for (std::size_t i = 0; i < banks_.size(); ++i)
      chart_.blocks.push_back(bank_block(board_.banks[i].name, banks_[i]));
  }

  // A block without texts; its name and colour are those of its kind.
  ChartBlock block_at(const std::string& id, const std::string& title, const ChartBox& box,
                      const std::string& fill) const {
    const bool limits = traffic_ != nullptr && traffic_->limiting.count(id) > 0;
    return {id, title, box, limits, {{box, 4, fill, limits ? "ink" : "line", limits ? 3.0 : 1.0}}, {}};
  }

  // A bar of parts with their widths and their colour.
  static void add_bar(ChartBlock& block, const ChartBox& bar, const std::vector<ChartRect>& parts) {
    block.rects.push_back({bar, 2, "free"});
    block.rects.insert(block.rects.end(), parts.begin(), parts.end());
    block.rects.push_back({bar, 2, "none", "line", kBarOutline});
  }

  ChartBlock bank_block(const std::string& name, const Bank& bank) const {
    const std::string title =
        fmt::format("{}: {}\n{}, {}", name, bank.lines.bandwidth, bank.lines.size, bank.lines.kind);
    ChartBlock block = block_at("bank-" + name, title, bank.box, bank.lines.busy_percent ? "free" : "memory");
    const double left = bank.box.x + 9;
    const double right = bank.box.right() - 9;
    double y = bank.box.y + kPadding;
    const ChartText rate = text_at(bank.lines.bandwidth, right, y + 1.5, ChartAnchor::kEnd, right - left);
    block.texts.push_back(
        text_at(name, left, y, ChartAnchor::kStart, right - left - rate.box.width - 8, kNameSize, true));
    block.texts.push_back(rate);
    y += kNameStep;
    if (bank.lines.busy_percent) {
      const double percent = *bank.lines.busy_percent;
      const std::string colour = load_colour(percent, 100);
      const ChartText busy =
          text_at(fmt::format("busy {} %", measured(percent)), left, y, ChartAnchor::kStart, 90);
      block.texts.push_back(busy);
      ChartBox bar = {left + 90, busy.box.middle_y() - kBusyBar / 2, right - left - 90, kBusyBar};
      block.rects.push_back({bank.box, 4, colour, "", 0, 0.2});
      add_bar(block, bar, {{{bar.x, bar.y, bar.width * percent / 100, bar.height}, 2, colour}});
      block.title += "\n" + busy.text + " of the cycles";
      y += kNoteStep;
    }
    const ChartText size = text_at(bank.lines.size, left, y, ChartAnchor::kStart, right - left);
    block.texts.push_back(size);
    block.texts.push_back(
        text_at(bank.lines.kind, right, y, ChartAnchor::kEnd, right - size.box.right() - 8));
    y += kNoteStep + 2;
    const ChartBox bar = {left, y, right - left, kWordsBar};
    std::vector<ChartRect> parts;
    double x = left;
    y += kWordsBar + 2;
    for (std::size_t i = 0; i < bank.rows.size(); ++i) {
      const BankLines::Held& held = bank.lines.buffers[i];
      y = bank.box.y + bank.rows[i];
      const double width =
          bar.width * static_cast<double>(held.words) / static_cast<double>(bank.lines.words);
      parts.push_back({{x, bar.y, width, kWordsBar}, 0, "used", "memory"});
      x += width;
      const std::string words = grouped(held.words);
      block.title += fmt::format("\n{}: {} words", held.label, words);
      ChartText label = text_at(held.label, left, y, ChartAnchor::kStart, right - left - 70);
      label.faint = false;
      block.texts.push_back(label);
      block.texts.push_back(text_at(words, right, y, ChartAnchor::kEnd, 66));
    }
    if (bank.lines.buffers.empty())
      block.texts.push_back(text_at("no buffer", left, y, ChartAnchor::kStart, 100));
    add_bar(block, bar, parts);
    return block;
  }

  void add_flow(const std::string& name, std::vector<ChartPoint> way) {
    chart_.flows.push_back({"flow-" + name, std::move(way)});
  }

  // A block with its lines in its middle.
  void add_block(const std::string& id, const ChartBox& box, const std::string& fill = "logic") {
    const ChartLines& lines = lines_.at(id);
    ChartBlock block = block_at(id, fmt::format("{}", fmt::join(lines, "\n")), box, fill);
    double y = box.middle_y() - block_height(lines) / 2 + kPadding;
    for (const std::string& line : lines) {
      const bool is_name = block.texts.empty();
      block.texts.push_back(text_at(line, box.middle_x(), y, ChartAnchor::kMiddle, box.width - 8,
                                    is_name ? kNameSize : kNoteSize, is_name));
      y += is_name ? kNameStep : kNoteStep;
    }
    chart_.blocks.push_back(std::move(block));
  }

  // A block of the height of its lines.
  ChartBox add_block_at(const std::string& id, double x, double middle_y, double width) {
    const ChartBox box{x, middle_y - height_of(id) / 2, width, height_of(id)};
    add_block(id, box);
    return box;
  }

  void add_core() {
    for (const std::string& name : ports_) add_block("port-" + name, port_box(name));
    const double lane_x = port_x() + kPortWidth + kBetweenStages;
    const double matcher_x = lane_x + kLaneWidth + kBetweenStages;
    const double check_x = matcher_x + kMatcherWidth + kBetweenStages;
    ChartBox matcher{matcher_x, 0, kMatcherWidth, 0};
    for (const std::string side : {"left", "right"}) {
      const ChartBox pixels = port_box(side + "_pixel");
      const ChartBox lane = add_block_at("stage-" + side + "_lane", lane_x, pixels.middle_y(), kLaneWidth);
      add_flow(side + "_pixel-" + side + "_lane",
               {{pixels.right(), lane.middle_y()}, {lane.x, lane.middle_y()}});
      add_flow(side + "_lane-matcher", {{lane.right(), lane.middle_y()}, {matcher_x, lane.middle_y()}});
      if (side == "left") matcher.y = lane.y;
      matcher.height = lane.bottom() - matcher.y;
      add_table_flow(side, pixels);
    }
    const double missing = std::max(0.0, height_of("stage-matcher") - matcher.height);
    matcher.y -= missing / 2;
    matcher.height += missing;
    add_block("stage-matcher", matcher);
    const ChartBox check = add_block_at("stage-lr_check", check_x, matcher.middle_y(), kCheckWidth);
    add_flow("matcher-lr_check", {{matcher.right(), check.middle_y()}, {check.x, check.middle_y()}});
    const ChartBox result = port_box("result");
    const ChartBox queue = add_block_at("stage-result_queue", check_x, result.middle_y(), kCheckWidth);
    add_flow("lr_check-result_queue", {{check.middle_x(), check.bottom()}, {check.middle_x(), queue.y}});
    add_flow("result_queue-result", {{queue.x, queue.middle_y()}, {result.right(), queue.middle_y()}});

    const double right = chart_.fpga.right() - kFpgaPadding;
    chart_.texts.push_back(text_at(fpga_line(board_), right, chart_.fpga.y + 7, ChartAnchor::kEnd,
                                   kFpgaWidth / 2, kNameSize, true));
    double y = chart_.fpga.bottom() - 2 * kNoteStep - 6;
    for (const std::string& line : arbitration_lines(board_)) {
      chart_.texts.push_back(text_at(line, port_x(), y, ChartAnchor::kStart, right - port_x()));
      y += kNoteStep;
    }
  }

  // From the port of the side's table to its pixel port, which is the next one above or below.
  void add_table_flow(const std::string& side, const ChartBox& pixels) {
    const std::string port = board_.fpga.joint_tables ? "left_lut" : side + "_lut";
    if (port_by_name_.count(port) == 0) return;
    const ChartBox table = port_box(port);
    const double x = table.middle_x();
    const bool is_above = table.y < pixels.y;
    add_flow(port + "-" + side + "_pixel",
             {{x, is_above ? table.bottom() : table.y}, {x, is_above ? pixels.y : pixels.bottom()}});
  }

  // An edge straight down, or up, between two blocks.
  void connect(const std::string& id, double x, double from_y, double to_y) {
    ChartEdge& drawn = edge(id);
    drawn.way = {{x, from_y}, {x, to_y}};
  }

  void add_computer(double top) {
    // The parts at the PCI bus, with their links.
    std::vector<std::pair<std::string, std::string>> parts = {
        {"part-left_capture", "edge-left_capture-pci"},
        {"part-right_capture", "edge-right_capture-pci"},
        {"part-cpu", "edge-cpu-pci"},
        {"part-host_memory", "edge-pci-host_memory"}};
    if (board_.pci.load) parts.emplace_back("part-load", "edge-load-pci");
    const double left = chart_.fpga.x;
    const auto count = static_cast<double>(parts.size());
    const double width = (kFpgaWidth - (count - 1) * kBetweenParts) / count;
    const double camera_height = height_of("part-left_camera");
    const double parts_y = top + camera_height + kShortEdge;
    const ChartBox pci{left, parts_y + parts_height() + kShortEdge, kFpgaWidth, kBusHeight};
    double x = left;
    for (const auto& [part, link] : parts) {
      const ChartBox box{x, parts_y, width, parts_height()};
      const bool from_bus = part == "part-host_memory";
      add_block(part, box, from_bus ? "memory" : "computer");
      connect(link, box.middle_x(), from_bus ? pci.y : box.bottom(), from_bus ? box.bottom() : pci.y);
      x = box.right() + kBetweenParts;
    }
    x = left;
    for (const std::string side : {"left", "right"}) {
      const ChartBox box{x, top, width, camera_height};
      add_block("part-" + side + "_camera", box, "computer");
      connect("edge-" + side + "_camera-" + side + "_capture", box.middle_x(), box.bottom(), parts_y);
      x = box.right() + kBetweenParts;
    }
    add_block("part-pci", pci, "bus");
    const ChartBox bridge{left, pci.bottom() + kShortEdge, kBridgeWidth, height_of("part-bridge")};
    add_block("part-bridge", bridge, "computer");
    connect("edge-pci-bridge", left + 56, pci.bottom(), bridge.y);
    connect("edge-bridge-pci", left + 150, bridge.y, pci.bottom());
    const ChartBox local{left, bridge.bottom() + kShortEdge, kBridgeWidth, height_of("part-local_bus")};
    add_block("part-local_bus", local, "bus");
    const ChartBox host = port_box("host");
    connect("edge-bridge-local_bus", host.middle_x(), bridge.bottom(), local.y);
    connect("edge-local_bus-host", host.middle_x(), local.bottom(), host.y);
    legend_ = {left + kBridgeWidth + 24, pci.bottom() + 14, kFpgaWidth - kBridgeWidth - 24, 0};
  }

  void add_labels() {
    for (ChartEdge& edge : chart_.edges) {
      const ChartPoint& end = edge.way.back();
      const ChartPoint& begin = edge.way.front();
      ChartText& label = edge.label;
      if (begin.x == end.x) {
        label.box.x = end.x + std::max(edge.width / 2, 4.5) + 4;
        label.box.y = (std::max(begin.y, end.y) + std::min(begin.y, end.y)) / 2 - kLabelHeight / 2;
        if (edge.link.to == "port-host") label.box.y = begin.y + (kShortEdge - kLabelHeight) / 2;
      } else {
        label.box.x = end.x + kLabelFromBank;
        label.box.y = end.y - edge.width / 2 - 1 - kLabelHeight;
      }
    }
  }

  void add_heading() {
    const double width = chart_.fpga.right() - kMargin;
    chart_.texts.push_back(text_at(board_.name, kMargin, kMargin, ChartAnchor::kStart, width, 18, true));
    double y = kMargin + 24;
    for (const std::string& line : subtitle_lines(board_, extent_, traffic_)) {
      chart_.texts.push_back(text_at(line, kMargin, y, ChartAnchor::kStart, width, kNoteSize));
      y += kNoteStep;
    }
  }

  // Beside the bridge, or below the FPGA.
  void add_legend() {
    if (!is_computer()) legend_ = {chart_.fpga.x, chart_.fpga.bottom() + 12, kFpgaWidth, 0};
    double y = legend_.y;
    for (const std::string& line : legend_lines(extent_, traffic_)) {
      chart_.texts.push_back(text_at(line, legend_.x, y, ChartAnchor::kStart, legend_.width));
      y += kNoteStep;
      if (line.find("Colour") == std::string::npos) continue;
      y += 2;
      constexpr double kSwatch = 56;
      double x = legend_.x;
      const auto add_swatch = [&](double percent, const std::string& text) {
        chart_.swatches.push_back({{x, y, kSwatch - 4, 8}, 1, load_colour(percent, 100)});
        chart_.texts.push_back(text_at(text, x, y + 10, ChartAnchor::kStart, kSwatch - 4));
        x += kSwatch;
      };
      add_swatch(0, "below " + short_number(kLoadSteps.front()));
      for (const double percent : kLoadSteps) add_swatch(percent, "from " + short_number(percent));
      y += 10 + kNoteStep + 3;
    }
    chart_.height = std::max(chart_.height, y + kMargin);
  }

  const platform::BoardConfig& board_;
  ChartExtent extent_;
  const ChartTraffic* traffic_;
  std::vector<std::string> ports_;           // from top to bottom
  std::map<std::string, ChartLines> lines_;  // of each block but the banks, by its id
  std::map<std::string, Port> port_by_name_;
  std::vector<Bank> banks_;  // in the order of the board
  double banks_top_ = 0;
  ChartBox legend_;  // its height does not count
  MemoryChart chart_;
};

}  // namespace

std::string load_colour(double load, double peak) {
  const auto steps = std::count_if(kLoadSteps.begin(), kLoadSteps.end(),
                                   [&](double percent) { return 100 * load >= percent * peak; });
  return fmt::format("load{}", steps);
}

MemoryChart layout_memory_chart(const platform::BoardConfig& board, ChartExtent extent) {
  return Layout(board, extent, nullptr).make();
}

MemoryChart layout_memory_chart(const platform::BoardConfig& board, const ChartTraffic& traffic) {
  return Layout(board, traffic.extent, &traffic).make();
}

}  // namespace stereotlm::report

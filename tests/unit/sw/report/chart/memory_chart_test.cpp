#include "sw/report/chart/memory_chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <tuple>

#include "platform/config/buffer_layout.h"
#include "platform/figures/derived_figures.h"
#include "sw/report/chart/chart_text.h"
#include "tests/support/board_of_random.h"

namespace stereotlm::report {
namespace {

using platform::BoardConfig;
using platform::Statistics;
using ::testing::HasSubstr;
using ::testing::Not;

// A board whose names are narrow or wide, and which may have many banks.
BoardConfig random_chart_board(std::uint64_t seed, test::SplitMix64& random) {
  test::RandomKnobs knobs = test::RandomKnobs::all();
  knobs.large_images = false;
  BoardConfig board = test::board_config(test::make_random_computer(seed, knobs));
  for (platform::BankConfig& bank : board.banks) {
    const std::string letters(static_cast<std::size_t>(random.mostly_small(0, 8, 60)),
                              random.chance(50) ? 'W' : 'i');
    for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
      if (buffer.bank == bank.name) platform::move_buffer(board, buffer, letters + bank.name);
    }
    bank.name = letters + bank.name;
  }
  for (int more = random.mostly_small(0, 2, 30); more > 0; --more) {
    board.banks.push_back(board.banks.front());
    board.banks.back().name = "more" + std::to_string(more);
    board.banks.back().words = 1 << 20;
    board.allocation.left_image.push_back(board.banks.back().name);
    board.allocation.right_image.push_back(board.banks.back().name);
  }
  board.name = std::string(static_cast<std::size_t>(random.mostly_small(1, 20, 300)), 'm');
  return board;
}

// A run of the board whose ports and banks have done anything that they can do in the cycles.
Statistics random_run(const BoardConfig& board, bool in_computer, test::SplitMix64& random) {
  Statistics run;
  run.frames = 6;  // each list of an allocation is used up to its end
  run.cycles = 60'000;
  run.frames_per_second.core = 18.596;
  run.bound.core = 18.596;
  run.bound.core_limited_by = "bank " + board.banks.front().name;
  for (const fpga::PortGroup& port : fpga::kPortGroups) {
    const int grants = random.chance(20) ? 0 : random.between(0, 10'000);
    run.ports.push_back({port.name, 6 * static_cast<std::uint64_t>(grants), run.cycles});
  }
  for (const platform::BankConfig& bank : board.banks) run.banks.push_back({bank.name});
  const auto accesses = platform::core_accesses(board, run);
  for (std::size_t bank = 0; bank < run.banks.size(); ++bank) {
    run.banks[bank].utilization = random.between(0, 1000) / 1000.0;
    run.banks[bank].megabytes_per_second = random.between(0, 1000);
    if (in_computer && random.chance(80))
      run.banks[bank].reads = static_cast<std::uint64_t>(random.between(0, 9000));
    for (const auto& of_port : accesses) run.banks[bank].writes += of_port[bank];
  }
  if (!in_computer) return run;
  run.bound.system = 18.596;
  run.bound.system_limited_by = run.bound.core_limited_by;
  platform::ComputerStatistics& around = run.computer.emplace();
  around.pci_clocks = around.local_clocks = 10'000;
  around.pci_busy_clocks = around.local_busy_clocks = 9'999;
  around.posted_words = static_cast<std::uint64_t>(random.between(0, 5000));
  for (const char* master : {"left_capture", "right_capture", "host", "bridge", "load"})
    around.pci_masters.push_back({master, 0, static_cast<std::uint64_t>(random.between(0, 2000))});
  return run;
}

struct Box {
  double x = 0;
  double y = 0;
  double right = 0;
  double bottom = 0;
};

bool overlap(const Box& a, const Box& b) {
  constexpr double kRounded = 0.02;
  return a.x < b.right - kRounded && b.x < a.right - kRounded && a.y < b.bottom - kRounded &&
         b.y < a.bottom - kRounded;
}

bool is_within(const Box& inner, const Box& outer) {
  constexpr double kRounded = 0.02;
  return inner.x >= outer.x - kRounded && inner.y >= outer.y - kRounded &&
         inner.right <= outer.right + kRounded && inner.bottom <= outer.bottom + kRounded;
}

struct Text {
  std::string text;
  Box box;
  std::string group;
};

struct Piece {  // of an edge
  std::string id;
  bool is_bend;
  Box box;
};

struct Group {
  std::string id;
  Box box;                                        // of a block
  std::vector<std::pair<double, double>> points;  // of an edge
  std::string from;
  std::string to;
};

// What a chart draws, read from its SVG: each element is a line.
struct Drawn {
  Box page;
  Box fpga;
  std::vector<Group> blocks;
  std::vector<Group> edges;
  std::vector<Text> texts;
  std::vector<Piece> pieces;

  explicit Drawn(const std::string& svg) {
    std::istringstream lines(svg);
    Group* group = nullptr;
    for (std::string line; std::getline(lines, line);) {
      const auto attribute = [&line](const std::string& name) {
        const std::size_t begin = line.find(" " + name + "=\"");
        if (begin == std::string::npos) return std::string();
        const std::size_t value = begin + name.size() + 3;
        return line.substr(value, line.find('"', value) - value);
      };
      const auto number = [&](const std::string& name) { return std::stod(attribute(name)); };
      const std::string kind = line.substr(0, line.find(' '));
      if (kind == "</g>") group = nullptr;
      if (kind == "<g" && attribute("class") != "flow") {
        std::vector<Group>& groups = attribute("class") == "edge" ? edges : blocks;
        groups.push_back({attribute("id"), {}, {}, attribute("data-from"), attribute("data-to")});
        group = &groups.back();
      }
      if (kind == "<rect") {
        const Box box{number("x"), number("y"), number("x") + number("width"),
                      number("y") + number("height")};
        if (line.find("stroke-frame") != std::string::npos) fpga = box;
        if (page.right == 0) page = box;
        if (group != nullptr && group->box.right == 0) group->box = box;
        if (group != nullptr) {
          EXPECT_TRUE(is_within(box, group->box)) << group->id;
        }
      }
      if (kind == "<text") {
        const std::size_t begin = line.find('>') + 1;
        const std::string text = line.substr(begin, line.rfind('<') - begin);
        const double size = number("font-size");
        const double width =
            text_width(text == "&lt;0.1" ? "<0.1" : text, size, !attribute("font-weight").empty());
        const std::string anchor = attribute("text-anchor");
        const double x = number("x") - (anchor == "middle" ? width / 2 : anchor == "end" ? width : 0);
        const double y = number("y") - 0.93 * size;
        texts.push_back(
            {text, {x, y, x + width, y + kLetterHeight * size}, group == nullptr ? "" : group->id});
      }
      if (kind == "<path" && group != nullptr && group->from != "" &&
          line.find(" stroke-width") != std::string::npos)
        add_way(*group, attribute("d"), number("stroke-width"));
    }
  }

  void add_way(Group& group, const std::string& way, double width) {
    std::istringstream points(way);
    double x = 0;
    double y = 0;
    for (char letter = 0; points >> letter;) {
      for (int controls = letter == 'C' ? 2 : 0; controls > 0; --controls) points >> x >> y;
      points >> x >> y;
      group.points.emplace_back(x, y);
    }
    for (std::size_t i = 0; i + 1 < group.points.size(); ++i) {
      const auto& [from_x, from_y] = group.points[i];
      const auto& [to_x, to_y] = group.points[i + 1];
      EXPECT_TRUE(from_x != to_x || from_y != to_y) << group.id << ": of some length";
      const double across = from_x == to_x ? width / 2 : 0;
      const double along = from_x == to_x ? 0 : width / 2;
      pieces.push_back({group.id,
                        from_x != to_x && from_y != to_y,
                        {std::min(from_x, to_x) - across, std::min(from_y, to_y) - along,
                         std::max(from_x, to_x) + across, std::max(from_y, to_y) + along}});
    }
  }

  const Group& block(const std::string& id) const {
    for (const Group& each : blocks) {
      if (each.id == id) return each;
    }
    ADD_FAILURE() << "no block " << id;
    return blocks.front();
  }
};

void expect_room_for_everything(const Drawn& chart) {
  for (const Text& text : chart.texts) {
    EXPECT_TRUE(is_within(text.box, chart.page)) << text.text;
    if (!text.group.empty() && text.group.compare(0, 5, "edge-") != 0) {
      EXPECT_TRUE(is_within(text.box, chart.block(text.group).box)) << text.group << ": " << text.text;
    }
    for (const Text& other : chart.texts)
      EXPECT_FALSE(&other != &text && overlap(text.box, other.box)) << text.text << " and " << other.text;
  }
  for (const Group& block : chart.blocks) {
    EXPECT_TRUE(is_within(block.box, chart.page)) << block.id;
    const bool in_fpga = block.id.compare(0, 5, "port-") == 0 || block.id.compare(0, 6, "stage-") == 0;
    EXPECT_TRUE(in_fpga ? is_within(block.box, chart.fpga) : !overlap(block.box, chart.fpga)) << block.id;
    for (const Group& other : chart.blocks)
      EXPECT_FALSE(&other != &block && overlap(block.box, other.box)) << block.id << " and " << other.id;
  }
}

// Each edge goes from its block to the other, through nothing. Edges lie on each other in their bends alone.
void expect_edges_clear(const Drawn& chart) {
  // Whether the end of an edge touches the block, but for the head of its arrow.
  const auto touches = [](const Box& block, const std::pair<double, double>& end,
                          const std::pair<double, double>& before) {
    constexpr double kTip = 11;
    const auto [x, y] = end;
    const double along_x = y == before.second ? kTip : 0.1;
    const double along_y = y == before.second ? 0.1 : kTip;
    return overlap({x - along_x, y - along_y, x + along_x, y + along_y}, block);
  };
  for (const Group& edge : chart.edges) {
    std::vector<std::pair<double, double>> way = edge.points;
    ASSERT_GE(way.size(), 2U) << edge.id;
    if (!touches(chart.block(edge.from).box, way[0], way[1])) std::reverse(way.begin(), way.end());
    EXPECT_TRUE(touches(chart.block(edge.from).box, way[0], way[1])) << edge.id;
    EXPECT_TRUE(touches(chart.block(edge.to).box, way.back(), way[way.size() - 2])) << edge.id;
  }
  for (const Piece& piece : chart.pieces) {
    EXPECT_TRUE(is_within(piece.box, chart.page)) << piece.id;
    for (const Text& text : chart.texts)
      EXPECT_FALSE(overlap(piece.box, text.box)) << piece.id << " through " << text.text;
    for (const Group& block : chart.blocks)
      EXPECT_FALSE(overlap(piece.box, block.box)) << piece.id << " through " << block.id;
    for (const Piece& other : chart.pieces) {
      if (piece.id == other.id || piece.is_bend || other.is_bend) continue;
      EXPECT_FALSE(overlap(piece.box, other.box)) << piece.id << " on " << other.id;
    }
  }
}

TEST(MemoryChart, OfRandomBoardsHasRoomForEverything) {
  for (std::uint64_t seed = 0; seed < 120 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    test::SplitMix64 random(seed);
    const BoardConfig board = random_chart_board(seed, random);
    const bool in_computer = random.chance(60);
    const Statistics run = random_run(board, in_computer, random);
    const ChartView view{board, in_computer, random.chance(60) ? &run : nullptr};
    const Drawn chart(memory_chart_svg(view));
    expect_room_for_everything(chart);
    expect_edges_clear(chart);
    std::vector<std::string> drawn;
    for (const Group& edge : chart.edges) drawn.push_back(edge.id);
    std::vector<std::string> links;
    for (const ChartLink& link : chart_links(view)) links.push_back(link.id());
    EXPECT_EQ(drawn, links);
  }
}

// A run of the paper's board in which only two ports access banks.
Statistics run_of_two_ports() {
  Statistics run;
  run.frames = 1;
  run.cycles = 1000;
  run.frames_per_second.core = 12.345;
  run.bound.core = 123.45;
  run.bound.core_limited_by = "bank bank0";
  for (const fpga::PortGroup& port : fpga::kPortGroups) run.ports.push_back({port.name});
  for (const platform::BankConfig& bank : BoardConfig().banks) run.banks.push_back({bank.name});
  run.ports[0].grants = run.banks[6].reads = 1000;
  run.ports[1].grants = run.banks[7].reads = 251;
  return run;
}

std::string svg_of(const Statistics& run) {
  const BoardConfig board;
  return memory_chart_svg({board, run.computer.has_value(), &run});
}

// The group of this id, without what follows it.
std::string group_of(std::string svg, const std::string& id) {
  svg.erase(0, svg.find("id=\"" + id + '"'));
  return svg.substr(0, svg.find("</g>"));
}

TEST(MemoryChart, HasAnIdForEachElement) {
  const std::string svg = memory_chart_svg({BoardConfig(), true});
  for (const char* id :
       {"bank-bank0", "port-left_lut", "stage-matcher", "stage-lr_check", "part-pci", "part-host_memory",
        "edge-left_lut-bank6", "edge-local_bus-host", "flow-left_pixel-left_lane"})
    EXPECT_THAT(svg, HasSubstr(std::string("id=\"") + id + '"'));
  EXPECT_THAT(svg, HasSubstr("data-from=\"port-left_lut\" data-to=\"bank-bank6\" data-peak=\"160\">"));
}

TEST(MemoryChart, DrawsLinksAsWideAsTheirTrafficAndThoseWithoutItThinWithoutNumber) {
  const std::string svg = svg_of(run_of_two_ports());
  EXPECT_THAT(group_of(svg, "edge-left_lut-bank6"),
              ::testing::AllOf(HasSubstr("stroke-width=\"12\""), HasSubstr(">160.0</text>")));
  EXPECT_THAT(group_of(svg, "edge-right_lut-bank7"),
              ::testing::AllOf(HasSubstr("data-peak=\"160\" data-mbps=\"40.16\">"),
                               HasSubstr("stroke-width=\"3.01\""), HasSubstr(">40.2</text>"),
                               HasSubstr("right_lut - bank7: 40.2 of 160 MB/s (25.1 %)<")));
  EXPECT_THAT(group_of(svg, "edge-result-bank4"),
              ::testing::AllOf(HasSubstr("stroke-width=\"1\""), Not(HasSubstr("<text"))));
  EXPECT_THAT(svg, Not(HasSubstr("part-pci")));
}

TEST(MemoryChart, NamesTheKindOfTheRateAndWhatBoundsIt) {
  const std::string svg = svg_of(run_of_two_ports());
  EXPECT_THAT(svg, HasSubstr(">12.35 frames/s, core only; 1 frame</text>"));
  EXPECT_THAT(svg, HasSubstr(">bound 123.5 frames/s, set by bank0</text>"));
}

TEST(MemoryChart, MarksWhatLimitsTheRate) {
  for (const auto& [resource, id] :
       {std::pair("bank bank0", "bank-bank0"), std::pair("matcher", "stage-matcher"),
        std::pair("port left_lut", "port-left_lut"), std::pair("camera", "part-left_camera"),
        std::pair("camera", "part-right_camera"), std::pair("pci", "part-pci"),
        std::pair("bridge", "part-bridge")}) {
    Statistics run = run_of_two_ports();
    run.computer.emplace();
    run.bound.system_limited_by = resource;
    EXPECT_THAT(group_of(svg_of(run), id), HasSubstr("class=\"block limits\"")) << resource;
    EXPECT_THAT(group_of(svg_of(run), "bank-bank1"), Not(HasSubstr("limits"))) << resource;
  }
}

TEST(MemoryChart, ColoursByTheShareOfThePeak) {
  EXPECT_EQ(load_colour(0, 160), "load0");
  EXPECT_EQ(load_colour(1.59, 160), "load0");
  EXPECT_EQ(load_colour(1.6, 160), "load1");
  EXPECT_EQ(load_colour(40, 160), "load2");
  EXPECT_EQ(load_colour(79.99, 160), "load2");
  EXPECT_EQ(load_colour(80, 160), "load3");
  EXPECT_EQ(load_colour(144, 160), "load4");
}

TEST(MemoryChart, ColoursABankAndItsBarByHowBusyItIs) {
  for (const auto& [percent, colour, width] :
       {std::tuple(100.0, "load4", "88"), std::tuple(50.0, "load3", "44"), std::tuple(24.9, "load1", "21.91"),
        std::tuple(0.0, "load0", "0")}) {
    Statistics run = run_of_two_ports();
    run.banks[0].utilization = percent / 100;
    run.banks[0].energy.emplace().energy_percent = 100;
    const std::string svg = group_of(svg_of(run), "bank-bank0");
    const std::string fill = std::string("class=\"fill-") + colour + '"';
    EXPECT_THAT(svg, HasSubstr("rx=\"4\" " + fill)) << percent;
    EXPECT_THAT(svg, HasSubstr(" fill-opacity=\"0.2\"/>")) << "the whole bank";
    EXPECT_THAT(svg, HasSubstr(std::string("width=\"") + width + "\" height=\"8\" rx=\"2\" " + fill))
        << "of 88";
    EXPECT_THAT(svg, HasSubstr(">busy " + measured(percent) + " %, 100.0 % mJ</text>"));
    EXPECT_THAT(svg, HasSubstr("rx=\"0\" class=\"fill-used\"")) << "words";
  }
}

TEST(MemoryChart, ShowsNamesAsText) {
  BoardConfig board;
  board.name = "<script>alert(\"1\")</script>";
  const std::string bank = "\"><script>'&";
  board.banks[6].name = bank;
  board.allocation.left_lut = bank;
  const std::string svg = memory_chart_svg({board});
  EXPECT_THAT(svg, Not(HasSubstr("<script")));
  EXPECT_THAT(svg, HasSubstr(">&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt;</text>"));
  EXPECT_THAT(svg, HasSubstr("id=\"edge-left_lut-&quot;&gt;&lt;script&gt;&#39;&amp;\""));
}

// A viewer without CSS variables takes the attributes, and one that has them either theme.
TEST(MemoryChart, HasEachColourAsAttributeAndAsVariableOfBothThemes) {
  const std::string svg = memory_chart_svg({BoardConfig()});
  EXPECT_THAT(svg, HasSubstr("class=\"fill-memory\" fill=\"#f1ebfb\""));
  const std::string rules = svg.substr(0, svg.find("</style>"));
  const auto count = [&rules](const std::string& text) {
    int found = 0;
    for (std::size_t at = rules.find(text); at != std::string::npos; at = rules.find(text, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("--mc-memory: #f1ebfb;"), 2) << "light, and print";
  EXPECT_EQ(count("--mc-memory: #2c2440;"), 2) << "dark, and forced dark";
  EXPECT_EQ(count("fill: var(--mc-memory)"), 1);
  EXPECT_EQ(rules.find("var("), rules.find("@supports (color: var(") + 18)
      << "only where variables are known";
}

}  // namespace
}  // namespace stereotlm::report

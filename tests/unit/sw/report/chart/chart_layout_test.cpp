#include "sw/report/chart/chart_layout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include "platform/config/buffer_layout.h"
#include "tests/unit/sw/report/chart/random_chart.h"

namespace stereotlm::report {
namespace {

constexpr double kEpsilon = 1e-6;

bool overlap(const ChartBox& a, const ChartBox& b) {
  return a.x < b.right() - kEpsilon && b.x < a.right() - kEpsilon && a.y < b.bottom() - kEpsilon &&
         b.y < a.bottom() - kEpsilon;
}

bool is_within(const ChartBox& inner, const ChartBox& outer) {
  return inner.x >= outer.x - kEpsilon && inner.y >= outer.y - kEpsilon &&
         inner.right() <= outer.right() + kEpsilon && inner.bottom() <= outer.bottom() + kEpsilon;
}

struct Piece {
  bool is_horizontal;
  ChartBox box;
};

std::vector<Piece> pieces(const ChartEdge& edge) {
  std::vector<Piece> all;
  for (std::size_t i = 0; i + 1 < edge.way.size(); ++i) {
    const ChartPoint& a = edge.way[i];
    const ChartPoint& b = edge.way[i + 1];
    const bool is_horizontal = a.y == b.y;
    const double x = std::min(a.x, b.x) - (is_horizontal ? 0 : edge.width / 2);
    const double y = std::min(a.y, b.y) - (is_horizontal ? edge.width / 2 : 0);
    all.push_back({is_horizontal,
                   {x, y, is_horizontal ? std::abs(a.x - b.x) : edge.width,
                    is_horizontal ? edge.width : std::abs(a.y - b.y)}});
  }
  return all;
}

std::vector<ChartText> all_texts(const MemoryChart& chart) {
  std::vector<ChartText> texts = chart.texts;
  for (const ChartBlock& block : chart.blocks)
    texts.insert(texts.end(), block.texts.begin(), block.texts.end());
  for (const ChartEdge& edge : chart.edges) {
    if (!edge.label.text.empty()) texts.push_back(edge.label);
  }
  return texts;
}

const ChartBlock& block_named(const MemoryChart& chart, const std::string& id) {
  for (const ChartBlock& block : chart.blocks) {
    if (block.id == id) return block;
  }
  throw std::out_of_range("no block " + id);
}

bool is_on_border(const ChartPoint& point, const ChartBox& box) {
  const bool on_side = point.x == box.x || point.x == box.right();
  const bool on_end = std::abs(point.y - box.y) < kEpsilon || std::abs(point.y - box.bottom()) < kEpsilon;
  const bool in_height = point.y >= box.y - kEpsilon && point.y <= box.bottom() + kEpsilon;
  const bool in_width = point.x >= box.x && point.x <= box.right();
  return (on_side && in_height) || (on_end && in_width);
}

void expect_texts_apart(const MemoryChart& chart) {
  const std::vector<ChartText> texts = all_texts(chart);
  for (std::size_t a = 0; a < texts.size(); ++a) {
    EXPECT_TRUE(is_within(texts[a].box, {0, 0, chart.width, chart.height})) << texts[a].text;
    for (std::size_t b = a + 1; b < texts.size(); ++b)
      EXPECT_FALSE(overlap(texts[a].box, texts[b].box)) << texts[a].text << " and " << texts[b].text;
    for (const ChartRect& swatch : chart.swatches)
      EXPECT_FALSE(overlap(texts[a].box, swatch.box)) << texts[a].text;
  }
}

void expect_blocks_apart(const MemoryChart& chart) {
  std::set<std::string> ids;
  for (const ChartBlock& block : chart.blocks) {
    EXPECT_TRUE(ids.insert(block.id).second) << block.id;
    EXPECT_TRUE(is_within(block.box, {0, 0, chart.width, chart.height})) << block.id;
    const bool in_fpga = block.id.compare(0, 5, "port-") == 0 || block.id.compare(0, 6, "stage-") == 0;
    EXPECT_TRUE(in_fpga ? is_within(block.box, chart.fpga) : !overlap(block.box, chart.fpga)) << block.id;
    for (const ChartText& text : block.texts)
      EXPECT_TRUE(is_within(text.box, block.box)) << block.id << ": " << text.text;
    for (const ChartBlock& other : chart.blocks)
      EXPECT_FALSE(&other != &block && overlap(block.box, other.box)) << block.id << " and " << other.id;
    for (const ChartRect& rect : block.rects) EXPECT_TRUE(is_within(rect.box, block.box)) << block.id;
  }
}

void expect_edges_clear(const MemoryChart& chart) {
  for (const ChartEdge& edge : chart.edges) {
    const std::string id = edge.link.id();
    ASSERT_GE(edge.way.size(), 2U) << id;
    for (std::size_t i = 0; i + 1 < edge.way.size(); ++i) {
      EXPECT_TRUE((edge.way[i].x == edge.way[i + 1].x) != (edge.way[i].y == edge.way[i + 1].y))
          << id << ": horizontal or vertical, and of some length";
    }
    EXPECT_TRUE(is_on_border(edge.way.front(), block_named(chart, edge.link.from).box)) << id;
    EXPECT_TRUE(is_on_border(edge.way.back(), block_named(chart, edge.link.to).box)) << id;
    for (const auto& [is_horizontal, piece] : pieces(edge)) {
      EXPECT_TRUE(is_within(piece, {0, 0, chart.width, chart.height})) << id;
      for (const ChartText& text : all_texts(chart))
        EXPECT_FALSE(overlap(piece, text.box)) << id << " through " << text.text;
      for (const ChartBlock& block : chart.blocks)
        EXPECT_FALSE(overlap(piece, block.box)) << id << " through " << block.id;
    }
  }
}

// Edges of different ports cross at right angles only.
void expect_edges_apart(const MemoryChart& chart) {
  for (const ChartEdge& a : chart.edges) {
    for (const ChartEdge& b : chart.edges) {
      if (a.link.from == b.link.from) continue;
      for (const Piece& piece : pieces(a)) {
        for (const Piece& other : pieces(b)) {
          if (piece.is_horizontal != other.is_horizontal || !overlap(piece.box, other.box)) continue;
          ADD_FAILURE() << a.link.id() << " on " << b.link.id();
        }
      }
    }
  }
}

void expect_all_named(const MemoryChart& chart, const platform::BoardConfig& board, ChartExtent extent) {
  for (const platform::BankConfig& bank : board.banks) {
    const ChartBlock& block = block_named(chart, "bank-" + bank.name);
    EXPECT_EQ(block.title.compare(0, bank.name.size() + 1, bank.name + ":"), 0) << block.title;
    std::string shown;
    for (const ChartText& text : block.texts) shown += text.text + "\n";
    for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
      const bool is_here = shown.find(buffer.label()) != std::string::npos;
      EXPECT_EQ(is_here, buffer.bank == bank.name) << buffer.label() << " in " << bank.name;
    }
  }
  std::vector<std::string> drawn;
  for (const ChartEdge& edge : chart.edges) drawn.push_back(edge.link.id());
  std::vector<std::string> links;
  for (const ChartLink& link : chart_links(board, extent)) links.push_back(link.id());
  EXPECT_EQ(drawn, links);
}

// The link of a port leaves a bank at its buffers there, that of the host at the name of the bank.
void expect_links_at_buffers(const MemoryChart& chart, const platform::BoardConfig& board) {
  for (const ChartEdge& edge : chart.edges) {
    if (edge.link.to.compare(0, 5, "bank-") != 0) continue;
    const std::vector<ChartText>& texts = block_named(chart, edge.link.to).texts;
    double top = texts.front().box.y;
    double bottom = texts.front().box.bottom();
    for (const fpga::CorePort& port : fpga::kPorts) {
      if (edge.link.from != std::string("port-") + port.name || edge.link.from == "port-host") continue;
      top = chart.height;
      bottom = 0;
      for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
        if (port.buffer != std::string(platform::name_of(buffer.buffer))) continue;
        for (const ChartText& text : texts) {
          if (text.text.find(buffer.label()) == std::string::npos) continue;
          top = std::min(top, text.box.y);
          bottom = std::max(bottom, text.box.bottom());
        }
      }
    }
    const double y = edge.way.back().y;
    EXPECT_TRUE(y > top && y < bottom) << edge.link.id() << ": " << y << " in " << top << ".." << bottom;
  }
}

TEST(ChartLayout, OfRandomBoardsHasRoomForEverything) {
  for (std::uint64_t seed = 0; seed < 400 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    test::SplitMix64 random(seed);
    const platform::BoardConfig board = random_chart_board(random);
    const ChartExtent extent = random.chance(60) ? ChartExtent::kComputer : ChartExtent::kBoard;
    const ChartTraffic traffic = random_chart_traffic(board, extent, random);
    const MemoryChart chart =
        random.chance(60) ? layout_memory_chart(board, traffic) : layout_memory_chart(board, extent);
    expect_texts_apart(chart);
    expect_blocks_apart(chart);
    expect_edges_clear(chart);
    expect_edges_apart(chart);
    expect_all_named(chart, board, extent);
    expect_links_at_buffers(chart, board);
  }
}

TEST(ChartLayout, DrawsLinksAsWideAsTheirTrafficAndThoseWithoutItThinWithoutNumber) {
  const platform::BoardConfig board;
  test::SplitMix64 random(1);
  ChartTraffic traffic = random_chart_traffic(board, ChartExtent::kBoard, random);
  for (auto& [id, value] : traffic.megabytes_per_second) value = 0;
  traffic.megabytes_per_second["edge-left_lut-bank6"] = 160;
  traffic.megabytes_per_second["edge-right_lut-bank7"] = 40;
  for (const ChartEdge& edge : layout_memory_chart(board, traffic).edges) {
    const std::string id = edge.link.id();
    EXPECT_EQ(edge.width, id == "edge-left_lut-bank6" ? 12 : id == "edge-right_lut-bank7" ? 3 : 1) << id;
    EXPECT_EQ(edge.label.text, id == "edge-left_lut-bank6"    ? "160.0"
                               : id == "edge-right_lut-bank7" ? "40.0"
                                                              : "")
        << id;
  }
}

TEST(ChartLayout, ColoursByTheShareOfThePeak) {
  EXPECT_EQ(load_colour(0, 160), "load0");
  EXPECT_EQ(load_colour(1.59, 160), "load0");
  EXPECT_EQ(load_colour(1.6, 160), "load1");
  EXPECT_EQ(load_colour(40, 160), "load2");
  EXPECT_EQ(load_colour(79.99, 160), "load2");
  EXPECT_EQ(load_colour(80, 160), "load3");
  EXPECT_EQ(load_colour(144, 160), "load4");
}

}  // namespace
}  // namespace stereotlm::report

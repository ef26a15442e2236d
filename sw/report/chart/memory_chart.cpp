#include "sw/report/chart/memory_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sw/report/chart/chart_layout.h"
#include "sw/report/chart/chart_text.h"

namespace stereotlm::report {
namespace {

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

constexpr double kHalo = 2;  // on each side of a line, where it crosses another

const Color& color(const std::string& name) {
  return *std::find_if(kColors.begin(), kColors.end(),
                       [&name](const Color& each) { return each.name == name; });
}

// A coordinate: at most two decimals.
std::string px(double value) {
  const std::string text = fmt::format("{:.2f}", std::round(value * 100) / 100 + 0.0);
  const std::size_t end = text.find_last_not_of('0');
  return text.substr(0, text[end] == '.' ? end : end + 1);
}

// The class and, for viewers without CSS variables, the attribute.
std::string paint(const std::string& fill, const std::string& stroke) {
  std::string classes;
  std::string attributes;
  const auto add = [&](const char* property, const std::string& name) {
    if (name == "none") {
      attributes += fmt::format(" {}=\"none\"", property);
    } else if (!name.empty()) {
      classes += fmt::format("{}{}-{}", classes.empty() ? "" : " ", property, name);
      attributes += fmt::format(" {}=\"{}\"", property, color(name).light);
    }
  };
  add("fill", fill);
  add("stroke", stroke);
  return fmt::format(" class=\"{}\"{}", classes, attributes);
}

std::string colors_css(const char* Color::*theme) {
  std::string text;
  for (const Color& each : kColors) text += fmt::format(" --mc-{}: {};", each.name, each.*theme);
  return text;
}

// Viewers that do not know CSS variables ignore all of it, and take the attributes. A page forces a theme by
// the class `light` or `dark` on the chart.
std::string style() {
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

std::string rect_element(const ChartRect& rect) {
  const auto attribute = [](const char* name, double value, double usual) {
    return value == usual ? "" : fmt::format(" {}=\"{}\"", name, value);
  };
  return fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{}\"{}{}{}/>\n", px(rect.box.x),
                     px(rect.box.y), px(rect.box.width), px(rect.box.height), px(rect.radius),
                     paint(rect.fill, rect.stroke), attribute("stroke-width", rect.stroke_width, 0),
                     attribute("fill-opacity", rect.opacity, 1));
}

std::string text_element(const ChartText& text) {
  constexpr double kBaseline = 0.93;  // below the top of the box, in font sizes
  const bool is_start = text.anchor == ChartAnchor::kStart;
  const bool is_middle = text.anchor == ChartAnchor::kMiddle;
  const double x = is_start ? text.box.x : is_middle ? text.box.middle_x() : text.box.right();
  return fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\"{}{}{}>{}</text>\n", px(x),
                     px(text.box.y + kBaseline * text.size), px(text.size),
                     is_start    ? ""
                     : is_middle ? " text-anchor=\"middle\""
                                 : " text-anchor=\"end\"",
                     text.bold ? " font-weight=\"bold\"" : "", paint(text.faint ? "faint" : "ink", ""),
                     xml_text(text.text));
}

std::string title_element(const std::string& text) { return "<title>" + xml_text(text) + "</title>\n"; }

std::string way_text(const std::vector<ChartPoint>& way) {
  std::string text;
  for (const ChartPoint& point : way)
    text += fmt::format("{}{} {}", text.empty() ? "M" : " L", px(point.x), px(point.y));
  return text;
}

std::string line_element(const std::vector<ChartPoint>& way, double width, const std::string& color_name) {
  return fmt::format("<path d=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}/>\n", way_text(way),
                     px(width), paint("none", color_name));
}

struct Tip {
  double length;
  double half;  // of its width
};
Tip tip_of(double width) { return {6.5 + width / 3, 3 + width / 2}; }

// The unit vector from `from` to `to`; the piece is horizontal or vertical.
ChartPoint direction(const ChartPoint& from, const ChartPoint& to) {
  const double length = std::abs(to.x - from.x) + std::abs(to.y - from.y);
  return length == 0 ? ChartPoint{} : ChartPoint{(to.x - from.x) / length, (to.y - from.y) / length};
}

// The tip at the end of a way, which is made shorter by it.
std::string tip_element(std::vector<ChartPoint>& way, double width, const std::string& color_name) {
  const Tip tip = tip_of(width);
  const ChartPoint end = way.back();
  const ChartPoint along = direction(way[way.size() - 2], end);
  const ChartPoint foot{end.x - tip.length * along.x, end.y - tip.length * along.y};
  way.back() = {end.x - (tip.length - 1) * along.x, end.y - (tip.length - 1) * along.y};
  return fmt::format("<path d=\"M{} {} L{} {} L{} {} z\"{}/>\n", px(end.x), px(end.y),
                     px(foot.x - tip.half * along.y), px(foot.y + tip.half * along.x),
                     px(foot.x + tip.half * along.y), px(foot.y - tip.half * along.x), paint(color_name, ""));
}

std::string arrow_elements(std::vector<ChartPoint> way, bool there, bool back, double width,
                           const std::string& color_name) {
  std::string tips;
  if (there) tips += tip_element(way, width, color_name);
  if (back) {
    std::reverse(way.begin(), way.end());
    tips += tip_element(way, width, color_name);
    std::reverse(way.begin(), way.end());
  }
  return line_element(way, width, color_name) + tips;
}

std::string edge_element(const ChartEdge& edge) {
  const std::string data =
      edge.megabytes_per_second ? fmt::format(" data-mbps=\"{}\"", *edge.megabytes_per_second) : "";
  return fmt::format("<g id=\"{}\" class=\"edge\" data-from=\"{}\" data-to=\"{}\" data-peak=\"{}\"{}>\n",
                     xml_text(edge.link.id()), xml_text(edge.link.from), xml_text(edge.link.to),
                     edge.link.peak, data) +
         title_element(edge.title) +
         arrow_elements(edge.way, edge.link.there, edge.link.back, edge.width, edge.colour) +
         (edge.label.text.empty() ? "" : text_element(edge.label)) + "</g>\n";
}

// Edges of one port follow each other, and lie side by side: a halo must not cover its neighbours.
std::string edge_elements(const std::vector<ChartEdge>& edges) {
  std::string text;
  for (std::size_t first = 0; first < edges.size();) {
    std::size_t end = first;
    for (; end < edges.size() && edges[end].link.from == edges[first].link.from; ++end)
      text += line_element(edges[end].way, edges[end].width + 2 * kHalo, "page");
    for (; first < end; ++first) text += edge_element(edges[first]);
  }
  return text;
}

std::string block_element(const ChartBlock& block) {
  std::string text =
      fmt::format("<g id=\"{}\" class=\"block{}\">\n", xml_text(block.id), block.limits ? " limits" : "");
  text += title_element(block.title);
  for (const ChartRect& rect : block.rects) text += rect_element(rect);
  for (const ChartText& line : block.texts) text += text_element(line);
  return text + "</g>\n";
}

std::string svg_of(const MemoryChart& chart) {
  std::string text = fmt::format(
      "{2} class=\"memory-chart\" role=\"img\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\"\n font-family=\"system-ui, -apple-system, 'Segoe UI', Helvetica, Arial, "
      "sans-serif\">\n",
      px(chart.width), px(chart.height), kChartMark);
  text += title_element(chart.title) + style();
  text += rect_element({{0, 0, chart.width, chart.height}, 0, "page"});
  text += rect_element({chart.fpga, 8, "none", "frame"});
  for (const ChartFlow& flow : chart.flows) {
    text += fmt::format("<g id=\"{}\" class=\"flow\">\n{}</g>\n", xml_text(flow.id),
                        arrow_elements(flow.way, true, false, 1, "line"));
  }
  text += edge_elements(chart.edges);
  for (const ChartBlock& block : chart.blocks) text += block_element(block);
  for (const ChartRect& swatch : chart.swatches) text += rect_element(swatch);
  for (const ChartText& line : chart.texts) text += text_element(line);
  return text + "</svg>\n";
}

}  // namespace

std::string memory_chart_svg(const platform::BoardConfig& board, ChartExtent extent) {
  return svg_of(layout_memory_chart(board, extent));
}

std::string memory_chart_svg(const platform::BoardConfig& board, const ChartTraffic& traffic) {
  return svg_of(layout_memory_chart(board, traffic));
}

}  // namespace stereotlm::report

#include "sw/stats/figures.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "platform/config/board_area.h"
#include "platform/config/board_keys.h"
#include "sw/stats/stats_fields.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::stats {
namespace {

constexpr std::string_view kName = "NAME";

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

// A name carries its unit: that of the last of its parts that ends in one of these.
std::string unit_of(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 19> kUnits = {{
      {"percent", "%"},
      {"_pj", "pJ"},
      {"_mj_per_frame", "mJ/frame"},
      {"_mw", "mW"},
      {"_ps", "ps"},
      {"_ms", "ms"},
      {"megabytes_per_frame", "MB/frame"},
      {"megabytes_per_second", "MB/s"},
      {"frames_per_second", "frames/s"},
      {"bound", "frames/s"},
      {"cycles", "cycles"},
      {"clocks", "clocks"},
      {"words", "words"},
      {"pixels", "pixels"},
      {"frames", "frames"},
      {"bytes", "bytes"},
      {"slices", "slices"},
      {"pins", "pins"},
      {"accesses", "accesses"},
  }};
  while (true) {
    for (const auto& [end, unit] : kUnits) {
      if (ends_with(name, end)) return std::string(unit);
    }
    const std::size_t dot = name.rfind('.');
    if (dot == std::string_view::npos) return "";
    name = name.substr(0, dot);
  }
}

// Adds the figures at and below a path of the document. The members `name` of lists are parts of paths.
void collect(const std::string& path, const Schema& schema, std::vector<Figure>& found) {
  if (schema.contains("properties")) {
    for (const auto& [key, value] : schema["properties"].items()) {
      if (key != "name") collect(platform::below(path, key), value, found);
    }
  } else if (schema.contains("items") && schema["items"].contains("properties")) {
    collect(platform::below(path, std::string(kName)), schema["items"], found);
  } else {
    const bool is_text = schema.value("type", "string") == "string";
    found.push_back({figure_column(path), is_text ? "" : unit_of(path),
                     schema.value("description", std::string()), is_text});
  }
}

// `blame` is a table of its own, and a point with `failed` has no figures.
std::vector<Property> point_properties() {
  std::vector<Property> properties;
  for (Property& property : properties_of<platform::Statistics>()) {
    if (property.key != "blame" && property.key != "failed?") properties.push_back(std::move(property));
  }
  properties.push_back({"accuracy?", schema_of<Accuracy>()});
  properties.push_back({"pins", from_one(), "of the FPGA that the board takes"});
  properties.push_back({"smallest_device?", text(), "that fits; absent if none does"});
  properties.push_back({"lost_pixels?", count(), "of both cameras; absent without cameras"});
  return properties;
}

// Where NAME of a figure is in a column that begins and ends as the figure: its position and size.
std::optional<std::pair<std::size_t, std::size_t>> name_in(std::string_view figure, std::string_view column) {
  const std::size_t at = figure.find(kName);
  if (at == std::string_view::npos || column.substr(0, at) != figure.substr(0, at)) return std::nullopt;
  const std::string_view end = figure.substr(at + kName.size());
  if (column.size() <= at + end.size() || !ends_with(column, end)) return std::nullopt;
  return std::pair(at, column.size() - at - end.size());
}

}  // namespace

const std::vector<Figure>& figures() {
  static const std::vector<Figure> kFigures = [] {
    std::vector<Figure> found;
    collect("", object_of(point_properties()), found);
    return found;
  }();
  return kFigures;
}

const Figure* find_figure(const std::string& column) {
  for (const Figure& figure : figures()) {
    if (figure.name == column || name_in(figure.name, column)) return &figure;
  }
  return nullptr;
}

std::vector<std::string> figure_names_like(const std::string& name) {
  std::vector<std::string> names;
  for (const Figure& figure : figures()) {
    names.push_back(figure.name);
    const std::size_t at = figure.name.find(kName);
    if (at == std::string::npos || name.substr(0, at) != figure.name.substr(0, at)) continue;
    const std::size_t size = std::min(name.find('.', at), name.size()) - at;
    names.back().replace(at, kName.size(), name.substr(at, size));
  }
  return names;
}

std::string unknown_figure_text(const std::string& name) {
  const std::string nearest = platform::nearest_path(name, figure_names_like(name));
  return "unknown figure " + name + (nearest.empty() ? "" : "; nearest: " + nearest);
}

std::string figure_column(const std::string& path) {
  return platform::find_key(path) == nullptr ? path : path + ".counted";
}

Json point_document(const platform::Statistics& statistics, const platform::BoardConfig& board,
                    const std::optional<Accuracy>& accuracy) {
  Json document = stats_document(statistics, accuracy);
  document["pins"] = platform::pins_of(board);
  if (const area::Device* const smallest = area::smallest_device(platform::area_of(board)))
    document["smallest_device"] = smallest->name;
  if (statistics.computer) {
    std::uint64_t lost = 0;
    for (const platform::CameraStatistics& camera : statistics.computer->cameras)
      lost += camera.dropped_pixels;
    document["lost_pixels"] = lost;
  }
  return document;
}

}  // namespace stereotlm::stats

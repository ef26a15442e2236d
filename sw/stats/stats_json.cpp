#include "sw/stats/stats_json.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "platform/config/board_area.h"
#include "sw/files/text_forms.h"
#include "sw/stats/console_table.h"
#include "sw/stats/stats_fields.h"

namespace stereotlm::stats {
namespace {

// Every value by its path. Paths are sorted as text: entry 10 of a list comes before entry 2.
std::map<std::string, std::string> values_of(const std::string& text) {
  std::map<std::string, std::string> values;
  const nlohmann::json flat = nlohmann::json(files::parse_json(text)).flatten();
  for (const auto& [path, value] : flat.items()) values[path] = value.dump();
  return values;
}

std::vector<Property> area_properties() {
  std::vector<Property> properties = properties_of<area::Area>();
  properties.push_back({"fits", truth(), "no percentage is above 100"});
  return properties;
}

}  // namespace

Json area_json(const platform::BoardConfig& board) {
  const area::Area area = platform::area_of(board);
  Json json = json_of(area);
  json["fits"] = area.fits();
  return json;
}

Json area_document(const platform::BoardConfig& board) {
  Json json = area_json(board);
  json["device"] = platform::device_of(board).name;
  if (const area::Device* const smallest = area::smallest_device(platform::area_of(board)))
    json["smallest_device"] = smallest->name;
  Json& parts = json["parts"] = Json::array();
  for (const area::Item& item : platform::area_items(board)) {
    parts.push_back({{"name", item.name},
                     {"count", item.count},
                     {"luts", item.all.luts},
                     {"flip_flops", item.all.flip_flops},
                     {"block_rams", item.all.block_rams},
                     {"multipliers", item.all.multipliers}});
  }
  return json;
}

Json stats_document(const platform::Statistics& statistics, const std::optional<Accuracy>& accuracy) {
  Json document = {{"schema", 1}};
  document.update(json_of(statistics));
  if (accuracy) document["accuracy"] = json_of(*accuracy);
  return document;
}

nlohmann::ordered_json run_document(const platform::Statistics& statistics, const TableExtras& extras) {
  Json document = stats_document(statistics, extras.accuracy);
  if (extras.waitless_frames_per_second)
    document["waitless_frames_per_second"] = *extras.waitless_frames_per_second;
  if (extras.answered_percent) document["disparities_percent"] = *extras.answered_percent;
  return document;
}

std::string stats_json(const platform::Statistics& statistics, const std::optional<Accuracy>& accuracy) {
  return files::json_text(stats_document(statistics, accuracy));
}

Schema area_schema() { return object_of(area_properties()); }

Schema area_document_schema() {
  std::vector<Property> properties = area_properties();
  const Schema part = object_of({{"name", text()},
                                 {"count", from_one()},
                                 {"luts", count()},
                                 {"flip_flops", count()},
                                 {"block_rams", count()},
                                 {"multipliers", count()}});
  properties.push_back({"device", text()});
  properties.push_back({"smallest_device?", text(), "that fits; absent if none does"});
  properties.push_back({"parts", list_of(part)});
  return object_of(properties);
}

Schema run_schema() {
  std::vector<Property> properties = properties_of<platform::Statistics>();
  properties.push_back(
      {"accuracy?", schema_of<Accuracy>(), "against --truth, or against the made scene of --synthetic"});
  properties.push_back(
      {"waitless_frames_per_second?", above_zero(), "of the core if no port waited; absent if none waits"});
  properties.push_back({"disparities_percent?", percentage(),
                        "pixels of the last frame with a disparity; absent with --timing-only"});
  Schema schema = document_of("What `stereotlm run --json` prints", properties);
  schema["description"] = "stats.json, and what only the table of `run` shows";
  require_together(schema, {"pci", "bridge", "cameras", "latency_ms"});
  return schema;
}

std::vector<std::string> stats_differences(const std::string& first, const std::string& second,
                                           const std::string& first_name, const std::string& second_name) {
  const auto firsts = values_of(first);
  const auto seconds = values_of(second);
  const auto value = [](const auto& values, const std::string& path) {
    const auto found = values.find(path);
    return found == values.end() ? std::string("absent") : found->second;
  };
  auto paths = firsts;
  paths.insert(seconds.begin(), seconds.end());
  std::vector<std::string> lines;
  for (const auto& [path, unused] : paths) {
    const std::string one = value(firsts, path);
    const std::string other = value(seconds, path);
    if (one != other)
      lines.push_back(fmt::format("{}: {} {}, {} {}", path, first_name, one, second_name, other));
  }
  return lines;
}

}  // namespace stereotlm::stats

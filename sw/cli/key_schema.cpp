#include "sw/cli/key_schema.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/kernels/filter_kernel.h"
#include "models/kernels/stereo.h"
#include "models/memory/memory_config.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "sw/explore/plan/points.h"

namespace stereotlm::cli {
namespace {

using Json = nlohmann::ordered_json;
using kernels::IntegerRule;

const std::string kBanksPath = "ssram.banks";
const std::string kBankPath = "ssram.banks.NAME";
constexpr const char* kBankNamePattern = "(?!none([.]|$))[A-Za-z][A-Za-z0-9_-]*";

Json reference(const std::string& path) { return {{"$ref", "#/$defs/" + path}}; }
Json word_schema(const std::vector<std::string>& words) { return {{"enum", words}}; }
Json either(const Json& first, const Json& second) { return {{"anyOf", {first, second}}}; }
Json list_of(const Json& items, const IntegerRule& count) {
  return {{"type", "array"}, {"items", items}, {"minItems", count.min}, {"maxItems", count.max}};
}

Json integer_schema(const IntegerRule& rule) {
  if (rule.step == 1 && !rule.is_power_of_two)
    return {{"type", "integer"}, {"minimum", rule.min}, {"maximum", rule.max}};
  if (rule.min % rule.step == 0 && !rule.is_power_of_two) {
    return {{"type", "integer"}, {"minimum", rule.min}, {"maximum", rule.max}, {"multipleOf", rule.step}};
  }
  Json values = Json::array();
  for (std::int64_t value = rule.min; value <= rule.max; ++value) {
    if (rule.allows(value)) values.push_back(value);
  }
  return {{"enum", values}};
}

// A map of the keys below the path. `required`: those that must be there.
Json map_of(const std::string& path, const std::vector<std::string>& required) {
  Json schema = {{"type", "object"}, {"properties", Json::object()}};
  for (const std::string& name : platform::child_keys(path))
    schema["properties"][name] = reference(platform::below(path, name));
  if (!required.empty()) schema["required"] = required;
  schema["additionalProperties"] = false;
  return schema;
}
Json whole_map_of(const std::string& path) { return map_of(path, platform::required_keys(path)); }

Json bank_name() { return {{"type", "string"}, {"pattern", fmt::format("^{}$", kBankNamePattern)}}; }
// A bank, or a stripe {rows: [..]}.
Json buffer_schema() {
  Json rows = list_of(bank_name(), fpga::kStripeRule);
  rows["uniqueItems"] = true;
  return either(bank_name(), {{"type", "object"},
                              {"properties", {{"rows", rows}}},
                              {"required", {"rows"}},
                              {"additionalProperties", false}});
}

// The lists, the name and `ssram.banks`; a null for any other key.
Json special_schema(const std::string& path) {
  if (path == "name") return {{"type", "string"}, {"minLength", 1}};
  if (path == "fpga.priority") {
    std::vector<std::string> ports;
    for (const auto& group : fpga::kPortGroups) ports.emplace_back(group.name);
    const auto count = static_cast<std::int64_t>(ports.size());
    Json priority = list_of(word_schema(ports), {count, count});
    priority["uniqueItems"] = true;
    return priority;
  }
  if (path == "matcher.filter.kernel") {
    const IntegerRule& size = kernels::kKernelSizeRule;
    return list_of(list_of(integer_schema(kernels::kKernelEntryRule), size), size);
  }
  if (path == kBanksPath) {
    return {{"type", "object"},
            {"propertyNames", bank_name()},
            {"additionalProperties", reference(kBankPath)},
            {"minProperties", memory::kBankCountRule.min},
            {"maxProperties", memory::kBankCountRule.max}};
  }
  if (path == platform::key_of(platform::Buffer::kLeftLut) ||
      path == platform::key_of(platform::Buffer::kRightLut)) {
    Json schema = either(buffer_schema(), list_of(buffer_schema(), {1, 1}));
    schema["anyOf"].push_back(word_schema({"none"}));
    return schema;
  }
  if (platform::is_below(path, "allocation"))
    return either(buffer_schema(), list_of(buffer_schema(), {1, platform::kMostBuffers}));
  return nullptr;
}

// A number, a word, or a map of the keys below.
Json schema_of(const platform::Key& key) {
  if (Json special = special_schema(key.path); !special.is_null()) return special;
  const platform::ValueRule& rule = key.rule;
  std::vector<Json> forms;
  if (rule.integers) forms.push_back(integer_schema(*rule.integers));
  if (rule.decimals)
    forms.push_back({{"type", "number"}, {"minimum", rule.decimals->min}, {"maximum", rule.decimals->max}});
  if (!rule.words.empty()) forms.push_back(word_schema(rule.words));
  if (!platform::child_keys(key.path).empty()) forms.push_back(whole_map_of(key.path));
  return forms.size() == 1 ? forms.front() : either(forms.at(0), forms.at(1));
}

// The schema of each path of a board, "image" and "image.width".
Json definitions() {
  Json schemas = Json::object();
  for (const platform::Key& key : platform::board_keys()) {
    for (std::size_t dot = key.path.find('.'); dot != std::string::npos; dot = key.path.find('.', dot + 1)) {
      const std::string section = key.path.substr(0, dot);
      if (platform::find_key(section) != nullptr || schemas.contains(section)) continue;
      schemas[section] = section == kBanksPath ? special_schema(section) : map_of(section, {});
    }
    Json schema = {
        {"description", fmt::format("{}{}: {}", key.meaning,
                                    key.unit.empty() ? "" : fmt::format(" ({})", key.unit), key.rule.text)}};
    schema.update(schema_of(key));
    schemas[key.path] = std::move(schema);
  }
  return schemas;
}

// What a board must have below the path if no preset supplies it.
Json requirement(const std::string& path) {
  Json schema = {{"required", platform::required_keys(path)}};
  for (const std::string& name : platform::required_keys(path)) {
    const std::string inner = platform::below(path, name);
    if (platform::find_key(inner) == nullptr && inner != kBanksPath)
      schema["properties"][name] = requirement(inner);
  }
  return schema;
}

Json schema_head(const char* title, const char* command) {
  return {
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"title", title},
      {"$comment", fmt::format("Made by `stereotlm keys --schema {0}`. An editor reads it by the first line "
                               "of a file: # yaml-language-server: $schema=PATH/{0}.schema.json",
                               command)}};
}

// A map from paths of a board, such as in `set` of a plan. `wrap` makes the schema of the value of a key.
template <typename Wrap>
Json assignments(const Wrap& wrap) {
  Json schema = {{"type", "object"}, {"properties", Json::object()}, {"patternProperties", Json::object()}};
  const Json paths = definitions();
  for (const auto& [path, unused] : paths.items()) {
    if (path.rfind(kBankPath, 0) == 0) {
      const std::string rest = std::regex_replace(path.substr(kBankPath.size()), std::regex("[.]"), "[.]");
      const std::string pattern = fmt::format("^ssram[.]banks[.]{}{}$", kBankNamePattern, rest);
      schema["patternProperties"][pattern] = wrap(reference(path));
    } else {
      const bool is_section = platform::find_key(path) == nullptr && path != kBanksPath;
      schema["properties"][path] = wrap(is_section ? whole_map_of(path) : reference(path));
    }
  }
  schema["additionalProperties"] = false;
  return schema;
}

}  // namespace

Json board_schema() {
  Json schema = schema_head("Board file of stereotlm", "board");
  schema.update(map_of("", {}));
  schema["properties"]["extends"] = {
      {"description", "the preset that supplies the keys that the file leaves out"},
      {"enum", platform::preset_names()}};
  schema["if"] = {{"required", {"extends"}}};
  schema["else"] = requirement("");
  schema["$defs"] = definitions();
  return schema;
}

Json plan_schema() {
  const Json text = {{"type", "string"}, {"minLength", 1}};
  const Json condition = {{"type", {"string", "number", "boolean"}}};
  const Json texts = either(text, {{"type", "array"}, {"items", text}});
  const Json number = {{"type", "number"}};
  const Json range = {{"type", "object"},
                      {"properties", {{"from", number}, {"to", number}, {"step", number}}},
                      {"required", {"from", "to", "step"}},
                      {"additionalProperties", false}};
  const Json source = word_schema({"preloaded", "camera"});
  const Json frames = integer_schema(explore::kFramesRule);
  const auto values = [&range](const Json& value) {
    return either({{"type", "array"}, {"items", value}, {"minItems", 1}}, range);
  };
  Json varied = assignments(values);
  varied["properties"]["run.source"] = values(source);
  varied["properties"]["run.frames"] = values(frames);
  Json schema = schema_head("Plan of a sweep or a search of stereotlm", "plan");
  schema.update({
      {"type", "object"},
      {"properties",
       {{"board",
         {{"description", "a preset, or the path of a board file"}, {"type", "string"}, {"minLength", 1}}},
        {"run",
         {{"type", "object"},
          {"properties", {{"source", source}, {"frames", frames}, {"calibration", text}}},
          {"additionalProperties", false}}},
        {"set", assignments([](const Json& value) { return value; })},
        {"vary", varied},
        {"zip", {{"type", "array"}, {"items", varied}}},
        {"where", either(condition, {{"type", "array"}, {"items", condition}})},
        {"maximise", texts},
        {"minimise", texts},
        {"require", texts},
        {"placements",
         {{"type", "object"},
          {"properties", {{"banks", integer_schema({1, 64})}, {"stripes", integer_schema({1, 16})}}},
          {"required", {"banks"}},
          {"additionalProperties", false}}},
        {"sample",
         {{"type", "object"},
          {"properties",
           {{"points", {{"type", "integer"}, {"minimum", 1}}},
            {"seed", {{"type", "integer"}, {"minimum", 0}}}}},
          {"required", {"points", "seed"}},
          {"additionalProperties", false}}}}},
      {"required", {"board"}},
      {"additionalProperties", false},
      {"$defs", definitions()},
  });
  return schema;
}

}  // namespace stereotlm::cli

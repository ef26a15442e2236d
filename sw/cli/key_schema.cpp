#include "sw/cli/key_schema.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
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
  Json schema = {{"type", "integer"}, {"minimum", rule.min}, {"maximum", rule.max}};
  if (rule.step == 1) return schema;
  if (rule.min % rule.step == 0) {
    schema["multipleOf"] = rule.step;
    return schema;
  }
  schema = {{"enum", Json::array()}};
  for (std::int64_t value = rule.min; value <= rule.max; value += rule.step) schema["enum"].push_back(value);
  return schema;
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

Json bank_timing(const platform::BankTimingKey& key) {
  Json schema = integer_schema(key.rule);
  if (key.is_power_of_two) {
    schema = {{"enum", Json::array()}};
    for (std::int64_t value = key.rule.min; value <= key.rule.max; value *= 2)
      schema["enum"].push_back(value);
  }
  return key.may_be_off ? either(schema, word_schema({"off"})) : schema;
}

// The values with code of their own.
std::map<std::string, Json> special_schemas() {
  std::vector<std::string> ports;
  for (const auto& group : fpga::kPortGroups) ports.emplace_back(group.name);
  const auto count = static_cast<std::int64_t>(ports.size());
  Json priority = list_of(word_schema(ports), {count, count});
  priority["uniqueItems"] = true;
  std::vector<std::string> costs;
  for (const kernels::CostKind kind :
       {kernels::CostKind::kSad, kernels::CostKind::kSsd, kernels::CostKind::kZncc})
    costs.emplace_back(kernels::name_of(kind));
  const IntegerRule& size = kernels::kKernelSizeRule;
  std::map<std::string, Json> schemas = {
      {"name", {{"type", "string"}, {"minLength", 1}}},
      {"fpga.priority", priority},
      {"matcher.filter", either(word_schema({"none", "log7"}), whole_map_of("matcher.filter"))},
      {"matcher.filter.kernel", list_of(list_of(integer_schema(kernels::kKernelEntryRule), size), size)},
      {"matcher.cost", either(word_schema(costs), whole_map_of("matcher.cost"))},
      {"pci.load", either(word_schema({"none"}), whole_map_of("pci.load"))},
      {kBanksPath,
       {{"type", "object"},
        {"propertyNames", bank_name()},
        {"additionalProperties", reference(kBankPath)},
        {"minProperties", memory::kBankCountRule.min},
        {"maxProperties", memory::kBankCountRule.max}}},
  };
  for (const platform::Buffer each :
       {platform::Buffer::kLeftImage, platform::Buffer::kRightImage, platform::Buffer::kDisparity,
        platform::Buffer::kLeftLut, platform::Buffer::kRightLut}) {
    const bool is_table = each == platform::Buffer::kLeftLut || each == platform::Buffer::kRightLut;
    const std::int64_t most = is_table ? 1 : platform::kMostBuffers;
    schemas[platform::key_of(each)] = either(buffer_schema(), list_of(buffer_schema(), {1, most}));
    if (is_table) schemas[platform::key_of(each)]["anyOf"].push_back(word_schema({"none"}));
  }
  for (const std::string& path : {std::string("ssram.default"), kBankPath}) {
    schemas[path + ".kind"] = word_schema(platform::bank_kind_names());
    for (const platform::BankTimingKey& key : platform::bank_timing_keys())
      schemas[platform::below(path, key.name)] = bank_timing(key);
  }
  return schemas;
}

Json schema_of(const platform::Key& key) {
  static const std::map<std::string, Json> kSpecial = special_schemas();
  if (const auto found = kSpecial.find(key.path); found != kSpecial.end()) return found->second;
  if (const auto* const decimal = std::get_if<platform::DecimalKey>(&key.kind))
    return {{"type", "number"}, {"minimum", decimal->min}, {"maximum", decimal->max}};
  if (const auto* const word = std::get_if<platform::WordKey>(&key.kind)) return word_schema(word->words);
  const Json number = integer_schema(key.numbers.value());
  return key.no_number.empty() ? number : either(number, word_schema({key.no_number}));
}

// The schema of each path of a board, "image" and "image.width".
Json definitions() {
  Json schemas = Json::object();
  for (const platform::Key& key : platform::board_keys()) {
    for (std::size_t dot = key.path.find('.'); dot != std::string::npos; dot = key.path.find('.', dot + 1)) {
      const std::string section = key.path.substr(0, dot);
      if (platform::find_key(section) != nullptr || schemas.contains(section)) continue;
      schemas[section] = section == kBanksPath ? special_schemas().at(kBanksPath) : map_of(section, {});
    }
    Json schema = {
        {"description", fmt::format("{}{}: {}", key.meaning,
                                    key.unit.empty() ? "" : fmt::format(" ({})", key.unit), key.rule_text)}};
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
      const std::string rest = path.substr(kBankPath.size());
      const std::string pattern =
          fmt::format("^ssram[.]banks[.]{}{}$", kBankNamePattern, rest.empty() ? "" : "[.]" + rest.substr(1));
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
  Json schema = schema_head("Plan of a sweep of stereotlm", "plan");
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

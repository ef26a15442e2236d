#include "sw/explore/plan/figures.h"

#include <nlohmann/json.hpp>
#include <string>

#include "platform/config/board_keys.h"

namespace stereotlm::explore {
namespace {

using Json = nlohmann::ordered_json;

bool is_list_of_named(const Json& value) {
  return value.is_array() && !value.empty() && value.front().is_object() && value.front().contains("name");
}

void append(const std::string& path, const Json& value, std::vector<platform::BoardValue>& values) {
  if (value.is_object()) {
    for (const auto& [key, child] : value.items()) {
      if (key != "name") append(platform::below(path, key), child, values);
    }
  } else if (is_list_of_named(value)) {
    for (const Json& item : value) append(platform::below(path, item["name"]), item, values);
  } else if (value.is_number_integer()) {
    values.push_back({path, value.get<std::int64_t>()});
  } else if (value.is_number()) {
    values.push_back({path, value.get<double>()});
  } else {
    values.push_back({path, value.is_string() ? value.get<std::string>() : value.dump()});
  }
}

}  // namespace

Figures figures_of(const Json& document) {
  Figures figures;
  for (const auto& [key, value] : document.items()) {
    if (key == "schema") continue;
    if (key == "blame") {
      for (const Json& row : value) {
        figures.blame.push_back({row["port"], row["bank"], row["by"], row["cycles"].get<std::int64_t>()});
      }
    } else {
      append(key, value, figures.values);
    }
  }
  return figures;
}

}  // namespace stereotlm::explore

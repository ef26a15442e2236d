#include "sw/stats/stats_differences.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace stereotlm::stats {
namespace {

// Every value by its path. Paths are sorted as text: entry 10 of a list comes before entry 2.
std::map<std::string, std::string> values_of(const std::string& text) {
  std::map<std::string, std::string> values;
  try {
    const nlohmann::json flat = nlohmann::json::parse(text).flatten();
    for (const auto& [path, value] : flat.items()) values[path] = value.dump();
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(fmt::format("statistics that are not JSON: {}", error.what()));
  }
  return values;
}

}  // namespace

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

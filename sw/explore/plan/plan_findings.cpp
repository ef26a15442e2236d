#include "sw/explore/plan/plan_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "platform/config/board_keys.h"
#include "platform/yaml/words.h"

namespace stereotlm::explore {

using platform::Place;
using platform::YamlNode;

std::string PlanFindings::place_text(const Place& place) const {
  return fmt::format("{}:{}:{}", file_, place.line, place.column);
}

void PlanFindings::report(const Place& place, const std::string& text) {
  all_.push_back({place_text(place), text});
}

void PlanFindings::report(const std::string& path, const YamlNode& node, const std::string& rule) {
  report(node.place, fmt::format("{} = {}: {}", path, short_text(node), rule));
}

void PlanFindings::add(const std::vector<platform::Diagnostic>& found) {
  all_.insert(all_.end(), found.begin(), found.end());
}

const PlanFindings::Entries* PlanFindings::read_map(const std::string& path, const YamlNode& node,
                                                    const std::vector<std::string>& known,
                                                    const std::string& rule) {
  if (!node.is_map()) {
    report(path.empty() ? "the plan" : path, node,
           known.empty() ? rule : fmt::format("{} of {}", rule, fmt::join(known, ", ")));
    return nullptr;
  }
  std::map<std::string, Place> first;
  for (const YamlNode::Entry& entry : node.entries) {
    const std::string name = short_text(entry.key);
    const std::string full = platform::below(path, name);
    const auto [at, is_new] = first.emplace(name, entry.key.place);
    if (!known.empty() && std::find(known.begin(), known.end(), name) == known.end()) {
      report(entry.key.place, fmt::format("{} = {}: unknown key{}; keys: {}", full, short_text(entry.value),
                                          platform::nearest_text(name, known), platform::listed(known)));
    } else if (!is_new) {
      report(entry.key.place, fmt::format("{} = {}: repeated key, first at {}:{}", full,
                                          short_text(entry.value), at->second.line, at->second.column));
    }
  }
  return &node.entries;
}

}  // namespace stereotlm::explore

#include <fmt/format.h>

#include <limits>
#include <map>

#include "models/memory/memory_config.h"
#include "platform/config/board_keys.h"

namespace stereotlm::platform {
namespace {

std::string_view last_part(std::string_view path) { return path.substr(path.rfind('.') + 1); }

// The section of a path; empty for one without.
std::string section_of(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

// likely_distance() of two paths, without the sections with which both begin.
std::optional<std::size_t> likely_path_distance(std::string_view path, std::string_view known) {
  for (std::size_t dot = path.find('.'); dot != std::string_view::npos; dot = path.find('.')) {
    if (path.substr(0, dot + 1) != known.substr(0, dot + 1)) break;
    path.remove_prefix(dot + 1);
    known.remove_prefix(dot + 1);
  }
  return likely_distance(path, known);
}

// The known key nearest to an unknown one. Below `ssram.banks` every name counts as a bank's.
std::string nearest_key(const std::string& path) {
  const std::string schema = schema_path(path);
  std::vector<std::string> known = {"extends"};
  for (const Key& key : board_keys()) {
    for (std::size_t dot = key.path.find('.'); dot != std::string::npos; dot = key.path.find('.', dot + 1))
      known.push_back(key.path.substr(0, dot));
    known.push_back(key.path);
  }
  std::string best = nearest_path(schema, known);
  const std::string name = "ssram.banks.NAME";
  if (is_below(best, name) && is_below(schema, name))
    best = path.substr(0, path.find('.', name.size() - 4)) + best.substr(name.size());
  return best;
}

struct Names {
  std::vector<std::string> all;
  std::vector<std::string> required;
};

// The names directly below a path. All paths are computed once, because sweeps read thousands of boards.
const Names& names_below(std::string_view path) {
  static const std::map<std::string, Names, std::less<>> kNames = [] {
    std::map<std::string, Names, std::less<>> found;
    const auto add = [&found](const std::string& full, bool is_required) {
      const std::size_t dot = full.rfind('.');
      Names& names = found[dot == std::string::npos ? "" : full.substr(0, dot)];
      const std::string name(last_part(full));
      if (!names.all.empty() && names.all.back() == name) return;
      names.all.push_back(name);
      if (is_required) names.required.push_back(name);
    };
    for (const Key& key : board_keys()) {
      for (std::size_t dot = key.path.find('.'); dot != std::string::npos;
           dot = key.path.find('.', dot + 1)) {
        const std::string section = key.path.substr(0, dot);
        if (found.count(section) == 0) add(section, last_part(section) != kEnergySection);
        found[section];
      }
      add(key.path, !key.is_optional);
    }
    return found;
  }();
  static const Names kNone;
  const auto found = kNames.find(path);
  return found == kNames.end() ? kNone : found->second;
}

}  // namespace

std::string below(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + '.' + name;
}

bool is_below(std::string_view path, std::string_view section) {
  return path.size() > section.size() && path[section.size()] == '.' &&
         path.substr(0, section.size()) == section;
}

const std::vector<std::string>& child_keys(std::string_view path) { return names_below(path).all; }

const std::vector<std::string>& required_keys(std::string_view path) { return names_below(path).required; }

std::size_t required_count(std::string_view path) {
  const auto& names = required_keys(path);
  if (find_key(path) != nullptr || names.empty()) return 1;
  std::size_t count = 0;
  for (const std::string& name : names) count += required_count(below(std::string(path), name));
  return count;
}

std::string rule_text(std::string_view path) {
  if (const Key* const key = find_key(path)) return key->rule.text;
  if (path == "ssram.banks") return "a map of " + memory::kBankCountRule.text() + " banks";
  return fmt::format("a map of {}", fmt::join(child_keys(path), ", "));
}

std::string schema_path(const std::string& path) {
  const std::string banks = "ssram.banks.";
  if (path.compare(0, banks.size(), banks) != 0) return path;
  const std::size_t end = path.find('.', banks.size());
  return banks + "NAME" + (end == std::string::npos ? "" : path.substr(end));
}

std::string nearest_path(const std::string& path, const std::vector<std::string>& known) {
  const std::string* best = nullptr;
  std::size_t best_distance = std::numeric_limits<std::size_t>::max();
  for (const std::string& each : known) {
    if (is_below(path, each) || path == each) continue;  // a section that holds `path`, or of a bank
    auto distance = likely_path_distance(path, each);
    const auto moved = likely_distance(last_part(path), last_part(each));
    if (moved && (!distance || *moved + 2 < *distance)) distance = *moved + 2;
    if (!distance || *distance >= best_distance) continue;
    best = &each;
    best_distance = *distance;
  }
  return best == nullptr ? "" : *best;
}

std::string unknown_key_text(const std::string& path) {
  const std::string nearest = nearest_key(path);
  const bool is_section = find_key(schema_path(nearest)) == nullptr;
  if (!nearest.empty() && (!is_section || section_of(nearest) == section_of(path)))
    return "unknown key; nearest known key: " + nearest;
  std::string section = section_of(path);
  while (!section.empty() && child_keys(schema_path(section)).empty()) section = section_of(section);
  if (section.empty()) section = nearest;
  if (section.empty()) return "unknown key, and no known key is near";
  return fmt::format("unknown key; keys of {}: {}", section,
                     fmt::join(child_keys(schema_path(section)), ", "));
}

}  // namespace stereotlm::platform

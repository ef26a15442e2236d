#include "platform/config/value_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "platform/config/key_paths.h"

namespace stereotlm::platform {

namespace {

// The known name in a key such as "census:5", which YAML takes for one word without a value.
std::optional<std::string> name_before_colon(const YamlNode::Entry& entry,
                                             const std::vector<std::string>& known) {
  const bool has_value = entry.value.kind != YamlNode::Kind::kNull || !entry.value.text.empty();
  if (!entry.key.is_scalar() || has_value) return std::nullopt;
  const std::string name = entry.key.text.substr(0, entry.key.text.find(':'));
  const bool is_joined = name.size() + 1 < entry.key.text.size();
  return is_joined && std::find(known.begin(), known.end(), name) != known.end() ? std::optional(name)
                                                                                 : std::nullopt;
}

}  // namespace

void ValueReader::report_between_keys(const Place& place, std::string text) {
  findings_.emplace_back(place, std::move(text));
  findings_.back().is_between_keys = true;
}

void ValueReader::report(const Place& place, const std::string& path, const std::string& value,
                         const std::string& rule) {
  findings_.emplace_back(place, fmt::format("{} = {}: {}", path.empty() ? "the board" : path, value, rule));
}

void ValueReader::report(const std::string& path, const YamlNode& node, const std::string& rule) {
  report(node.place, path, short_text(node), rule);
}

void ValueReader::report_missing(const Place& place, const std::string& path, const std::string& rule) {
  if (!report_missing_) return;
  findings_.emplace_back(place, fmt::format("{}: missing: {}", path, rule));
  findings_.back().missing = path;
}

void ValueReader::report_missing_beside(const Place& place, const std::string& path,
                                        const std::string& rule) {
  report_missing(place, path, rule);
  if (report_missing_) findings_.back().is_between_keys = true;
}

void ValueReader::accept(const std::string& path, const Place& place) {
  valid_.insert_or_assign(path, place);
}

const Place* ValueReader::find(const std::string& path) const {
  const auto found = valid_.find(path);
  return found == valid_.end() ? nullptr : &found->second;
}

bool ValueReader::check_use(const std::string& path, const YamlNode& node) {
  if (!node.misuse.empty()) report(path, node, node.misuse);
  return node.misuse.empty();
}

std::optional<ValueReader::Entries> ValueReader::read_entries(const std::string& path, const YamlNode& node,
                                                              const Place& key,
                                                              const std::vector<std::string>& known,
                                                              const std::vector<std::string>& required) {
  if (!node.misuse.empty()) {  // the message does not show values that a preset added to the map
    report(node.place, path, node.is_map() ? "{..}" : short_text(node), node.misuse);
  }
  if (!node.is_map()) {
    if (node.misuse.empty()) report(path, node, rule_text(schema_path(path)));
    return std::nullopt;
  }
  Entries entries;
  std::set<std::string> joined;  // names that are joined with their value by the colon
  for (const YamlNode::Entry& entry : node.entries) {
    const std::string full = below(path, entry.key.is_scalar() ? entry.key.text : short_text(entry.key));
    if (!entry.key.misuse.empty()) report(entry.key.place, full, short_text(entry.value), entry.key.misuse);
    if (!entry.key.is_scalar() || std::find(known.begin(), known.end(), entry.key.text) == known.end()) {
      const bool is_bank = path == "ssram.banks";
      std::string rule = is_bank ? kBankNameRule : unknown_key_text(full);
      if (const auto name = name_before_colon(entry, known)) {
        joined.insert(*name);
        rule = fmt::format("a blank is missing after the colon: {}: {}", *name,
                           entry.key.text.substr(name->size() + 1));
      }
      report(entry.key.place, full, short_text(entry.value), rule);
    } else if (const auto [first, is_new] = entries.emplace(entry.key.text, &entry); !is_new) {
      report_repeated(entry, *first->second, full);
    }
  }
  for (const std::string& name : required) {
    const std::string full = below(path, name);
    if (entries.count(name) == 0 && joined.count(name) == 0) report_missing(key, full, rule_text(full));
  }
  return entries;
}

void ValueReader::report_repeated(const YamlNode::Entry& entry, const YamlNode::Entry& first,
                                  const std::string& path) {
  const Place& place = first.key.place;
  const bool is_beside = place.source == Place::kBoard && entry.key.place.source == Place::kBoard;
  report(entry.key.place, path, short_text(entry.value),
         is_beside ? fmt::format("repeated key, first at {}:{}", place.line, place.column) : "repeated key");
}

std::optional<int> ValueReader::read_integer(const std::string& path, const YamlNode& node,
                                             const IntegerRule& rule, const std::string& rule_text) {
  if (!check_use(path, node)) return std::nullopt;
  const auto value = integer_of(node);
  if (!value) {
    report(path, node, fmt::format("not an integer (decimal digits, not in quotes); {}", rule_text));
  } else if (!rule.allows(*value)) {
    report(path, node, rule_text);
  } else {
    accept(path, node.place);
    return static_cast<int>(*value);
  }
  return std::nullopt;
}

std::optional<int> ValueReader::read_word(const std::string& path, const YamlNode& node,
                                          const std::vector<std::string>& words) {
  if (!check_use(path, node)) return std::nullopt;
  const auto found = std::find(words.begin(), words.end(), node.text);
  if (!node.is_scalar() || found == words.end()) {
    report(path, node, kMustBeOneOf + listed(words));
    return std::nullopt;
  }
  accept(path, node.place);
  return static_cast<int>(found - words.begin());
}

}  // namespace stereotlm::platform

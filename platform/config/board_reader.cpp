#include "platform/config/board_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

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

// The values in the entry of `ssram.default` or of one bank.
struct BankEntry {
  struct Given {
    Place place;
    std::optional<KeyValue> value;  // nullopt: it could not be read
  };
  Place key;                           // place of the entry's key
  std::map<std::string, Given> given;  // [name of a BankKey]

  const Given* find(const std::string& name) const {
    const auto found = given.find(name);
    return found == given.end() ? nullptr : &found->second;
  }
};

const Place& latest(const Place& first, const Place& second) {
  return second.source > first.source ? second : first;
}

class BoardReader {
 public:
  explicit BoardReader(std::vector<Finding>& findings) : values_(findings) {}

  BoardConfig read(const YamlNode& tree) {
    read_section("", tree, {Place::kBoard, 1, 1});
    check_rules();
    return std::move(board_);
  }

 private:
  void read_section(const std::string& path, const YamlNode& node, const Place& key) {
    const auto entries = values_.read_entries(path, node, key);
    if (!entries) return;
    if (path == "ssram") return read_ssram(*entries);
    for (const YamlNode::Entry* const entry : *entries) {
      const std::string full = below(path, entry->key.text);
      const Key* const known = find_key(full);
      if (known == nullptr) {
        read_section(full, entry->value, entry->key.place);
      } else if (is_section(*known)) {
        read_load(*known, *entry);
      } else if (values_.check_use(known->path, entry->value)) {
        known->read(values_, *known, *entry, board_);
      }
    }
  }

  void read_load(const Key& key, const YamlNode::Entry& entry) {
    if (!values_.check_use(key.path, entry.value) || entry.value.is("none")) return;
    if (!entry.value.is_map()) return values_.report(key.path, entry.value, key.rule.text);
    board_.pci.load.emplace();
    read_section(key.path, entry.value, entry.key.place);
  }

  void read_ssram(const ValueReader::Entries& entries) {
    BankEntry defaults;
    for (const YamlNode::Entry* const entry : entries) {
      if (entry->key.is("default")) defaults = read_bank_entry("ssram.default", *entry);
    }
    for (const YamlNode::Entry* const entry : entries) {
      if (entry->key.is("banks")) read_banks(entry->value, defaults);
    }
  }

  BankEntry read_bank_entry(const std::string& path, const YamlNode::Entry& entry) {
    BankEntry bank{entry.key.place, {}};
    read_bank_values(path, "", entry, bank);
    check_timing_use(path, bank);
    return bank;
  }

  // `section`: below the path of the bank, or empty.
  void read_bank_values(const std::string& path, const std::string& section, const YamlNode::Entry& entry,
                        BankEntry& bank) {
    const std::string full = section.empty() ? path : below(path, section);
    const auto entries = values_.read_entries(full, entry.value, entry.key.place);
    if (!entries) return;
    for (const YamlNode::Entry* const given : *entries) {
      const std::string name = below(section, given->key.text);
      if (name == kEnergySection) read_bank_values(path, name, *given, bank);
      for (const BankKey& key : bank_keys()) {
        if (name != key.name) continue;
        bank.given[name] = {given->value.place, values_.read(below(path, name), given->value, key.rule)};
      }
    }
  }

  // An entry with a timing of another kind than its own is a mistake. If the entry inherits its kind, the
  // timing is allowed, and has an effect only if it is of that kind. So is the time of a refresh beside
  // `off`.
  void check_timing_use(const std::string& path, const BankEntry& entry) {
    const BankEntry::Given* const kind = entry.find("kind");
    const BankEntry::Given* const refresh = entry.find("refresh_interval_cycles");
    for (const BankKey& key : bank_keys()) {
      const BankEntry::Given* const given = entry.find(key.name);
      // Those of a preset count as inherited: the file or `--set` has overridden the kind beside them.
      if (!key.kind || given == nullptr || !given->value || given->place.source == Place::kPreset) continue;
      const auto report = [&](const Place& place, const std::string& rule) {
        values_.report_between_keys(
            latest(given->place, place),
            fmt::format("{}.{} = {}: {}", path, key.name, value_text(*given->value), rule));
      };
      const std::string needed = memory::traits_of(*key.kind).name;
      if (kind != nullptr && kind->value && value_text(*kind->value) != needed) {
        report(kind->place,
               fmt::format("only where the kind is {}, and it is {}", needed, value_text(*kind->value)));
      } else if (key.name == "refresh_cycles" && refresh != nullptr && refresh->value == KeyValue("off")) {
        report(refresh->place, "only with a refresh, and refresh_interval_cycles is off");
      }
    }
  }

  void read_banks(const YamlNode& node, const BankEntry& defaults) {
    const std::string path = "ssram.banks";
    // The number of banks is checked first, because the time to check their names grows with its square.
    if (node.is_map() && !memory::kBankCountRule.allows(static_cast<std::int64_t>(node.entries.size()))) {
      Place place = node.place;
      for (const YamlNode::Entry& entry : node.entries) place = latest(place, entry.key.place);
      return values_.report(place, path, short_text(node),
                            fmt::format("{} banks; {}", node.entries.size(), rule_text(path)));
    }
    const std::size_t before = values_.finding_count();
    const auto entries = values_.read_entries(path, node, node.place);
    if (!entries) return;
    const bool names_valid = values_.finding_count() == before;
    board_.banks.clear();
    std::set<std::string> default_lacks;
    for (const YamlNode::Entry* const entry : *entries)
      read_bank(below(path, entry->key.text), *entry, defaults, default_lacks);
    if (names_valid) values_.accept(path, node.place);
    const BankEntry::Given* const kind = defaults.find("kind");
    for (const BankKey& key : bank_keys()) {
      if (default_lacks.count(key.name) == 0) continue;
      const std::string full = below("ssram.default", key.name);
      values_.report_missing(latest(defaults.key, kind->place), full, rule_text(full), true);
    }
  }

  void read_bank(const std::string& path, const YamlNode::Entry& node, const BankEntry& defaults,
                 std::set<std::string>& default_lacks) {
    const BankEntry own = read_bank_entry(path, node);
    BankConfig bank;
    bank.name = node.key.text;
    for (const BankKey& key : bank_keys()) {
      if (!needs_key(bank, key)) continue;
      const BankEntry::Given* const in_own = own.find(key.name);
      const BankEntry::Given* const given = in_own != nullptr ? in_own : defaults.find(key.name);
      if (given != nullptr && given->value) {
        key.access.set(bank, *given->value);
        values_.accept(below(path, key.name), given->place);
      } else if (given != nullptr || !key.kind || key.is_given) {
        continue;  // reported with its entry, or not needed
      } else if (const auto* const kind = own.find("kind")) {
        values_.report_missing(latest(latest(own.key, kind->place), defaults.key), below(path, key.name),
                               rule_text(below("ssram.banks.NAME", key.name)), true);
      } else {
        default_lacks.insert(key.name);
      }
    }
    if (bank.kind == memory::BankKind::kSdram && !bank.sdram) bank.sdram.emplace();
    board_.banks.push_back(std::move(bank));
  }

  // Reports each broken rule between keys at one of the values that it involves: the value of the last source
  // (preset, file, then each `--set`), or the first of several such values.
  void check_rules() {
    const auto is_valid = [this](const std::string& path) { return values_.find(path) != nullptr; };
    for (const BrokenRule& rule : broken_rules(board_, is_valid)) {
      Place place = *values_.find(rule.involved.front());
      for (const std::string& path : rule.involved) {
        if (const Place* other = values_.find(path)) place = latest(place, *other);
      }
      values_.report_between_keys(place, rule.text);
    }
  }

  ValueReader values_;
  BoardConfig board_;
};

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

void ValueReader::report_missing(const Place& place, const std::string& path, const std::string& rule,
                                 bool is_between_keys) {
  findings_.emplace_back(place, fmt::format("{}: missing: {}", path, rule));
  findings_.back().missing = path;
  findings_.back().is_between_keys = is_between_keys;
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
                                                              const Place& key) {
  if (!node.misuse.empty()) {  // the message does not show values that a preset added to the map
    report(node.place, path, node.is_map() ? "{..}" : short_text(node), node.misuse);
  }
  const std::string schema = schema_path(path);
  if (!node.is_map()) {
    if (node.misuse.empty()) report(path, node, rule_text(schema));
    return std::nullopt;
  }
  const bool is_banks = path == "ssram.banks";
  std::vector<std::string> known = is_banks ? std::vector<std::string>() : child_keys(schema);
  for (const YamlNode::Entry& entry : node.entries) {
    if (is_banks && is_bank_name(entry.key.text)) known.push_back(entry.key.text);
  }
  Entries entries;
  const auto find = [&entries](const std::string& name) {
    return std::find_if(entries.begin(), entries.end(),
                        [&](const YamlNode::Entry* entry) { return entry->key.text == name; });
  };
  std::set<std::string> joined;  // names that are joined with their value by the colon
  for (const YamlNode::Entry& entry : node.entries) {
    const std::string full = below(path, entry.key.is_scalar() ? entry.key.text : short_text(entry.key));
    if (!entry.key.misuse.empty()) report(entry.key.place, full, short_text(entry.value), entry.key.misuse);
    if (!entry.key.is_scalar() || std::find(known.begin(), known.end(), entry.key.text) == known.end()) {
      std::string rule = is_banks ? kBankNameRule : unknown_key_text(full);
      if (const auto name = name_before_colon(entry, known)) {
        joined.insert(*name);
        rule = fmt::format("a blank is missing after the colon: {}: {}", *name,
                           entry.key.text.substr(name->size() + 1));
      }
      report(entry.key.place, full, short_text(entry.value), rule);
    } else if (const auto first = find(entry.key.text); first != entries.end()) {
      const Place& place = (*first)->key.place;
      const bool is_beside = place.source == Place::kBoard && entry.key.place.source == Place::kBoard;
      report(
          entry.key.place, full, short_text(entry.value),
          is_beside ? fmt::format("repeated key, first at {}:{}", place.line, place.column) : "repeated key");
    } else {
      entries.push_back(&entry);
    }
  }
  for (const std::string& name : is_banks ? std::vector<std::string>() : required_keys(schema)) {
    const std::string full = below(path, name);
    if (find(name) == entries.end() && joined.count(name) == 0)
      report_missing(key, full, rule_text(full), false);
  }
  return entries;
}

std::optional<KeyValue> ValueReader::read(const std::string& path, const YamlNode& node,
                                          const ValueRule& rule) {
  if (!check_use(path, node)) return std::nullopt;
  std::optional<KeyValue> value;
  const char* problem = "";
  if (node.is_scalar() && std::find(rule.words.begin(), rule.words.end(), node.text) != rule.words.end()) {
    value = node.text;
  } else if (rule.integers) {
    const auto integer = integer_of(node);
    if (!integer) problem = "not an integer (decimal digits, not in quotes); ";
    if (integer && rule.integers->allows(*integer)) value = *integer;
  } else if (rule.decimals) {
    const auto decimal = decimal_of(node);
    if (!decimal) problem = "not a decimal number (such as 29.97, not in quotes); ";
    if (decimal && rule.decimals->allows(*decimal)) value = *decimal;
  } else {
    problem = "must be one of ";
  }
  if (value) {
    accept(path, node.place);
  } else {
    report(path, node, problem + rule.text);
  }
  return value;
}

BoardConfig read_board(const YamlNode& tree, std::vector<Finding>& findings) {
  return BoardReader(findings).read(tree);
}

std::vector<std::string> problems(const BoardConfig& board) {
  YamlNode tree = board_node(board);
  for_each_node(tree, [](YamlNode& node) { node.place.source = Place::kPreset; });
  std::vector<Finding> findings;
  read_board(tree, findings);
  std::vector<std::string> texts;
  for (Finding& finding : findings) texts.push_back(std::move(finding.text));
  return texts;
}

const BoardConfig& require_valid(const BoardConfig& board) {
  const std::vector<std::string> found = problems(board);
  if (!found.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(found, "\n")));
  return board;
}

}  // namespace stereotlm::platform

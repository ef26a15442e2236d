#include "platform/config/board_reader.h"

#include <fmt/format.h>

#include <optional>
#include <utility>
#include <variant>

#include "platform/config/board_keys.h"
#include "platform/config/board_rules.h"
#include "platform/config/key_paths.h"

namespace stereotlm::platform {
namespace {

// A value of `ssram.default` or of a bank, if the tree has it, and its place. `value` is empty if it could
// not be read.
struct Given {
  bool present = false;
  Place place;
  std::optional<int> value;
};

// The entry of `ssram.default` or of one bank. `key` is the place of its key.
struct BankEntry {
  Place key;
  Given words;
  Given kind;  // index of memory::kBankTraits
  Given turnaround_cycles;
};

// Null if there is no kind, or it could not be read.
const memory::BankTraits* traits_of(const Given& kind) {
  return kind.value ? &memory::kBankTraits[static_cast<std::size_t>(*kind.value)] : nullptr;
}

const Place& latest(const Place& first, const Place& second) {
  return second.source > first.source ? second : first;
}

class BoardReader {
 public:
  BoardReader(bool report_missing, std::vector<Finding>& findings) : values_(report_missing, findings) {}

  BoardConfig read(const YamlNode& tree) {
    read_section("", tree, {Place::kBoard, 1, 1});
    check_rules();
    return std::move(board_);
  }

 private:
  void read_section(const std::string& path, const YamlNode& node, const Place& key) {
    const auto entries = values_.read_entries(path, node, key, child_keys(path), required_keys(path));
    if (!entries) return;
    if (path == "ssram") return read_ssram(*entries);
    for (const auto& [name, entry] : *entries) {
      const std::string full = below(path, name);
      const Key* const known = find_key(full);
      if (known == nullptr) {
        read_section(full, entry->value, entry->key.place);
      } else if (const auto* const section = std::get_if<SectionKey>(&known->kind)) {
        read_optional_section(*known, *section, *entry);
      } else {
        read_value(values_, *known, *entry, board_);
      }
    }
  }

  void read_optional_section(const Key& key, const SectionKey& section, const YamlNode::Entry& entry) {
    if (!values_.check_use(key.path, entry.value)) return;
    const bool is_none = entry.value.is("none");
    if (!is_none && !entry.value.is_map()) return values_.report(key.path, entry.value, key.rule_text);
    section.give(board_, !is_none);
    if (!is_none) read_section(key.path, entry.value, entry.key.place);
  }

  void read_ssram(const ValueReader::Entries& entries) {
    BankEntry defaults;
    if (const auto found = entries.find("default"); found != entries.end())
      defaults = read_bank_entry("ssram.default", *found->second);
    if (const auto found = entries.find("banks"); found != entries.end())
      read_banks(found->second->value, defaults);
  }

  BankEntry read_bank_entry(const std::string& path, const YamlNode::Entry& entry) {
    BankEntry bank;
    bank.key = entry.key.place;
    const std::string schema = schema_path(path);
    const auto entries =
        values_.read_entries(path, entry.value, entry.key.place, child_keys(schema), required_keys(schema));
    if (!entries) return bank;
    for (const auto& [name, given] : *entries) {
      const std::string full = below(path, name);
      const auto& numbers = board_key(below(schema, name)).numbers;
      const std::optional<int> value =
          numbers ? values_.read_integer(full, given->value, *numbers, numbers->text())
                  : values_.read_word(full, given->value, bank_kind_names());
      Given& field = !numbers ? bank.kind : name == "words" ? bank.words : bank.turnaround_cycles;
      field = {true, given->value.place, value};
    }
    check_turnaround_use(path, bank);
    return bank;
  }

  // An entry with turnaround cycles and a kind without turnaround is a mistake. If the entry inherits its
  // kind, turnaround cycles are allowed, and have an effect only if that kind has turnaround.
  void check_turnaround_use(const std::string& path, const BankEntry& entry) {
    const Given& given = entry.turnaround_cycles;
    const Given& kind = entry.kind;
    if (!given.value || !kind.value || traits_of(kind)->has_turnaround) return;
    // Turnaround cycles of a preset count as inherited: the file or `--set` has overridden the kind beside
    // them.
    if (given.place.source == Place::kPreset) return;
    values_.report_between_keys(
        latest(given.place, kind.place),
        fmt::format("{}.turnaround_cycles = {}: only where the kind is {}, and it is {}", path, *given.value,
                    turnaround_kinds(), traits_of(kind)->name));
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
    std::vector<std::string> names;
    for (const YamlNode::Entry& entry : node.entries) {
      if (is_bank_name(entry.key.text)) names.push_back(entry.key.text);
    }
    const std::size_t before = values_.finding_count();
    const auto entries = values_.read_entries(path, node, node.place, names, {});
    if (!entries) return;
    const bool names_valid = values_.finding_count() == before;
    board_.banks.clear();
    bool default_lacks_turnaround = false;
    for (const YamlNode::Entry& entry : node.entries) {  // in the order of the file
      const auto found = entries->find(entry.key.text);
      if (found == entries->end() || found->second != &entry) continue;
      read_bank(below(path, entry.key.text), entry, defaults, default_lacks_turnaround);
    }
    if (names_valid) values_.accept(path, node.place);
    if (default_lacks_turnaround) {
      values_.report_missing_beside(latest(defaults.key, defaults.kind.place),
                                    "ssram.default.turnaround_cycles",
                                    rule_text("ssram.default.turnaround_cycles"));
    }
  }

  void read_bank(const std::string& path, const YamlNode::Entry& node, const BankEntry& defaults,
                 bool& default_lacks_turnaround) {
    const BankEntry own = read_bank_entry(path, node);
    const auto given = [&](Given BankEntry::*field) {
      return (own.*field).present ? own.*field : defaults.*field;
    };
    const Given words = given(&BankEntry::words);
    const Given turnaround = given(&BankEntry::turnaround_cycles);
    const memory::BankTraits* const traits = traits_of(given(&BankEntry::kind));
    if (traits != nullptr && traits->has_turnaround && !turnaround.present) {
      if (own.kind.present) {
        values_.report_missing_beside(latest(latest(own.key, own.kind.place), defaults.key),
                                      path + ".turnaround_cycles",
                                      rule_text("ssram.banks.NAME.turnaround_cycles"));
      } else {
        default_lacks_turnaround = true;
      }
    }
    BankConfig bank;
    bank.name = node.key.text;
    if (words.value) {
      bank.words = *words.value;
      values_.accept(path + ".words", words.place);
    }
    if (traits != nullptr) {
      bank.kind = traits->kind;
      if (traits->has_turnaround) bank.turnaround_cycles = turnaround.value.value_or(0);
    }
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

BoardConfig read_board(const YamlNode& tree, bool report_missing, std::vector<Finding>& findings) {
  return BoardReader(report_missing, findings).read(tree);
}

}  // namespace stereotlm::platform

#include "platform/config/board_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include "models/fpga/core_ports.h"
#include "models/kernels/stereo.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_rules.h"
#include "platform/config/buffer_layout.h"
#include "platform/config/value_reader.h"
#include "platform/config/yaml_values.h"

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
  Given kind;  // index into memory::kBankTraits
  Given turnaround_cycles;
};

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
    if (path == "ssram") {
      read_ssram(*entries);
      return;
    }
    for (const auto& named : *entries) {
      const std::string full = below(path, named.first);
      const YamlNode::Entry& entry = *named.second;
      const auto& keys = board_keys();
      const auto known = std::find_if(keys.begin(), keys.end(), [&](const Key& k) { return k.path == full; });
      if (known == keys.end()) {
        read_section(full, entry.value, entry.key.place);
      } else if (values_.check_use(full, entry.value)) {
        std::visit([&](const auto& rule) { read_key(*known, rule, entry); }, known->rule);
      }
    }
  }

  void read_key(const Key& key, const IntegerKey& rule, const YamlNode::Entry& entry) {
    if (const auto value = values_.read_integer(key.path, entry.value, rule.rule, key.rule_text)) {
      rule.field(board_) = *value;
    }
  }
  void read_key(const Key& key, const DecimalKey& rule, const YamlNode::Entry& entry) {
    const auto value = decimal_of(entry.value);
    if (!value) {
      values_.report(key.path, entry.value,
                     fmt::format("not a decimal number (such as 29.97, not in quotes); {}", key.rule_text));
    } else if (!rule.allows(*value)) {
      values_.report(key.path, entry.value, key.rule_text);
    } else {
      values_.accept(key.path, entry.value.place);
      rule.field(board_) = *value;
    }
  }
  void read_key(const Key& key, const WordKey& rule, const YamlNode::Entry& entry) {
    if (const auto index = values_.read_word(key.path, entry.value, rule.words)) rule.set(board_, *index);
  }
  void read_key(const Key& key, const OtherKey&, const YamlNode::Entry& entry) {
    const YamlNode& node = entry.value;
    if (key.path == "name") read_name(key, node);
    if (key.path == "pci.load") read_load(key, entry);
    if (key.path == "fpga.priority") read_priority(key, node);
    if (const auto buffer = buffer_of_key(key.path))
      visit_buffer(board_.allocation, *buffer, [&](auto& banks) { read_banks_of(key, node, banks); });
    if (key.path == "matcher.filter") read_filter(key, entry);
    if (key.path == "matcher.lr_tolerance")
      read_integer_or(key, node, "off", kernels::kLrToleranceRule, board_.matcher.lr_tolerance);
    if (key.path == "matcher.units")
      read_integer_or(key, node, "all", fpga::kUnitsRule, board_.matcher.units);
    if (key.path == "matcher.cost") read_cost(key, entry);
  }

  void read_name(const Key& key, const YamlNode& node) {
    if (!is_text(node) || !is_board_name(node.text)) {
      values_.report(key.path, node, key.rule_text);
    } else {
      board_.name = node.text;
    }
  }

  void read_load(const Key& key, const YamlNode::Entry& entry) {
    const YamlNode& node = entry.value;
    if (node.is_scalar() && node.text == "none") {
      board_.pci.load = std::nullopt;
    } else if (!node.is_map()) {
      values_.report(key.path, node, key.rule_text);
    } else {
      board_.pci.load = PciLoadConfig();
      read_section(key.path, node, entry.key.place);
    }
  }

  void read_priority(const Key& key, const YamlNode& node) {
    if (!node.is_list()) return values_.report(key.path, node, key.rule_text);
    std::vector<std::string> names;
    for (const fpga::CorePort& port : fpga::kPorts) names.emplace_back(port.name);
    memory::PriorityList ports;
    bool all_known = true;
    for (const YamlNode& item : node.items) {
      const auto index = values_.read_word(key.path, item, names);
      all_known = all_known && index;
      if (!index) continue;
      if (std::find(ports.begin(), ports.end(), *index) != ports.end()) {
        values_.report(key.path, item, "repeated; each port once");
        all_known = false;
      }
      ports.push_back(*index);
    }
    if (!all_known) return;
    if (ports.size() != fpga::kPortCount) {
      std::vector<std::string> lacking;
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (std::find(ports.begin(), ports.end(), i) == ports.end()) lacking.push_back(names[i]);
      }
      return values_.report(key.path, node,
                            fmt::format("each port once; {} missing", fmt::join(lacking, ", ")));
    }
    board_.fpga.arbiter.priority = ports;
  }

  // Reads the names of banks. Whether they exist is a rule between keys, which check_rules() checks.
  void read_banks_of(const Key& key, const YamlNode& node, std::vector<std::string>& banks) {
    const std::vector<YamlNode> single = {node};
    const std::vector<YamlNode>& items = node.is_list() ? node.items : single;
    if (items.empty() || items.size() > kMaximumBuffers) return values_.report(key.path, node, key.rule_text);
    banks.clear();
    bool all_read = true;
    for (const YamlNode& item : items) {
      if (!values_.check_use(key.path, item)) {
        all_read = false;
      } else if (!item.is_scalar()) {
        values_.report(key.path, item, key.rule_text);
        all_read = false;
      } else {
        values_.accept(fmt::format("{}[{}]", key.path, banks.size()), item.place);
        banks.push_back(item.text);
      }
    }
    if (all_read) values_.accept(key.path, node.place);
  }

  void read_banks_of(const Key& key, const YamlNode& node, std::optional<std::string>& bank) {
    const YamlNode& item = node.is_list() && node.items.size() == 1 ? node.items[0] : node;
    if (!values_.check_use(key.path, item)) return;
    if (!item.is_scalar()) return values_.report(key.path, item, key.rule_text);
    values_.accept(key.path, item.place);
    bank = item.text == "none" ? std::nullopt : std::optional(item.text);
  }

  // Reads an integer, or the word that stands for no value.
  void read_integer_or(const Key& key, const YamlNode& node, const char* none, const IntegerRule& rule,
                       std::optional<int>& field) {
    if (node.is_scalar() && node.text == none) {
      values_.accept(key.path, node.place);
      field = std::nullopt;
    } else if (const auto value = values_.read_integer(key.path, node, rule, key.rule_text)) {
      field = *value;
    }
  }

  void read_cost(const Key& key, const YamlNode::Entry& entry) {
    using kernels::CostKind;
    const YamlNode& node = entry.value;
    if (node.is_map()) {
      const std::vector<std::string> names = {kernels::name_of(CostKind::kCensus)};
      const auto entries = values_.read_entries(key.path, node, entry.key.place, names, names);
      if (!entries || entries->empty()) return;
      const Key& census = board_key("matcher.cost.census");
      const auto size = values_.read_integer(census.path, entries->begin()->second->value,
                                             kernels::kCensusSizeRule, census.rule_text);
      board_.matcher.cost = {CostKind::kCensus,
                             size.value_or(static_cast<int>(kernels::kCensusSizeRule.min))};
      return;
    }
    for (const CostKind kind : {CostKind::kSad, CostKind::kSsd, CostKind::kZncc}) {
      if (!node.is_scalar() || node.text != kernels::name_of(kind)) continue;
      board_.matcher.cost = {kind, 0};
      return;
    }
    values_.report(key.path, node, kMustBeOneOf + key.rule_text);
  }

  void read_filter(const Key& key, const YamlNode::Entry& entry) {
    const YamlNode& node = entry.value;
    if (node.is_scalar() && node.text == "none") {
      board_.matcher.filter = std::nullopt;
    } else if (node.is_scalar() && node.text == "log7") {
      board_.matcher.filter = kernels::log7();
    } else if (!node.is_map()) {
      values_.report(key.path, node, key.rule_text);
    } else {
      const std::vector<std::string> names = {"kernel", "shift"};
      const auto entries = values_.read_entries(key.path, node, entry.key.place, names, names);
      kernels::FilterKernel filter;
      if (entries->count("kernel") > 0) {
        read_kernel(board_key("matcher.filter.kernel"), entries->at("kernel")->value, filter);
      }
      if (entries->count("shift") > 0) {
        const Key& shift = board_key("matcher.filter.shift");
        filter.shift =
            values_
                .read_integer(shift.path, entries->at("shift")->value, kernels::kShiftRule, shift.rule_text)
                .value_or(0);
      }
      board_.matcher.filter = std::move(filter);
    }
  }

  void read_kernel(const Key& key, const YamlNode& node, kernels::FilterKernel& filter) {
    if (!values_.check_use(key.path, node)) return;
    const auto size = static_cast<std::int64_t>(node.items.size());
    if (!node.is_list() || !kernels::kKernelSizeRule.allows(size)) {
      return values_.report(key.path, node, key.rule_text);
    }
    bool all_read = true;
    std::int64_t sum = 0;
    for (const YamlNode& row : node.items) {
      if (!values_.check_use(key.path, row)) {
        all_read = false;
      } else if (!row.is_list() || row.items.size() != node.items.size()) {
        values_.report(key.path, row, fmt::format("a row of {} entries, as many as there are rows", size));
        all_read = false;
      } else {
        for (const YamlNode& item : row.items) {
          const auto weight = values_.read_integer(key.path, item, kernels::kKernelEntryRule,
                                                   "entries " + kernels::kKernelEntryRule.text());
          all_read = all_read && weight;
          sum += weight.value_or(0);
          filter.weights.push_back(weight.value_or(0));
        }
      }
    }
    filter.size = static_cast<int>(size);
    if (all_read && sum != 0) {
      values_.report(key.path, node, fmt::format("the entries' sum must be 0, not {}", sum));
    }
  }

  void read_ssram(const ValueReader::Entries& entries) {
    BankEntry defaults;
    if (const auto found = entries.find("default"); found != entries.end()) {
      defaults = read_bank_entry("ssram.default", *found->second);
    }
    if (const auto found = entries.find("banks"); found != entries.end()) {
      read_banks(found->second->value, defaults);
    }
  }

  BankEntry read_bank_entry(const std::string& path, const YamlNode::Entry& entry) {
    BankEntry bank;
    bank.key = entry.key.place;
    const std::string schema = schema_path(path);
    const auto entries =
        values_.read_entries(path, entry.value, entry.key.place, child_keys(schema), required_keys(schema));
    if (!entries) return bank;
    const auto read = [&](const std::string& name, Given& field, const auto& reader) {
      const auto found = entries->find(name);
      if (found == entries->end()) return;
      const YamlNode& node = found->second->value;
      field = {true, node.place, reader(path + '.' + name, node)};
    };
    const auto integer = [this](const IntegerRule& rule) {
      return [this, rule](const std::string& key, const YamlNode& node) {
        return values_.read_integer(key, node, rule, rule.text());
      };
    };
    read("words", bank.words, integer(memory::kBankWordsRule));
    read("kind", bank.kind, [this](const std::string& key, const YamlNode& node) {
      return values_.read_word(key, node, bank_kind_names());
    });
    read("turnaround_cycles", bank.turnaround_cycles, integer(memory::kTurnaroundRule));
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
  // Null if there is no kind, or it could not be read.
  static const memory::BankTraits* traits_of(const Given& kind) {
    return kind.value ? &memory::kBankTraits[static_cast<std::size_t>(*kind.value)] : nullptr;
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
    const Given& kind = own.kind.present ? own.kind : defaults.kind;
    const Given& words = own.words.present ? own.words : defaults.words;
    const Given& turnaround =
        own.turnaround_cycles.present ? own.turnaround_cycles : defaults.turnaround_cycles;
    const memory::BankTraits* const traits = traits_of(kind);
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

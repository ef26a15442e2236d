#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "platform/config/board_keys.h"
#include "platform/config/board_reader.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

// What a bank gives beside `ssram.default`, which has the values of `base` but for the energy.
YamlNode bank_node(const BankConfig& bank, const BankConfig* base) {
  YamlNode node = YamlNode::map();
  node.style = YamlNode::Style::kOther;
  const bool has_words = base == nullptr || bank.words != base->words;
  const bool has_kind = base == nullptr || bank.kind != base->kind ||
                        bank.turnaround_cycles != base->turnaround_cycles || !(bank.sdram == base->sdram);
  YamlNode energy = YamlNode::map();
  energy.style = YamlNode::Style::kOther;
  for (const BankKey& key : bank_keys()) {
    if (!needs_key(bank, key)) continue;
    if (key.is_given ? key.is_given(bank) : key.name == "words" ? has_words : has_kind)
      (key.is_given ? energy : node)
          .add(YamlNode::plain(key.name.substr(key.name.find('.') + 1)), value_node(key.access.get(bank)));
  }
  if (!energy.entries.empty()) node.add(YamlNode::plain(kEnergySection), std::move(energy));
  return node;
}

// An optional key is left out where it has its default, so that the text of such a board stays what it was
// before there was the key. A section that may be absent is written in full.
bool is_left_out(const Key& key, const BoardConfig& board) {
  static const BoardConfig kDefaults;
  return key.is_optional && has_key(kDefaults, key) && value_of(key, board) == value_of(key, kDefaults);
}

// The section of a board file at this path: "" is the whole board.
YamlNode section_node(const std::string& path, const BoardConfig& board) {
  YamlNode map = YamlNode::map();
  for (const std::string& name : child_keys(path)) {
    const std::string full = below(path, name);
    const Key* const key = find_key(full);
    YamlNode value;
    if (full == "ssram.default") {
      const BankConfig first = board.banks.empty() ? BankConfig() : board.banks.front();
      value = bank_node({"", first.words, first.kind, first.turnaround_cycles, first.sdram}, nullptr);
    } else if (full == "ssram.banks") {
      value = YamlNode::map();
      for (const BankConfig& bank : board.banks)
        value.add(YamlNode::word(bank.name), bank_node(bank, &board.banks.front()));
    } else if (key == nullptr || is_section(*key)) {
      if (key != nullptr && !board.pci.load) continue;
      value = section_node(full, board);
    } else {
      if (is_left_out(*key, board)) continue;
      value = key->write(board);
    }
    map.add(YamlNode::plain(name), std::move(value));
  }
  return map;
}

// The value as `--set` takes it.
std::string set_text(const Key& key, const BoardConfig& board) {
  const bool is_flow =
      key.path == "name" || key.path == key_of(Buffer::kLeftLut) || key.path == key_of(Buffer::kRightLut);
  return is_flow ? flow_text(key.write(board)) : value_text(value_of(key, board));
}

// The values of `--set` that give the banks of `to` to a board with the banks of `from`.
std::vector<std::string> bank_sets(const BoardConfig& from, const BoardConfig& to) {
  std::vector<std::string> sets;
  for (const BankConfig& bank : to.banks) {
    const std::string text = flow_text(bank_node(bank, nullptr));
    const bool is_known = std::any_of(from.banks.begin(), from.banks.end(), [&](const BankConfig& other) {
      return other.name == bank.name && flow_text(bank_node(other, nullptr)) == text;
    });
    if (!is_known) sets.push_back(fmt::format("ssram.banks.{}={}", bank.name, text));
  }
  const bool keeps_places =
      from.banks.size() <= to.banks.size() &&
      std::equal(from.banks.begin(), from.banks.end(), to.banks.begin(),
                 [](const BankConfig& a, const BankConfig& b) { return a.name == b.name; });
  if (keeps_places && sets.size() < 2) return sets;
  const YamlNode ssram = section_node("ssram", to);
  return {"ssram.default=" + flow_text(ssram.entries[0].value),
          "ssram.banks=" + flow_text(ssram.entries[1].value)};
}

}  // namespace

YamlNode board_node(const BoardConfig& board) { return section_node("", board); }

std::string to_yaml(const BoardConfig& board) { return yaml_text(board_node(board)); }

std::vector<BoardValue> values_of(const BoardConfig& board) {
  std::vector<BoardValue> values;
  for (const Key& key : board_keys()) {
    if (has_value(key) && has_key(board, key)) values.push_back({key.path, value_of(key, board)});
  }
  for (const BankConfig& bank : board.banks) {
    const std::string path = below("ssram.banks", bank.name);
    for (const BankKey& key : bank_keys()) {
      if (!needs_key(bank, key) && key.name != "turnaround_cycles") continue;
      const KeyValue value = key.access.get(bank);
      const bool is_off = key.kind && std::holds_alternative<std::string>(value);
      values.push_back({below(path, key.name), is_off ? KeyValue(std::int64_t{0}) : value});
    }
  }
  return values;
}

bool operator==(const BoardConfig& a, const BoardConfig& b) {
  const auto is_same = [](const BoardValue& x, const BoardValue& y) {
    return x.path == y.path && x.value == y.value;
  };
  const std::vector<BoardValue> values = values_of(a);
  const std::vector<BoardValue> others = values_of(b);
  return std::equal(values.begin(), values.end(), others.begin(), others.end(), is_same);
}

std::vector<std::string> sets_between(const BoardConfig& from, const BoardConfig& to) {
  std::vector<std::string> sets = bank_sets(from, to);
  if (from.pci.load && !to.pci.load) sets.emplace_back("pci.load=none");
  for (const Key& key : board_keys()) {
    if (!has_value(key) || !has_key(to, key)) continue;
    const std::string text = set_text(key, to);
    if (!has_key(from, key) || set_text(key, from) != text) sets.push_back(key.path + "=" + text);
  }
  return sets;
}

std::pair<std::string, std::vector<std::string>> sets_of_nearest_preset(const BoardConfig& board) {
  std::pair<std::string, std::vector<std::string>> nearest;
  for (const std::string& name : preset_names()) {
    std::vector<std::string> sets = sets_between(load_board(name), board);
    if (nearest.first.empty() || sets.size() < nearest.second.size()) nearest = {name, std::move(sets)};
  }
  return nearest;
}

}  // namespace stereotlm::platform

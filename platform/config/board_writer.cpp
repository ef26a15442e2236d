#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "platform/config/board_keys.h"
#include "platform/config/board_reader.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

// What a bank gives beside `ssram.default`, which has the values of `base`.
YamlNode bank_node(const BankConfig& bank, const BankConfig* base) {
  YamlNode node = YamlNode::map();
  node.style = YamlNode::Style::kOther;
  if (base == nullptr || bank.words != base->words)
    node.add(YamlNode::plain("words"), YamlNode::plain(std::to_string(bank.words)));
  if (base != nullptr && bank.kind == base->kind && bank.turnaround_cycles == base->turnaround_cycles &&
      bank.sdram == base->sdram)
    return node;
  node.add(YamlNode::plain("kind"), YamlNode::word(memory::traits_of(bank.kind).name));
  for (const BankTimingKey& key : bank_timing_keys()) {
    if (!needs_key(bank, key)) continue;
    const int value = key.get(bank);
    node.add(YamlNode::plain(key.name),
             key.may_be_off && value == 0 ? YamlNode::word("off") : YamlNode::plain(std::to_string(value)));
  }
  return node;
}

// An optional key is left out where it has its default, so that the text of such a board stays what it was
// before there was the key. A section that may be absent is written in full.
bool is_left_out(const Key& key, const YamlNode& value) {
  static const auto kDefaults = [] {
    const BoardConfig defaults;
    std::unordered_map<std::string_view, std::string> texts;
    for (const Key& optional : board_keys()) {
      if (optional.is_optional && optional.write && has_key(defaults, optional))
        texts[optional.path] = flow_text(optional.write(defaults));
    }
    return texts;
  }();
  const auto text = kDefaults.find(key.path);
  return text != kDefaults.end() && flow_text(value) == text->second;
}

// The section of a board file at this path: "" is the whole board.
YamlNode section_node(const std::string& path, const BoardConfig& board) {
  YamlNode map = YamlNode::map();
  for (const std::string& name : child_keys(path)) {
    const std::string full = below(path, name);
    const Key* const key = find_key(full);
    YamlNode value;
    if (full == "ssram.default") {
      value = bank_node(board.banks.empty() ? BankConfig() : board.banks.front(), nullptr);
    } else if (full == "ssram.banks") {
      value = YamlNode::map();
      for (const BankConfig& bank : board.banks)
        value.add(YamlNode::word(bank.name), bank_node(bank, &board.banks.front()));
    } else if (key == nullptr || is_section(*key)) {
      if (key != nullptr && !board.pci.load) continue;
      value = section_node(full, board);
    } else {
      value = key->write(board);
      if (is_left_out(*key, value)) continue;
    }
    map.add(YamlNode::plain(name), std::move(value));
  }
  return map;
}

std::variant<std::int64_t, double, std::string> plain_value(const Key& key, const YamlNode& node) {
  if (std::holds_alternative<DecimalKey>(key.kind))
    return decimal_of(node).value_or(0);  // not finite: not of a valid board
  if (const auto integer = integer_of(node)) return *integer;
  return node.is_scalar() ? node.text : flow_text(node);
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
  if (sets.size() < 2) return sets;
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
    if (has_value(key) && has_key(board, key))
      values.push_back({key.path, plain_value(key, key.write(board))});
  }
  for (const BankConfig& bank : board.banks) {
    const std::string path = below("ssram.banks", bank.name);
    values.push_back({path + ".words", std::int64_t{bank.words}});
    values.push_back({path + ".kind", memory::traits_of(bank.kind).name});
    values.push_back({path + ".turnaround_cycles", std::int64_t{bank.turnaround_cycles}});
    for (const BankTimingKey& key : bank_timing_keys()) {
      if (key.kind == memory::BankKind::kSdram && needs_key(bank, key))
        values.push_back({below(path, key.name), std::int64_t{key.get(bank)}});
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
  const auto text_of = [](const BoardValue& value) {
    if (const auto* const decimal = std::get_if<double>(&value.value)) return decimal_text(*decimal);
    if (const auto* const integer = std::get_if<std::int64_t>(&value.value)) return std::to_string(*integer);
    const bool is_bank = value.path == key_of(Buffer::kLeftLut) || value.path == key_of(Buffer::kRightLut);
    const std::string& text = std::get<std::string>(value.value);
    return is_bank && text[0] != '{' ? flow_text(YamlNode::word(text)) : text;
  };
  std::map<std::string, std::string> before;
  for (const BoardValue& value : values_of(from)) before[value.path] = text_of(value);
  std::vector<std::string> sets = bank_sets(from, to);
  if (from.pci.load && !to.pci.load) sets.emplace_back("pci.load=none");
  for (const BoardValue& value : values_of(to)) {
    if (!is_below(value.path, "ssram") && before[value.path] != text_of(value))
      sets.push_back(value.path + "=" + text_of(value));
  }
  return sets;
}

}  // namespace stereotlm::platform

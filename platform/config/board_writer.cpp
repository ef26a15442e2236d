#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "platform/config/board_keys.h"
#include "platform/config/board_rules.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "platform/config/value_reader.h"
#include "platform/config/yaml_values.h"

namespace stereotlm::platform {
namespace {

std::string banks_text(std::vector<std::string> banks) {
  for (std::string& bank : banks) bank = scalar_text(bank);
  return list_text(banks);
}
std::string banks_text(const std::optional<std::string>& bank) { return scalar_text(bank.value_or("none")); }

std::vector<std::string> filter_rows(const kernels::FilterKernel& filter) {
  std::vector<std::string> rows;
  for (int row = 0; row < filter.size; ++row) {
    std::vector<std::string> weights;
    weights.reserve(static_cast<std::size_t>(filter.size));
    for (int column = 0; column < filter.size; ++column) {
      weights.push_back(std::to_string(filter.weight(column, row)));
    }
    rows.push_back(list_text(weights));
  }
  return rows;
}

std::string filter_text(const kernels::FilterKernel& filter) {
  if (filter == kernels::log7()) return "log7";
  const std::vector<std::string> rows = filter_rows(filter);
  return fmt::format("\n    kernel:\n      - {}\n    shift: {}", fmt::join(rows, "\n      - "), filter.shift);
}

std::string filter_flow_text(const kernels::FilterKernel& filter) {
  if (filter == kernels::log7()) return "log7";
  return fmt::format("{{kernel: {}, shift: {}}}", list_text(filter_rows(filter)), filter.shift);
}

class BoardWriter {
 public:
  explicit BoardWriter(const BoardConfig& board) : board_(board), writable_(board) {}

  std::string write() {
    write_children("", "");
    return std::move(out_);
  }

  // The values of `--set` that give a board with the banks `from` those of this board.
  std::vector<std::string> bank_sets(const std::vector<BankConfig>& from) const {
    std::vector<std::string> sets;
    std::vector<std::string> whole;
    for (const BankConfig& bank : board_.banks) {
      whole.push_back(fmt::format("{}: {}", scalar_text(bank.name), bank_text(bank)));
      const bool is_known = std::any_of(from.begin(), from.end(), [&](const BankConfig& other) {
        return other.name == bank.name && whole_bank_text(other) == whole_bank_text(bank);
      });
      if (!is_known) sets.push_back(fmt::format("ssram.banks.{}={}", bank.name, whole_bank_text(bank)));
    }
    if (sets.size() < 2) return sets;
    return {"ssram.default=" + default_text(), fmt::format("ssram.banks={{{}}}", fmt::join(whole, ", "))};
  }

  std::vector<BoardValue> values() {
    for (const Key& key : board_keys()) {
      if (key.path == "pci.load" || key.path.find("matcher.filter.") == 0 ||
          key.path.find("matcher.cost.") == 0)
        continue;  // not a value: a map, or a part of `matcher.filter` or `matcher.cost`
      if (key.path.find("pci.load.") == 0 && !board_.pci.load) continue;
      if (key.path.find("ssram.") == 0) continue;
      values_.push_back({key.path, std::visit([&](const auto& rule) { return value(key, rule); }, key.rule)});
    }
    for (const BankConfig& bank : board_.banks) {
      const std::string path = below("ssram.banks", bank.name);
      values_.push_back({path + ".words", std::int64_t{bank.words}});
      values_.push_back({path + ".kind", memory::traits_of(bank.kind).name});
      values_.push_back({path + ".turnaround_cycles", std::int64_t{bank.turnaround_cycles}});
    }
    return std::move(values_);
  }

 private:
  using Value = decltype(BoardValue::value);

  Value value(const Key&, const IntegerKey& integer) { return std::int64_t{integer.field(writable_)}; }
  Value value(const Key&, const DecimalKey& decimal) { return decimal.field(writable_); }
  Value value(const Key& key, const WordKey& word) { return value_text(key, word); }
  Value value(const Key& key, const OtherKey& other) {
    if (key.path == "name") return board_.name;
    if (key.path == key_of(Buffer::kLeftLut)) return board_.allocation.left_lut.value_or("none");
    if (key.path == key_of(Buffer::kRightLut)) return board_.allocation.right_lut.value_or("none");
    if (key.path == "matcher.filter")
      return board_.matcher.filter ? filter_flow_text(*board_.matcher.filter) : "none";
    if (key.path == "matcher.lr_tolerance") {
      if (const auto& tolerance = board_.matcher.lr_tolerance) return std::int64_t{*tolerance};
      return "off";
    }
    if (key.path == "matcher.units") {
      if (const auto& units = board_.matcher.units) return std::int64_t{*units};
      return "all";
    }
    return value_text(key, other);
  }

  void write_children(const std::string& path, const std::string& indent) {
    for (const std::string& name : child_keys(path)) {
      const std::string full = below(path, name);
      if (full == "pci.load" && !board_.pci.load) continue;
      const bool is_map = !child_keys(full).empty() && full != "matcher.cost";
      if (!is_map && is_left_out(board_key(full))) continue;
      out_ += fmt::format("{}{}:", indent, name);
      if (full == "matcher.filter") {
        write_line(board_.matcher.filter ? filter_text(*board_.matcher.filter) : "\"none\"");
      } else if (full == "ssram.default") {
        write_line(default_text());
      } else if (full == "ssram.banks") {
        out_ += '\n';
        for (const BankConfig& bank : board_.banks) {
          out_ += fmt::format("{}  {}: {}\n", indent, scalar_text(bank.name), bank_text(bank));
        }
      } else if (is_map) {
        out_ += '\n';
        write_children(full, indent + "  ");
      } else {
        write_line(text_of(board_key(full)));
      }
    }
  }

  std::string text_of(const Key& key) {
    return std::visit([&](const auto& rule) { return value_text(key, rule); }, key.rule);
  }

  // An optional key is left out where it has its default, so that the text of such a board stays what it was
  // before there was the key. A load is written in full.
  bool is_left_out(const Key& key) {
    if (!key.is_optional || key.path.find("pci.load.") == 0) return false;
    static const BoardConfig kDefaults;
    return text_of(key) == BoardWriter(kDefaults).text_of(key);
  }

  void write_line(const std::string& value) {
    if (value.front() != '\n') out_ += ' ';
    out_ += value + '\n';
  }

  std::string value_text(const Key&, const IntegerKey& integer) {
    return std::to_string(integer.field(writable_));
  }
  std::string value_text(const Key&, const DecimalKey& decimal) {
    return decimal_text(decimal.field(writable_));
  }
  std::string value_text(const Key&, const WordKey& word) {
    return word.words[static_cast<std::size_t>(word.get(board_))];
  }
  std::string value_text(const Key& key, const OtherKey&) {
    if (key.path == "name") return scalar_text(board_.name);
    if (key.path == "fpga.priority") {
      std::vector<std::string> ports;
      for (const memory::Port port : board_.fpga.arbiter.priority)
        ports.emplace_back(fpga::kPorts[port].name);
      return list_text(ports);
    }
    if (const auto buffer = buffer_of_key(key.path))
      return visit_buffer(board_.allocation, *buffer, [](const auto& banks) { return banks_text(banks); });
    if (key.path == "matcher.lr_tolerance") {
      const auto& tolerance = board_.matcher.lr_tolerance;
      return tolerance ? std::to_string(*tolerance) : "\"off\"";
    }
    if (key.path == "matcher.units")
      return board_.matcher.units ? std::to_string(*board_.matcher.units) : "all";
    if (key.path == "matcher.cost") return cost_text(board_.matcher.cost);
    throw std::logic_error(key.path + ": a key that the writer does not know");
  }

  static std::string whole_bank_text(const BankConfig& bank) {
    return fmt::format("{{words: {}, {}}}", bank.words, kind_text(bank));
  }
  static std::string kind_text(const BankConfig& bank) {
    const memory::BankTraits& traits = memory::traits_of(bank.kind);
    if (!traits.has_turnaround) return fmt::format("kind: {}", traits.name);
    return fmt::format("kind: {}, turnaround_cycles: {}", traits.name, bank.turnaround_cycles);
  }
  std::string default_text() const { return whole_bank_text(board_.banks.front()); }
  std::string bank_text(const BankConfig& bank) const {
    const BankConfig& first = board_.banks.front();
    std::vector<std::string> parts;
    if (bank.words != first.words) parts.push_back(fmt::format("words: {}", bank.words));
    if (bank.kind != first.kind || bank.turnaround_cycles != first.turnaround_cycles) {
      parts.push_back(kind_text(bank));
    }
    return fmt::format("{{{}}}", fmt::join(parts, ", "));
  }

  const BoardConfig& board_;
  BoardConfig writable_;  // a copy, because the keys' accessors need a mutable board
  std::string out_;
  std::vector<BoardValue> values_;
};

}  // namespace

std::string to_yaml(const BoardConfig& board) {
  const std::vector<std::string> found = problems(board);
  if (!found.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(found, "\n")));
  return BoardWriter(board).write();
}

std::vector<std::string> sets_between(const BoardConfig& from, const BoardConfig& to) {
  const auto text_of = [](const BoardValue& value) {
    if (const auto* const decimal = std::get_if<double>(&value.value)) return decimal_text(*decimal);
    if (const auto* const integer = std::get_if<std::int64_t>(&value.value)) return std::to_string(*integer);
    const bool is_bank = value.path == key_of(Buffer::kLeftLut) || value.path == key_of(Buffer::kRightLut);
    const std::string& text = std::get<std::string>(value.value);
    return is_bank ? scalar_text(text) : text;
  };
  std::map<std::string, std::string> before;
  for (const BoardValue& value : values_of(from)) before[value.path] = text_of(value);
  std::vector<std::string> sets = BoardWriter(to).bank_sets(from.banks);
  if (from.pci.load && !to.pci.load) sets.emplace_back("pci.load=none");
  for (const BoardValue& value : values_of(to)) {
    if (value.path.rfind("ssram.", 0) != 0 && before[value.path] != text_of(value))
      sets.push_back(value.path + "=" + text_of(value));
  }
  return sets;
}

std::vector<BoardValue> values_of(const BoardConfig& board) { return BoardWriter(board).values(); }

}  // namespace stereotlm::platform

#include "platform/config/board_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "platform/config/board_keys.h"
#include "platform/config/board_rules.h"
#include "platform/config/buffer_layout.h"
#include "platform/config/key_paths.h"
#include "platform/config/value_reader.h"

namespace stereotlm::platform {
namespace {

// Finds the broken rules of a board. The place of a finding is the index of its key.
class Checker {
 public:
  explicit Checker(const BoardConfig& board) : board_(board), copy_(board), values_(true, findings_) {}

  std::vector<Finding> check() {
    const std::vector<Key>& keys = board_keys();
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const Key& key = keys[i];
      if (key.path == "ssram.banks.NAME.words") check_banks(place_of(i));
      if (!has_value(key) || !has_key(board_, key) || is_plainly_valid(key, board_)) continue;
      const std::size_t before = findings_.size();
      YamlNode::Entry entry{YamlNode::plain(key.path, place_of(i)), value_node(key, board_)};
      for_each_node(entry.value, [i](YamlNode& node) { node.place = place_of(i); });
      read_value(values_, key, entry, copy_);
      if (findings_.size() > before) broken_.insert(key.path);
    }
    const auto is_valid = [this](const std::string& path) { return broken_.count(path) == 0; };
    for (BrokenRule& rule : broken_rules(board_, is_valid)) {
      const std::string path = schema_path(rule.involved.front());
      const auto key = std::find_if(keys.begin(), keys.end(), [&](const Key& one) {
        return path.compare(0, one.path.size(), one.path) == 0;
      });
      values_.report_between_keys(place_of(static_cast<std::size_t>(key - keys.begin())), rule.text);
    }
    std::stable_sort(findings_.begin(), findings_.end(),
                     [](const Finding& a, const Finding& b) { return a.place.line < b.place.line; });
    return std::move(findings_);
  }

 private:
  static Place place_of(std::size_t key) { return {Place::kFirstSet, static_cast<int>(key), 1}; }

  void check_banks(const Place& place) {
    const auto report = [&](const std::string& path, const std::string& value, const std::string& rule) {
      values_.report(place, path, value, rule);
      broken_.insert(path);
    };
    const std::string path = "ssram.banks";
    if (!memory::kBankCountRule.allows(static_cast<std::int64_t>(board_.banks.size())))
      report(path, fmt::format("{} banks", board_.banks.size()), rule_text(path));
    std::set<std::string> names;
    for (const BankConfig& bank : board_.banks) {
      const std::string own = below(path, bank.name);
      if (!is_bank_name(bank.name)) report(path, bank.name, kBankNameRule);
      if (!names.insert(bank.name).second) report(path, bank.name, "repeated name");
      if (!memory::kBankWordsRule.allows(bank.words))
        report(own + ".words", std::to_string(bank.words), memory::kBankWordsRule.text());
      if (!memory::is_bank_kind(bank.kind)) {
        report(own + ".kind", std::to_string(static_cast<int>(bank.kind)),
               kMustBeOneOf + listed(bank_kind_names()));
      } else if (const auto rule = memory::broken_turnaround_rule(bank.kind, bank.turnaround_cycles);
                 !rule.empty()) {
        report(own + ".turnaround_cycles", std::to_string(bank.turnaround_cycles), rule);
      }
    }
  }

  const BoardConfig& board_;
  BoardConfig copy_;  // that the values are read into
  std::vector<Finding> findings_;
  ValueReader values_;
  std::set<std::string> broken_;  // paths of the values that break a rule of their own
};

void add(std::vector<BufferPlace>& list, const BufferPlace& place) { list.push_back(place); }
void add(std::optional<BufferPlace>& table, const BufferPlace& place) { table = place; }

}  // namespace

std::vector<std::string> problems(const BoardConfig& board) {
  std::vector<std::string> texts;
  for (Finding& finding : Checker(board).check()) texts.push_back(std::move(finding.text));
  return texts;
}

void require_valid(const BoardConfig& board) {
  const std::vector<std::string> found = problems(board);
  if (!found.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(found, "\n")));
}

BufferLayout layout_buffers(const BoardConfig& board) {
  require_valid(board);
  std::vector<std::uint64_t> used(board.banks.size(), 0);
  BufferLayout layout;
  for (const PlacedBuffer& buffer : buffers(board)) {
    const auto bank = std::find_if(board.banks.begin(), board.banks.end(), [&](const BankConfig& candidate) {
      return candidate.name == buffer.bank;
    });
    const auto index = static_cast<std::size_t>(bank - board.banks.begin());
    const BufferPlace place{static_cast<int>(index), static_cast<std::uint32_t>(used[index])};
    used[index] += buffer_words(buffer, board.image);
    visit_buffer(layout, buffer.buffer, [&place](auto& places) { add(places, place); });
  }
  return layout;
}

memory::SsramBankConfig ssram_config(const BoardConfig& board, const BankConfig& bank) {
  return {static_cast<std::uint32_t>(bank.words), bank.kind, bank.turnaround_cycles, board.fpga.clock_mhz};
}

std::vector<memory::SsramBankConfig> ssram_configs(const BoardConfig& board) {
  std::vector<memory::SsramBankConfig> banks;
  for (const BankConfig& bank : board.banks) banks.push_back(ssram_config(board, bank));
  return banks;
}

fpga::CoreConfig core_config(const BoardConfig& board) {
  require_valid(board);
  fpga::CoreConfig core;
  core.width = board.image.width;
  core.height = board.image.height;
  core.window = board.matcher.window;
  core.disparities = board.matcher.disparities;
  core.filter = board.matcher.filter;
  core.fetch = board.matcher.fetch;
  core.units = board.matcher.units;
  core.rows = board.matcher.rows;
  core.cost = board.matcher.cost;
  core.lr_tolerance = board.matcher.lr_tolerance;
  core.left_table = board.allocation.left_lut.has_value();
  core.right_table = board.allocation.right_lut.has_value();
  core.joint_tables = board.fpga.joint_tables;
  core.pixel_cache = board.fpga.pixel_cache;
  core.clock_mhz = board.fpga.clock_mhz;
  core.lane_fifo_slots = board.fpga.lane_fifo_slots;
  core.result_fifo_words = board.fpga.result_fifo_words;
  core.pipeline_latency_cycles = board.fpga.pipeline_latency_cycles;
  return core;
}

std::uint64_t allocation_period_frames(const BoardConfig& board) {
  const AllocationConfig& allocation = board.allocation;
  return std::lcm(std::lcm(allocation.left_image.size(), allocation.right_image.size()),
                  allocation.disparity.size());
}

}  // namespace stereotlm::platform

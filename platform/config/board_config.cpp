#include "platform/config/board_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <variant>

#include "models/kernels/stereo.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_rules.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

// Checks the rules of single fields and stores the path of each key whose field breaks its rule.
class FieldChecker {
 public:
  explicit FieldChecker(const BoardConfig& board) : board_(board), writable_(board) {}

  void check() {
    for (const Key& key : board_keys()) {
      const bool is_of_load = key.path.rfind("pci.load.", 0) == 0;
      if (is_of_load && !board_.pci.load) continue;
      std::visit([&](const auto& rule) { check_key(key, rule); }, key.rule);
    }
  }

  bool broke(const std::string& path) const { return broken_.count(path) > 0; }
  // The problems, sorted by the index of their key in board_keys(): that is the order of the fields.
  std::multimap<std::size_t, std::string> found;

  // The index in board_keys() of the first key at or below the path.
  static std::size_t order_of(const std::string& path) {
    const std::string schema = schema_path(path);
    const auto& keys = board_keys();
    const auto at = std::find_if(keys.begin(), keys.end(), [&](const Key& key) {
      return key.path.compare(0, schema.size(), schema) == 0;
    });
    return static_cast<std::size_t>(at - keys.begin());
  }

 private:
  template <typename Value>
  void report(const std::string& path, const Value& value, const std::string& rule) {
    broken_.insert(path);
    found.emplace(order_of(path), fmt::format("{} = {}: {}", path, value, rule));
  }

  void check_key(const Key& key, const IntegerKey& integer) {
    const int value = integer.field(writable_);
    if (!integer.rule.allows(value)) report(key.path, value, key.rule_text);
  }
  void check_key(const Key& key, const DecimalKey& decimal) {
    const double value = decimal.field(writable_);
    if (!decimal.allows(value)) report(key.path, value, key.rule_text);
  }
  void check_key(const Key& key, const WordKey& word) {
    const int index = word.get(board_);
    if (index >= 0 && index < static_cast<int>(word.words.size())) return;
    report(key.path, word.text(board_), kMustBeOneOf + key.rule_text);
  }
  void check_key(const Key& key, const OtherKey&) {
    if (key.path == "name") {
      if (!is_board_name(board_.name)) report(key.path, board_.name, key.rule_text);
    } else if (key.path == "fpga.priority") {
      check_priority(key);
    } else if (key.path == "ssram.banks.NAME.words") {
      check_banks();
    } else if (const auto buffer = buffer_of_key(key.path)) {
      visit_buffer(board_.allocation, *buffer, [&](const auto& banks) { check_buffer(key, banks); });
    } else if (key.path == "matcher.filter" && board_.matcher.filter) {
      for (const std::string& text : kernels::problems(*board_.matcher.filter)) {
        found.emplace(order_of(key.path), "matcher.filter." + text);
      }
    } else if (key.path == "matcher.lr_tolerance" && board_.matcher.lr_tolerance) {
      const int value = *board_.matcher.lr_tolerance;
      if (!kernels::kLrToleranceRule.allows(value)) report(key.path, value, key.rule_text);
    } else if (key.path == "matcher.units" && board_.matcher.units) {
      const int value = *board_.matcher.units;
      if (!fpga::kUnitsRule.allows(value)) report(key.path, value, key.rule_text);
    } else if (key.path == "matcher.cost.census" && !kernels::problems(board_.matcher.cost).empty()) {
      const kernels::MatchingCost& cost = board_.matcher.cost;
      const bool is_census = cost.kind == kernels::CostKind::kCensus;
      report(key.path, cost.census_size, is_census ? key.rule_text : "0 unless the cost is census");
    }
  }

  void check_priority(const Key& key) {
    const auto& list = board_.fpga.arbiter.priority;
    std::vector<std::string> names;
    for (const memory::Port port : list) {
      names.emplace_back(port < fpga::kPortCount ? fpga::kPorts[port].name : "(no port)");
    }
    const std::set<std::string> different(names.begin(), names.end());
    if (different.size() < list.size() || different.count("(no port)") > 0) {
      report(key.path, list_text(names), key.rule_text);
    }
  }

  void check_banks() {
    if (!memory::kBankCountRule.allows(static_cast<std::int64_t>(board_.banks.size()))) {
      report("ssram.banks", fmt::format("{} banks", board_.banks.size()), rule_text("ssram.banks"));
    }
    std::set<std::string> names;
    for (const BankConfig& bank : board_.banks) {
      const std::string path = "ssram.banks." + bank.name;
      if (!is_bank_name(bank.name)) report("ssram.banks", bank.name, kBankNameRule);
      if (!names.insert(bank.name).second) report("ssram.banks", bank.name, "repeated name");
      if (!memory::kBankWordsRule.allows(bank.words))
        report(path + ".words", bank.words, memory::kBankWordsRule.text());
      if (!memory::is_bank_kind(bank.kind)) {
        report(path + ".kind", static_cast<int>(bank.kind), kMustBeOneOf + listed(bank_kind_names()));
      } else if (const auto rule = memory::broken_turnaround_rule(bank.kind, bank.turnaround_cycles);
                 !rule.empty()) {
        report(path + ".turnaround_cycles", bank.turnaround_cycles, rule);
      }
    }
  }

  void check_buffer(const Key& key, const std::vector<std::string>& banks) {
    if (banks.empty() || banks.size() > kMaximumBuffers) report(key.path, list_text(banks), key.rule_text);
  }
  void check_buffer(const Key&, const std::optional<std::string>&) {}  // a table may be absent

  const BoardConfig& board_;
  BoardConfig writable_;  // a copy, because the keys' accessors need a mutable board
  std::set<std::string> broken_;
};

void add(std::vector<BufferPlace>& list, const BufferPlace& place) { list.push_back(place); }
void add(std::optional<BufferPlace>& table, const BufferPlace& place) { table = place; }

void require_valid(const BoardConfig& board) {
  const std::vector<std::string> found = problems(board);
  if (!found.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(found, "\n")));
}

auto fields(const PciLoadConfig& load) {
  return std::tie(load.burst_words, load.interval_us, load.first_us, load.access_us);
}

auto fields(const BankConfig& bank) {
  return std::tie(bank.name, bank.words, bank.kind, bank.turnaround_cycles);
}

auto fields(const BoardConfig& b) {
  return std::tie(
      b.name, b.image.width, b.image.height, b.cameras.frame_rate_hz, b.cameras.trigger,
      b.capture.destination, b.capture.host_frames, b.capture.fifo_words, b.capture.fifo_trigger_words,
      b.pci.clock_mhz, b.pci.latency_timer_clocks, b.pci.bridge_wait_clocks, b.pci.memory_wait_clocks,
      b.pci.width_bits, b.pci.load, b.bridge.local_clock_mhz, b.bridge.dma_burst_words, b.bridge.posted_words,
      b.fpga.device, b.fpga.clock_mhz, b.fpga.arbiter.policy, b.fpga.arbiter.priority, b.fpga.lane_fifo_slots,
      b.fpga.result_fifo_words, b.fpga.pipeline_latency_cycles, b.allocation.left_image,
      b.allocation.right_image, b.allocation.disparity, b.allocation.left_lut, b.allocation.right_lut,
      b.matcher.window, b.matcher.disparities, b.matcher.filter, b.matcher.fetch, b.matcher.lr_tolerance,
      b.matcher.units, b.matcher.rows, b.matcher.cost, b.fpga.joint_tables, b.fpga.pixel_cache);
}

}  // namespace

bool operator==(const PciLoadConfig& a, const PciLoadConfig& b) { return fields(a) == fields(b); }

bool operator==(const BoardConfig& a, const BoardConfig& b) {
  return fields(a) == fields(b) &&
         std::equal(a.banks.begin(), a.banks.end(), b.banks.begin(), b.banks.end(),
                    [](const BankConfig& x, const BankConfig& y) { return fields(x) == fields(y); });
}

std::vector<std::string> problems(const BoardConfig& board) {
  FieldChecker checker(board);
  checker.check();
  const auto is_valid = [&checker](const std::string& path) { return !checker.broke(path); };
  for (BrokenRule& rule : broken_rules(board, is_valid)) {
    checker.found.emplace(FieldChecker::order_of(rule.involved.front()), std::move(rule.text));
  }
  std::vector<std::string> all;
  for (auto& [order, text] : checker.found) all.push_back(std::move(text));
  return all;
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

#include "platform/config/board_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include "models/area/device.h"
#include "models/area/pins.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_ports.h"
#include "models/kernels/stereo.h"
#include "models/memory/arbitration_policies.h"
#include "models/pci/pci_config.h"
#include "platform/config/board_reader.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

using Entry = YamlNode::Entry;

const std::string kRefreshCycles = "refresh_cycles";

// The value of a key's field. The accessors need a board that is not const.
template <typename Field>
auto value_of(Field field, const BoardConfig& board) {
  return *field(const_cast<BoardConfig&>(board));
}

Key integer(const char* path, int* (*field)(BoardConfig&), std::string meaning, const char* unit,
            const IntegerRule& rule) {
  Key made = {path, std::move(meaning), unit, IntegerKey{field}, rule.text(), rule};
  made.write = [field](const BoardConfig& board) {
    return YamlNode::plain(std::to_string(value_of(field, board)));
  };
  made.read = [field](ValueReader& values, const Key& key, const Entry& entry, BoardConfig& board) {
    if (const auto value = values.read_integer(key, entry.value)) *field(board) = *value;
  };
  return made;
}

// An integer, or a word that stands for no value.
Key integer_or(const char* none, const char* path, std::optional<int>* (*field)(BoardConfig&),
               const char* meaning, const char* unit, const IntegerRule& rule) {
  Key made = {path, meaning, unit, {}, rule.text() + " or " + none, rule};
  made.no_number = none;
  made.write = [none, field](const BoardConfig& board) {
    const std::optional<int> number = value_of(field, board);
    return number ? YamlNode::plain(std::to_string(*number)) : YamlNode::word(none);
  };
  made.read = [none, field](ValueReader& values, const Key& key, const Entry& entry, BoardConfig& board) {
    if (entry.value.is(none)) {
      values.accept(key.path, entry.value.place);
      *field(board) = std::nullopt;
    } else if (const auto value = values.read_integer(key, entry.value)) {
      *field(board) = *value;
    }
  };
  return made;
}

Key decimal(const char* path, double* (*field)(BoardConfig&), const char* meaning, const char* unit,
            double min, double max) {
  const DecimalKey kind = {min, max, field};
  Key made = {path, meaning, unit, kind, fmt::format("{}..{}", min, max), std::nullopt};
  made.write = [field](const BoardConfig& board) {
    return YamlNode::plain(decimal_text(value_of(field, board)));
  };
  made.read = [kind](ValueReader& values, const Key& key, const Entry& entry, BoardConfig& board) {
    const auto value = decimal_of(entry.value);
    if (!value || !kind.allows(*value)) {
      const char* const type = value ? "" : "not a decimal number (such as 29.97, not in quotes); ";
      return values.report(key.path, entry.value, type + key.rule_text);
    }
    values.accept(key.path, entry.value.place);
    *kind.field(board) = *value;
  };
  return made;
}

// A key of one of a few words. The field is an enumeration, whose values are in the order of the words, or
// the word itself.
template <typename Field>
Key word(const char* path, Field field, const char* meaning, const std::vector<std::string>& words) {
  using Value = std::remove_pointer_t<decltype(field(std::declval<BoardConfig&>()))>;
  WordKey kind;
  kind.words = words;
  if constexpr (std::is_same_v<Value, std::string>) {
    kind.get = [field](const BoardConfig& board) { return value_of(field, board); };
    kind.set = [field, words](BoardConfig& board, int index) {
      *field(board) = words[static_cast<std::size_t>(index)];
    };
  } else {
    kind.get = [field, words](const BoardConfig& board) {
      const auto index = static_cast<std::size_t>(value_of(field, board));
      return index < words.size() ? words[index] : std::to_string(index);
    };
    kind.set = [field](BoardConfig& board, int index) { *field(board) = static_cast<Value>(index); };
  }
  Key made = {path, meaning, "", kind, listed(words), std::nullopt};
  made.write = [kind](const BoardConfig& board) { return YamlNode::word(kind.get(board)); };
  made.read = [kind](ValueReader& values, const Key& key, const Entry& entry, BoardConfig& board) {
    if (const auto index = values.read_word(key.path, entry.value, kind.words)) kind.set(board, *index);
  };
  return made;
}

// A value with code of its own.
template <typename Read, typename Write>
Key coded(const char* path, Read read, Write write, std::string meaning, std::string rule) {
  return {path, std::move(meaning), "", {}, std::move(rule), std::nullopt, false, write, read};
}

// A part of the value of another key, whose code reads and writes it; or a key of a bank, or a section.
Key part(const char* path, std::string meaning, const char* unit, std::string rule,
         const std::optional<IntegerRule>& numbers = std::nullopt) {
  return {path, std::move(meaning), unit, {}, std::move(rule), numbers};
}

Key optional(Key key) {
  key.is_optional = true;
  return key;
}

constexpr double microseconds(std::int64_t ps) { return static_cast<double>(ps) / 1e6; }

template <typename Table>
std::vector<std::string> names_in(const Table& table) {
  std::vector<std::string> names;
  for (const auto& row : table) names.emplace_back(row.name);
  return names;
}

const std::vector<std::string>& port_names() {
  static const std::vector<std::string> kNames = names_in(fpga::kPortGroups);
  return kNames;
}

// The meaning of `fpga.priority` under each policy: "the ports, highest priority first; ..".
std::string priority_meaning() {
  std::vector<std::string> meanings;
  for (const memory::ArbitrationPolicy& policy : memory::arbitration_policies())
    meanings.emplace_back(policy.list_meaning);
  return fmt::format("the ports, {}", fmt::join(meanings, "; "));
}

std::string size_meaning(const char* size, const IntegerRule& with_table) {
  return fmt::format("{} of the images, at most {} with a look-up table", size, with_table.max);
}

std::vector<std::string> census_size_texts() {
  const IntegerRule& rule = kernels::kCensusSizeRule;
  std::vector<std::string> texts;
  for (std::int64_t size = rule.min; size <= rule.max; size += rule.step)
    texts.push_back(std::to_string(size));
  return texts;
}

constexpr std::array kPlainCosts = {kernels::CostKind::kSad, kernels::CostKind::kSsd,
                                    kernels::CostKind::kZncc};

std::vector<std::string> cost_texts() {
  std::vector<std::string> texts;
  for (const kernels::CostKind kind : kPlainCosts) texts.push_back(cost_text({kind, 0}));
  for (const std::string& size : census_size_texts())
    texts.push_back(fmt::format("{{{}: {}}}", kernels::name_of(kernels::CostKind::kCensus), size));
  return texts;
}

void read_name(ValueReader& values, const Key& key, const Entry& entry, BoardConfig& board) {
  const std::string& name = entry.value.text;
  const bool is_printable = std::none_of(
      name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
  if (!is_text(entry.value) || name.empty() || !is_printable)
    return values.report(key.path, entry.value, key.rule_text);
  board.name = name;
}

void read_priority(ValueReader& values, const Key& key, const Entry& entry, BoardConfig& board) {
  if (!entry.value.is_list()) return values.report(key.path, entry.value, key.rule_text);
  const std::size_t before = values.finding_count();
  std::vector<std::string> missing = port_names();
  memory::PriorityList ports;
  for (const YamlNode& item : entry.value.items) {
    const auto port = values.read_word(key.path, item, port_names());
    if (!port) continue;
    const auto name = std::find(missing.begin(), missing.end(), item.text);
    if (name == missing.end()) {
      values.report(key.path, item, "repeated; each port once");
    } else {
      missing.erase(name);
    }
    ports.push_back(static_cast<memory::Port>(*port));
  }
  if (values.finding_count() > before) return;
  if (!missing.empty())
    return values.report(key.path, entry.value,
                         fmt::format("each port once; {} missing", fmt::join(missing, ", ")));
  board.fpga.arbiter.priority = ports;
}

YamlNode write_priority(const BoardConfig& board) {
  std::vector<YamlNode> ports;
  for (const memory::Port port : board.fpga.arbiter.priority)
    ports.push_back(YamlNode::word(port < fpga::kGroupCount ? fpga::kPortGroups[port].name : "(no port)"));
  return YamlNode::list(std::move(ports));
}

// Reads the banks of a buffer: a name, or {rows: [names]}. Whether they exist is a rule between keys
// (board_rules.cpp). `path`: of the buffer.
std::optional<BufferBanks> read_buffer(ValueReader& values, const Key& key, const std::string& path,
                                       const YamlNode& node) {
  if (!values.check_use(key.path, node)) return std::nullopt;
  if (node.is_scalar()) {
    values.accept(path, node.place);
    return BufferBanks(node.text);
  }
  const Entry* const entry = node.is_map() && node.entries.size() == 1 ? node.find("rows") : nullptr;
  const std::string rule =
      fmt::format("a stripe {{rows: [..]}} has {} different banks", fpga::kStripeRule.text());
  if (entry == nullptr) {
    values.report(key.path, node, key.rule_text);
    return std::nullopt;
  }
  const YamlNode* const rows = &entry->value;
  std::vector<std::string> banks;
  const std::size_t before = values.finding_count();
  for (const YamlNode& item : rows->items) {
    if (!values.check_use(key.path, item)) continue;
    if (!item.is_scalar()) {
      values.report(key.path, item, rule);
    } else if (std::find(banks.begin(), banks.end(), item.text) != banks.end()) {
      values.report(key.path, item, "twice in one stripe; " + rule);
    } else {
      values.accept(fmt::format("{}.rows[{}]", path, banks.size()), item.place);
      banks.push_back(item.text);
    }
  }
  if (values.finding_count() != before) return std::nullopt;
  if (!rows->is_list() || !fpga::kStripeRule.allows(static_cast<std::int64_t>(banks.size()))) {
    values.report(key.path, *rows, rule);
    return std::nullopt;
  }
  return BufferBanks(banks);
}

void read_banks(ValueReader& values, const Key& key, const YamlNode& node, std::vector<BufferBanks>& list) {
  const std::vector<YamlNode> single = {node};
  const std::vector<YamlNode>& items = node.is_list() ? node.items : single;
  if (items.empty() || items.size() > kMostBuffers) return values.report(key.path, node, key.rule_text);
  const std::size_t before = values.finding_count();
  list.clear();
  for (const YamlNode& item : items) {
    if (auto banks = read_buffer(values, key, fmt::format("{}[{}]", key.path, list.size()), item))
      list.push_back(*banks);
  }
  if (values.finding_count() == before) values.accept(key.path, node.place);
}

void read_banks(ValueReader& values, const Key& key, const YamlNode& node,
                std::optional<BufferBanks>& table) {
  const YamlNode& item = node.is_list() && node.items.size() == 1 ? node.items[0] : node;
  if (auto banks = read_buffer(values, key, key.path, item)) {
    if (banks->is_striped()) values.accept(key.path, item.place);
    table = item.is("none") ? std::nullopt : std::optional(*banks);
  }
}

YamlNode banks_node(const BufferBanks& in) {
  if (!in.is_striped()) return YamlNode::word(in.banks.front());
  std::vector<YamlNode> items;
  for (const std::string& bank : in.banks) items.push_back(YamlNode::word(bank));
  YamlNode node = YamlNode::map();
  node.style = YamlNode::Style::kOther;
  node.add(YamlNode::word("rows"), YamlNode::list(std::move(items)));
  return node;
}
YamlNode banks_node(const std::vector<BufferBanks>& list) {
  std::vector<YamlNode> items;
  for (const BufferBanks& banks : list) items.push_back(banks_node(banks));
  return YamlNode::list(std::move(items));
}
YamlNode banks_node(const std::optional<BufferBanks>& in) {
  return in ? banks_node(*in) : YamlNode::word("none");
}

Key banks_key(Buffer buffer, const char* meaning, const std::string& rule) {
  const auto read = [buffer](ValueReader& values, const Key& key, const Entry& entry, BoardConfig& board) {
    visit_buffer(board.allocation, buffer, [&](auto& banks) { read_banks(values, key, entry.value, banks); });
  };
  const auto write = [buffer](const BoardConfig& board) {
    return visit_buffer(board.allocation, buffer, [](const auto& banks) { return banks_node(banks); });
  };
  return coded(key_of(buffer), read, write, meaning, rule);
}

void read_kernel(ValueReader& values, const Key& key, const YamlNode& node, kernels::FilterKernel& filter) {
  if (!values.check_use(key.path, node)) return;
  const auto size = static_cast<std::int64_t>(node.items.size());
  if (!node.is_list() || !kernels::kKernelSizeRule.allows(size))
    return values.report(key.path, node, key.rule_text);
  const std::size_t before = values.finding_count();
  const std::string rule = "entries " + kernels::kKernelEntryRule.text();
  std::int64_t sum = 0;
  for (const YamlNode& row : node.items) {
    if (!values.check_use(key.path, row)) continue;
    if (!row.is_list() || row.items.size() != node.items.size()) {
      values.report(key.path, row, fmt::format("a row of {} entries, as many as there are rows", size));
      continue;
    }
    for (const YamlNode& item : row.items) {
      filter.weights.push_back(
          values.read_integer(key.path, item, kernels::kKernelEntryRule, rule).value_or(0));
      sum += filter.weights.back();
    }
  }
  filter.size = static_cast<int>(size);
  if (values.finding_count() == before && sum != 0)
    values.report(key.path, node, fmt::format("the entries' sum must be 0, not {}", sum));
}

void read_filter(ValueReader& values, const Key& key, const Entry& entry, BoardConfig& board) {
  const YamlNode& node = entry.value;
  if (node.is("none")) {
    board.matcher.filter = std::nullopt;
  } else if (node.is("log7")) {
    board.matcher.filter = kernels::log7();
  } else if (!node.is_map()) {
    values.report(key.path, node, key.rule_text);
  } else {
    const auto entries =
        values.read_entries(key.path, node, entry.key.place, child_keys(key.path), child_keys(key.path));
    kernels::FilterKernel filter;
    for (const Entry* const part : *entries) {
      if (part->key.is("kernel"))
        read_kernel(values, board_key("matcher.filter.kernel"), part->value, filter);
      else
        filter.shift = values.read_integer(board_key("matcher.filter.shift"), part->value).value_or(0);
    }
    board.matcher.filter = std::move(filter);
  }
}

YamlNode write_filter(const BoardConfig& board) {
  const auto& filter = board.matcher.filter;
  if (!filter) return YamlNode::word("none");
  if (*filter == kernels::log7()) return YamlNode::word("log7");
  std::vector<YamlNode> rows;
  for (std::size_t i = 0; i < filter->weights.size(); ++i) {
    if (filter->size <= 0 || i % static_cast<std::size_t>(filter->size) == 0)
      rows.push_back(YamlNode::list({}));
    rows.back().items.push_back(YamlNode::plain(std::to_string(filter->weights[i])));
  }
  YamlNode node = YamlNode::map();
  node.add(YamlNode::word("kernel"), YamlNode::list(std::move(rows))).style = YamlNode::Style::kOther;
  node.add(YamlNode::word("shift"), YamlNode::plain(std::to_string(filter->shift)));
  return node;
}

void read_cost(ValueReader& values, const Key& key, const Entry& entry, BoardConfig& board) {
  const YamlNode& node = entry.value;
  if (node.is_map()) {
    const auto entries =
        values.read_entries(key.path, node, entry.key.place, child_keys(key.path), child_keys(key.path));
    if (entries->empty()) return;
    const auto size = values.read_integer(board_key("matcher.cost.census"), entries->front()->value);
    board.matcher.cost = {kernels::CostKind::kCensus,
                          size.value_or(static_cast<int>(kernels::kCensusSizeRule.min))};
    return;
  }
  for (const kernels::CostKind kind : kPlainCosts) {
    if (!node.is(kernels::name_of(kind))) continue;
    board.matcher.cost = {kind, 0};
    return;
  }
  values.report(key.path, node, kMustBeOneOf + key.rule_text);
}

YamlNode write_cost(const BoardConfig& board) {
  const kernels::MatchingCost& cost = board.matcher.cost;
  const YamlNode name = YamlNode::word(kernels::name_of(cost.kind));
  if (cost.kind != kernels::CostKind::kCensus && cost.census_size == 0) return name;
  YamlNode node = YamlNode::map();
  node.style = YamlNode::Style::kOther;
  node.add(name, YamlNode::plain(std::to_string(cost.census_size)));
  return node;
}

std::string rule_of(const BankTimingKey& key) {
  const std::string kind = memory::traits_of(key.kind).name;
  if (key.name == kRefreshCycles)
    return fmt::format("{}; required where the kind is {} and refreshes, refused beside off or another kind",
                       key.rule_text(), kind);
  return fmt::format("{}; required where the kind is {}, refused beside another", key.rule_text(), kind);
}

// The keys of `ssram`.
std::vector<Key> bank_keys() {
  const std::string kinds = listed(bank_kind_names());
  const std::string words = memory::kBankWordsRule.text();
  std::vector<Key> keys = {
      part("ssram.default.words", "depth of a bank that gives none of its own", "words", words,
           memory::kBankWordsRule),
      part("ssram.default.kind", "kind of a bank that gives none of its own", "", kinds)};
  const auto add_timing = [&keys](const std::string& path, const char* of) {
    for (const BankTimingKey& key : bank_timing_keys())
      keys.push_back(optional(part((path + key.name).c_str(), fmt::format("{}{}", key.meaning, of), key.unit,
                                   rule_of(key), key.rule)));
  };
  add_timing("ssram.default.", "; of a bank that gives none of its own");
  keys.push_back(optional(
      part("ssram.banks.NAME.words", "depth of the bank NAME", "words", words, memory::kBankWordsRule)));
  keys.push_back(optional(part("ssram.banks.NAME.kind", "kind of the bank NAME", "", kinds)));
  add_timing("ssram.banks.NAME.", "; of the bank NAME");
  return keys;
}

std::vector<Key> make_keys() {
  using B = BoardConfig;
  const std::string one =
      fmt::format("a bank, a stripe {{rows: [..]}} of {} banks, or ", fpga::kStripeRule.text());
  const std::string list_rule = one + "a list of 1 to 3 of them";
  const std::string image_rule = list_rule + "; left_image and right_image equally long";
  const std::string table_rule = one + "none";
  const std::string kinds = listed(bank_kind_names());
  Key trigger_words =
      integer("capture.fifo_trigger_words", [](B& b) { return &b.capture.fifo_trigger_words; },
              "words in the FIFO at which it asks for the PCI bus", "words", {1, 4096});
  trigger_words.rule_text = "1..fifo_words";
  std::vector<Key> all = {
      coded(
          "name", read_name, [](const B& b) { return YamlNode::word(b.name); },
          "the board's name, as results give it",
          "a text of one or more characters without control characters; quoted if it could be read as "
          "a number, a truth value or null"),
      integer(
          "image.width", [](B& b) { return &b.image.width; },
          size_meaning("width", fpga::kWidthWithTableRule), "pixels", fpga::kWidthRule),
      integer(
          "image.height", [](B& b) { return &b.image.height; },
          size_meaning("height", fpga::kHeightWithTableRule), "pixels", fpga::kHeightRule),
      decimal(
          "cameras.frame_rate_hz", [](B& b) { return &b.cameras.frame_rate_hz; },
          "frame rate of both cameras; on demand that of their line times", "Hz", 0.1, 1000),
      word("cameras.trigger", [](B& b) { return &b.cameras.trigger; },
           "whether frames follow a frame clock, or begin when triggered", {"free_running", "on_demand"}),
      word("capture.destination", [](B& b) { return &b.capture.destination; },
           "where capture writes: the FPGA board, or a ring in host memory", {"board", "host_memory"}),
      integer("capture.host_frames", [](B& b) { return &b.capture.host_frames; },
              "pairs in the ring in host memory, which takes at most 1 GiB", "pairs", {1, 64}),
      integer("capture.fifo_words", [](B& b) { return &b.capture.fifo_words; }, "FIFO of a capture board",
              "words", {1, 4096}),
      trigger_words,
      decimal(
          "pci.clock_mhz", [](B& b) { return &b.pci.clock_mhz; }, "clock of the PCI bus", "MHz", 1, 1000),
      integer("pci.latency_timer_clocks", [](B& b) { return &b.pci.latency_timer_clocks; },
              "latency timer of every PCI master", "clocks", {0, 255}),
      integer("pci.bridge_wait_clocks", [](B& b) { return &b.pci.bridge_wait_clocks; },
              "wait clocks of the bridge as a PCI target", "clocks", {0, 255}),
      integer("pci.memory_wait_clocks", [](B& b) { return &b.pci.memory_wait_clocks; },
              "wait clocks of host memory as a PCI target", "clocks", {0, 255}),
      optional(integer(
          "pci.width_bits", [](B& b) { return &b.pci.width_bits; },
          "width of the PCI bus; optional, without it 32", "bits", pci::kWidthRule)),
      optional(part("pci.load", "a third-party master that loads the PCI bus; optional, without it none", "",
                    "none or a map of burst_words, interval_us, first_us, access_us")),
      integer(
          "pci.load.burst_words", [](B& b) { return &b.pci.load.value().burst_words; },
          "words that each transfer of the load reads", "words", pci::kLoadBurstRule),
      decimal(
          "pci.load.interval_us", [](B& b) { return &b.pci.load.value().interval_us; },
          "from one transfer's request to the next, to the nearest picosecond; 0: asks again at once, a hog",
          "us", 0, microseconds(pci::kLoadTimeRule.max)),
      optional(decimal(
          "pci.load.first_us", [](B& b) { return &b.pci.load.value().first_us; },
          "time of the first request, to the nearest picosecond; optional, without it 0", "us", 0,
          microseconds(pci::kLoadTimeRule.max))),
      optional(decimal(
          "pci.load.access_us", [](B& b) { return &b.pci.load.value().access_us; },
          "time that the load's own device makes the bus wait before the first word, to the "
          "nearest picosecond; optional, without it 0",
          "us", 0, microseconds(pci::kLoadAccessRule.max))),
      decimal(
          "bridge.local_clock_mhz", [](B& b) { return &b.bridge.local_clock_mhz; },
          "clock of the bridge's local bus", "MHz", 1, 1000),
      integer("bridge.dma_burst_words", [](B& b) { return &b.bridge.dma_burst_words; },
              "longest burst of a DMA channel", "words", {1, 1024}),
      integer("bridge.posted_words", [](B& b) { return &b.bridge.posted_words; },
              "posted writes that the bridge can hold", "words", {1, 4096}),
      word(
          "fpga.device", [](B& b) { return &b.fpga.device; }, "the FPGA, for its resources",
          names_in(area::kDevices)),
      optional(word(
          "fpga.package", [](B& b) { return &b.fpga.package; },
          "the package of an xc2v6000, whose user pins the board must not exceed; optional, without it any",
          names_in(area::kPackages))),
      decimal(
          "fpga.clock_mhz", [](B& b) { return &b.fpga.clock_mhz; },
          "clock of the FPGA core and of the SSRAM banks", "MHz", 1, 1000),
      word(
          "fpga.arbitration", [](B& b) { return &b.fpga.arbiter.policy; },
          "how a bank picks one of the ports that request it", names_in(memory::arbitration_policies())),
      coded("fpga.priority", read_priority, write_priority, priority_meaning(),
            fmt::format("a list that names each port once: {}", fmt::join(port_names(), ", "))),
      integer(
          "fpga.lane_fifo_slots", [](B& b) { return &b.fpga.lane_fifo_slots; },
          "slots that may be in a lane, taken and not yet consumed", "slots", fpga::kLaneFifoRule),
      integer(
          "fpga.result_fifo_words", [](B& b) { return &b.fpga.result_fifo_words; },
          "queue of result words before the result port; with fewer than 2 for each of matcher.rows "
          "the matcher waits for it",
          "words", fpga::kResultFifoRule),
      integer(
          "fpga.pipeline_latency_cycles", [](B& b) { return &b.fpga.pipeline_latency_cycles; },
          "cycles of registers that the model does not spell out", "cycles", fpga::kPipelineLatencyRule),
      optional(word("fpga.tables", [](B& b) { return &b.fpga.joint_tables; },
                    "whether each side has a look-up table of its own, "
                    "or both share one; optional, without it separate",
                    {"separate", "joint"})),
      optional(word(
          "fpga.pixel_cache", [](B& b) { return &b.fpga.pixel_cache; },
          "whether a lane keeps the last word that it read, for each slot of a column; optional, without it "
          "none",
          {"none", "word"})),
      optional(integer(
          "fpga.lanes", [](B& b) { return &b.fpga.lanes; },
          "lanes of each side, each fetches a pixel in a cycle; at most matcher.window + matcher.rows - 1, "
          "and 1 "
          "unless matcher.fetch is column; optional, without it 1",
          "lanes", fpga::kLanesRule)),
      banks_key(Buffer::kLeftImage, "banks of the left input buffers, used in turn", image_rule),
      banks_key(Buffer::kRightImage, "banks of the right input buffers, used in turn", image_rule),
      banks_key(Buffer::kDisparity, "banks of the result buffers, used in turn", list_rule),
      banks_key(Buffer::kLeftLut, "bank of the left rectification table", table_rule),
      banks_key(Buffer::kRightLut, "bank of the right rectification table", table_rule),
      integer(
          "matcher.window", [](B& b) { return &b.matcher.window; }, "rows and columns of the matching window",
          "pixels", kernels::kWindowRule),
      integer(
          "matcher.disparities", [](B& b) { return &b.matcher.disparities; },
          "number of candidate disparities", "pixels", kernels::kDisparitiesRule),
      coded("matcher.filter", read_filter, write_filter, "filter before matching",
            "none, log7 or a map of kernel, shift"),
      part("matcher.filter.kernel", "weights of a filter of one's own, rows from the top", "",
           "a square list of lists, " + kernels::kKernelSizeRule.text() + " rows, entries " +
               kernels::kKernelEntryRule.text() + ", sum 0"),
      part("matcher.filter.shift", "right shift of the sum of a filter of one's own", "bits",
           kernels::kShiftRule.text(), kernels::kShiftRule),
      word("matcher.fetch", [](B& b) { return &b.matcher.fetch; },
           "how often a pixel is read: in every column of its window, or once", {"column", "line_buffer"}),
      integer_or(
          "off", "matcher.lr_tolerance", [](B& b) { return &b.matcher.lr_tolerance; },
          "difference that the left-right check tolerates", "pixels", kernels::kLrToleranceRule),
      optional(integer_or(
          "all", "matcher.units", [](B& b) { return &b.matcher.units; },
          "column and window modules, at most matcher.disparities; optional, without it all, "
          "one for each disparity",
          "modules", fpga::kUnitsRule)),
      optional(integer(
          "matcher.rows", [](B& b) { return &b.matcher.rows; },
          "rows of results computed at once, 1 unless matcher.fetch is column; optional, without "
          "it 1",
          "rows", fpga::kRowsRule)),
      optional(coded("matcher.cost", read_cost, write_cost,
                     "how two windows are compared; optional, without it sad", listed(cost_texts()))),
      part("matcher.cost.census", "rows and columns of the neighbourhood of the census bits", "pixels",
           listed(census_size_texts()), kernels::kCensusSizeRule),
  };
  const auto allocation = std::find_if(all.begin(), all.end(),
                                       [](const Key& key) { return key.path == key_of(Buffer::kLeftImage); });
  const std::vector<Key> banks = bank_keys();
  all.insert(allocation, banks.begin(), banks.end());
  return all;
}

}  // namespace

const std::vector<Key>& board_keys() {
  static const std::vector<Key> table = make_keys();
  return table;
}

std::vector<Key> keys() {
  std::vector<Key> all = {
      part("extends", "the preset that supplies the keys that the file leaves out; optional, the first key",
           "", listed(preset_names()))};
  all.insert(all.end(), board_keys().begin(), board_keys().end());
  return all;
}

const Key* find_key(std::string_view path) {
  static const auto kByPath = [] {
    std::unordered_map<std::string_view, const Key*> keys;
    for (const Key& key : board_keys()) keys[key.path] = &key;
    return keys;
  }();
  const auto found = kByPath.find(path);
  return found == kByPath.end() ? nullptr : found->second;
}

const Key& board_key(std::string_view path) {
  if (const Key* const key = find_key(path)) return *key;
  throw std::out_of_range(fmt::format("{}: not a key of a board", path));
}

bool has_key(const BoardConfig& board, const Key& key) {
  return board.pci.load.has_value() || !is_below(key.path, "pci.load");
}

bool allows_number(const Key& key, const YamlNode& number) {
  if (key.numbers) {
    const auto value = integer_of(number);
    return value && key.numbers->allows(*value);
  }
  const auto* const decimal = std::get_if<DecimalKey>(&key.kind);
  return decimal == nullptr || decimal->allows(decimal_of(number).value_or(decimal->min - 1));
}

std::string cost_text(const kernels::MatchingCost& cost) {
  BoardConfig board;
  board.matcher.cost = cost;
  return flow_text(write_cost(board));
}

const std::vector<std::string>& bank_kind_names() {
  static const std::vector<std::string> kNames = names_in(memory::kBankTraits);
  return kNames;
}

std::string BankTimingKey::rule_text() const {
  return rule.text() + (is_power_of_two ? ", a power of two" : "") + (may_be_off ? " or off" : "");
}

const std::vector<BankTimingKey>& bank_timing_keys() {
  using memory::BankKind;
  using memory::SdramTiming;
  using B = BankConfig;
  // With a value that is read, the timing of the other keys follows.
  static const auto sdram = [](B& bank) -> SdramTiming& {
    if (!bank.sdram) bank.sdram.emplace();
    return *bank.sdram;
  };
  constexpr BankKind kSdram = BankKind::kSdram;
  static const std::vector<BankTimingKey> kKeys = {
      {"turnaround_cycles", BankKind::kSyncBurst, "cycles lost between a read and a write", "cycles",
       memory::kTurnaroundRule, false, false, [](const B& bank) { return bank.turnaround_cycles; },
       [](B& bank, int value) { bank.turnaround_cycles = value; }},
      {"cas_latency", kSdram, "read latency", "cycles", memory::kCasLatencyRule, false, false,
       [](const B& bank) { return bank.sdram->cas_latency; },
       [](B& bank, int value) { sdram(bank).cas_latency = value; }},
      {"row_words", kSdram, "32-bit words of a row", "words", memory::kRowWordsRule, true, false,
       [](const B& bank) { return bank.sdram->row_words; },
       [](B& bank, int value) { sdram(bank).row_words = value; }},
      {"internal_banks", kSdram, "banks inside the memory, each with an open row", "banks",
       memory::kInternalBanksRule, true, false, [](const B& bank) { return bank.sdram->internal_banks; },
       [](B& bank, int value) { sdram(bank).internal_banks = value; }},
      {"activate_cycles", kSdram, "cycles to open a row", "cycles", memory::kRowCyclesRule, false, false,
       [](const B& bank) { return bank.sdram->activate_cycles; },
       [](B& bank, int value) { sdram(bank).activate_cycles = value; }},
      {"precharge_cycles", kSdram, "cycles to close a row", "cycles", memory::kRowCyclesRule, false, false,
       [](const B& bank) { return bank.sdram->precharge_cycles; },
       [](B& bank, int value) { sdram(bank).precharge_cycles = value; }},
      {"refresh_interval_cycles", kSdram, "cycles from one refresh to the next", "cycles",
       memory::kRefreshIntervalRule, false, true,
       [](const B& bank) { return bank.sdram->refresh_interval_cycles.value_or(0); },
       [](B& bank, int value) {
         sdram(bank).refresh_interval_cycles = value == 0 ? std::nullopt : std::optional(value);
       }},
      {kRefreshCycles.c_str(), kSdram, "cycles of a refresh", "cycles", memory::kRefreshCyclesRule, false,
       false, [](const B& bank) { return bank.sdram->refresh_cycles; },
       [](B& bank, int value) { sdram(bank).refresh_cycles = value; }},
  };
  return kKeys;
}

bool needs_key(const BankConfig& bank, const BankTimingKey& key) {
  if (bank.kind != key.kind) return false;
  const bool refreshes = bank.sdram && bank.sdram->refresh_interval_cycles.has_value();
  return key.name != kRefreshCycles || refreshes;
}

bool is_bank_name(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
  return !name.empty() && letter(name[0]) && name != "none" &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-'; });
}

std::string bank_text(const std::string& name) {
  const std::string bank = "bank";
  const bool is_numbered = name.size() > bank.size() && name.compare(0, bank.size(), bank) == 0 &&
                           name.find_first_not_of("0123456789", bank.size()) == std::string::npos;
  return is_numbered ? name : bank + ' ' + name;
}

}  // namespace stereotlm::platform

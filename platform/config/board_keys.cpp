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
#include "models/capture/capture_config.h"
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

constexpr const char* kRefreshCycles = "refresh_cycles";

int index_in(const std::vector<std::string>& words, const std::string& word) {
  return static_cast<int>(std::find(words.begin(), words.end(), word) - words.begin());
}

// Fields of a board or a bank: functions that return a pointer into their owner.
template <typename Owner, typename Value>
auto at(Value Owner::*member) {
  return [member](auto& owner) { return &(owner.*member); };
}
template <typename Section, typename Value>
auto at(Section BoardConfig::*section, Value Section::*member) {
  return [section, member](auto& board) { return &((board.*section).*member); };
}
template <typename Value>
auto of_load(Value PciLoadConfig::*member) {
  return [member](auto& board) { return &(board.pci.load.value().*member); };
}
template <typename Value>
auto of_timing(Value memory::SdramTiming::*member) {
  return [member](auto& bank) {
    if constexpr (!std::is_const_v<std::remove_reference_t<decltype(bank)>>) {
      if (!bank.sdram) bank.sdram.emplace();
    }
    return &((*bank.sdram).*member);
  };
}

using Words = std::vector<std::string>;

// The value of a field. `words`: those of the key's rule, in the order of an enumeration. The word of an
// optional integer stands for no value.
template <typename Field>
KeyValue value_in(const Field& field, const Words& words) {
  if constexpr (std::is_same_v<Field, double> || std::is_same_v<Field, std::string>) {
    return field;
  } else if constexpr (std::is_same_v<Field, int>) {
    return std::int64_t{field};
  } else if constexpr (std::is_same_v<Field, std::optional<int>>) {
    return field ? KeyValue(std::int64_t{*field}) : KeyValue(words.front());
  } else {
    const auto index = static_cast<std::size_t>(field);
    return index < words.size() ? words[index] : std::to_string(index);
  }
}

template <typename Field>
void set_field(Field& field, const KeyValue& value, const Words& words) {
  if constexpr (std::is_same_v<Field, double> || std::is_same_v<Field, std::string>) {
    field = std::get<Field>(value);
  } else if constexpr (std::is_same_v<Field, int>) {
    field = static_cast<int>(std::get<std::int64_t>(value));
  } else if constexpr (std::is_same_v<Field, std::optional<int>>) {
    const auto* const number = std::get_if<std::int64_t>(&value);
    field = number != nullptr ? std::optional(static_cast<int>(*number)) : std::nullopt;
  } else {
    field = static_cast<Field>(index_in(words, std::get<std::string>(value)));
  }
}

template <typename Owner, typename Field>
Access<Owner> access_to(Field field, const Words& words) {
  return {[=](const Owner& owner) { return value_in(*field(owner), words); },
          [=](Owner& owner, const KeyValue& value) { set_field(*field(owner), value, words); }};
}

ValueRule rule_of(const IntegerRule& integers) { return {integers.text(), integers}; }
ValueRule rule_of(const IntegerRule& integers, const char* none) {
  return {integers.text() + " or " + none, integers, {}, {none}};
}
ValueRule rule_of(const DecimalRule& decimals) {
  return {fmt::format("{}..{}", decimals.min, decimals.max), {}, decimals};
}
ValueRule rule_of(const Words& words) { return {listed(words), {}, {}, words}; }

// A key whose value is a number or a word.
template <typename Field>
Key simple(const char* path, Field field, std::string meaning, const char* unit, ValueRule rule) {
  Key made = {path, std::move(meaning), unit, std::move(rule)};
  made.access = access_to<BoardConfig>(field, made.rule.words);
  made.write = [get = made.access.get](const BoardConfig& board) { return value_node(get(board)); };
  made.read = [set = made.access.set](ValueReader& values, const Key& key, const Entry& entry,
                                      BoardConfig& board) {
    if (const auto value = values.read(key.path, entry.value, key.rule)) set(board, *value);
  };
  return made;
}

// A value with code of its own.
template <typename Read, typename Write>
Key coded(const char* path, Read read, Write write, std::string meaning, ValueRule rule) {
  return {path, std::move(meaning), "", std::move(rule), {}, write, read};
}

// A part of the value of another key, whose code reads and writes it; or a key of a bank, or a section.
Key part(const std::string& path, std::string meaning, const std::string& unit, ValueRule rule) {
  return {path, std::move(meaning), unit, std::move(rule)};
}

Key optional(Key key) {
  key.is_optional = true;
  return key;
}

constexpr double microseconds(std::int64_t ps) { return static_cast<double>(ps) / 1e6; }

template <typename Table>
Words names_in(const Table& table) {
  Words names;
  for (const auto& row : table) names.emplace_back(row.name);
  return names;
}

const Words& port_names() {
  static const Words kNames = names_in(fpga::kPortGroups);
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

// The costs without a parameter, in the order of CostKind.
std::vector<std::string> plain_costs() {
  using kernels::CostKind;
  std::vector<std::string> names;
  for (const CostKind kind : {CostKind::kSad, CostKind::kSsd, CostKind::kZncc})
    names.emplace_back(kernels::name_of(kind));
  return names;
}

ValueRule cost_rule() {
  std::vector<std::string> texts = plain_costs();
  for (const std::string& size : census_size_texts())
    texts.push_back(fmt::format("{{{}: {}}}", kernels::name_of(kernels::CostKind::kCensus), size));
  return {listed(texts), {}, {}, plain_costs()};
}

void read_name(ValueReader& values, const Key& key, const Entry& entry, BoardConfig& board) {
  const std::string& name = entry.value.text;
  const bool is_printable = std::none_of(
      name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
  if (!is_text(entry.value) || name.empty() || !is_printable)
    return values.report(key.path, entry.value, key.rule.text);
  board.name = name;
}

void read_priority(ValueReader& values, const Key& key, const Entry& entry, BoardConfig& board) {
  if (!entry.value.is_list()) return values.report(key.path, entry.value, key.rule.text);
  const std::size_t before = values.finding_count();
  std::vector<std::string> missing = port_names();
  memory::PriorityList ports;
  for (const YamlNode& item : entry.value.items) {
    if (!values.read(key.path, item, rule_of(port_names()))) continue;
    const auto name = std::find(missing.begin(), missing.end(), item.text);
    if (name == missing.end()) {
      values.report(key.path, item, "repeated; each port once");
    } else {
      missing.erase(name);
    }
    ports.push_back(static_cast<memory::Port>(index_in(port_names(), item.text)));
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
    values.report(key.path, node, key.rule.text);
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
  if (items.empty() || items.size() > kMostBuffers) return values.report(key.path, node, key.rule.text);
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
  return coded(key_of(buffer), read, write, meaning, {rule});
}

// 0 if the value could not be read.
int integer_or_zero(const std::optional<KeyValue>& read) {
  return read ? static_cast<int>(std::get<std::int64_t>(*read)) : 0;
}

void read_kernel(ValueReader& values, const Key& key, const YamlNode& node, kernels::FilterKernel& filter) {
  if (!values.check_use(key.path, node)) return;
  const auto size = static_cast<std::int64_t>(node.items.size());
  if (!node.is_list() || !kernels::kKernelSizeRule.allows(size))
    return values.report(key.path, node, key.rule.text);
  const std::size_t before = values.finding_count();
  const ValueRule rule = {"entries " + kernels::kKernelEntryRule.text(), kernels::kKernelEntryRule};
  std::int64_t sum = 0;
  for (const YamlNode& row : node.items) {
    if (!values.check_use(key.path, row)) continue;
    if (!row.is_list() || row.items.size() != node.items.size()) {
      values.report(key.path, row, fmt::format("a row of {} entries, as many as there are rows", size));
      continue;
    }
    for (const YamlNode& item : row.items) {
      filter.weights.push_back(integer_or_zero(values.read(key.path, item, rule)));
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
    values.report(key.path, node, key.rule.text);
  } else {
    const auto entries = values.read_entries(key.path, node, entry.key.place);
    kernels::FilterKernel filter;
    for (const Entry* const part : *entries) {
      const Key& its = board_key(below(key.path, part->key.text));
      if (part->key.is("kernel"))
        read_kernel(values, its, part->value, filter);
      else
        filter.shift = integer_or_zero(values.read(its.path, part->value, its.rule));
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
  kernels::MatchingCost& cost = board.matcher.cost;
  if (!entry.value.is_map()) {
    if (values.read(key.path, entry.value, key.rule))
      cost = {static_cast<kernels::CostKind>(index_in(key.rule.words, entry.value.text)), 0};
    return;
  }
  const auto entries = values.read_entries(key.path, entry.value, entry.key.place);
  if (entries->empty()) return;
  const Key& census = board_key("matcher.cost.census");
  const int size = integer_or_zero(values.read(census.path, entries->front()->value, census.rule));
  cost = {kernels::CostKind::kCensus, size != 0 ? size : static_cast<int>(kernels::kCensusSizeRule.min)};
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

std::string rule_text_of(const BankKey& key) {
  if (!key.kind) return key.rule.text;
  const std::string kind = memory::traits_of(*key.kind).name;
  if (key.is_given) return fmt::format("{}; refused beside another kind than {}", key.rule.text, kind);
  if (key.name == kRefreshCycles)
    return fmt::format("{}; required where the kind is {} and refreshes, refused beside off or another kind",
                       key.rule.text, kind);
  return fmt::format("{}; required where the kind is {}, refused beside another", key.rule.text, kind);
}

// A figure of the energy of a bank. `energy`: where energy_of() has it.
template <typename Value>
BankKey energy_key(const char* name, const char* meaning, ValueRule rule,
                   std::optional<Value> BankConfig::*own, Value memory::BankEnergy::*energy,
                   std::optional<memory::BankKind> kind = {}) {
  using Kept = std::conditional_t<std::is_same_v<Value, int>, std::int64_t, Value>;
  return {below(kEnergySection, name),
          meaning,
          std::is_same_v<Value, int> ? "pJ" : "mW",
          std::move(rule),
          {[=](const BankConfig& bank) { return KeyValue(Kept{energy_of(bank).*energy}); },
           [=](BankConfig& bank, const KeyValue& value) {
             bank.*own = static_cast<Value>(std::get<Kept>(value));
           }},
          kind,
          [own](const BankConfig& bank) { return (bank.*own).has_value(); }};
}

// The keys of `ssram`.
std::vector<Key> ssram_keys() {
  std::vector<Key> keys;
  for (const auto& [section, bank] : {std::pair("ssram.default", "a bank that gives none of its own"),
                                      {"ssram.banks.NAME", "the bank NAME"}}) {
    for (const BankKey& key : bank_keys()) {
      ValueRule rule = key.rule;
      rule.text = rule_text_of(key);
      const std::string meaning = key.meaning + (key.kind ? "; of " : " of ") + bank;
      const char* const without = key.is_given ? "; optional, without it that of the kind" : "";
      keys.push_back(part(below(section, key.name), meaning + without, key.unit, std::move(rule)));
      keys.back().is_optional = key.kind || key.is_given || section != std::string("ssram.default");
    }
  }
  return keys;
}

std::vector<Key> make_keys() {
  using B = BoardConfig;
  constexpr DecimalRule kClockMhz = {1, 1000};
  const std::string one =
      fmt::format("a bank, a stripe {{rows: [..]}} of {} banks, or ", fpga::kStripeRule.text());
  const std::string list_rule = one + "a list of 1 to 3 of them";
  const std::string image_rule = list_rule + "; left_image and right_image equally long";
  const std::string table_rule = one + "none";
  std::vector<Key> all = {
      coded("name", read_name, [](const BoardConfig& b) { return YamlNode::word(b.name); },
            "the board's name, as results give it",
            {"a text of one or more characters without control characters; quoted if it could be read as "
             "a number, a truth value or null"}),
      simple("image.width", at(&B::image, &ImageConfig::width),
             size_meaning("width", fpga::kWidthWithTableRule), "pixels", rule_of(fpga::kWidthRule)),
      simple("image.height", at(&B::image, &ImageConfig::height),
             size_meaning("height", fpga::kHeightWithTableRule), "pixels", rule_of(fpga::kHeightRule)),
      simple("cameras.frame_rate_hz", at(&B::cameras, &CamerasConfig::frame_rate_hz),
             "frame rate of both cameras; on demand that of their line times", "Hz",
             rule_of(DecimalRule{capture::kMinFrameRateHz, capture::kMaxFrameRateHz})),
      simple("cameras.trigger", at(&B::cameras, &CamerasConfig::trigger),
             "whether frames follow a frame clock, or begin when triggered", "",
             rule_of({"free_running", "on_demand"})),
      simple("capture.destination", at(&B::capture, &CaptureConfig::destination),
             "where capture writes: the FPGA board, or a ring in host memory", "",
             rule_of({"board", "host_memory"})),
      simple("capture.host_frames", at(&B::capture, &CaptureConfig::host_frames),
             "pairs in the ring in host memory, which takes at most 1 GiB", "pairs",
             rule_of(IntegerRule{1, 64})),
      simple("capture.fifo_words", at(&B::capture, &CaptureConfig::fifo_words), "FIFO of a capture board",
             "words", rule_of(capture::kFifoWordsRule)),
      simple("capture.fifo_trigger_words", at(&B::capture, &CaptureConfig::fifo_trigger_words),
             "words in the FIFO at which it asks for the PCI bus", "words",
             {"1..fifo_words", capture::kFifoWordsRule}),
      simple("pci.clock_mhz", at(&B::pci, &PciConfig::clock_mhz), "clock of the PCI bus", "MHz",
             rule_of(kClockMhz)),
      simple("pci.latency_timer_clocks", at(&B::pci, &PciConfig::latency_timer_clocks),
             "latency timer of every PCI master", "clocks", rule_of(pci::kLatencyTimerRule)),
      simple("pci.bridge_wait_clocks", at(&B::pci, &PciConfig::bridge_wait_clocks),
             "wait clocks of the bridge as a PCI target", "clocks", rule_of(pci::kWaitClocksRule)),
      simple("pci.memory_wait_clocks", at(&B::pci, &PciConfig::memory_wait_clocks),
             "wait clocks of host memory as a PCI target", "clocks", rule_of(pci::kWaitClocksRule)),
      optional(simple("pci.width_bits", at(&B::pci, &PciConfig::width_bits),
                      "width of the PCI bus; optional, without it 32", "bits", rule_of(pci::kWidthRule))),
      optional(part("pci.load", "a third-party master that loads the PCI bus; optional, without it none", "",
                    {"none or a map of burst_words, interval_us, first_us, access_us", {}, {}, {"none"}})),
      simple("pci.load.burst_words", of_load(&PciLoadConfig::burst_words),
             "words that each transfer of the load reads", "words", rule_of(pci::kLoadBurstRule)),
      simple(
          "pci.load.interval_us", of_load(&PciLoadConfig::interval_us),
          "from one transfer's request to the next, to the nearest picosecond; 0: asks again at once, a hog",
          "us", rule_of(DecimalRule{0, microseconds(pci::kLoadTimeRule.max)})),
      optional(simple("pci.load.first_us", of_load(&PciLoadConfig::first_us),
                      "time of the first request, to the nearest picosecond; optional, without it 0", "us",
                      rule_of(DecimalRule{0, microseconds(pci::kLoadTimeRule.max)}))),
      optional(simple("pci.load.access_us", of_load(&PciLoadConfig::access_us),
                      "time that the load's own device makes the bus wait before the first word, to the "
                      "nearest picosecond; optional, without it 0",
                      "us", rule_of(DecimalRule{0, microseconds(pci::kLoadAccessRule.max)}))),
      simple("bridge.local_clock_mhz", at(&B::bridge, &BridgeConfig::local_clock_mhz),
             "clock of the bridge's local bus", "MHz", rule_of(kClockMhz)),
      simple("bridge.dma_burst_words", at(&B::bridge, &BridgeConfig::dma_burst_words),
             "longest burst of a DMA channel", "words", rule_of(pci::kDmaBurstRule)),
      simple("bridge.posted_words", at(&B::bridge, &BridgeConfig::posted_words),
             "posted writes that the bridge can hold", "words", rule_of(pci::kPostedWordsRule)),
      simple("fpga.device", at(&B::fpga, &FpgaConfig::device), "the FPGA, for its resources", "",
             rule_of(names_in(area::kDevices))),
      optional(simple(
          "fpga.package", at(&B::fpga, &FpgaConfig::package),
          "the package of an xc2v6000, whose user pins the board must not exceed; optional, without it any",
          "", rule_of(names_in(area::kPackages)))),
      simple("fpga.clock_mhz", at(&B::fpga, &FpgaConfig::clock_mhz),
             "clock of the FPGA core and of the SSRAM banks", "MHz", rule_of(kClockMhz)),
      simple(
          "fpga.arbitration", [](auto& b) { return &b.fpga.arbiter.policy; },
          "how a bank picks one of the ports that request it", "",
          rule_of(names_in(memory::arbitration_policies()))),
      coded("fpga.priority", read_priority, write_priority, priority_meaning(),
            {fmt::format("a list that names each port once: {}", fmt::join(port_names(), ", "))}),
      simple("fpga.lane_fifo_slots", at(&B::fpga, &FpgaConfig::lane_fifo_slots),
             "slots that may be in a lane, taken and not yet consumed", "slots",
             rule_of(fpga::kLaneFifoRule)),
      simple("fpga.result_fifo_words", at(&B::fpga, &FpgaConfig::result_fifo_words),
             "queue of result words before the result port; with fewer than 2 for each of matcher.rows "
             "the matcher waits for it",
             "words", rule_of(fpga::kResultFifoRule)),
      simple("fpga.pipeline_latency_cycles", at(&B::fpga, &FpgaConfig::pipeline_latency_cycles),
             "cycles of registers that the model does not spell out", "cycles",
             rule_of(fpga::kPipelineLatencyRule)),
      optional(simple("fpga.tables", at(&B::fpga, &FpgaConfig::joint_tables),
                      "whether each side has a look-up table of its own, or both share one; optional, "
                      "without it separate",
                      "", rule_of({"separate", "joint"}))),
      optional(simple("fpga.pixel_cache", at(&B::fpga, &FpgaConfig::pixel_cache),
                      "whether a lane keeps the last word that it read, for each slot of a column; optional, "
                      "without it none",
                      "", rule_of({"none", "word"}))),
      optional(simple(
          "fpga.lanes", at(&B::fpga, &FpgaConfig::lanes),
          "lanes of each side, each fetches a pixel in a cycle; at most matcher.window + matcher.rows - 1, "
          "and 1 unless matcher.fetch is column; optional, without it 1",
          "lanes", rule_of(fpga::kLanesRule))),
      optional(simple("fpga.result_delay_cycles", at(&B::fpga, &FpgaConfig::result_delay_cycles),
                      "cycles for which a result word is on its way to the result queue, where its place is "
                      "taken meanwhile; optional, without it 0",
                      "cycles", rule_of(fpga::kResultDelayRule))),
      banks_key(Buffer::kLeftImage, "banks of the left input buffers, used in turn", image_rule),
      banks_key(Buffer::kRightImage, "banks of the right input buffers, used in turn", image_rule),
      banks_key(Buffer::kDisparity, "banks of the result buffers, used in turn", list_rule),
      banks_key(Buffer::kLeftLut, "bank of the left rectification table", table_rule),
      banks_key(Buffer::kRightLut, "bank of the right rectification table", table_rule),
      simple("matcher.window", at(&B::matcher, &MatcherConfig::window),
             "rows and columns of the matching window", "pixels", rule_of(kernels::kWindowRule)),
      simple("matcher.disparities", at(&B::matcher, &MatcherConfig::disparities),
             "number of candidate disparities", "pixels", rule_of(kernels::kDisparitiesRule)),
      coded("matcher.filter", read_filter, write_filter, "filter before matching",
            {"none, log7 or a map of kernel, shift", {}, {}, {"none", "log7"}}),
      part("matcher.filter.kernel", "weights of a filter of one's own, rows from the top", "",
           {"a square list of lists, " + kernels::kKernelSizeRule.text() + " rows, entries " +
            kernels::kKernelEntryRule.text() + ", sum 0"}),
      part("matcher.filter.shift", "right shift of the sum of a filter of one's own", "bits",
           rule_of(kernels::kShiftRule)),
      simple("matcher.fetch", at(&B::matcher, &MatcherConfig::fetch),
             "how often a pixel is read: in every column of its window, or once", "",
             rule_of({"column", "line_buffer"})),
      simple("matcher.lr_tolerance", at(&B::matcher, &MatcherConfig::lr_tolerance),
             "difference that the left-right check tolerates", "pixels",
             rule_of(kernels::kLrToleranceRule, "off")),
      optional(simple("matcher.units", at(&B::matcher, &MatcherConfig::units),
                      "column and window modules, at most matcher.disparities; optional, without it all, one "
                      "for each disparity",
                      "modules", rule_of(fpga::kUnitsRule, "all"))),
      optional(simple("matcher.rows", at(&B::matcher, &MatcherConfig::rows),
                      "rows of results computed at once, 1 unless matcher.fetch is column; optional, "
                      "without it 1",
                      "rows", rule_of(fpga::kRowsRule))),
      optional(coded("matcher.cost", read_cost, write_cost,
                     "how two windows are compared; optional, without it sad", cost_rule())),
      part("matcher.cost.census", "rows and columns of the neighbourhood of the census bits", "pixels",
           {listed(census_size_texts()), kernels::kCensusSizeRule}),
  };
  const auto allocation = std::find_if(all.begin(), all.end(),
                                       [](const Key& key) { return key.path == key_of(Buffer::kLeftImage); });
  const std::vector<Key> banks = ssram_keys();
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
           "", rule_of(preset_names()))};
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

bool ValueRule::allows_number(const YamlNode& number) const {
  if (integers) return integers->allows(integer_of(number).value_or(integers->min - 1));
  return !decimals || decimals->allows(decimal_of(number).value_or(decimals->min - 1));
}

KeyValue value_of(const Key& key, const BoardConfig& board) {
  if (key.access.get) return key.access.get(board);
  const YamlNode node = key.write(board);
  return node.is_scalar() ? node.text : flow_text(node);
}

std::string value_text(const KeyValue& value) {
  if (const auto* const integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  const auto* const decimal = std::get_if<double>(&value);
  return decimal != nullptr ? decimal_text(*decimal) : std::get<std::string>(value);
}

YamlNode value_node(const KeyValue& value) {
  const bool is_word = std::holds_alternative<std::string>(value);
  return is_word ? YamlNode::word(std::get<std::string>(value)) : YamlNode::plain(value_text(value));
}

std::string cost_text(const kernels::MatchingCost& cost) {
  BoardConfig board;
  board.matcher.cost = cost;
  return flow_text(write_cost(board));
}

const std::vector<BankKey>& bank_keys() {
  using memory::BankKind;
  using memory::SdramTiming;
  const auto key = [](const char* name, auto field, const char* meaning, const char* unit, ValueRule rule,
                      std::optional<BankKind> kind = BankKind::kSdram) {
    return BankKey{name, meaning, unit, rule, access_to<BankConfig>(field, rule.words), kind};
  };
  static const std::vector<BankKey> kKeys = {
      key("words", at(&BankConfig::words), "depth", "words", rule_of(memory::kBankWordsRule), {}),
      key("kind", at(&BankConfig::kind), "kind", "", rule_of(names_in(memory::kBankTraits)), {}),
      key("turnaround_cycles", at(&BankConfig::turnaround_cycles), "cycles lost between a read and a write",
          "cycles", rule_of(memory::kTurnaroundRule), BankKind::kSyncBurst),
      key("cas_latency", of_timing(&SdramTiming::cas_latency), "read latency", "cycles",
          rule_of(memory::kCasLatencyRule)),
      key("row_words", of_timing(&SdramTiming::row_words), "32-bit words of a row", "words",
          rule_of(memory::kRowWordsRule)),
      key("internal_banks", of_timing(&SdramTiming::internal_banks),
          "banks inside the memory, each with an open row", "banks", rule_of(memory::kInternalBanksRule)),
      key("activate_cycles", of_timing(&SdramTiming::activate_cycles), "cycles to open a row", "cycles",
          rule_of(memory::kRowCyclesRule)),
      key("precharge_cycles", of_timing(&SdramTiming::precharge_cycles), "cycles to close a row", "cycles",
          rule_of(memory::kRowCyclesRule)),
      key("refresh_interval_cycles", of_timing(&SdramTiming::refresh_interval_cycles),
          "cycles from one refresh to the next", "cycles", rule_of(memory::kRefreshIntervalRule, "off")),
      key(kRefreshCycles, of_timing(&SdramTiming::refresh_cycles), "cycles of a refresh", "cycles",
          rule_of(memory::kRefreshCyclesRule)),
      energy_key("standby_mw", "power without accesses, to the nearest uW,",
                 rule_of(DecimalRule{0, memory::kMostStandbyMw}), &BankConfig::standby_mw,
                 &memory::BankEnergy::standby_mw),
      energy_key("access_pj", "energy of an access, beyond standby,", rule_of(memory::kWorkEnergyRule),
                 &BankConfig::access_pj, &memory::BankEnergy::access_pj),
      energy_key("row_pj", "energy to open and to close a row", rule_of(memory::kWorkEnergyRule),
                 &BankConfig::row_pj, &memory::BankEnergy::row_pj, BankKind::kSdram),
      energy_key("refresh_pj", "energy of a refresh", rule_of(memory::kWorkEnergyRule),
                 &BankConfig::refresh_pj, &memory::BankEnergy::refresh_pj, BankKind::kSdram),
  };
  return kKeys;
}

bool needs_key(const BankConfig& bank, const BankKey& key) {
  if (!key.kind) return true;
  if (bank.kind != *key.kind) return false;
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

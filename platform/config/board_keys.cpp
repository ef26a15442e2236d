#include "platform/config/board_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "models/area/device.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_ports.h"
#include "models/kernels/stereo.h"
#include "models/memory/arbitration_policies.h"
#include "models/pci/pci_config.h"
#include "platform/config/buffer_layout.h"
#include "platform/config/yaml_tree.h"

namespace stereotlm::platform {
namespace {

template <auto... kMembers>
auto& member(BoardConfig& board) {
  return (board.*....*kMembers);
}

template <auto kMember>
auto& load_member(BoardConfig& board) {
  return board.pci.load.value().*kMember;
}

template <auto... kMembers>
int get_enum(const BoardConfig& board) {
  return static_cast<int>((board.*....*kMembers));
}

template <auto... kMembers>
std::string enum_text(const BoardConfig& board) {
  return std::to_string(get_enum<kMembers...>(board));
}

template <auto... kMembers>
void set_enum(BoardConfig& board, int index) {
  auto& field = (board.*....*kMembers);
  field = static_cast<std::remove_reference_t<decltype(field)>>(index);
}

Key integer(const char* path, std::string meaning, const char* unit, IntegerRule rule,
            int& (*field)(BoardConfig&)) {
  return {path, std::move(meaning), unit, IntegerKey{rule, field}, rule.text()};
}

Key decimal(const char* path, const char* meaning, const char* unit, double min, double max,
            double& (*field)(BoardConfig&)) {
  return {path, meaning, unit, DecimalKey{min, max, field}, fmt::format("{}..{}", min, max)};
}

template <auto... kMembers>
Key word(const char* path, const char* meaning, std::vector<std::string> words) {
  std::string text = listed(words);
  WordKey key{std::move(words), get_enum<kMembers...>, set_enum<kMembers...>, enum_text<kMembers...>};
  return {path, meaning, "", std::move(key), text};
}

// A key whose value is one of the names that kNames() returns. The board stores the name itself.
template <const std::vector<std::string>& (*kNames)(), auto... kMembers>
Key name(const char* path, const char* meaning) {
  const auto get = [](const BoardConfig& board) {
    const auto found = std::find(kNames().begin(), kNames().end(), (board.*....*kMembers));
    return found == kNames().end() ? -1 : static_cast<int>(found - kNames().begin());
  };
  const auto set = [](BoardConfig& board, int index) {
    (board.*....*kMembers) = kNames()[static_cast<std::size_t>(index)];
  };
  const auto text = [](const BoardConfig& board) { return (board.*....*kMembers); };
  return {path, meaning, "", WordKey{kNames(), get, set, text}, listed(kNames())};
}

Key other(const char* path, std::string meaning, const char* unit, std::string text) {
  return {path, std::move(meaning), unit, OtherKey{}, std::move(text)};
}

// A key with code of its own that takes numbers, and possibly words.
Key other_integer(const char* path, std::string meaning, const char* unit, IntegerRule rule,
                  std::string text) {
  return {path, std::move(meaning), unit, OtherKey{rule}, std::move(text)};
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

const std::vector<std::string>& device_names() {
  static const std::vector<std::string> kNames = names_in(area::kDevices);
  return kNames;
}

const std::vector<std::string>& policy_names() {
  static const std::vector<std::string> kNames = names_in(memory::arbitration_policies());
  return kNames;
}

// The meaning of `fpga.priority` under each policy: "the ports, highest priority first; ..".
std::string priority_meaning() {
  std::vector<std::string> meanings;
  for (const memory::PolicyEntry& policy : memory::arbitration_policies())
    meanings.emplace_back(policy.list_meaning);
  return fmt::format("the ports, {}", fmt::join(meanings, "; "));
}

std::string size_meaning(const char* size, const IntegerRule& with_table) {
  return fmt::format("{} of the images, at most {} with a look-up table", size, with_table.max);
}

std::string port_names() {
  std::vector<std::string> names;
  for (const fpga::CorePort& port : fpga::kPorts) names.emplace_back(port.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::vector<int> census_sizes() {
  const IntegerRule& rule = kernels::kCensusSizeRule;
  std::vector<int> sizes;
  for (std::int64_t size = rule.min; size <= rule.max; size += rule.step)
    sizes.push_back(static_cast<int>(size));
  return sizes;
}

// Every cost.
std::vector<std::string> cost_texts() {
  using kernels::CostKind;
  std::vector<std::string> texts;
  for (const CostKind kind : {CostKind::kSad, CostKind::kSsd, CostKind::kZncc})
    texts.push_back(cost_text({kind, 0}));
  for (const int size : census_sizes()) texts.push_back(cost_text({CostKind::kCensus, size}));
  return texts;
}

std::vector<std::string> census_size_texts() {
  std::vector<std::string> texts;
  for (const int size : census_sizes()) texts.push_back(std::to_string(size));
  return texts;
}

std::vector<Key> make_keys() {
  using B = BoardConfig;
  const std::string list_rule = "a bank, or a list of 1 to 3 banks";
  const std::string image_rule = list_rule + "; left_image and right_image equally long";
  const std::string table_rule = "a bank or none";
  const std::string kinds = listed(bank_kind_names());
  const std::string turnaround_rule = fmt::format("{}; required where the kind is {}, refused beside another",
                                                  memory::kTurnaroundRule.text(), turnaround_kinds());
  const std::string default_turnaround =
      fmt::format("turnaround of a {} bank that gives none of its own", turnaround_kinds());
  Key trigger_words =
      integer("capture.fifo_trigger_words", "words in the FIFO at which it asks for the PCI bus", "words",
              {1, 4096}, member<&B::capture, &CaptureConfig::fifo_trigger_words>);
  trigger_words.rule_text = "1..fifo_words";
  return {
      other("name", "the board's name, as results give it", "",
            "a text of one or more characters without control characters; quoted if it could be read as "
            "a number, a truth value or null"),
      integer("image.width", size_meaning("width", fpga::kWidthWithTableRule), "pixels", fpga::kWidthRule,
              member<&B::image, &ImageConfig::width>),
      integer("image.height", size_meaning("height", fpga::kHeightWithTableRule), "pixels", fpga::kHeightRule,
              member<&B::image, &ImageConfig::height>),
      decimal("cameras.frame_rate_hz", "frame rate of both cameras; on demand that of their line times", "Hz",
              0.1, 1000, member<&B::cameras, &CamerasConfig::frame_rate_hz>),
      word<&B::cameras, &CamerasConfig::trigger>(
          "cameras.trigger", "whether frames follow a frame clock, or begin when triggered",
          {"free_running", "on_demand"}),
      word<&B::capture, &CaptureConfig::destination>(
          "capture.destination", "where capture writes: the FPGA board, or a ring in host memory",
          {"board", "host_memory"}),
      integer("capture.host_frames", "pairs in the ring in host memory, which takes at most 1 GiB", "pairs",
              {1, 64}, member<&B::capture, &CaptureConfig::host_frames>),
      integer("capture.fifo_words", "FIFO of a capture board", "words", {1, 4096},
              member<&B::capture, &CaptureConfig::fifo_words>),
      trigger_words,
      decimal("pci.clock_mhz", "clock of the PCI bus", "MHz", 1, 1000,
              member<&B::pci, &PciConfig::clock_mhz>),
      integer("pci.latency_timer_clocks", "latency timer of every PCI master", "clocks", {0, 255},
              member<&B::pci, &PciConfig::latency_timer_clocks>),
      integer("pci.bridge_wait_clocks", "wait clocks of the bridge as a PCI target", "clocks", {0, 255},
              member<&B::pci, &PciConfig::bridge_wait_clocks>),
      integer("pci.memory_wait_clocks", "wait clocks of host memory as a PCI target", "clocks", {0, 255},
              member<&B::pci, &PciConfig::memory_wait_clocks>),
      optional(integer("pci.width_bits", "width of the PCI bus; optional, without it 32", "bits",
                       pci::kWidthRule, member<&B::pci, &PciConfig::width_bits>)),
      optional(other("pci.load", "a third-party master that loads the PCI bus; optional, without it none", "",
                     "none or a map of burst_words, interval_us, first_us, access_us")),
      integer("pci.load.burst_words", "words that each transfer of the load reads", "words",
              pci::kLoadBurstRule, load_member<&PciLoadConfig::burst_words>),
      decimal(
          "pci.load.interval_us",
          "from one transfer's request to the next, to the nearest picosecond; 0: asks again at once, a hog",
          "us", 0, microseconds(pci::kLoadTimeRule.max), load_member<&PciLoadConfig::interval_us>),
      optional(decimal("pci.load.first_us",
                       "time of the first request, to the nearest picosecond; optional, without it 0", "us",
                       0, microseconds(pci::kLoadTimeRule.max), load_member<&PciLoadConfig::first_us>)),
      optional(decimal("pci.load.access_us",
                       "time that the load's own device makes the bus wait before the first word, to the "
                       "nearest picosecond; optional, without it 0",
                       "us", 0, microseconds(pci::kLoadAccessRule.max),
                       load_member<&PciLoadConfig::access_us>)),
      decimal("bridge.local_clock_mhz", "clock of the bridge's local bus", "MHz", 1, 1000,
              member<&B::bridge, &BridgeConfig::local_clock_mhz>),
      integer("bridge.dma_burst_words", "longest burst of a DMA channel", "words", {1, 1024},
              member<&B::bridge, &BridgeConfig::dma_burst_words>),
      integer("bridge.posted_words", "posted writes that the bridge can hold", "words", {1, 4096},
              member<&B::bridge, &BridgeConfig::posted_words>),
      name<device_names, &B::fpga, &FpgaConfig::device>("fpga.device", "the FPGA, for its resources"),
      decimal("fpga.clock_mhz", "clock of the FPGA core and of the SSRAM banks", "MHz", 1, 1000,
              member<&B::fpga, &FpgaConfig::clock_mhz>),
      name<policy_names, &B::fpga, &FpgaConfig::arbiter, &memory::ArbiterConfig::policy>(
          "fpga.arbitration", "how a bank picks one of the ports that request it"),
      other("fpga.priority", priority_meaning(), "", "a list that names each port once: " + port_names()),
      integer("fpga.lane_fifo_slots", "slots that may be in a lane, taken and not yet consumed", "slots",
              fpga::kLaneFifoRule, member<&B::fpga, &FpgaConfig::lane_fifo_slots>),
      integer("fpga.result_fifo_words",
              "queue of result words before the result port; with fewer than 2 for each of matcher.rows "
              "the matcher waits for it",
              "words", fpga::kResultFifoRule, member<&B::fpga, &FpgaConfig::result_fifo_words>),
      integer("fpga.pipeline_latency_cycles", "cycles of registers that the model does not spell out",
              "cycles", fpga::kPipelineLatencyRule, member<&B::fpga, &FpgaConfig::pipeline_latency_cycles>),
      optional(word<&B::fpga, &FpgaConfig::joint_tables>("fpga.tables",
                                                         "whether each side has a look-up table of its own, "
                                                         "or both share one; optional, without it separate",
                                                         {"separate", "joint"})),
      optional(word<&B::fpga, &FpgaConfig::pixel_cache>(
          "fpga.pixel_cache",
          "whether a lane keeps the last word that it read, for each slot of a column; optional, without it "
          "none",
          {"none", "word"})),
      other_integer("ssram.default.words", "depth of a bank that gives none of its own", "words",
                    memory::kBankWordsRule, memory::kBankWordsRule.text()),
      other("ssram.default.kind", "kind of a bank that gives none of its own", "", kinds),
      optional(other_integer("ssram.default.turnaround_cycles", default_turnaround, "cycles",
                             memory::kTurnaroundRule, turnaround_rule)),
      optional(other_integer("ssram.banks.NAME.words", "depth of the bank NAME", "words",
                             memory::kBankWordsRule, memory::kBankWordsRule.text())),
      optional(other("ssram.banks.NAME.kind", "kind of the bank NAME", "", kinds)),
      optional(other_integer("ssram.banks.NAME.turnaround_cycles",
                             "cycles lost when the bank NAME changes between reads and writes", "cycles",
                             memory::kTurnaroundRule, turnaround_rule)),
      other(key_of(Buffer::kLeftImage), "banks of the left input buffers, used in turn", "", image_rule),
      other(key_of(Buffer::kRightImage), "banks of the right input buffers, used in turn", "", image_rule),
      other(key_of(Buffer::kDisparity), "banks of the result buffers, used in turn", "", list_rule),
      other(key_of(Buffer::kLeftLut), "bank of the left rectification table", "", table_rule),
      other(key_of(Buffer::kRightLut), "bank of the right rectification table", "", table_rule),
      integer("matcher.window", "rows and columns of the matching window", "pixels", kernels::kWindowRule,
              member<&B::matcher, &MatcherConfig::window>),
      integer("matcher.disparities", "number of candidate disparities", "pixels", kernels::kDisparitiesRule,
              member<&B::matcher, &MatcherConfig::disparities>),
      other("matcher.filter", "filter before matching", "", "none, log7 or a map of kernel, shift"),
      other("matcher.filter.kernel", "weights of a filter of one's own, rows from the top", "",
            "a square list of lists, " + kernels::kKernelSizeRule.text() + " rows, entries " +
                kernels::kKernelEntryRule.text() + ", sum 0"),
      other_integer("matcher.filter.shift", "right shift of the sum of a filter of one's own", "bits",
                    kernels::kShiftRule, kernels::kShiftRule.text()),
      word<&B::matcher, &MatcherConfig::fetch>(
          "matcher.fetch", "how often a pixel is read: in every column of its window, or once",
          {"column", "line_buffer"}),
      other_integer("matcher.lr_tolerance", "difference that the left-right check tolerates", "pixels",
                    kernels::kLrToleranceRule, kernels::kLrToleranceRule.text() + " or off"),
      optional(
          other_integer("matcher.units",
                        "column and window modules, at most matcher.disparities; optional, without it all, "
                        "one for each disparity",
                        "modules", fpga::kUnitsRule, fpga::kUnitsRule.text() + " or all")),
      optional(
          integer("matcher.rows",
                  "rows of results computed at once, 1 unless matcher.fetch is column; optional, without "
                  "it 1",
                  "rows", fpga::kRowsRule, member<&B::matcher, &MatcherConfig::rows>)),
      optional(other("matcher.cost", "how two windows are compared; optional, without it sad", "",
                     listed(cost_texts()))),
      other_integer("matcher.cost.census", "rows and columns of the neighbourhood of the census bits",
                    "pixels", kernels::kCensusSizeRule, listed(census_size_texts())),
  };
}

// The edit distance of two words: the least number of characters to change, add, remove or swap with a
// neighbour.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> above_last(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    above_last.swap(above);
    above.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({row[j - 1] + 1, above[j] + 1, above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      const bool is_exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (is_exchanged) row[j] = std::min(row[j], above_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

// The edit distance of a word from a known word; nullopt if the known word was probably not meant. It was
// probably meant if at most one of three characters is edited, or if `word` is the known word without its
// last part, such as a unit.
std::optional<std::size_t> likely_distance(std::string_view word, std::string_view known) {
  const bool is_begin = !word.empty() && word.size() < known.size() && known[word.size()] == '_' &&
                        known.substr(0, word.size()) == word;
  if (is_begin) return 1;
  const auto [shorter, longer] = std::minmax({word.size(), known.size()});
  const std::size_t most = (longer + 2) / 3;
  if (longer - shorter > most) return std::nullopt;
  const std::size_t distance = edit_distance(word, known);
  return distance <= most && distance < longer ? std::optional(distance) : std::nullopt;
}

// likely_distance() of two paths, without the sections with which both begin.
std::optional<std::size_t> likely_path_distance(std::string_view path, std::string_view known) {
  for (std::size_t dot = path.find('.'); dot != std::string_view::npos; dot = path.find('.')) {
    if (path.substr(0, dot + 1) != known.substr(0, dot + 1)) break;
    path.remove_prefix(dot + 1);
    known.remove_prefix(dot + 1);
  }
  return likely_distance(path, known);
}

bool is_below(std::string_view path, std::string_view section) {
  return path.size() > section.size() && path[section.size()] == '.' &&
         path.substr(0, section.size()) == section;
}

std::string_view last_part(std::string_view path) { return path.substr(path.rfind('.') + 1); }

// The known path nearest to an unknown one; empty if no path is near. Below `ssram.banks` every name counts
// as the name of a bank.
std::string nearest_path(const std::string& path) {
  const std::string schema = schema_path(path);
  std::string best;
  std::size_t best_distance = std::numeric_limits<std::size_t>::max();
  const auto offer = [&](const std::string& known, std::optional<std::size_t> distance) {
    if (!distance || *distance >= best_distance) return;
    best = known;
    best_distance = *distance;
  };
  const auto offer_known = [&](const std::string& known) {
    if (is_below(schema, known)) return;  // the section that holds `path`
    if (schema == known) return;          // the schema path of a bank, not a key
    offer(known, likely_path_distance(schema, known));
    // A known key of another section counts as 2 further away. So the right key in a wrong section is nearer
    // than most wrong keys in the right section.
    if (const auto moved = likely_distance(last_part(schema), last_part(known))) offer(known, *moved + 2);
  };
  offer_known("extends");
  for (const Key& key : board_keys()) {
    for (std::size_t dot = key.path.find('.'); dot != std::string::npos; dot = key.path.find('.', dot + 1)) {
      offer_known(key.path.substr(0, dot));
    }
    offer_known(key.path);
  }
  const std::string name = "ssram.banks.NAME";
  if (schema.compare(0, name.size(), name) == 0 && best.compare(0, name.size(), name) == 0) {
    const std::size_t begin = name.size() - 4;
    best = path.substr(0, path.find('.', begin)) + best.substr(name.size());
  }
  return best;
}

struct Names {
  std::vector<std::string> all;
  std::vector<std::string> required;
};

// The names directly below a path. All paths are computed once, because sweeps read thousands of boards.
const Names& names_below(std::string_view path) {
  static const std::map<std::string, Names, std::less<>> kNames = [] {
    std::map<std::string, Names, std::less<>> found;
    const auto add = [&found](const std::string& full, bool is_required) {
      const std::size_t dot = full.rfind('.');
      Names& names = found[dot == std::string::npos ? "" : full.substr(0, dot)];
      const std::string name(last_part(full));
      if (!names.all.empty() && names.all.back() == name) return;
      names.all.push_back(name);
      if (is_required) names.required.push_back(name);
    };
    for (const Key& key : board_keys()) {
      for (std::size_t dot = key.path.find('.'); dot != std::string::npos;
           dot = key.path.find('.', dot + 1)) {
        const std::string section = key.path.substr(0, dot);
        if (found.count(section) == 0) add(section, true);
        found[section];
      }
      add(key.path, !key.is_optional);
    }
    return found;
  }();
  static const Names kNone;
  const auto found = kNames.find(path);
  return found == kNames.end() ? kNone : found->second;
}

}  // namespace

const std::vector<Key>& board_keys() {
  static const std::vector<Key> table = make_keys();
  return table;
}

const Key& board_key(std::string_view path) {
  for (const Key& key : board_keys()) {
    if (key.path == path) return key;
  }
  throw std::out_of_range(fmt::format("{}: not a key of a board", path));
}

const std::vector<std::string>& child_keys(std::string_view path) { return names_below(path).all; }

const std::vector<std::string>& required_keys(std::string_view path) { return names_below(path).required; }

std::size_t required_count(std::string_view path) {
  const auto& names = required_keys(path);
  const bool is_key = std::any_of(board_keys().begin(), board_keys().end(),
                                  [path](const Key& key) { return key.path == path; });
  if (is_key || names.empty()) return 1;
  std::size_t count = 0;
  for (const std::string& name : names)
    count += required_count(path.empty() ? name : std::string(path) + '.' + name);
  return count;
}

std::string rule_text(std::string_view path) {
  for (const Key& key : board_keys()) {
    if (key.path == path) return key.rule_text;
  }
  if (path == "ssram.banks") return "a map of " + memory::kBankCountRule.text() + " banks";
  return fmt::format("a map of {}", fmt::join(child_keys(path), ", "));
}

std::string schema_path(const std::string& path) {
  const std::string banks = "ssram.banks.";
  if (path.compare(0, banks.size(), banks) != 0) return path;
  const std::size_t end = path.find('.', banks.size());
  return banks + "NAME" + (end == std::string::npos ? "" : path.substr(end));
}

std::string unknown_key_text(const std::string& path) {
  const std::string nearest = nearest_path(path);
  return nearest.empty() ? "unknown key, and no known key is near"
                         : "unknown key; nearest known key: " + nearest;
}

std::string nearest_text(std::string_view word, const std::vector<std::string>& words) {
  const std::string* nearest = nullptr;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string& known : words) {
    const auto distance = likely_distance(word, known);
    if (!distance || *distance >= least) continue;
    nearest = &known;
    least = *distance;
  }
  return nearest == nullptr ? "" : "; nearest: " + *nearest;
}

std::string listed(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) out += i + 1 == words.size() ? " or " : ", ";
    out += words[i];
  }
  return out;
}

std::string cost_text(const kernels::MatchingCost& cost) {
  const char* const name = kernels::name_of(cost.kind);
  return cost.kind == kernels::CostKind::kCensus ? fmt::format("{{{}: {}}}", name, cost.census_size) : name;
}

const std::vector<std::string>& bank_kind_names() {
  static const std::vector<std::string> kNames = names_in(memory::kBankTraits);
  return kNames;
}

std::string turnaround_kinds() {
  std::vector<std::string> names;
  for (const memory::BankTraits& traits : memory::kBankTraits) {
    if (traits.has_turnaround) names.emplace_back(traits.name);
  }
  return listed(names);
}

bool is_bank_name(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
  return !name.empty() && letter(name[0]) && name != "none" &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-'; });
}

bool is_board_name(std::string_view name) {
  const bool printable = std::none_of(
      name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
  return !name.empty() && printable && is_utf8(name);
}

}  // namespace stereotlm::platform

#include "sw/explore/optimise/key_effects.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "models/memory/memory_config.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::explore {
namespace {

using platform::BoardConfig;

constexpr KeyEffects kNothing = {};
constexpr KeyEffects kComputer = {false, false, true, false, false, false};
constexpr KeyEffects kCore = {false, true, true, false, false, false};
constexpr KeyEffects kCoreOfArea = {false, true, true, true, false, false};
constexpr KeyEffects kPixelsOfArea = {true, false, false, true, false, false};
constexpr KeyEffects kArea = {false, false, false, true, false, false};
constexpr KeyEffects kPinsAlone = {false, false, false, false, true, false};
constexpr KeyEffects kEnergyAlone = {false, false, false, false, false, true};
constexpr KeyEffects kPlace = {false, true, true, true, true, true};
constexpr KeyEffects kAll = {true, true, true, true, true, true};

std::map<std::string, KeyEffects> table() {
  std::map<std::string, KeyEffects> effects = {
      {"name", kNothing},
      {"image.width", kAll},
      {"image.height", kAll},
      {"fpga.device", kArea},
      {"fpga.package", {false, false, false, true, true, false}},
      {"fpga.clock_mhz", {false, false, true, false, false, true}},
      {"fpga.arbitration", kCore},
      {"fpga.priority", kCore},
      {"fpga.lane_fifo_slots", kCoreOfArea},
      {"fpga.result_fifo_words", kCoreOfArea},
      {"fpga.pipeline_latency_cycles", kCoreOfArea},
      {"fpga.result_delay_cycles", kCoreOfArea},
      {"fpga.tables", kPlace},
      {"fpga.pixel_cache", kCoreOfArea},
      {"fpga.lanes", kCoreOfArea},
      {"matcher.window", kAll},
      {"matcher.disparities", kAll},
      {"matcher.filter", kAll},
      {"matcher.fetch", kCoreOfArea},
      {"matcher.lr_tolerance", kPixelsOfArea},
      {"matcher.units", kCoreOfArea},
      {"matcher.rows", kCoreOfArea},
      {"matcher.cost", kAll},
  };
  for (const platform::Key& key : platform::board_keys()) {
    const auto begins_with = [&key](const char* section) { return key.path.rfind(section, 0) == 0; };
    if (begins_with("cameras.") || begins_with("capture.") || begins_with("pci.") || begins_with("bridge."))
      effects.emplace(key.path, kComputer);
    if (begins_with("allocation.")) effects.emplace(key.path, kPlace);
    if (begins_with("matcher.filter.") || begins_with("matcher.cost.")) effects.emplace(key.path, kAll);
    if (!begins_with("ssram.")) continue;
    const bool is_energy = key.path.find(".energy.") != std::string::npos;
    const bool is_words = key.path.size() > 6 && key.path.rfind(".words") == key.path.size() - 6;
    const bool is_kind = key.path.size() > 5 && key.path.rfind(".kind") == key.path.size() - 5;
    const bool is_row = key.path.find("row_words") != std::string::npos ||
                        key.path.find("internal_banks") != std::string::npos;
    effects.emplace(key.path, is_energy  ? kEnergyAlone
                              : is_words ? kPinsAlone
                              : is_kind  ? KeyEffects{false, true, true, true, true, true}
                              : is_row   ? KeyEffects{false, true, true, false, true, false}
                                         : kCore);
  }
  return effects;
}

}  // namespace

const KeyEffects& effects_of_key(const std::string& schema_path) {
  static const std::map<std::string, KeyEffects> kTable = table();
  return kTable.at(schema_path);
}

namespace {

using Keys = std::vector<const platform::Key*>;

// Those that no bank and no allocation has.
template <typename Have>
Keys keys_that(const Have& have) {
  Keys keys;
  for (const platform::Key& key : platform::board_keys()) {
    const bool is_placed = key.path.rfind("ssram.", 0) == 0 || key.path.rfind("allocation.", 0) == 0;
    if (platform::has_value(key) && !is_placed && have(effects_of_key(key.path))) keys.push_back(&key);
  }
  return keys;
}

std::string keys_text(const BoardConfig& board, const Keys& keys) {
  std::string text;
  for (const platform::Key* const key : keys)
    text += (has_key(board, *key) ? platform::value_text(platform::value_of(*key, board)) : "") + '\n';
  return text;
}

// The values of the keys that change the cycles, without those of banks and of allocations.
std::string keys_text(const BoardConfig& board) {
  static const Keys kKeys = keys_that([](const KeyEffects& effects) { return effects.core_cycles; });
  return keys_text(board, kKeys);
}

}  // namespace

std::string core_cycles_key(const BoardConfig& board) {
  std::string text = keys_text(board);
  std::map<std::string, const platform::BankConfig*> banks;
  for (const platform::BankConfig& bank : board.banks) banks.emplace(bank.name, &bank);
  std::set<std::string> named;
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
    text += fmt::format("{} {}", buffer.label(), buffer.bank);
    if (named.insert(buffer.bank).second) {
      const platform::BankConfig& bank = *banks.at(buffer.bank);
      text += fmt::format(" {} {}", static_cast<int>(bank.kind), bank.turnaround_cycles);
      if (bank.sdram) {
        const memory::SdramTiming& its = *bank.sdram;
        text += fmt::format(" {} {} {} {} {} {} {}", its.cas_latency, its.row_words, its.internal_banks,
                            its.activate_cycles, its.precharge_cycles,
                            its.refresh_interval_cycles.value_or(0), its.refresh_cycles);
      }
    }
    text += '\n';
  }
  return text;
}

// The host sees of the core when its frames end, and where its words go.
std::string computer_time_key(const BoardConfig& board, const std::vector<std::uint64_t>& frame_cycles) {
  static const Keys kKeys =
      keys_that([](const KeyEffects& effects) { return effects.computer_time && !effects.core_cycles; });
  BoardConfig its = board;
  if (its.capture.destination == platform::CaptureDestination::kBoard)
    its.capture.host_frames = 1;  // no ring
  std::string text =
      keys_text(its, kKeys) + fmt::format("{} {} {} {} {}\n", board.image.width, board.image.height,
                                          board.fpga.joint_tables, board.fpga.pipeline_latency_cycles,
                                          fmt::join(frame_cycles, " "));
  const std::vector<memory::SsramBankConfig> configs = ssram_configs(board);
  std::map<std::string, std::size_t> places;  // of banks, in the order of their first buffers
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
    const std::size_t place = places.emplace(buffer.bank, places.size()).first->second;
    for (std::size_t bank = 0; bank < configs.size(); ++bank) {
      if (board.banks[bank].name == buffer.bank)
        text += fmt::format("{} {} {} {}\n", buffer.label(), place,
                            memory::read_latency_cycles(configs[bank]), board.banks[bank].turnaround_cycles);
    }
  }
  return text;
}

std::string waitless_key(const BoardConfig& board) {
  std::string text = keys_text(board);
  const std::vector<memory::SsramBankConfig> configs = ssram_configs(board);
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
    if (buffer.part > 0) continue;
    for (std::size_t bank = 0; bank < configs.size(); ++bank) {
      if (board.banks[bank].name == buffer.bank)
        text += fmt::format("{} {} {}\n", buffer.label(), buffer.parts,
                            memory::read_latency_cycles(configs[bank]));
    }
  }
  return text;
}

}  // namespace stereotlm::explore

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "platform/config/board_area.h"
#include "platform/config/buffer_layout.h"
#include "platform/config/tables.h"
#include "platform/figures/bounds.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/files/text_forms.h"
#include "sw/stats/console_table.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::cli {
namespace {

using platform::BoardConfig;
using platform::PlacedBuffer;
using platform::ResourceBound;

using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

std::string text_of(const Names& banks) {
  Names texts;
  for (const std::string& bank : banks) texts.push_back(platform::bank_text(bank));
  return fmt::format("{}", fmt::join(texts, ", "));
}

struct Row {
  std::string role;  // "port left_lut"; for a bank its buffers, "bank of left_image left_lut"
  std::uint64_t cycles = 0;
  Names banks;  // banks with this role; empty for a port
};

// Frames whose bounds differ only in the names of banks.
struct Group {
  std::vector<std::uint64_t> frames;
  std::vector<std::pair<std::string, Names>> lists;  // of buffers, such as left_image, and the banks used
  std::vector<Row> rows;
};

void add_new(Names& names, const Names& others) {
  for (const std::string& name : others) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
}

std::vector<PlacedBuffer> buffers_of(const BoardConfig& board, std::uint64_t frame) {
  std::vector<PlacedBuffer> all = platform::buffers(board);
  std::map<platform::Buffer, std::uint64_t> lengths;
  for (const PlacedBuffer& buffer : all)
    lengths[buffer.buffer] = static_cast<std::uint64_t>(std::max(buffer.index, 0) + 1);
  const auto is_of_another = [&](const PlacedBuffer& buffer) {
    return buffer.index >= 0 && static_cast<std::uint64_t>(buffer.index) != frame % lengths[buffer.buffer];
  };
  all.erase(std::remove_if(all.begin(), all.end(), is_of_another), all.end());
  return all;
}

Group group_of(const BoardConfig& board, const platform::FrameAccesses& accesses, std::uint64_t frame) {
  Group group;
  group.frames = {frame};
  const std::vector<PlacedBuffer> buffers = buffers_of(board, frame);
  for (const PlacedBuffer& buffer : buffers) {
    if (buffer.index < 0) continue;
    if (buffer.part == 0) group.lists.emplace_back(platform::name_of(buffer.buffer), Names{});
    group.lists.back().second.push_back(buffer.bank);
  }
  for (const ResourceBound& bound : platform::frame_bounds(board, accesses, frame)) {
    Row row{bound.resource, bound.cycles, {}};
    if (const auto bank = platform::bank_of_resource(bound.resource)) {
      row.banks = {*bank};
      row.role = "bank of";
      for (const PlacedBuffer& buffer : buffers) {
        if (buffer.bank != row.banks.front()) continue;
        row.role += std::string(" ") + platform::name_of(buffer.buffer);
        if (buffer.parts > 1) row.role += fmt::format(".rows[{}]", buffer.part);
      }
    }
    group.rows.push_back(std::move(row));
  }
  return group;
}

// If `group` and `other` have equal bounds, adds the frame and the banks of `other` to `group` and returns
// true. `other` has one frame.
bool take_in(Group& group, const Group& other) {
  const auto is_like = [](const Row& a, const Row& b) { return a.role == b.role && a.cycles == b.cycles; };
  if (!std::is_permutation(group.rows.begin(), group.rows.end(), other.rows.begin(), other.rows.end(),
                           is_like))
    return false;
  group.frames.insert(group.frames.end(), other.frames.begin(), other.frames.end());
  for (Row& row : group.rows) {
    for (const Row& its : other.rows) {
      if (its.role == row.role) add_new(row.banks, its.banks);
    }
  }
  for (std::size_t list = 0; list < group.lists.size(); ++list)
    add_new(group.lists[list].second, other.lists[list].second);
  return true;
}

// The share of the time of the slowest resource that a resource does not need, in percent.
double headroom_percent(const Row& row, const Group& group) {
  std::uint64_t most = 0;
  for (const Row& each : group.rows) most = std::max(most, each.cycles);
  return 100 * (1 - static_cast<double>(row.cycles) / static_cast<double>(most));
}

struct BoardBounds {
  const BoardConfig& board;
  std::vector<Group> groups;
  std::vector<platform::RateBound> computer;
  platform::Bound bound;

  double frames_per_second(const Row& row) const {
    return board.fpga.clock_mhz * 1e6 / static_cast<double>(row.cycles);
  }
};

BoardBounds bounds_of(const BoardConfig& board, const platform::Tables& tables) {
  const std::uint64_t frames = platform::allocation_period_frames(board);
  const platform::FrameAccesses accesses = platform::frame_accesses(board, tables);
  BoardBounds all = {
      board, {}, platform::computer_bounds(board, accesses, true), platform::core_bound(board, accesses)};
  platform::add_system_bound(board, accesses, true, all.bound);
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const Group group = group_of(board, accesses, frame);
    if (std::none_of(all.groups.begin(), all.groups.end(),
                     [&](Group& known) { return take_in(known, group); })) {
      all.groups.push_back(group);
    }
  }
  return all;
}

std::string lines_of(const Group& group, const BoardBounds& all) {
  std::vector<std::pair<std::string, const Row*>> lines;
  for (auto first = group.rows.begin(), next = first; first != group.rows.end(); first = next) {
    std::vector<std::string> lanes;
    for (; next != group.rows.end() && stats::group_text(next->role) == stats::group_text(first->role) &&
           next->cycles == first->cycles && next->banks == first->banks;
         ++next)
      lanes.push_back(next->role);
    lines.emplace_back(first->banks.empty() ? stats::ports_text(lanes) : text_of(first->banks), &*first);
  }
  std::size_t width = 16;
  for (const auto& line : lines) width = std::max(width, line.first.size());
  std::string text =
      (group.frames.size() == 1 ? "frame " : "frames ") + files::ranges_text(group.frames, ", ");
  const char* separator = ": ";
  for (const auto& [name, banks] : group.lists) {
    text += fmt::format("{}{} in {}", separator, name, text_of(banks));
    separator = "; ";
  }
  text +=
      fmt::format("\n  {:<{}} {:>14} {:>14} {:>12}\n", "resource", width, "cycles", "frames/s", "headroom %");
  for (const auto& [label, row] : lines)
    text += fmt::format("  {:<{}} {:>14} {:>14.3f} {:>12.2f}\n", label, width, row->cycles,
                        all.frames_per_second(*row), headroom_percent(*row, group));
  return text;
}

// What the core takes of the FPGA, and the pins of the board.
std::string area_text(const BoardConfig& board) {
  const area::Device& device = platform::device_of(board);
  const area::Area area = platform::area_of(board);
  return fmt::format(
      "area of the core: {} of {} slices ({:.2f} %), {} of {} block RAMs, {} of {} multipliers\n{}\n",
      area.slices, device.slices, area.slices_percent, area.block_rams, device.block_rams, area.multipliers,
      device.multipliers, platform::device_text(board));
}

// The same part by part and bank by bank.
std::string part_lines(const BoardConfig& board) {
  constexpr const char* row = "  {:<21} {:>6} {:>10} {:>11} {:>11} {:>12}\n";
  const area::Device& device = platform::device_of(board);
  const std::vector<area::Item> items = platform::area_items(board);
  const area::Area area = area::total(items, device);
  std::string text = fmt::format("area of {}\n", device.name);
  text += fmt::format(row, "parts", "count", "LUTs", "flip-flops", "block RAMs", "multipliers");
  for (const area::Item& item : items) {
    text += fmt::format(row, item.name, item.count, item.all.luts, item.all.flip_flops, item.all.block_rams,
                        item.all.multipliers);
  }
  text += fmt::format(row, "all", "", area.luts, area.flip_flops, area.block_rams, area.multipliers);
  constexpr const char* pins_row = "  {:<16} {:>6} {:>8} {:>8} {:>6}\n";
  text += "pins\n" + fmt::format(pins_row, "bank", "data", "control", "address", "all");
  for (const auto& [bank, pins] : platform::bank_pins(board))
    text +=
        fmt::format(pins_row, platform::bank_text(bank), pins.data, pins.control, pins.address, pins.all());
  return text + fmt::format(pins_row, "local bus", "", "", "", area::kLocalBusPins) +
         fmt::format(pins_row, "clocks, status", "", "", "", area::kOtherPins);
}

std::string text_of(const BoardBounds& all) {
  const std::uint64_t turn = platform::allocation_period_frames(all.board);
  const auto bound_line = [&](const char* whole, double bound, const std::string& limited_by) {
    const bool differs = all.groups.size() > 1 || (turn > 1 && platform::bank_of_resource(limited_by));
    return fmt::format("{:<12} {:>10.3f} frames/s{}, limited by {}\n", whole, bound,
                       differs ? fmt::format(" over whole turns of {} frames", turn) : "",
                       stats::resource_words(limited_by));
  };
  std::string text = bound_line("steady bound", *all.bound.system, all.bound.system_limited_by) +
                     bound_line("core bound", all.bound.core, all.bound.core_limited_by) +
                     area_text(all.board);
  for (const Group& group : all.groups) text += lines_of(group, all);
  std::size_t width = 16;
  for (const platform::RateBound& part : all.computer)
    width = std::max(width, stats::resource_text(part.resource).size());
  text +=
      fmt::format("the whole computer, with all masters\n  {:<{}} {:>14}\n", "resource", width, "frames/s");
  for (const platform::RateBound& part : all.computer)
    text += fmt::format("  {:<{}} {:>14.3f}\n", stats::resource_text(part.resource), width,
                        part.frames_per_second);
  return text + platform::local_bus_remark(all.board);
}

Json json_of(const Group& group, const BoardBounds& all) {
  Json buffers = Json::array();
  for (const auto& [name, banks] : group.lists) buffers.push_back({{"name", name}, {"banks", banks}});
  Json resources = Json::array();
  for (const Row& row : group.rows) {
    Json resource = {{"resource", row.banks.empty() ? row.role : "bank"}};
    if (!row.banks.empty()) resource["banks"] = row.banks;
    resource["cycles"] = row.cycles;
    resource["frames_per_second"] = all.frames_per_second(row);
    resource["headroom_percent"] = headroom_percent(row, group);
    resources.push_back(std::move(resource));
  }
  return {{"frames", group.frames}, {"buffers", std::move(buffers)}, {"resources", std::move(resources)}};
}

Json document_of(const BoardBounds& all) {
  Json document = {{"schema", 1}, {"board", all.board.name}};
  Json& groups = document["frames"] = Json::array();
  for (const Group& group : all.groups) groups.push_back(json_of(group, all));
  Json& computer = document["computer"] = Json::array();
  for (const platform::RateBound& part : all.computer)
    computer.push_back({{"resource", part.resource}, {"frames_per_second", part.frames_per_second}});
  document["bound"] = {{"core", all.bound.core},
                       {"core_limited_by", all.bound.core_limited_by},
                       {"system", *all.bound.system},
                       {"system_limited_by", all.bound.system_limited_by}};
  document["area"] = stats::area_document(all.board);
  Json banks = Json::array();
  for (const auto& [bank, pins] : platform::bank_pins(all.board)) {
    banks.push_back({{"bank", bank},
                     {"data", pins.data},
                     {"control", pins.control},
                     {"address", pins.address},
                     {"all", pins.all()}});
  }
  document["pins"] = {{"banks", std::move(banks)},
                      {"local_bus", area::kLocalBusPins},
                      {"other", area::kOtherPins},
                      {"all", platform::pins_of(all.board)}};
  return document;
}

struct BoundsOptions : BoardCommandOptions {
  using BoardCommandOptions::BoardCommandOptions;

  Option area = Option(this, "--area", "", "Also print the parts of the core, and the pins of each bank");
};

int bounds(const BoundsOptions& options) {
  process::Problems problems;
  const LoadedBoard loaded = options.board.load(problems);
  problems.check();
  loaded.say_clock_remark();
  const BoardBounds all = bounds_of(*loaded.board, loaded.tables());
  process::print(options.json.is_given()
                     ? json_text(document_of(all))
                     : text_of(all) + (options.area.is_given() ? part_lines(all.board) : ""));
  return kDone;
}

}  // namespace

void add_bounds(Commands& commands) {
  add_command(
      commands, "bounds",
      "Say what limits the frame rate: ports, banks, matcher, cameras, buses; and the area", bounds,
      "First the bounds of the steady rate of the whole computer and of the core alone, over whole turns of\n"
      "the allocation's lists, and an estimate of what the core takes of its FPGA. Then for each frame of a\n"
      "turn, equal ones together: the fewest FPGA cycles that a frame costs each resource alone, the frames\n"
      "a second that follow, and the headroom: the share of the slowest resource's time that it does not\n"
      "need. Last what cameras, PCI bus, bridge and banks allow with --source camera as long as no pixel is\n"
      "lost. Tables, where the board has them, are the identity, or those of --calibration. JSON has the\n"
      "parts of --area always.");
}

}  // namespace stereotlm::cli

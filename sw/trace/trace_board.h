#pragma once

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/clock.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/local_bus_control.h"
#include "models/fpga/record/conflict_recorder.h"
#include "platform/config/board_config.h"
#include "platform/config/board_keys.h"
#include "platform/records/trace_records.h"

namespace stereotlm::trace {

// The place of a slot in the picture.
struct SlotPlace {
  std::uint64_t strip = 0;
  int row = 0;  // may lie outside the image
  int column = 0;
};

// What the sinks need of a board.
struct TraceBoard {
  explicit TraceBoard(const platform::BoardConfig& board)
      : core(platform::core_config(board)),
        geometry(core),
        clock(board.fpga.clock_mhz),
        banks(board.banks),
        requesters(platform::core_ports(board)) {
    for (std::size_t requester = 0; requester < requesters.causes(); ++requester)
      requester_names.push_back(requesters.name(requester));
    for (const platform::BankConfig& bank : banks) bank_texts.push_back(platform::bank_text(bank.name));
  }

  std::uint64_t ps(std::uint64_t cycle) const { return clock.edge_ps(cycle); }
  const std::string& bank_name(std::size_t bank) const { return banks[bank].name; }
  // The name of the slice of a wait.
  std::string wait_text(std::size_t requester, std::uint64_t cycles, std::size_t by, std::size_t bank) const {
    return fmt::format("{} waits {} cycle{} for {} on {}", requester_names[requester], cycles,
                       cycles == 1 ? "" : "s", requester_names[by], bank_texts[bank]);
  }
  // Whether two ports can be granted in one cycle: one that reads and one that writes.
  bool has_separate_ports(std::size_t bank) const { return memory::has_separate_ports(banks[bank].kind); }

  SlotPlace place_of_slot(std::uint64_t slot) const {
    const auto slots = static_cast<std::uint64_t>(geometry.slots_per_column);
    const std::uint64_t column = slot / slots;
    const std::uint64_t strip = column / geometry.columns_per_strip();
    return {strip, geometry.first_row_of(static_cast<int>(strip)) + static_cast<int>(slot % slots),
            static_cast<int>(column % geometry.columns_per_strip())};
  }
  // The row and the first column of the four disparities in a word of the result.
  SlotPlace place_of_word(std::uint64_t word) const {
    const std::uint64_t row_words = geometry.columns_per_strip() / 4;
    const std::uint64_t place = geometry.place_of_result_word(word);
    const std::uint64_t row = place / row_words;
    return {
        row / static_cast<std::uint64_t>(geometry.rows) + static_cast<std::uint64_t>(geometry.lead_strips),
        static_cast<int>(row), static_cast<int>(4 * (place % row_words))};
  }
  // The place of what an access of a port of the core is for.
  SlotPlace place_of(std::size_t port, std::uint64_t item) const {
    return port == ports().result() ? place_of_word(item) : place_of_slot(slot_of_item(port, item));
  }
  // The number among all slots of its side, of a slot that a reader has counted in its lane.
  std::uint64_t slot_of_item(std::size_t port, std::uint64_t item) const {
    const std::size_t lane = ports().lane_of(port);
    const auto of_lane = static_cast<std::uint64_t>(geometry.slots_of_lane(static_cast<int>(lane)));
    return item / of_lane * static_cast<std::uint64_t>(geometry.slots_per_column) +
           item % of_lane * ports().lanes() + lane;
  }
  // The slots of the pixels whose disparities the word holds. With the fetch `column` a pixel has several:
  // this is the one in the strip of the result. Nullopt if the filter takes the pixel from an earlier strip.
  std::optional<std::array<std::uint64_t, 4>> slots_of_word(std::uint64_t word) const {
    const SlotPlace result = place_of_word(word);
    const auto strip = geometry.slots_per_column > 1 ? static_cast<int>(result.strip) : result.row;
    const int k = result.row - geometry.first_row_of(strip);
    if (k < 0 || k >= geometry.slots_per_column) return std::nullopt;
    std::array<std::uint64_t, 4> slots{};
    for (std::uint64_t i = 0; i < slots.size(); ++i) {
      const std::uint64_t column = static_cast<std::uint64_t>(strip) * geometry.columns_per_strip() +
                                   static_cast<std::uint64_t>(result.column) + i;
      slots[i] =
          column * static_cast<std::uint64_t>(geometry.slots_per_column) + static_cast<std::uint64_t>(k);
    }
    return slots;
  }

  fpga::CoreConfig core;
  fpga::FrameGeometry geometry;
  Clock clock;
  std::vector<platform::BankConfig> banks;
  fpga::Requesters requesters;
  std::vector<std::string> requester_names;  // [requester], then the other causes
  std::vector<std::string> bank_texts;       // [bank]: its name in a text

  const fpga::CorePorts& ports() const { return requesters.ports(); }
};

// The name of the target of a burst, in a text.
inline std::string target_text(const platform::BusBurst& burst) {
  const bool is_bank = burst.bus == platform::BusBurst::Bus::kLocal && burst.address < fpga::kLocalRegisters;
  return is_bank ? platform::bank_text(burst.target) : burst.target;
}

}  // namespace stereotlm::trace

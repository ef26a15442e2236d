#include "models/fpga/fast/sdram_parts.h"

#include <algorithm>
#include <utility>

namespace stereotlm::fpga {
namespace {

// How a state writes the row that an internal bank has open.
constexpr std::uint64_t kClosed = 0;
constexpr std::uint64_t kForeign = 1;  // a row without buffer of the frame, which stays open
constexpr std::uint64_t kFirst = 2;    // that of part 0 with number -kBias

constexpr std::int64_t kBias = std::int64_t{1} << 24U;  // more than a bank has rows
constexpr unsigned kPartBit = 32;

}  // namespace

std::int64_t origin_row(const FrameGeometry& geometry, const SdramPart& part, std::uint64_t column) {
  const bool of_results = part.group == kResultGroup;
  // Before the first results the number of the strip is negative, and at the end of the frame it is one too
  // many. The origin must not move there: no row of sdram does.
  const std::int64_t last = (geometry.height - 1) / geometry.rows * geometry.rows;
  const std::int64_t row = of_results ? std::clamp<std::int64_t>(geometry.first_row_at(true, column), 0, last)
                                      : geometry.first_row_at(false, column);
  return floor_divide(part.word_of(row), part.turn()) * part.internal_banks;
}

std::vector<SdramPart> sdram_parts(const CoreConfig& config, const Placements& placements,
                                   const SdramTimings& timings) {
  std::vector<SdramPart> found;
  for (std::size_t group = 0; group < kCoreGroupCount; ++group) {
    if (!has_group(config, group)) continue;
    const Placement& buffer = placements[group];
    for (std::size_t part = 0; part < buffer.parts().size(); ++part) {
      const std::uint32_t base = buffer.parts()[part];
      const std::size_t bank = registers::bank_of(base);
      const memory::SdramTiming* const timing = timings[bank];
      const auto words =
          static_cast<std::int64_t>(buffer.rows_of_part(part, config.height) * buffer.row_words());
      if (timing == nullptr || words == 0) continue;
      found.push_back({group, bank, registers::first_word_of(base), words,
                       static_cast<std::int64_t>(buffer.parts().size()), static_cast<std::int64_t>(part),
                       static_cast<std::int64_t>(buffer.row_words()), timing->row_words,
                       timing->internal_banks});
    }
  }
  return found;
}

bool are_apart(const std::vector<SdramPart>& parts) {
  for (const SdramPart& part : parts) {
    const auto shares_row = [&part](const SdramPart& other) {
      return &other != &part && other.bank == part.bank &&
             (other.has_row(part.base / part.row_words) ||
              other.has_row((part.base + part.words - 1) / part.row_words));
    };
    if (std::any_of(parts.begin(), parts.end(), shares_row)) return false;
  }
  return true;
}

void OpenRows::start_frame(std::vector<SdramPart> parts, memory::Arbitration& arbitration) {
  banks_.clear();
  for (SdramPart& part : parts) {
    auto bank = std::find_if(banks_.begin(), banks_.end(),
                             [&part](const Bank& other) { return other.number == part.bank; });
    if (bank == banks_.end()) bank = banks_.insert(bank, {part.bank, &arbitration.arbiter(part.bank), {}});
    bank->parts.push_back(part);
  }
}

void OpenRows::append_state(std::uint64_t cycle, std::uint64_t column, memory::StateWords& state) const {
  for (const Bank& bank : banks_) {
    state.push_back(bank.rows().busy_state(cycle));
    for (int internal = 0; internal < bank.rows().timing().internal_banks; ++internal) {
      const auto open = bank.rows().open_row(static_cast<std::size_t>(internal));
      if (!open) {
        state.push_back(kClosed);
        continue;
      }
      const auto part = std::find_if(bank.parts.begin(), bank.parts.end(),
                                     [&open](const SdramPart& one) { return one.has_row(*open); });
      if (part == bank.parts.end()) {
        state.push_back(kForeign);
        continue;
      }
      const auto number = static_cast<std::uint64_t>(*open - origin_row(geometry_, *part, column) + kBias);
      state.push_back(static_cast<std::uint64_t>(part - bank.parts.begin()) << kPartBit | (number + kFirst));
    }
  }
}

void OpenRows::set_state(std::uint64_t cycle, std::uint64_t column, memory::StateReader& state) const {
  for (const Bank& bank : banks_) {
    bank.rows().set_busy_state(cycle, *state++);
    for (int internal = 0; internal < bank.rows().timing().internal_banks; ++internal) {
      const std::uint64_t word = *state++;
      if (word == kForeign) continue;
      std::optional<std::uint32_t> open;
      if (word != kClosed) {
        const auto number = static_cast<std::int64_t>((word & UINT32_MAX) - kFirst) - kBias;
        open =
            static_cast<std::uint32_t>(number + origin_row(geometry_, bank.parts[word >> kPartBit], column));
      }
      bank.rows().set_open_row(static_cast<std::size_t>(internal), open);
    }
  }
}

std::vector<std::int64_t> OpenRows::refreshes(std::uint64_t cycle, memory::StateReader state) const {
  std::vector<std::int64_t> refreshes;
  for (const Bank& bank : banks_) {
    if (const std::uint64_t next = bank.rows().next_refresh(cycle, *state); next != 0)
      refreshes.push_back(static_cast<std::int64_t>(next) - static_cast<std::int64_t>(cycle));
    state += 1 + bank.rows().timing().internal_banks;
  }
  return refreshes;
}

}  // namespace stereotlm::fpga

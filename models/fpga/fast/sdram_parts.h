#pragma once

#include <cstdint>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/placement.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// Rounds down. `divisor` is positive.
constexpr std::int64_t floor_divide(std::int64_t number, std::int64_t divisor) {
  return number >= 0 ? number / divisor : -1 - (-1 - number) / divisor;
}
constexpr std::uint64_t floor_remainder(std::int64_t number, std::int64_t divisor) {
  return static_cast<std::uint64_t>(number - floor_divide(number, divisor) * divisor);
}

// The part of a buffer that lies in a bank of sdram. Accesses are alike in two rows of the buffer whose words
// lie a multiple of turn() apart: then all words lie in the same internal banks.
struct SdramPart {
  std::size_t group = 0;        // port group
  std::size_t bank = 0;         // that holds it
  std::int64_t base = 0;        // its first word
  std::int64_t words = 0;       // of the part
  std::int64_t parts = 1;       // of the buffer
  std::int64_t number = 0;      // of this part: it has the rows with this remainder
  std::int64_t line_words = 0;  // of a row of the buffer
  std::int64_t row_words = 0;   // of a row of the sdram
  std::int64_t internal_banks = 0;

  std::int64_t turn() const { return row_words * internal_banks; }
  // The place of a row of the buffer, which may lie outside it: the word where this row or the next one of
  // the part begins.
  std::int64_t word_of(std::int64_t row) const { return base + floor_divide(row, parts) * line_words; }
  bool has_row(std::int64_t sdram_row) const {
    return sdram_row >= base / row_words && sdram_row <= (base + words - 1) / row_words;
  }
};

// The row of the sdram from which the rows of a part are counted at a column of the matcher: a row of
// internal bank 0, less than a turn() before the first row of the strip. Before the first results it is that
// of strip 0, behind the last ones that of the last strip.
std::int64_t origin_row(const FrameGeometry& geometry, const SdramPart& part, std::uint64_t column);

// Those of the buffers of a frame. `timings`: [bank], null for any other kind.
using SdramTimings = std::vector<const memory::SdramTiming*>;
std::vector<SdramPart> sdram_parts(const CoreConfig& config, const Placements& placements,
                                   const SdramTimings& timings);
// Whether each row of the sdram belongs to one part at most, so that its number says what it holds.
bool are_apart(const std::vector<SdramPart>& parts);

// The state of the banks of sdram, for FastForward. The number of an open row is counted from origin_row(),
// which moves with the strips, so that a state comes again in later strips.
class OpenRows {
 public:
  explicit OpenRows(const FrameGeometry& geometry) : geometry_(geometry) {}

  // The buffers of the frame; `arbitration` outlives it.
  void start_frame(std::vector<SdramPart> parts, memory::Arbitration& arbitration);
  // Counts the cycles before `cycle` in which a row was opened, or a bank refreshed.
  void count(std::uint64_t cycle) {
    for (const Bank& bank : banks_) bank.arbiter->count_rows(cycle);
  }
  // `column`: of the matcher. The cycles before `cycle` have been counted.
  void append_state(std::uint64_t cycle, std::uint64_t column, memory::StateWords& state) const;
  void set_state(std::uint64_t cycle, std::uint64_t column, memory::StateReader& state) const;
  // From the words of a state in `cycle`: the cycles to the next refresh of each bank that has any, negative
  // if it is late.
  std::vector<std::int64_t> refreshes(std::uint64_t cycle, memory::StateReader state) const;

 private:
  struct Bank {
    std::size_t number;
    memory::BankArbiter* arbiter;
    std::vector<SdramPart> parts;

    memory::SdramRows& rows() const { return *arbiter->rows(); }
  };

  FrameGeometry geometry_;
  std::vector<Bank> banks_;
};

}  // namespace stereotlm::fpga

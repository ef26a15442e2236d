#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

// The part of a board on which the timing of the core depends (plain_core.h), in types that share nothing
// with the models. Nothing checks it: a board must keep the rules of contract section 4.
namespace stereotlm::test {

// The groups of ports, in the order of "Ports" in the contract: the first four have a port for each lane.
enum class PlainPort { kLeftLut, kRightLut, kLeftPixel, kRightPixel, kResult, kHost };
inline constexpr std::size_t kPlainPortCount = 6;
const char* name_of(PlainPort port);  // as in the contract: "left_lut"

enum class PlainBankKind { kZbtPipelined, kZbtFlowThrough, kSyncBurst, kQdr, kSdram };
enum class PlainFetch { kColumn, kLineBuffer };
enum class PlainArbitration { kFixedPriority, kRoundRobin, kAge };
const char* name_of(PlainArbitration arbitration);

struct PlainSdram {
  int cas_latency = 2;
  int row_words = 256;
  int internal_banks = 4;
  int activate_cycles = 1;
  int precharge_cycles = 1;
  int refresh_interval_cycles = 625;  // T; 0: off
  int refresh_cycles = 3;
};

// Contract 9.1. The last two are of kSdram.
struct PlainEnergy {
  int standby_uw = 0;
  int access_pj = 0;
  int row_pj = 0;
  int refresh_pj = 0;
};

struct PlainBank {
  PlainBankKind kind = PlainBankKind::kZbtPipelined;
  int turnaround_cycles = 0;               // for kSyncBurst; has no effect otherwise
  PlainSdram sdram{};                      // for kSdram; has no effect otherwise
  std::optional<PlainEnergy> energy = {};  // nullopt: that of the kind
};

// A buffer names its bank by the index in `banks`; the rows of a striped one lie in two or more in turn.
struct PlainBuffer {
  PlainBuffer(int bank = 0) : banks{bank} {}
  PlainBuffer(std::initializer_list<int> stripes) : banks(stripes) {}
  std::vector<int> banks;
};

struct PlainCycleInput {
  int width = 0;        // W
  int height = 0;       // H
  int window = 0;       // n
  int disparities = 0;  // D
  int filter_half = 0;  // h is the sum of these two: of the filter, 0 without filter,
  int cost_half = 0;    // and of the cost function, 0 but for census
  int units = 0;        // U; 0: all, one for each disparity
  int rows = 1;         // R; more than 1 only with kColumn
  PlainFetch fetch = PlainFetch::kColumn;
  PlainArbitration arbitration = PlainArbitration::kFixedPriority;
  std::array<PlainPort, kPlainPortCount> priority = {PlainPort::kHost,      PlainPort::kResult,
                                                     PlainPort::kLeftPixel, PlainPort::kRightPixel,
                                                     PlainPort::kLeftLut,   PlainPort::kRightLut};
  int lanes = 1;  // P; more than 1 only with kColumn
  int lane_fifo_slots = 16;
  int result_fifo_words = 8;
  int result_delay_cycles = 0;  // Q
  int pipeline_latency_cycles = 16;
  std::vector<PlainBank> banks;
  std::vector<PlainBuffer> left_image;
  std::vector<PlainBuffer> right_image;
  std::vector<PlainBuffer> disparity;
  std::optional<PlainBuffer> left_lut;  // nullopt: a side without table
  std::optional<PlainBuffer> right_lut;
  bool joint_tables = false;  // one table for both sides: left_lut and right_lut name its banks
  bool word_cache = false;
  // The entries in the tables, row-major, W * H, as in separate tables; nullopt: the identity. Only on a side
  // with a table.
  std::optional<std::vector<std::uint32_t>> left_table;
  std::optional<std::vector<std::uint32_t>> right_table;
};

// A word of a bank; of a part of a buffer, the first.
struct PlainWord {
  int bank = 0;
  std::uint64_t word = 0;
};

// Row y of a buffer lies in part y mod N of its N parts, as row floor(y / N) there.
using PlainParts = std::vector<PlainWord>;
PlainWord plain_word(const PlainParts& parts, int row, int word_of_row, int words_of_row);
// The number of rows in a part, 0 in the last parts of an image with fewer than N rows.
int plain_rows(std::size_t parts, std::size_t part, int height);

// The parts of each buffer.
struct PlainPlaces {
  std::vector<PlainParts> left_image;  // in the order of the list
  std::vector<PlainParts> right_image;
  std::vector<PlainParts> disparity;
  PlainParts left_lut;  // none on a side without table
  PlainParts right_lut;
};
PlainPlaces plain_places(const PlainCycleInput& input);

// From the cycle of the grant to the first in which the word can be used.
int plain_read_latency(const PlainBank& bank);

}  // namespace stereotlm::test

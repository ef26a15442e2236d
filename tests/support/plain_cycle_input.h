#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

// What the plain cycle loop is told about a board: all that contract section 2 depends on, in types of its
// own.
namespace stereotlm::test {

// In the order of "Ports" in the contract.
enum class PlainPort { kLeftLut, kRightLut, kLeftPixel, kRightPixel, kResult, kHost };
inline constexpr std::size_t kPlainPortCount = 6;
const char* name_of(PlainPort port);  // as in the contract: "left_lut"

enum class PlainBankKind { kZbtPipelined, kZbtFlowThrough, kSyncBurst };
const char* name_of(PlainBankKind kind);

enum class PlainFetch { kColumn, kLineBuffer };
const char* name_of(PlainFetch fetch);

enum class PlainArbitration { kFixedPriority, kRoundRobin };
const char* name_of(PlainArbitration arbitration);

struct PlainBank {
  PlainBankKind kind = PlainBankKind::kZbtPipelined;
  int turnaround_cycles = 0;  // for kSyncBurst; has no effect otherwise
};

// Buffers name their bank by its index in `banks`.
struct PlainCycleInput {
  int width = 0;        // W
  int height = 0;       // H
  int window = 0;       // n
  int disparities = 0;  // D
  int filter_half = 0;  // h; 0 without filter
  PlainFetch fetch = PlainFetch::kColumn;
  PlainArbitration arbitration = PlainArbitration::kFixedPriority;
  std::array<PlainPort, kPlainPortCount> priority = {PlainPort::kHost,      PlainPort::kResult,
                                                     PlainPort::kLeftPixel, PlainPort::kRightPixel,
                                                     PlainPort::kLeftLut,   PlainPort::kRightLut};
  int lane_fifo_slots = 16;
  int result_fifo_words = 8;
  int pipeline_latency_cycles = 16;
  std::vector<PlainBank> banks;
  std::vector<int> left_image;
  std::vector<int> right_image;
  std::vector<int> disparity;
  std::optional<int> left_lut;  // nullopt: a side without table
  std::optional<int> right_lut;
  // The entries in the tables, row-major, W * H; nullopt: all valid. Only on a side with a table.
  std::optional<std::vector<std::uint32_t>> left_table;
  std::optional<std::vector<std::uint32_t>> right_table;
};

// Throws std::invalid_argument if a list is empty or longer than three, the image lists differ in length, a
// bank does not exist, the priority list does not name each port once, a table has the wrong length or no
// bank, or a number is out of its range in contract section 4; the message names the field, the value and the
// rule.
void require_valid(const PlainCycleInput& input);

}  // namespace stereotlm::test

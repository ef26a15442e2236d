#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

// The part of a board on which contract sections 2 and 7 depend, in types that share nothing with the models.
// Nothing checks it: a board must keep the rules of contract section 4.
namespace stereotlm::test {

// In the order of "Ports" in the contract.
enum class PlainPort { kLeftLut, kRightLut, kLeftPixel, kRightPixel, kResult, kHost };
inline constexpr std::size_t kPlainPortCount = 6;
const char* name_of(PlainPort port);  // as in the contract: "left_lut"

enum class PlainBankKind { kZbtPipelined, kZbtFlowThrough, kSyncBurst, kQdr };
enum class PlainFetch { kColumn, kLineBuffer };
enum class PlainArbitration { kFixedPriority, kRoundRobin, kAge };
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
  int filter_half = 0;  // h is the sum of these two: of the filter, 0 without filter,
  int cost_half = 0;    // and of the cost function, 0 but for census
  int units = 0;        // U; 0: all, one for each disparity
  int rows = 1;         // R; more than 1 only with kColumn
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
  bool joint_tables = false;  // one table for both sides: left_lut and right_lut name its bank
  bool word_cache = false;
  // The entries in the tables, row-major, W * H, as in separate tables; nullopt: the identity. Only on a side
  // with a table.
  std::optional<std::vector<std::uint32_t>> left_table;
  std::optional<std::vector<std::uint32_t>> right_table;
};

}  // namespace stereotlm::test

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

// The part of a board on which contract section 2 depends, in types that share nothing with the models.
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

}  // namespace stereotlm::test

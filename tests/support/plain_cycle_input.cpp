#include "tests/support/plain_cycle_input.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace stereotlm::test {
namespace {

void require(bool holds, const std::string& field, long long value, const std::string& rule) {
  if (!holds) {
    throw std::invalid_argument("plain cycle loop: " + field + " = " + std::to_string(value) + ": " + rule);
  }
}

void require_banks(const PlainCycleInput& input, const std::string& field, const std::vector<int>& list) {
  require(!list.empty() && list.size() <= 3, field + " length", static_cast<long long>(list.size()), "1..3");
  for (const int bank : list) {
    require(bank >= 0 && bank < static_cast<int>(input.banks.size()), field, bank, "must be a bank");
  }
}

void require_table(const PlainCycleInput& input, const std::string& side, const std::optional<int>& bank,
                   const std::optional<std::vector<std::uint32_t>>& entries) {
  if (bank) require_banks(input, side + "_lut", {*bank});
  if (!entries) return;
  const auto length = static_cast<long long>(entries->size());
  require(bank.has_value(), side + "_table length", length, "a side without table has no entries");
  require(length == static_cast<long long>(input.width) * input.height, side + "_table length", length,
          "must be width * height");
}

}  // namespace

const char* name_of(PlainPort port) {
  static constexpr std::array<const char*, kPlainPortCount> kNames = {
      "left_lut", "right_lut", "left_pixel", "right_pixel", "result", "host"};
  return kNames[static_cast<std::size_t>(port)];
}

const char* name_of(PlainBankKind kind) {
  switch (kind) {
    case PlainBankKind::kZbtPipelined:
      return "zbt_pipelined";
    case PlainBankKind::kZbtFlowThrough:
      return "zbt_flow_through";
    case PlainBankKind::kSyncBurst:
      break;
  }
  return "sync_burst";
}

const char* name_of(PlainFetch fetch) { return fetch == PlainFetch::kColumn ? "column" : "line_buffer"; }

const char* name_of(PlainArbitration arbitration) {
  return arbitration == PlainArbitration::kFixedPriority ? "fixed_priority" : "round_robin";
}

void require_valid(const PlainCycleInput& input) {
  require(input.width >= 4 && input.width <= 2048 && input.width % 4 == 0, "width", input.width,
          "4..2048, a multiple of 4");
  require(input.height >= 1 && input.height <= 2048, "height", input.height, "1..2048");
  require(input.window >= 3 && input.window <= 31 && input.window % 2 == 1, "window", input.window,
          "3..31, odd");
  require(input.disparities >= 1 && input.disparities <= 254, "disparities", input.disparities, "1..254");
  require(input.filter_half >= 0 && input.filter_half <= 15, "filter_half", input.filter_half, "0..15");
  require(input.lane_fifo_slots >= 1 && input.lane_fifo_slots <= 64, "lane_fifo_slots", input.lane_fifo_slots,
          "1..64");
  require(input.result_fifo_words >= 1 && input.result_fifo_words <= 64, "result_fifo_words",
          input.result_fifo_words, "1..64");
  require(input.pipeline_latency_cycles >= 0 && input.pipeline_latency_cycles <= 1024,
          "pipeline_latency_cycles", input.pipeline_latency_cycles, "0..1024");
  for (std::size_t port = 0; port < kPlainPortCount; ++port) {
    const auto named = std::count(input.priority.begin(), input.priority.end(), static_cast<PlainPort>(port));
    require(named == 1, "priority: " + std::string(name_of(static_cast<PlainPort>(port))) + " named", named,
            "each of the six ports once");
  }
  require_banks(input, "left_image", input.left_image);
  require_banks(input, "right_image", input.right_image);
  require_banks(input, "disparity", input.disparity);
  require(input.left_image.size() == input.right_image.size(), "right_image length",
          static_cast<long long>(input.right_image.size()), "must be the length of left_image");
  require_table(input, "left", input.left_lut, input.left_table);
  require_table(input, "right", input.right_lut, input.right_table);
  for (const PlainBank& bank : input.banks) {
    require(bank.kind != PlainBankKind::kSyncBurst ||
                (bank.turnaround_cycles >= 1 && bank.turnaround_cycles <= 16),
            "turnaround_cycles", bank.turnaround_cycles, "1..16 with sync_burst");
  }
}

}  // namespace stereotlm::test

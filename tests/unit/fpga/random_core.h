#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/fpga/core_ports.h"
#include "models/kernels/rectification_table.h"
#include "models/memory/arbitration_policies.h"
#include "models/memory/memory_config.h"
#include "tests/support/random_board.h"

namespace stereotlm::fpga {

// 3 x 3 windows, no filter, and a few disparities.
inline CoreConfig small_core(int width, int height, int disparities = 3, Fetch fetch = Fetch::kColumn) {
  CoreConfig config;
  config.width = width;
  config.height = height;
  config.window = 3;
  config.disparities = disparities;
  config.filter.reset();
  config.fetch = fetch;
  return config;
}

// Small cores for property tests: every way to fetch and filter, images lower than the window, short queues.
// `widest`: largest width in pixels, a multiple of 4.
inline CoreConfig random_core(test::SplitMix64& random, int widest) {
  CoreConfig config;
  config.width = 4 * random.mostly_small(1, 8, widest / 4);
  config.height = random.mostly_small(1, 8, 24);
  config.window = 2 * random.mostly_small(1, 4, 15) + 1;
  config.disparities = random.between(1, 20);
  config.filter.reset();
  if (random.chance(50)) {
    const int size = 2 * random.mostly_small(1, 3, 15) + 1;
    config.filter = {size, std::vector<int>(static_cast<std::size_t>(size * size)), 0};
  }
  config.fetch = random.chance(70) ? Fetch::kColumn : Fetch::kLineBuffer;
  config.left_table = random.chance(80);
  config.right_table = random.chance(80);
  config.lane_fifo_slots = random.mostly_small(1, 16, 64);
  config.joint_tables = config.left_table && config.right_table && random.chance(30);
  if (random.chance(50)) config.pixel_cache = PixelCache::kWord;
  config.result_fifo_words = random.mostly_small(1, 8, 64);
  config.pipeline_latency_cycles = random.between(0, 20);
  return config;
}

inline void draw_units(test::SplitMix64& random, CoreConfig& config) {
  if (random.chance(50)) config.units = random.between(1, config.disparities);
}
inline void draw_rows(test::SplitMix64& random, CoreConfig& config) {
  if (config.fetch == Fetch::kLineBuffer || random.chance(50)) return;
  config.rows = random.mostly_small(2, 5, 16);
  config.result_fifo_words = std::max(config.result_fifo_words, config.rows);
}

inline void draw_cost(test::SplitMix64& random, CoreConfig& config) {
  using kernels::CostKind;
  constexpr CostKind kKinds[] = {CostKind::kSad, CostKind::kSsd, CostKind::kZncc, CostKind::kCensus};
  config.cost.kind = kKinds[random.between(0, 3)];
  if (config.cost.kind == CostKind::kCensus) config.cost.census_size = 2 * random.between(1, 3) + 1;
}

// Any policy and any order of the ports.
inline memory::ArbiterConfig random_arbiter(test::SplitMix64& random) {
  const auto& policies = memory::arbitration_policies();
  memory::ArbiterConfig config = core_arbiter();
  config.policy =
      policies[static_cast<std::size_t>(random.between(0, static_cast<int>(policies.size()) - 1))].name;
  auto& list = config.priority;
  for (auto place = list.begin(); place != list.end(); ++place)
    std::iter_swap(place, place + random.between(0, static_cast<int>(list.end() - place) - 1));
  return config;
}

// The default bank, but of any kind.
inline memory::SsramBankConfig random_bank(test::SplitMix64& random) {
  const int kinds = static_cast<int>(memory::kBankTraits.size());
  memory::SsramBankConfig config;
  config.kind = static_cast<memory::BankKind>(random.between(0, kinds - 1));
  if (memory::traits_of(config.kind).has_turnaround) config.turnaround_cycles = random.mostly_small(1, 3, 16);
  if (config.kind == memory::BankKind::kSdram) {
    memory::SdramTiming& timing = config.sdram.emplace();
    timing.cas_latency = random.mostly_small(1, 3, 8);
    timing.row_words = 16 << random.between(0, 4);
    timing.internal_banks = 1 << random.between(0, 3);
    timing.activate_cycles = random.mostly_small(0, 2, 20);
    timing.precharge_cycles = random.mostly_small(0, 2, 20);
    timing.refresh_cycles = random.mostly_small(1, 5, 60);
    timing.refresh_interval_cycles.reset();
    if (random.chance(70))
      timing.refresh_interval_cycles =
          std::max(64, memory::least_refresh_interval(timing)) + random.between(0, 500);
  }
  return config;
}

// Index of a pixel's entry in a table.
inline std::size_t place_of(const CoreConfig& config, int column, int row) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(config.width) +
         static_cast<std::size_t>(column);
}

// The table entries of one side: all valid, valid but for a block or some columns, or some anywhere. The
// sources are the pixels themselves, or lie on slanted lines.
inline std::vector<std::uint32_t> random_entries(test::SplitMix64& random, const CoreConfig& config) {
  auto entries = kernels::identity_table(config.width, config.height).entries;
  if (random.chance(50)) {
    const int slope = random.between(-16, 16);
    const int slant = random.between(-16, 16);
    const auto wrapped = [](int place, int size) { return (place % size + size) % size; };
    for (int row = 0; row < config.height; ++row) {
      for (int column = 0; column < config.width; ++column) {
        entries[place_of(config, column, row)] =
            kernels::make_entry(wrapped(column + (column * slope + row * slant) / 16, config.width),
                                wrapped(row + column * slant / 32, config.height));
      }
    }
  }
  const auto invalidate = [&](int column, int row) { entries[place_of(config, column, row)] = 0; };
  const int kind = random.between(0, 3);
  const int percent = random.between(1, 99);
  const int first_column = random.between(0, config.width - 1);
  const int first_row = kind == 1 ? random.between(0, config.height - 1) : 0;
  for (int row = first_row; row < config.height; ++row) {
    for (int column = 0; column < config.width; ++column) {
      const bool in_block = kind != 0 && column >= first_column;
      if (kind == 3 ? random.chance(percent) : in_block) invalidate(column, row);
    }
  }
  return entries;
}

}  // namespace stereotlm::fpga

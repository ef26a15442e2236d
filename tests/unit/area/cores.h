#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "models/area/area.h"
#include "tests/unit/area/resources.h"

// Cores that differ from the paper's in some fields, and what their parts take.
namespace stereotlm::area {

using fpga::CoreConfig;
using fpga::Fetch;

inline constexpr auto kWidth = &CoreConfig::width;
inline constexpr auto kHeight = &CoreConfig::height;
inline constexpr auto kWindow = &CoreConfig::window;
inline constexpr auto kDisparities = &CoreConfig::disparities;
inline constexpr auto kFilter = &CoreConfig::filter;
inline constexpr auto kFetch = &CoreConfig::fetch;
inline constexpr auto kTolerance = &CoreConfig::lr_tolerance;
inline constexpr auto kLeftTable = &CoreConfig::left_table;
inline constexpr auto kRightTable = &CoreConfig::right_table;
inline constexpr auto kLaneSlots = &CoreConfig::lane_fifo_slots;
inline constexpr auto kResultWords = &CoreConfig::result_fifo_words;
inline constexpr auto kResultDelay = &CoreConfig::result_delay_cycles;
inline constexpr auto kUnits = &CoreConfig::units;
inline constexpr auto kRows = &CoreConfig::rows;
inline constexpr auto kLanes = &CoreConfig::lanes;
inline constexpr auto kCost = &CoreConfig::cost;
inline constexpr auto kJoint = &CoreConfig::joint_tables;
inline constexpr auto kCache = &CoreConfig::pixel_cache;

// The paper's core with other values in the fields that are named.
inline CoreConfig core() { return {}; }
template <class Field, class Value, class... More>
CoreConfig core(Field CoreConfig::*field, const Value& value, const More&... more) {
  CoreConfig config = core(more...);
  config.*field = value;
  return config;
}

// The parts of this name; a count of 0 if there are none.
inline Item item_of(const CoreConfig& config, const std::string& name) {
  for (const Item& item : items(config)) {
    if (item.name == name) return item;
  }
  return {};
}

inline Resources all_of(const CoreConfig& config, const std::string& name) {
  return item_of(config, name).all;
}

using Cores = std::vector<std::pair<CoreConfig, Resources>>;

// What all parts of this name take in each of the cores.
inline void expect_all(const std::string& name, const Cores& cores) {
  for (std::size_t number = 0; number < cores.size(); ++number)
    EXPECT_EQ(all_of(cores[number].first, name), cores[number].second) << name << " of core " << number;
}

constexpr Resources block_rams(std::int64_t count) { return {0, 0, count, 0}; }

}  // namespace stereotlm::area

#include "models/fpga/access_pattern.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

// The accesses of a slot.
enum class Access : std::uint8_t { kNone, kTable, kTableAndImage };

// Every column of slots of a frame, by a literal walk over all of them.
std::vector<std::vector<Access>> columns_of(const CoreConfig& config,
                                            const std::vector<std::uint32_t>& entries) {
  const FrameGeometry geometry(config);
  std::vector<std::vector<Access>> columns;
  for (SlotCursor slot(geometry); !slot.done();) {
    columns.emplace_back();
    for (int k = 0; k < geometry.slots_per_column; ++k, slot.advance()) {
      if (slot.empty()) {
        columns.back().push_back(Access::kNone);
        continue;
      }
      const bool valid = kernels::entry_is_valid(entries[place_of(config, slot.column(), slot.row())]);
      columns.back().push_back(valid ? Access::kTableAndImage : Access::kTable);
    }
  }
  return columns;
}

std::uint64_t count(const std::vector<std::vector<Access>>& columns, Access what) {
  std::uint64_t slots = 0;
  for (const auto& column : columns) {
    for (const Access access : column) slots += std::uint64_t{access == what};
  }
  return slots;
}

TEST(AccessPattern, EqualsAWalkOverTheSlots) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::SplitMix64 random(seed);
    const CoreConfig config = random_core(random, 140);
    AccessPattern pattern{FrameGeometry(config)};
    std::vector<std::uint32_t> entries;
    // A table before this one has no effect.
    for (int table = random.between(1, 2); table > 0; --table) {
      entries = random_entries(random, config);
      pattern.set_entries(entries.data());
    }
    const auto columns = columns_of(config, entries);
    ASSERT_EQ(pattern.empty_slots(), count(columns, Access::kNone));
    ASSERT_EQ(pattern.pixel_accesses(), count(columns, Access::kTableAndImage));
    std::size_t next = columns.size();
    for (std::size_t column = columns.size(); column-- > 0;) {
      if (column + 1 < columns.size() && columns[column + 1] != columns[column]) next = column + 1;
      ASSERT_EQ(pattern.uniform_until(column), next) << column;
    }
    for (int row = 0; row < config.height; ++row) {
      for (int column = 0; column < config.width; ++column) {
        ASSERT_EQ(pattern.entry_valid(column, row),
                  kernels::entry_is_valid(entries[place_of(config, column, row)]));
      }
    }
  }
}

}  // namespace
}  // namespace stereotlm::fpga

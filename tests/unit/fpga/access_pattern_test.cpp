#include "models/fpga/access_pattern.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

// The accesses of a slot.
enum class SlotAccess : std::uint8_t { kNone, kTable, kTableAndCache, kTableAndImage };

// Every column of slots of a frame, by a literal walk over all of them.
std::vector<std::vector<SlotAccess>> columns_of(const CoreConfig& config,
                                                const std::vector<std::uint32_t>& entries) {
  const FrameGeometry geometry(config);
  std::vector<std::vector<SlotAccess>> columns;
  std::map<int, int> cached;  // slot of a column -> word
  for (SlotCursor slot(geometry, 0); !slot.done();) {
    columns.emplace_back();
    for (int k = 0; k < geometry.slots_per_column; ++k, slot.advance()) {
      if (slot.empty()) {
        columns.back().push_back(SlotAccess::kNone);
        continue;
      }
      const std::uint32_t entry = entries[place_of(config, slot.column(), slot.row())];
      if (slot.column() == 0) cached.erase(k);
      const int word = (kernels::entry_row(entry) * config.width + kernels::entry_column(entry)) / 4;
      if (!kernels::entry_is_valid(entry)) {
        columns.back().push_back(SlotAccess::kTable);
      } else if (config.pixel_cache == PixelCache::kWord && cached.count(k) != 0 && cached[k] == word) {
        columns.back().push_back(SlotAccess::kTableAndCache);
      } else {
        columns.back().push_back(SlotAccess::kTableAndImage);
        cached[k] = word;
      }
    }
  }
  return columns;
}

std::uint64_t count(const std::vector<std::vector<SlotAccess>>& columns, SlotAccess what) {
  std::uint64_t slots = 0;
  for (const auto& column : columns) {
    for (const SlotAccess access : column) slots += std::uint64_t{access == what};
  }
  return slots;
}

TEST(AccessPattern, EqualsAWalkOverTheSlots) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::SplitMix64 random(seed);
    const CoreConfig config = random_core(random, 140);
    AccessPattern pattern(FrameGeometry(config), config.pixel_cache);
    std::vector<std::uint32_t> entries;
    // A table before this one has no effect.
    for (int table = random.between(1, 2); table > 0; --table) {
      entries = random_entries(random, config);
      pattern.set_entries(entries.data());
    }
    const auto columns = columns_of(config, entries);
    ASSERT_EQ(pattern.table_accesses(),
              columns.size() * columns.front().size() - count(columns, SlotAccess::kNone));
    ASSERT_EQ(pattern.pixel_accesses(), count(columns, SlotAccess::kTableAndImage));
    const FrameGeometry geometry(config);
    std::uint64_t slot = 0;
    std::vector<bool> pixels(geometry.slots + 256 + 1);  // beyond the end of the frame there are none
    for (SlotCursor place(geometry, 0); !place.done(); place.advance(), ++slot) {
      const SlotAccess access = columns[slot / columns.front().size()][slot % columns.front().size()];
      if (access != SlotAccess::kNone) {
        ASSERT_EQ(pattern.needs_pixel(place.column(), place.row()), access == SlotAccess::kTableAndImage);
      }
      pixels[slot] = access == SlotAccess::kTableAndImage;
    }
    std::uint64_t expected = 0;
    for (slot = pixels.size(); slot-- > 0;) {
      expected = expected << 1U | std::uint64_t{pixels[slot]};
      ASSERT_EQ(pattern.pixels_of_slots(slot), expected) << slot;
    }
  }
}

}  // namespace
}  // namespace stereotlm::fpga

#include "models/area/area.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "models/area/filter_arithmetic.h"
#include "models/fpga/frame_geometry.h"

namespace stereotlm::area {
namespace {

using fpga::CoreConfig;
using fpga::Fetch;

constexpr int kEntryBits = 11 + 11 + 1;  // contract 1.1: source row, source column, valid
constexpr int kDisparityBits = 8;        // contract 1.5, 255 = invalid
constexpr int kWordBits = 32;
constexpr int kValidBit = 1;

// The configuration, and the widths that follow from it.
struct Core {
  explicit Core(const CoreConfig& core_config)
      : config(core_config),
        geometry(config),
        columns_of_pixels(config.fetch == Fetch::kLineBuffer),
        column_sum_bits(bits_of(kMostPixel * config.window)),
        window_sum_bits(bits_of(kMostPixel * config.window * config.window)),
        disparity_bits(bits_of(config.disparities - 1)) {}

  int valid_bit_of(bool left) const { return left && config.left_table ? kValidBit : 0; }
  int tables() const { return int{config.left_table} + int{config.right_table}; }

  const CoreConfig& config;
  fpga::FrameGeometry geometry;
  bool columns_of_pixels;  // the matcher takes a whole column per cycle, not one pixel
  int column_sum_bits;
  int window_sum_bits;
  int disparity_bits;  // bits of a disparity, 0..D-1
};

using Items = std::vector<Item>;

void add(const char* name, std::int64_t count, const Resources& all, Items& items) {
  if (count > 0) items.push_back({name, count, all});
}

// Contract section 2, "Lane": a slot waits as a table entry, then as a pixel, in queues of `lane_fifo_slots`
// places. Of the valid bits only the left one is passed on, to the left-right check. Paper section 3.2: an
// entry names a source pixel. The address of that pixel is row * W + column, and the pixel is one of four in
// a word.
void add_lanes(const Core& core, Items& items) {
  const CoreConfig& config = core.config;
  const int tables = core.tables();
  add("table entry queues", tables, tables * shift_register(config.lane_fifo_slots, kEntryBits), items);
  const int address_bits = bits_of(std::int64_t{config.width} * config.height - 1);
  // If the width is a power of two, the row's bits and the column's bits are the address.
  const bool is_power_of_two = bits_of(config.width) != bits_of(config.width - 1);
  const Resources address = is_power_of_two ? Resources{} : Resources{0, 0, 0, 1} + adder(address_bits);
  add("source addresses", tables, tables * address, items);
  add("byte selectors", 2, 2 * (2 * selector(kPixelBits)), items);  // one of 4: two LUTs a bit, and MUXF5
  Resources queues;
  for (const bool left : {true, false})
    queues += shift_register(config.lane_fifo_slots, kPixelBits + core.valid_bit_of(left));
  add("pixel queues", 2, queues, items);
}

// Paper section 2.4, contract 1.2. m is the size of the kernel. Beside the new pixel the filter reads the
// pixels of the m - 1 columns before it in the same row; a column of slots has n rows. For each column of the
// image the line memories hold the partial sums of the rows above. They also hold as many valid bits as there
// are rows from the middle of the window down to the newest n rows.
void add_filter(const Core& core, Items& items) {
  const CoreConfig& config = core.config;
  if (!config.filter) return;
  const FilterArithmetic arithmetic = filter_arithmetic(*config.filter);
  add("filters", 2, 2 * arithmetic.resources, items);
  const int before_bits = (config.filter->size - 1) * kPixelBits;
  const Resources columns_before =
      core.columns_of_pixels ? registers(before_bits) : memory(config.window, before_bits);
  add("filter columns", 2, 2 * columns_before, items);
  Resources lines;
  for (const bool left : {true, false}) {
    const int valid_bits = core.columns_of_pixels ? 0 : core.valid_bit_of(left) * core.geometry.lead_strips;
    lines += memory(config.width, arithmetic.chain_bits + valid_bits);
  }
  add("filter line memories", 2, lines, items);
}

// Contract section 2, `line_buffer`: the row buffers hold the n - 1 filtered rows above the newest row, and
// the left valid bits from the newest row up to the middle of the window.
void add_row_buffers(const Core& core, Items& items) {
  if (!core.columns_of_pixels) return;
  Resources rows;
  for (const bool left : {true, false}) {
    const int valid_bits = core.valid_bit_of(left) * core.geometry.lead_strips;
    rows += memory(core.config.width, (core.config.window - 1) * kPixelBits + valid_bits);
  }
  add("row buffers", 2, rows, items);
}

// A tree of adders that sums `count` pixel differences in one cycle.
Resources sum_of_differences(int count) {
  if (count == 1) return {};
  const int half = count / 2;
  return sum_of_differences(half) + sum_of_differences(count - half) + adder(bits_of(kMostPixel * count));
}

// Paper figures 6 and 8. Left pixels go to all column modules. Right pixels go from module to module, one
// column later in each. A column module adds up n absolute differences of two pixels, one a cycle. A window
// module adds the output of its column module, and subtracts the output of n columns before. Each candidate
// has a flip-flop that marks whether its window lies inside both images (contract 1.3). With each column of a
// row, the window of one candidate more does.
void add_modules(const Core& core, Items& items) {
  const int n = core.config.window;
  const int disparities = core.config.disparities;
  const Resources delay = core.columns_of_pixels ? registers(n * kPixelBits) : shift_register(n, kPixelBits);
  add("right pixel delays", disparities - 1, (disparities - 1) * delay, items);

  const Resources difference = absolute_difference(kPixelBits);
  const Resources column = core.columns_of_pixels ? n * difference + sum_of_differences(n)
                                                  : difference + adder(core.column_sum_bits);
  add("column modules", disparities, disparities * (column + registers(core.column_sum_bits)), items);

  const Resources new_less_old = adder(core.column_sum_bits + 1);  // signed
  const Resources window = shift_register(n, core.column_sum_bits) + new_less_old +
                           adder(core.window_sum_bits) + registers(core.window_sum_bits);
  add("window modules", disparities, disparities * window, items);
  add("candidate marks", disparities, disparities * registers(1), items);
}

// One step of select-min unit A or B: compares two sums, and selects one of them with its disparity, if both
// candidates are valid.
Resources select_min(int sum_bits, int disparity_bits) {
  return comparator(sum_bits) + Resources{1} + selector(sum_bits) + selector(disparity_bits);
}

// Paper section 3.3, figure 6: a chain. Module d keeps the smaller of its own sum and the sum that module d-1
// held a column ago, whose disparity is at most d-1. Module 0 only holds its own sum.
void add_select_min_chain(const Core& core, Items& items) {
  const int sum_bits = core.window_sum_bits;
  Resources chain = registers(sum_bits + kValidBit);
  for (int d = 1; d < core.config.disparities; ++d) {
    const int disparity_bits = bits_of(d);
    chain += select_min(sum_bits, disparity_bits) + registers(sum_bits + disparity_bits + kValidBit);
  }
  add("select-min unit A", core.config.disparities, chain, items);
}

// Paper section 3.3: a tree of D-1 comparators, registered at every level. The result of a comparison is the
// highest bit of the pair's disparity; the lower bits are those of the smaller sum. A sum without a partner
// at its level waits in registers.
void add_select_min_tree(const Core& core, Items& items) {
  const int sum_bits = core.window_sum_bits;
  Resources tree;
  int disparity_bits = 0;  // of the disparities at this level
  for (int at_level = core.config.disparities; at_level > 1; ++disparity_bits) {
    const int pairs = at_level / 2;
    const int left_over = at_level % 2;
    tree +=
        pairs * (select_min(sum_bits, disparity_bits) + registers(sum_bits + disparity_bits + 1 + kValidBit));
    tree += left_over * registers(sum_bits + disparity_bits + kValidBit);
    at_level = pairs + left_over;
  }
  add("select-min unit B", core.config.disparities - 1, tree, items);
}

// Contract 1.4. The left-based disparity waits D-1 columns for the right-based one. A block RAM holds the
// last D right-based disparities, and is read at the place to which the left-based disparity points. The
// comparison takes an absolute difference, LUTs that compare it with the tolerance (4 bits in the first LUT,
// 3 more in each further one), and a LUT that joins the result with both valid bits. The valid bit of the
// left pixel itself waits until its column is the middle of the window. Without a check only the delays and
// the selector remain.
void add_left_right_check(const Core& core, Items& items) {
  const int bits = core.disparity_bits;
  Resources check = shift_register(core.config.disparities - 1, bits + kValidBit);
  if (core.config.left_table) check += shift_register(core.geometry.radius + core.geometry.half, kValidBit);
  if (core.config.lr_tolerance) {
    check += memory(core.config.disparities, bits + kValidBit) + absolute_difference(bits) +
             Resources{std::max(1, (bits + 1) / 3)} + Resources{1};
  }
  check += selector(kDisparityBits);  // the disparity or 255
  add("left-right check", 1, check, items);
}

// Contract 1.5 and section 2, "Matcher": the first three disparities of a word wait for the fourth; words
// wait in the queue.
void add_results(const Core& core, Items& items) {
  add("result packer", 1, registers(kWordBits - kDisparityBits), items);
  add("result queue", 1, shift_register(core.config.result_fifo_words, kWordBits), items);
}

double percent(std::int64_t part, std::int64_t whole) {
  return 100 * static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::int64_t Item::lut_equivalents() const { return std::max(all.luts, all.flip_flops); }

std::vector<Item> items(const CoreConfig& config) {
  const std::vector<std::string> problems = fpga::problems(config);
  if (!problems.empty()) throw std::invalid_argument(problems.front());
  const Core core(config);
  Items found;
  add_lanes(core, found);
  add_filter(core, found);
  add_row_buffers(core, found);
  add_modules(core, found);
  if (config.lr_tolerance) add_select_min_chain(core, found);  // only the check needs it
  add_select_min_tree(core, found);
  add_left_right_check(core, found);
  add_results(core, found);
  return found;
}

Area total(const std::vector<Item>& items, const Device& device) {
  Area area;
  Resources all;
  for (const Item& item : items) {
    area.lut_equivalents += item.lut_equivalents();
    all += item.all;
  }
  area.slices = static_cast<std::int64_t>(
      std::ceil(kSlicesPerLutEquivalent * static_cast<double>(area.lut_equivalents)));
  area.slices_percent = percent(area.slices, device.slices);
  area.luts = all.luts;
  area.flip_flops = all.flip_flops;
  area.block_rams = all.block_rams;
  area.block_rams_percent = percent(area.block_rams, device.block_rams);
  area.multipliers = all.multipliers;
  area.multipliers_percent = percent(area.multipliers, device.multipliers);
  return area;
}

}  // namespace stereotlm::area

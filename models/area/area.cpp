#include "models/area/area.h"

#include <algorithm>

#include "models/area/filter_arithmetic.h"
#include "models/fpga/frame_geometry.h"

namespace stereotlm::area {
namespace {

using fpga::CoreConfig;
using fpga::Fetch;
using kernels::CostKind;

constexpr int kEntryBits = 11 + 11 + 1;     // contract 1.1: source row, source column, valid
constexpr int kJointEntryBits = 7 + 8 + 1;  // contract 7.3, for one side: dy, dx, valid
constexpr int kOffsetBits = 12;             // contract 7.3: X and Y are -2048..2047
constexpr int kDisparityBits = 8;           // contract 1.5, 255 = invalid
constexpr int kWordBits = 32;
constexpr int kValidBit = 1;
constexpr int kAddressBits = 26;  // of a word in a bank

// What controls the parts, as Yosys makes it of these blocks of models/rtl for images of 640x480
// (results/silicon). Other sizes have other counters; they differ by a few LUTs.
constexpr Resources kSequencer{103, 105};       // of a lane: sequencer, and the rest of lane
constexpr Resources kMatcherControl{132, 119};  // match_control, window_control, matcher
constexpr Resources kSlotPosition{153, 64};     // slot_position
constexpr Resources kResultControl{92, 64};     // result_port
constexpr Resources kFrameRegisters{51, 225};   // stereo_core
constexpr Resources kMultiplexer{150, 13};      // a port's share of paper_crossbar

// Resources of the cost functions (contract 7.6).

constexpr std::int64_t kMostProduct = kMostPixel * kMostPixel;

Resources zero_test(int bits) { return {(bits + 3) / 4}; }  // 4 bits a LUT, joined by the carry chain

// What a column module does with two pixels.
struct PairArithmetic {
  Resources resources;    // for one pair per cycle
  std::int64_t most = 0;  // largest value of the result
  int pixel_bits = 0;     // bits of a pixel, as it goes to the modules
};

//   sad     the absolute difference
//   ssd     the difference and a multiplier that squares it
//   zncc    a multiplier
//   census  two LUTs count how many of two bits differ; a tree of adders sums the counts
PairArithmetic pair_arithmetic(const kernels::MatchingCost& cost) {
  switch (cost.kind) {
    case CostKind::kSad:
      break;
    case CostKind::kSsd:
      return {adder(kPixelBits + 1) + product(kPixelBits, kPixelBits), kMostProduct, kPixelBits};
    case CostKind::kZncc:
      return {product(kPixelBits, kPixelBits), kMostProduct, kPixelBits};
    case CostKind::kCensus: {
      const int bits = cost.census_bits();
      return {Resources{bits} + adder_tree(bits / 2, 2), bits, bits};
    }
  }
  return {absolute_difference(kPixelBits), kMostPixel, kPixelBits};
}

// The resources for the census bits of one pixel per cycle, on one side. c is the size of the neighbourhood.
// - c * c - 1 comparators, and registers for the c * (c - 1) pixels that the next position needs too.
// - `moves_down`: the neighbourhood moves down a column. At the top of a column one selector per bit loads
//   these registers with the c - 1 rows above. Their newest column comes from the line memories, the other
//   c - 1 columns from (c - 1) * (c - 1) further registers.
// - Else it moves to the right, behind a line buffer.
Resources census_bits(const kernels::MatchingCost& cost, bool moves_down) {
  const int before = 2 * cost.half();
  const int kept = cost.census_size * before * kPixelBits;
  const int above = before * before * kPixelBits;
  Resources bits = cost.census_bits() * comparator(kPixelBits) + registers(kept);
  if (moves_down) bits += selector(kept) + registers(above);
  return bits;
}

// zncc: the widths that follow from the window, and the parts for one pixel or candidate. N is the number of
// pixels of a window. A variance is at most N^2 * 255^2 / 4: half the pixels are 0, half are 255. |cov| is at
// most the larger variance (inequality of Cauchy and Schwarz).
struct ZnccArithmetic {
  explicit ZnccArithmetic(int window)
      : count(std::int64_t{window} * window), variance_bits(bits_of(kMostProduct * count * count / 4)) {}

  int score_bits() const { return 3 * variance_bits + 1; }  // numerator cov * |cov|, and denominator

  // The two products of a variance or a covariance.
  Resources products() const {
    return product(bits_of(count), bits_of(kMostProduct * count)) + product(sum_bits, sum_bits);
  }
  // N * sum(F^2) - sum(F)^2, with its register; the lowest bit of a variance of 0 is set, so that a fraction
  // is never 0 / 0.
  Resources variance() const {
    return products() + adder(variance_bits) + zero_test(variance_bits) + registers(variance_bits);
  }
  // cov = N * sum(FrFl) - sum(Fr) * sum(Fl), then cov * |cov|, with its register.
  Resources score() const {
    return products() + adder(variance_bits + 1) + selector(variance_bits) +
           product(variance_bits, variance_bits) + registers(2 * variance_bits + 1);
  }
  // Compares two fractions, and selects one: multiplies each numerator by the denominator of the other.
  Resources select() const {
    return 2 * product(2 * variance_bits, variance_bits) + comparator(score_bits()) + selector(score_bits());
  }

  std::int64_t count;                          // N
  int sum_bits = bits_of(kMostPixel * count);  // of the sum of the pixels of a window
  int variance_bits;                           // of N * sum(F^2) - sum(F)^2; also of |cov|
};

// The configuration, and the widths that follow from it.
struct Core {
  explicit Core(const CoreConfig& core_config)
      : config(core_config),
        geometry(config),
        columns_of_pixels(config.fetch == Fetch::kLineBuffer),
        folds(fpga::folds_of(config)),
        units(fpga::units_of(config)),
        pair(pair_arithmetic(config.cost)),
        disparity_bits(bits_of(config.disparities - 1)) {
    pair.resources += registers(bits_of(pair.most));  // of the pipeline
  }

  int valid_bit_of(bool left) const { return left && config.left_table ? kValidBit : 0; }
  int tables() const { return int{config.left_table} + int{config.right_table}; }
  int column_sum_bits(std::int64_t most) const { return bits_of(most * config.window); }
  int window_sum_bits(std::int64_t most) const { return bits_of(most * config.window * config.window); }

  const CoreConfig& config;
  fpga::FrameGeometry geometry;
  bool columns_of_pixels;  // the matcher takes a whole column per cycle, not one pixel
  int folds;               // S
  int units;               // U
  PairArithmetic pair;
  int disparity_bits;  // bits of a disparity, 0..D-1
};

using Items = std::vector<Item>;

void add(const char* name, std::int64_t count, const Resources& all, Items& items) {
  if (count > 0) items.push_back({name, count, all});
}

// Contract 7.4. For each slot that it has of a column, a lane keeps the last word, its address and a valid
// bit. Slots come in turn, so these are shift registers with a place for each of them. A slot without access
// keeps the old address and word.
Resources word_cache(const Core& core, int lane) {
  const int places = core.geometry.slots_of_lane(lane);
  const int address_bits = bits_of(std::int64_t{core.config.width} * core.config.height / 4 - 1) + kValidBit;
  return shift_register(places, address_bits) + selector(address_bits) + equality(address_bits) +
         shift_register(places, kWordBits) + selector(kWordBits);
}

// Contract section 2, "Lane", and paper section 3.2. A slot waits in queues of `lane_fifo_slots` places,
// first as a table entry, then as a pixel. Only the left valid bit is passed on, to the left-right check. The
// source pixel of an entry has the address row * W + column, and is one of four in its word. It is added to
// the first address of its buffer, as the place of the slot is to that of the table. Joint tables
// (contract 7.3): one port reads both halves of an entry, and each lane has its queue. The halves are
// displacements. The counters of a lane's position begin at the offsets X and Y, so that a displacement takes
// one adder for the column and one for the row. Each side has P lanes (contract 8.1).
void add_lanes(const Core& core, Items& items) {
  const CoreConfig& config = core.config;
  const int lanes = 2 * config.lanes;
  const int tables = core.tables() * config.lanes;
  const int entry_bits = config.joint_tables ? kJointEntryBits : kEntryBits;
  add("slot sequencers", lanes, lanes * (kSequencer + adder(kAddressBits)), items);
  add("table entry queues", tables, tables * queue(config.lane_fifo_slots, entry_bits), items);
  if (config.joint_tables) {
    const Resources position =
        adder(bits_of(config.width - 1)) + adder(bits_of(config.height - 1)) + registers(2 * kOffsetBits);
    add("source positions", tables, tables * position, items);
  }
  const int address_bits = bits_of(std::int64_t{config.width} * config.height - 1);
  add("source addresses", tables, tables * (digits(config.width, address_bits) + adder(kAddressBits)), items);
  Resources caches;
  for (int lane = 0; lane < config.lanes; ++lane) caches += 2 * word_cache(core, lane);
  if (config.pixel_cache == fpga::PixelCache::kWord) add("word caches", lanes, caches, items);
  add("byte selectors", lanes, lanes * multiplexer(4, kPixelBits), items);
  Resources queues;
  for (const bool left : {true, false})
    queues += config.lanes * queue(config.lane_fifo_slots, kPixelBits + core.valid_bit_of(left));
  add("pixel queues", lanes, queues, items);
}

// Paper section 2.4, contract 1.2. m is the size of the kernel. The m - 1 columns before the new pixel are in
// shift registers with a place for each slot that the lane has of a column (one behind a line buffer). The
// line memories hold the partial results of each image column, and a pixel that repeats below the image. Each
// of P lanes has a filter, which passes its partial results on to the next slot of the column.
void add_filter(const Core& core, Items& items) {
  const CoreConfig& config = core.config;
  if (!config.filter) return;
  const FilterArithmetic arithmetic = filter_arithmetic(*config.filter);
  const int filters = 2 * config.lanes;
  add("filters", filters, filters * arithmetic.resources, items);
  Resources columns;
  for (int lane = 0; lane < config.lanes; ++lane) {
    const int places = core.columns_of_pixels ? 1 : core.geometry.slots_of_lane(lane);
    for (const bool left : {true, false})
      columns += shift_register(places, (config.filter->size - 1) * (kPixelBits + core.valid_bit_of(left)));
  }
  add("filter columns", filters, columns, items);
  const Resources lines =
      memory(config.width, arithmetic.chain_bits) + memory(config.width, kPixelBits + kValidBit);
  add("filter line memories", 2, 2 * lines, items);
}

// Contract 7.6. c is the size of the neighbourhood. The stage behind the filter makes c * c - 1 bits of each
// filtered pixel. Line memories hold c - 1 rows of filtered pixels, column memories the c - 1 columns before.
// Without a filter the line memories also hold the valid bits, at most 2, for which they have room. The bits
// of P pixels are made in a cycle.
void add_census(const Core& core, Items& items) {
  const CoreConfig& config = core.config;
  if (config.cost.kind != CostKind::kCensus) return;
  const int before_bits = 2 * config.cost.half() * kPixelBits;
  const int lanes = 2 * config.lanes;
  add("census bits", lanes, lanes * census_bits(config.cost, !core.columns_of_pixels), items);
  Resources columns;
  for (int lane = 0; lane < config.lanes; ++lane)
    columns += 2 * memory(core.geometry.slots_of_lane(lane), before_bits);
  if (!core.columns_of_pixels) add("census columns", lanes, columns, items);
  add("census line memories", 2, 2 * memory(config.width, before_bits), items);
}

// Contract section 2, `line_buffer`: the row buffers hold the n - 1 rows above the newest one, as the modules
// take them, and r + h left valid bits: from the middle row of the window to the row above the newest slot.
void add_row_buffers(const Core& core, Items& items) {
  if (!core.columns_of_pixels) return;
  Resources rows;
  for (const bool left : {true, false}) {
    const int valid_bits = core.valid_bit_of(left) * core.geometry.lead_strips;
    rows += memory(core.config.width, (core.config.window - 1) * core.pair.pixel_bits + valid_bits);
  }
  add("row buffers", 2, rows, items);
}

// Contract 7.1: a module computes the candidates u, u + U, u + 2U, .. in S folds. A value that it keeps from
// column to column is a shift register with a place for each fold (S = 1: registers).

// Sums the results of n pixel pairs of a column: one pair per cycle, or all in one cycle behind a line
// buffer. A register of the pipeline follows. With one row of results the sum begins anew with each column.
// With several rows (contract 7.2) it slides down the column: it adds the result of the new pair, and
// subtracts that of n slots before. Its last R values belong to the R rows. With P lanes (contract 8.1) P
// pairs come in a cycle: a tree of adders sums their results. With several rows the sum slides P times in a
// cycle, because each of its values may belong to a row.
Resources column_sum(const Core& core, const Resources& pair, std::int64_t most, int folds) {
  const int n = core.config.window;
  const int bits = core.column_sum_bits(most);
  if (core.columns_of_pixels) return n * pair + adder_tree(n, most) + 2 * registers(bits);
  const int lanes = core.config.lanes;
  Resources column = lanes * pair + shift_register(folds, bits) + registers(bits);
  if (core.config.rows == 1) return column + adder_tree(lanes, most) + adder(bits);
  const Resources kept = shift_register((n + lanes - 1) / lanes * folds, bits_of(most));
  return column + lanes * (kept + adder(bits_of(most) + 1) + adder(bits));
}

// Sums the last n column sums: adds the new column sum, and subtracts that of n columns before, once there is
// one. A register of the pipeline follows.
Resources window_sum(const Core& core, std::int64_t most, int folds) {
  const int column_bits = core.column_sum_bits(most);
  const int bits = core.window_sum_bits(most);
  const Resources gate{column_bits - 1};
  return shift_register(core.config.window * folds, column_bits) + gate + 2 * adder(bits) +
         shift_register(folds, bits) + registers(bits);
}

// U - 1 delays, which take a number of the right side from module to module, by `places` clock enables each.
// With several folds one more delay takes it from the last module back to the first one, a fold later.
struct Delays {
  std::int64_t count;
  Resources all;
};
Delays delays(const Core& core, int places, int bits) {
  Delays chain{core.units - 1, (core.units - 1) * shift_register(places * core.folds, bits)};
  if (core.folds > 1) {
    ++chain.count;
    chain.all += shift_register(places * core.folds + 1, bits) + selector(bits);
  }
  return chain;
}

// Paper figures 6 and 8. Left pixels go to all column modules. Right pixels go from module to module, one
// column later in each. A column module sums the results of n pixel pairs. Each of its R window modules adds
// the new column sum, and subtracts that of n columns before. One flip-flop per candidate marks that its
// windows lie inside both images (contract 1.3). Along a row each column marks one more candidate.
void add_modules(const Core& core, Items& items) {
  const PairArithmetic& pair = core.pair;
  const Delays pixels = core.columns_of_pixels ? delays(core, 1, core.config.window * pair.pixel_bits)
                                               : delays(core, core.geometry.cycles_per_column,
                                                        core.config.lanes * pair.pixel_bits);
  add("right pixel delays", pixels.count, pixels.all, items);
  const std::int64_t units = core.units;
  add("column modules", units, units * column_sum(core, pair.resources, pair.most, core.folds), items);
  const std::int64_t windows = units * core.config.rows;
  add("window modules", windows, windows * window_sum(core, pair.most, core.folds), items);
  add("candidate marks", units, units * (shift_register(core.folds, 1) + selector(2)), items);
}

// Contract 7.6, zncc. Each side has the sums of its pixels and of their squares, and the variance, for each
// row of results. Those of the right side go from module to module, one column later in each. Each window
// module has the arithmetic of its score.
void add_scores(const Core& core, Items& items) {
  if (core.config.cost.kind != CostKind::kZncc) return;
  const std::int64_t rows = core.config.rows;
  const ZnccArithmetic zncc(core.config.window);
  const Resources side =
      column_sum(core, {}, kMostPixel, 1) + column_sum(core, core.pair.resources, core.pair.most, 1) +
      rows * (window_sum(core, kMostPixel, 1) + window_sum(core, core.pair.most, 1) + zncc.variance());
  add("window statistics", 2 * rows, 2 * side, items);
  const Delays right = delays(core, 1, zncc.sum_bits + zncc.variance_bits);
  add("right statistics delays", rows * right.count, rows * right.all, items);
  add("scores", rows * core.units, rows * core.units * zncc.score(), items);
}

// What the select-min units compare: the bits of a candidate's sum or score, and the parts that compare two
// of them and select one.
struct Rank {
  int bits;
  Resources select;
};

Rank rank_of(const Core& core) {
  if (core.config.cost.kind == CostKind::kZncc) {
    const ZnccArithmetic zncc(core.config.window);
    return {zncc.score_bits(), zncc.select()};
  }
  const int bits = core.window_sum_bits(core.pair.most);
  return {bits, comparator(bits) + selector(bits)};
}

// One step of select-min unit A or B: compares two sums, and selects one of them with its disparity, if both
// candidates are valid.
Resources select_min(const Rank& rank, int disparity_bits) {
  return rank.select + Resources{1} + selector(disparity_bits);
}

// With several folds a disparity is held as its fold and its module, and is put together at the end.
int split_disparity_bits(const Core& core) { return bits_of(core.folds - 1) + bits_of(core.units - 1); }

// Paper section 3.3, figure 6: a chain. Module d keeps the smaller of two sums: its own, and the sum that
// module d-1 held one column before, whose disparity is at most d-1. In fold 0 module 0 keeps its own sum. In
// later folds its second sum is that of the last module, one column and one fold before.
void add_select_min_chain(const Core& core, Items& items) {
  const Rank rank = rank_of(core);
  Resources chain;
  if (core.folds == 1) {
    chain += registers(rank.bits + kValidBit);
    for (int d = 1; d < core.units; ++d) {
      const int disparity_bits = bits_of(d);
      chain += select_min(rank, disparity_bits) + registers(rank.bits + disparity_bits + kValidBit);
    }
  } else {
    const int disparity_bits = split_disparity_bits(core);
    const int held_bits = rank.bits + disparity_bits + kValidBit;
    chain += core.units * (select_min(rank, disparity_bits) + shift_register(core.folds, held_bits)) +
             registers(held_bits) + digits(core.units, core.disparity_bits);
  }
  const std::int64_t rows = core.config.rows;
  add("select-min unit A", rows * core.units, rows * chain, items);
}

// Paper section 3.3: a tree of U-1 comparators, registered at every level. The result of a comparison is the
// highest bit of the pair's disparity; the lower bits are the disparity of the smaller sum. A sum without a
// partner at its level waits in registers. With several folds a last comparator keeps the smallest sum of
// the folds so far.
void add_select_min_tree(const Core& core, Items& items) {
  const Rank rank = rank_of(core);
  std::int64_t comparators = core.units - 1;
  Resources tree;
  int disparity_bits = 0;  // of the disparities at this level
  for (int at_level = core.units; at_level > 1; ++disparity_bits) {
    const int pairs = at_level / 2;
    const int left_over = at_level % 2;
    tree +=
        pairs * (select_min(rank, disparity_bits) + registers(rank.bits + disparity_bits + 1 + kValidBit));
    tree += left_over * registers(rank.bits + disparity_bits + kValidBit);
    at_level = pairs + left_over;
  }
  if (core.folds > 1) {
    ++comparators;
    const int split_bits = split_disparity_bits(core);
    tree += select_min(rank, split_bits) + registers(rank.bits + split_bits + kValidBit) +
            digits(core.units, core.disparity_bits);
  }
  const std::int64_t rows = core.config.rows;
  add("select-min unit B", rows * comparators, rows * tree, items);
}

// Contract 1.4. The left-based disparity waits D-1 columns for the right-based one. Memories of LUTs hold the
// last D of each, read at the places of D-1 columns before and of the disparity. The comparison takes an
// absolute difference. The valid bit of the left pixel itself waits until its column is the middle of the
// window. A selector gives the disparity or 255. Without a check only the delays and this selector remain.
// Each row of results has all these parts.
void add_left_right_check(const Core& core, Items& items) {
  const int place_bits = std::max(1, core.disparity_bits);
  const Resources delay = lut_memory(1 << place_bits, kDisparityBits) + adder(place_bits);
  Resources check = delay + selector(kDisparityBits);
  if (core.config.left_table) check += shift_register(core.geometry.radius + core.geometry.half, kValidBit);
  if (core.config.lr_tolerance)
    check += delay + absolute_difference(kDisparityBits) + selector(kDisparityBits);
  add("left-right check", core.config.rows, core.config.rows * check, items);
}

// Contract 1.5 and section 2, "Matcher": the first three disparities of a word wait for the fourth; words
// wait in the queue. With several rows, the words of all rows are complete in the same cycle. Each whole word
// waits until the queue takes it; the queue takes one word per cycle. A delay (contract 7.11) is that of the
// disparities before they are packed: those of all rows, and a bit that says that they are there.
void add_results(const Core& core, Items& items) {
  const int rows = core.config.rows;
  if (const int delay = core.config.result_delay_cycles; delay > 0)
    add("result delay", rows, shift_register(delay, rows * kDisparityBits + kValidBit), items);
  const Resources packers = rows == 1 ? registers(kWordBits - kDisparityBits)
                                      : rows * registers(kWordBits) + multiplexer(rows, kWordBits);
  add("result packer", rows, packers, items);
  const int words = core.config.result_fifo_words;
  add("result queue", 1, kResultControl + (words == 1 ? registers(kWordBits) : memory(words, kWordBits)),
      items);
}

// Control, the registers of the frame, and the multiplexers and arbiters of the banks: a port for each table
// (joint tables: for both), for each lane, for the results and for the host. Each port reaches one or two
// banks, the host all.
void add_control(const Core& core, Items& items) {
  const CoreConfig& config = core.config;
  add("matcher control", 1, kMatcherControl, items);
  if (config.filter) add("slot positions", 1, kSlotPosition, items);
  add("frame registers", 1, kFrameRegisters, items);
  const int tables = config.joint_tables ? core.tables() / 2 : core.tables();
  const int ports = (tables + 2) * config.lanes + 2;
  add("bank multiplexers", ports, ports * kMultiplexer, items);
}

double percent(std::int64_t part, std::int64_t whole) {
  return 100 * static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::int64_t Item::lut_equivalents() const { return std::max(all.luts, all.flip_flops); }

std::vector<Item> items(const CoreConfig& config) {
  const Core core(checked(config));
  Items found;
  add_lanes(core, found);
  add_filter(core, found);
  add_census(core, found);
  add_row_buffers(core, found);
  add_modules(core, found);
  add_scores(core, found);
  if (config.lr_tolerance) add_select_min_chain(core, found);  // only the check needs it
  add_select_min_tree(core, found);
  add_left_right_check(core, found);
  add_results(core, found);
  add_control(core, found);
  return found;
}

bool Area::fits() const {
  return slices_percent <= 100 && block_rams_percent <= 100 && multipliers_percent <= 100;
}

Area total(const std::vector<Item>& items, const Device& device) {
  Area area;
  Resources all;
  for (const Item& item : items) all += item.all;
  area.lut_equivalents = std::max(all.luts, all.flip_flops);
  area.slices = ceil_of(area.lut_equivalents, 2);
  area.slices_percent = percent(area.slices, device.slices);
  area.luts = all.luts;
  area.flip_flops = all.flip_flops;
  area.block_rams = all.block_rams;
  area.block_rams_percent = percent(area.block_rams, device.block_rams);
  area.multipliers = all.multipliers;
  area.multipliers_percent = percent(area.multipliers, device.multipliers);
  return area;
}

const Device* smallest_device(const Area& area) {
  for (const Device& device : kDevices) {
    if (area.slices <= device.slices && area.block_rams <= device.block_rams &&
        area.multipliers <= device.multipliers)
      return &device;
  }
  return nullptr;
}

}  // namespace stereotlm::area

#include "tests/support/random_board.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <numeric>
#include <utility>

namespace stereotlm::test {

std::uint64_t SplitMix64::next() {
  state_ += 0x9E3779B97F4A7C15U;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

int SplitMix64::between(int low, int high) {
  const auto count = static_cast<std::uint64_t>(high - low) + 1;
  return low + static_cast<int>(next() % count);
}

bool SplitMix64::chance(int percent) { return between(1, 100) <= percent; }

int SplitMix64::mostly_small(int low, int small, int high) {
  return chance(75) ? between(low, small) : between(low, high);
}

namespace {

constexpr int kLeastWeight = -32768;
constexpr int kMostWeight = 32767;

// Moves random weights within their range until they sum to 0.
void balance(std::vector<int>& weights, SplitMix64& random) {
  std::int64_t sum = std::accumulate(weights.begin(), weights.end(), std::int64_t{0});
  while (sum != 0) {
    int& weight = weights[static_cast<std::size_t>(random.between(0, static_cast<int>(weights.size()) - 1))];
    const std::int64_t balanced = std::clamp<std::int64_t>(weight - sum, kLeastWeight, kMostWeight);
    sum += balanced - weight;
    weight = static_cast<int>(balanced);
  }
}

ReferenceKernel random_kernel(SplitMix64& random) {
  ReferenceKernel kernel;
  kernel.size = 2 * random.mostly_small(1, 3, 15) + 1;
  const bool extreme = random.chance(25);
  const int most = extreme ? 0 : random.mostly_small(1, 40, 2000);
  std::int64_t magnitude = 0;
  for (int place = 0; place < kernel.size * kernel.size; ++place) {
    if (extreme) {
      kernel.weights.push_back(random.chance(50) ? kMostWeight : kLeastWeight);
    } else {
      kernel.weights.push_back(random.chance(20) ? 0 : random.between(-most, most));
    }
  }
  balance(kernel.weights, random);
  for (const int weight : kernel.weights) magnitude += std::abs(weight);

  if (random.chance(25)) {
    kernel.shift = random.between(0, 31);
  } else {  // near the shift at which the response just fits into a byte
    while (kernel.shift < 28 && magnitude >> kernel.shift > 2) ++kernel.shift;
    kernel.shift = std::max(0, kernel.shift - random.between(0, 3));
  }
  return kernel;
}

std::uint32_t valid_entry(int column, int row) {
  return 0x8000'0000U | static_cast<std::uint32_t>(row) << 16U | static_cast<std::uint32_t>(column);
}

// Entries with bit 31 clear may hold anything in the named bits.
std::uint32_t invalid_entry(SplitMix64& random) {
  if (random.chance(50)) return 0;
  const auto row = static_cast<std::uint32_t>(random.between(0, 0x7FF));
  const auto column = static_cast<std::uint32_t>(random.between(0, 0x7FF));
  return row << 16U | column;
}

enum class Holes { kNone, kScattered, kBlock, kBorder, kEverywhere };

std::vector<std::uint32_t> random_table(const RandomBoard& board, SplitMix64& random) {
  const int width = board.width;
  const int height = board.height;
  const bool identity = random.chance(30);
  const bool wild = random.chance(30);  // any source pixel; otherwise one close by
  const int reach = random.between(0, 3);

  Holes holes = Holes::kNone;
  const int draw = random.between(1, 100);
  if (draw > 25) holes = Holes::kScattered;
  if (draw > 50) holes = Holes::kBlock;
  if (draw > 73) holes = Holes::kBorder;
  if (draw > 96) holes = Holes::kEverywhere;
  const int scattered_percent = random.mostly_small(1, 20, 95);
  const int first_column = random.between(0, width - 1);
  const int last_column = random.between(first_column, width - 1);
  const int first_row = random.between(0, height - 1);
  const int last_row = random.between(first_row, height - 1);
  const int border = random.mostly_small(1, 3, 10);

  std::vector<std::uint32_t> entries;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      bool hole = holes == Holes::kEverywhere;
      if (holes == Holes::kScattered) hole = random.chance(scattered_percent);
      if (holes == Holes::kBlock) {
        hole = column >= first_column && column <= last_column && row >= first_row && row <= last_row;
      }
      if (holes == Holes::kBorder) {
        hole = column < border || column >= width - border || row < border || row >= height - border;
      }
      int source_column = column;
      int source_row = row;
      if (!identity && wild) {
        source_column = random.between(0, width - 1);
        source_row = random.between(0, height - 1);
      } else if (!identity) {
        source_column = std::clamp(column + random.between(-reach, reach), 0, width - 1);
        source_row = std::clamp(row + random.between(-reach, reach), 0, height - 1);
      }
      entries.push_back(hole ? invalid_entry(random) : valid_entry(source_column, source_row));
    }
  }
  return entries;
}

enum class Texture { kNoise, kConstant, kGradient, kPeriodic, kExtremes };

// A picture of the given size with one kind of texture.
std::vector<std::uint8_t> random_texture(int width, int height, SplitMix64& random) {
  const auto texture = static_cast<Texture>(random.between(0, 4));
  const int base = random.between(0, 255);
  const int column_step = random.between(-9, 9);
  const int row_step = random.between(-9, 9);
  const int period = random.between(1, 8);
  const bool gradient_wraps = random.chance(50);
  std::vector<std::uint8_t> pixels;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      int value = base;
      switch (texture) {
        case Texture::kNoise:
          value = random.between(0, 255);
          break;
        case Texture::kConstant:
          break;
        case Texture::kGradient:
          value = base + column_step * column + row_step * row;
          value = gradient_wraps ? value & 0xFF : std::clamp(value, 0, 255);
          break;
        case Texture::kPeriodic:
          value = (base + 37 * (column % period) + row_step * row) & 0xFF;
          break;
        case Texture::kExtremes:
          value = random.chance(50) ? 255 : 0;
          break;
      }
      pixels.push_back(static_cast<std::uint8_t>(value));
    }
  }
  return pixels;
}

std::vector<std::uint8_t> cut_out(const std::vector<std::uint8_t>& scene, int scene_width, int first_column,
                                  int width, int height) {
  std::vector<std::uint8_t> pixels;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const auto place = static_cast<std::size_t>(row) * static_cast<std::size_t>(scene_width) +
                         static_cast<std::size_t>(first_column + column);
      pixels.push_back(scene[place]);
    }
  }
  return pixels;
}

// Two views of one scene, a constant disparity apart, with or without noise; or two unrelated pictures.
PicturePair random_pair(const RandomBoard& board, SplitMix64& random) {
  PicturePair pair;
  if (random.chance(30)) {
    pair.left = random_texture(board.width, board.height, random);
    pair.right = random_texture(board.width, board.height, random);
    return pair;
  }
  const int shift = random.between(0, std::min(board.disparities, board.width) - 1);
  const int scene_width = board.width + shift;
  const std::vector<std::uint8_t> scene = random_texture(scene_width, board.height, random);
  pair.left = cut_out(scene, scene_width, 0, board.width, board.height);
  pair.right = cut_out(scene, scene_width, shift, board.width, board.height);
  if (random.chance(40)) {
    const int noise = random.between(1, 12);
    for (std::uint8_t& pixel : pair.right) {
      pixel = static_cast<std::uint8_t>(std::clamp(pixel + random.between(-noise, noise), 0, 255));
    }
  }
  return pair;
}

PlainBank random_bank(SplitMix64& random) {
  PlainBank bank;
  bank.kind = static_cast<PlainBankKind>(random.between(0, 2));
  if (bank.kind == PlainBankKind::kSyncBurst) bank.turnaround_cycles = random.mostly_small(1, 3, 16);
  return bank;
}

void draw_banks(RandomBoard& board, SplitMix64& random) {
  const int count = random.between(1, 10);
  const bool all_alike = random.chance(40);
  for (int bank = 0; bank < count; ++bank) {
    board.banks.push_back(all_alike && bank > 0 ? board.banks.front() : random_bank(random));
  }
}

// Draws from a random selection of the banks, so that a board with many banks may still share few.
class BankDraw {
 public:
  BankDraw(const RandomBoard& board, SplitMix64& random) : random_(random) {
    for (std::size_t bank = 0; bank < board.banks.size(); ++bank) free_.push_back(static_cast<int>(bank));
    for (std::size_t place = free_.size(); place > 1; --place) {
      std::swap(free_[place - 1],
                free_[static_cast<std::size_t>(random.between(0, static_cast<int>(place) - 1))]);
    }
    spread_ = random.chance(40);
    if (!spread_) free_.resize(static_cast<std::size_t>(random.between(1, static_cast<int>(free_.size()))));
  }
  // Spread: the banks in turn, as few buffers to a bank as can be. Otherwise any of the selection.
  int bank() {
    const int place = spread_ ? drawn_++ % static_cast<int>(free_.size())
                              : random_.between(0, static_cast<int>(free_.size()) - 1);
    return free_[static_cast<std::size_t>(place)];
  }
  std::vector<PlainBuffer> banks(int count) {
    std::vector<PlainBuffer> list(static_cast<std::size_t>(count));
    for (PlainBuffer& entry : list) entry = bank();
    return list;
  }

 private:
  SplitMix64& random_;
  std::vector<int> free_;
  bool spread_ = false;
  int drawn_ = 0;
};

void draw_allocation(RandomBoard& board, SplitMix64& random) {
  BankDraw draw(board, random);
  const int image_entries = random.between(1, 3);
  const int disparity_entries = random.between(1, 3);
  board.left_image = draw.banks(image_entries);
  board.right_image = draw.banks(image_entries);
  board.disparity = draw.banks(disparity_entries);
  if (random.chance(75)) board.left_lut = draw.bank();
  if (random.chance(75)) board.right_lut = draw.bank();
}

void draw_priority(RandomBoard& board, SplitMix64& random) {
  for (std::size_t port = 0; port < kPlainPortCount; ++port)
    board.priority[port] = static_cast<PlainPort>(port);
  for (int place = static_cast<int>(kPlainPortCount) - 1; place > 0; --place) {
    std::swap(board.priority[static_cast<std::size_t>(place)],
              board.priority[static_cast<std::size_t>(random.between(0, place))]);
  }
}

// The generator of one knob.
SplitMix64 random_of(const RandomBoard& board, std::uint64_t knob) {
  return SplitMix64(SplitMix64(board.seed).next() + knob);
}

// Sometimes makes the image very wide and at most 5 rows high, or very high and at most 8 columns wide.
// Windows and disparities stay small, because the references compute every pixel one by one.
void draw_large_image(RandomBoard& board, SplitMix64 random) {
  if (board.left_lut || board.right_lut || !random.chance(50)) return;
  const bool is_wide = random.chance(50);
  board.width = 4 * (is_wide ? random.between(513, 2048) : random.between(1, 2));
  board.height = is_wide ? random.between(1, 5) : random.between(2049, 8192);
  board.window = std::min(board.window, 5);
  board.disparities = std::min(board.disparities, 8);
  board.frames = 1;
  board.pictures = {random_pair(board, random)};
}

void draw_units(RandomBoard& board, SplitMix64 random) {
  if (!random.chance(60)) return;
  const int passes = random.mostly_small(1, 4, 16);
  const int fewest = (board.disparities + passes - 1) / passes;
  board.units = random.between(fewest, std::min(board.disparities, 2 * fewest));
}

void draw_rows(RandomBoard& board, SplitMix64 random) {
  if (board.fetch == PlainFetch::kLineBuffer || !random.chance(60)) return;
  board.rows = random.mostly_small(1, 5, 16);
  board.result_fifo_words = std::max(board.result_fifo_words, board.rows);
}

void draw_joint_tables(RandomBoard& board, SplitMix64 random) {
  const bool is_small = board.width <= 128 && board.height <= 64;  // any displacement fits
  if (!is_small || !random.chance(50)) return;
  board.joint_tables = true;
  if (!board.left_lut) board.left_lut = random.between(0, static_cast<int>(board.banks.size()) - 1);
  board.right_lut = board.left_lut;
  for (auto* table : {&board.left_table, &board.right_table}) {
    if (!*table) *table = random_table(board, random);
  }
}

// In few boards all banks, in most some.
void draw_qdr_banks(RandomBoard& board, SplitMix64 random) {
  const int percent = random.chance(20) ? 100 : random.between(0, 60);
  for (PlainBank& bank : board.banks) {
    if (random.chance(percent)) bank = {PlainBankKind::kQdr, 0};
  }
}

void draw_cost(RandomBoard& board, SplitMix64 random) {
  board.cost.kind = static_cast<ReferenceCost::Kind>(random.between(0, 3));
  if (board.cost.kind == ReferenceCost::Kind::kCensus) board.cost.census_size = 2 * random.between(1, 3) + 1;
}

void draw_result_delay(RandomBoard& board, SplitMix64 random) {
  if (random.chance(50)) board.result_delay_cycles = random.mostly_small(1, 20, 64);
}

PlainSdram random_sdram(SplitMix64& random) {
  PlainSdram sdram;
  sdram.cas_latency = random.mostly_small(1, 3, 8);
  sdram.row_words = 16 << random.mostly_small(0, 4, 12);
  sdram.internal_banks = 1 << random.between(0, 3);
  sdram.activate_cycles = random.mostly_small(0, 4, 63);
  sdram.precharge_cycles = random.mostly_small(0, 4, 63);
  sdram.refresh_interval_cycles = 0;
  if (random.chance(30)) return sdram;
  sdram.refresh_cycles = random.mostly_small(1, 12, 255);
  const int openings = 2 * (sdram.activate_cycles + sdram.precharge_cycles);
  const int least = std::max({64, openings + sdram.refresh_cycles, sdram.refresh_cycles + 1});
  sdram.refresh_interval_cycles = least + random.mostly_small(0, 200, 2000);
  return sdram;
}

// In few boards all banks, in most some.
void draw_sdram_banks(RandomBoard& board, SplitMix64 random) {
  const int percent = random.chance(20) ? 100 : random.between(0, 60);
  for (PlainBank& bank : board.banks) {
    if (random.chance(percent)) bank = {PlainBankKind::kSdram, 0, random_sdram(random)};
  }
}

// Puts the rows of a buffer in turn over its bank and others of the same read latency.
void stripe(const RandomBoard& board, PlainBuffer& buffer, SplitMix64& random) {
  const auto latency_of = [&](int bank) {
    return plain_read_latency(board.banks[static_cast<std::size_t>(bank)]);
  };
  const int latency = latency_of(buffer.banks.front());
  std::vector<int> banks;
  for (int bank = 0; bank < static_cast<int>(board.banks.size()); ++bank) {
    if (latency_of(bank) == latency)
      banks.insert(banks.begin() + random.between(0, static_cast<int>(banks.size())), bank);
  }
  if (banks.size() < 2) return;
  banks.resize(static_cast<std::size_t>(random.between(2, std::min(16, static_cast<int>(banks.size())))));
  buffer.banks = banks;
}

void draw_stripes(RandomBoard& board, SplitMix64 random) {
  if (!random.chance(70)) return;
  for (int more = random.between(0, 8); more > 0; --more) {
    const int last = static_cast<int>(board.banks.size()) - 1;
    board.banks.push_back(board.banks[static_cast<std::size_t>(random.between(0, last))]);
  }
  for (auto* list : {&board.left_image, &board.right_image, &board.disparity}) {
    for (PlainBuffer& buffer : *list) {
      if (random.chance(60)) stripe(board, buffer, random);
    }
  }
  for (auto* table : {&board.left_lut, &board.right_lut}) {
    if (*table && random.chance(60)) stripe(board, **table, random);
  }
  if (board.joint_tables) board.right_lut = board.left_lut;
}

void draw_lanes(RandomBoard& board, SplitMix64 random) {
  if (board.fetch == PlainFetch::kLineBuffer || !random.chance(70)) return;
  board.lanes = random.mostly_small(1, 5, 16);
  board.lanes = std::min(board.lanes, board.window + board.rows - 1);
}

void draw_energy(RandomBoard& board, SplitMix64 random) {
  board.clock_mhz = {random.between(1'000, 200'000), 1'000};
  for (PlainBank& bank : board.banks) {
    if (random.chance(50)) continue;
    bank.energy = {random.mostly_small(0, 300'000, 10'000'000), random.mostly_small(0, 9'000, 1'000'000)};
    if (bank.kind != PlainBankKind::kSdram) continue;
    bank.energy->row_pj = random.between(0, 1'000'000);
    bank.energy->refresh_pj = random.between(0, 1'000'000);
  }
}

void draw_knobs(RandomBoard& board, const RandomKnobs& knobs) {
  if (knobs.large_images) draw_large_image(board, random_of(board, 1));
  if (knobs.units) draw_units(board, random_of(board, 2));
  if (knobs.rows) draw_rows(board, random_of(board, 3));
  if (knobs.joint_tables) draw_joint_tables(board, random_of(board, 4));
  if (knobs.word_cache) board.word_cache = random_of(board, 5).chance(50);
  if (knobs.qdr) draw_qdr_banks(board, random_of(board, 6));
  if (knobs.cost) draw_cost(board, random_of(board, 7));
  if (knobs.sdram) draw_sdram_banks(board, random_of(board, 8));
  if (knobs.stripes) draw_stripes(board, random_of(board, 9));
  if (knobs.lanes) draw_lanes(board, random_of(board, 10));
  if (knobs.energy) draw_energy(board, random_of(board, 11));
  if (knobs.result_delay) draw_result_delay(board, random_of(board, 12));
}

}  // namespace

std::uint64_t random_boards(std::uint64_t without_it) {
  const char* const asked = std::getenv("STEREOTLM_RANDOM_BOARDS");
  return asked != nullptr ? std::stoull(asked) : without_it;
}

RandomBoard make_random_board(std::uint64_t seed, const RandomKnobs& knobs,
                              const std::function<void(RandomBoard&)>& fix) {
  SplitMix64 random(seed);
  RandomBoard board;
  board.seed = seed;
  board.width = 4 * random.mostly_small(1, 10, 16);
  board.height = random.mostly_small(1, 20, 40);
  board.window = 2 * random.mostly_small(1, 3, 15) + 1;
  board.disparities = random.mostly_small(1, 24, 254);
  if (random.chance(60)) board.filter = random_kernel(random);
  board.fetch = random.chance(60) ? PlainFetch::kColumn : PlainFetch::kLineBuffer;
  if (random.chance(80)) board.lr_tolerance = random.mostly_small(0, 2, 253);

  board.arbitration = static_cast<PlainArbitration>(random.between(0, 2));
  draw_priority(board, random);
  board.lane_fifo_slots = random.mostly_small(1, 8, 64);
  board.result_fifo_words = random.mostly_small(1, 4, 64);
  board.pipeline_latency_cycles = random.mostly_small(0, 8, 40);
  draw_banks(board, random);
  draw_allocation(board, random);
  if (fix) fix(board);

  if (board.left_lut) board.left_table = random_table(board, random);
  if (board.right_lut) board.right_table = random_table(board, random);
  board.frames = random.between(1, 4);
  const int pairs = random.between(1, board.frames);
  for (int pair = 0; pair < pairs; ++pair) board.pictures.push_back(random_pair(board, random));

  draw_knobs(board, knobs);
  return board;
}

PlainCycleInput cycle_input(const RandomBoard& board) {
  PlainCycleInput input = board;
  input.filter_half = board.filter ? (board.filter->size - 1) / 2 : 0;
  input.cost_half = half_of(board.cost);
  return input;
}

ReferenceInput reference_input(const RandomBoard& board, int frame) {
  const PicturePair& pair = board.pictures_of_frame(frame);
  ReferenceInput input;
  input.width = board.width;
  input.height = board.height;
  input.left = pair.left;
  input.right = pair.right;
  input.left_table = board.left_table;
  input.right_table = board.right_table;
  input.filter = board.filter;
  input.window = board.window;
  input.disparities = board.disparities;
  input.lr_tolerance = board.lr_tolerance;
  input.cost = board.cost;
  return input;
}

}  // namespace stereotlm::test

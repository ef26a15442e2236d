#include "platform/figures/search_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "models/fpga/frame_geometry.h"
#include "models/fpga/placement.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

using Count = std::uint64_t;

// What a bank has to do for a strip: the reads of its slots, and the words of results that leave meanwhile.
struct Work {
  Count reads = 0;
  Count words = 0;     // of results
  Count openings = 0;  // of rows of sdram
};

// Rows of a buffer that a port accesses column by column, every `step`-th of them: of each row word `begin`
// first, word `end` - 1 last, each of them `repeats` times.
struct ColumnAccess {
  int first_row;
  int rows;
  int step;
  Count begin;
  Count end;
  Count repeats;
};

// The openings of rows that these accesses need in a bank, whoever else accesses it: a port that goes from
// one row of an internal bank to another finds the second one closed. A row in which another buffer ends
// does not count, because the other one may have opened it.
Count openings_of(const fpga::Placement& buffer, std::size_t bank, const memory::SdramTiming& timing,
                  const ColumnAccess& access, int height) {
  const auto row_words = static_cast<Count>(timing.row_words);
  constexpr Count kNone = UINT64_MAX;
  std::vector<Count> words;  // that are accessed next
  Count shared = kNone;
  for (int row = access.first_row; row < access.first_row + access.rows; row += access.step) {
    if (!fpga::is_row_of_image(row, height)) continue;
    const auto place = static_cast<Count>(row);
    const fpga::Placement::Word word = buffer.word(place, access.begin);
    if (word.bank != bank) continue;
    words.push_back(word.word);
    const Count first = buffer.word(place % buffer.parts().size(), 0).word;
    if (first % row_words != 0) shared = first / row_words;
  }
  std::array<Count, memory::kInternalBanksRule.max> open;
  open.fill(kNone);
  Count openings = 0;
  const auto pass = [&](Count times) {
    for (const Count word : words) {
      const Count row = word / row_words;
      Count& its = open[row % static_cast<Count>(timing.internal_banks)];
      if (its != row && its != kNone && row != shared) openings += times;
      its = row;
    }
  };
  for (Count at = access.begin; at < access.end && words.size() > 1;) {
    Count same = access.end - at;  // words to the end of a row
    for (const Count word : words) same = std::min(same, row_words - word % row_words);
    pass(1);
    if (same * access.repeats > 1) pass(same * access.repeats - 1);
    for (Count& word : words) word += same;
    at += same;
  }
  return openings;
}

// One way to count the cycles that a bank needs.
struct Limit {
  std::vector<double> cycles;  // [strip]
  double before = 0;  // the most of them that may lie before the slots of a span of strips, but at the start
  double after = 0;   // the most of them that may lie behind the slots of a span of strips
};

class Frame {
 public:
  Frame(const BoardConfig& board, const FrameAccesses& accesses, Count frame)
      : board_(board),
        accesses_(accesses),
        core_(core_config(board)),
        geometry_(core_),
        placements_(placements_of(core_, buffer_bases(board).of_frame(frame))),
        banks_(ssram_configs(board)) {}

  Count least_cycles() const;

 private:
  using Works = std::vector<std::vector<Work>>;  // [bank][strip]

  bool uses(std::size_t group, std::size_t bank) const {
    return group < fpga::kCoreGroupCount && has_group(core_, group) &&
           (placements_[group].banks() >> bank & 1U) != 0;
  }
  void add_reads(std::size_t group, int strip, Works& works) const;
  void add_writes(int strip, Works& works) const;
  Works works() const;
  double turnaround_a_batch(std::size_t bank, double readers) const;
  std::vector<Limit> limits() const;

  const BoardConfig& board_;
  const FrameAccesses& accesses_;
  fpga::CoreConfig core_;
  fpga::FrameGeometry geometry_;
  fpga::Placements placements_;
  std::vector<memory::SsramBankConfig> banks_;
};

void Frame::add_reads(std::size_t group, int strip, Works& works) const {
  const fpga::Placement& buffer = placements_[group];
  const bool is_table = fpga::kPortGroups[group].stage == fpga::PortStage::kLutReader;
  const std::vector<Count>& of_table = accesses_.pixels_of_row[index_of(fpga::kPortGroups[group].side)];
  const bool is_regular = is_table || of_table.empty();
  if (!is_regular && buffer.parts().size() > 1) return;  // the rows of the pixels are not known
  const bool keeps_word = !is_table && core_.pixel_cache == fpga::PixelCache::kWord;
  const Count columns = geometry_.columns_per_strip();
  const int first = geometry_.first_row_of(strip);
  const int end = std::min(first + geometry_.slots_per_column, geometry_.height);
  const auto place = static_cast<std::size_t>(strip);
  for (int row = std::max(first, 0); row < end; ++row) {
    const std::uint32_t base = buffer.parts()[static_cast<std::size_t>(row) % buffer.parts().size()];
    works[fpga::registers::bank_of(base)][place].reads += !is_regular
                                                              ? of_table[static_cast<std::size_t>(row)]
                                                          : keeps_word ? columns / 4
                                                                       : columns;
  }
  const Count repeats = is_table || keeps_word ? 1 : 4;
  for (const std::uint32_t base : buffer.parts()) {
    const std::size_t bank = fpga::registers::bank_of(base);
    if (!banks_[bank].sdram || !is_regular) continue;
    // Lane 0 only: another lane may share its openings, in another strip too.
    works[bank][place].openings += openings_of(
        buffer, bank, *banks_[bank].sdram,
        {first, geometry_.slots_per_column, core_.lanes, 0, buffer.row_words(), repeats}, geometry_.height);
  }
}

void Frame::add_writes(int strip, Works& works) const {
  const fpga::Placement& buffer = placements_[fpga::kResultGroup];
  const Count columns = geometry_.columns_per_strip();
  const Count begin = static_cast<Count>(strip) * columns;
  const auto place = static_cast<std::size_t>(strip);
  for (auto of = std::max<std::int64_t>(geometry_.result_strip(begin), 0);
       of <= geometry_.result_strip(begin + columns - 1); ++of) {
    const Count first_column = geometry_.result_delay_columns + static_cast<Count>(of) * columns;
    const auto words_by = [&](Count column) {
      return column > first_column ? std::min(column - first_column, columns) / 4 : 0;
    };
    const Count first_word = words_by(begin);
    const Count end_word = words_by(begin + columns);
    const int first_row = static_cast<int>(of) * geometry_.rows;
    const int end_row = std::min(first_row + geometry_.rows, geometry_.height);
    for (int row = first_row; row < end_row; ++row) {
      const std::uint32_t base = buffer.parts()[static_cast<std::size_t>(row) % buffer.parts().size()];
      works[fpga::registers::bank_of(base)][place].words += end_word - first_word;
    }
    for (const std::uint32_t base : buffer.parts()) {
      const std::size_t bank = fpga::registers::bank_of(base);
      if (banks_[bank].sdram)
        works[bank][place].openings +=
            openings_of(buffer, bank, *banks_[bank].sdram,
                        {first_row, geometry_.rows, 1, first_word, end_word, 1}, geometry_.height);
    }
  }
}

Frame::Works Frame::works() const {
  // Strips inside the image do the same work as those so many rows before them.
  int period = 1;
  int margin = 0;  // rows behind the first row of the sdram of each buffer
  for (std::size_t group = 0; group < fpga::kCoreGroupCount; ++group) {
    if (!has_group(core_, group)) continue;
    const fpga::Placement& buffer = placements_[group];
    const auto parts = static_cast<int>(buffer.parts().size());
    const auto words = static_cast<int>(buffer.row_words());
    period = std::lcm(period, parts);
    for (const std::uint32_t base : buffer.parts()) {
      const auto& sdram = banks_[fpga::registers::bank_of(base)].sdram;
      if (!sdram || period > geometry_.height) continue;
      const int turn = sdram->row_words * sdram->internal_banks;
      period = std::lcm(period, parts * (turn / std::gcd(turn, words)));
      margin = std::max(margin, parts * (sdram->row_words / words + 2));
    }
  }
  const bool is_regular = accesses_.pixels_of_row[0].empty() && accesses_.pixels_of_row[1].empty();
  const int strips = period / std::gcd(period, geometry_.rows);
  const auto is_inside = [&](std::int64_t first_row, int rows) {
    return first_row >= margin && first_row + rows <= geometry_.height;
  };
  const auto repeats = [&](int strip) {
    const Count begin = static_cast<Count>(strip) * geometry_.columns_per_strip();
    return is_inside(geometry_.first_row_of(strip), geometry_.slots_per_column) &&
           is_inside(geometry_.first_row_at(true, begin), geometry_.rows) &&
           is_inside(geometry_.first_row_at(true, begin + geometry_.columns_per_strip() - 1), geometry_.rows);
  };
  Works works(banks_.size(), std::vector<Work>(static_cast<std::size_t>(geometry_.strips)));
  for (int strip = 0; strip < geometry_.strips; ++strip) {
    if (is_regular && strip >= strips && repeats(strip) && repeats(strip - strips)) {
      const auto place = static_cast<std::size_t>(strip);
      for (auto& of_bank : works) of_bank[place] = of_bank[place - static_cast<std::size_t>(strips)];
      continue;
    }
    for (std::size_t group = 0; group < fpga::kResultGroup; ++group) {
      if (has_group(core_, group)) add_reads(group, strip, works);
    }
    add_writes(strip, works);
  }
  return works;
}

// The cycles that a bank with turnaround loses for each batch of results, on average.
double Frame::turnaround_a_batch(std::size_t bank, double readers) const {
  const double turnaround = banks_[bank].turnaround_cycles;
  if (turnaround == 0 || !uses(fpga::kResultGroup, bank) ||
      placements_[fpga::kResultGroup].parts().size() > 1)
    return 0;
  const memory::ArbiterConfig& arbiter = board_.fpga.arbiter;
  const bool is_fixed = arbiter.policy == "fixed_priority";
  const auto results = std::find(arbiter.priority.begin(), arbiter.priority.end(), fpga::kResultGroup);
  const bool is_first =
      std::none_of(arbiter.priority.begin(), results, [&](std::size_t group) { return uses(group, bank); });
  const double rows = geometry_.rows;
  bool reads_all_columns = false;
  for (std::size_t group = 0; group < fpga::kResultGroup; ++group) {
    const fpga::PortGroup& its = fpga::kPortGroups[group];
    if (uses(group, bank) && placements_[group].parts().size() == 1 &&
        (its.stage == fpga::PortStage::kLutReader || accesses_.pixels_of_row[index_of(its.side)].empty()))
      reads_all_columns = true;
  }
  // Without reads the queue runs full, and the matcher goes on with the columns that the lanes hold.
  const int columns = core_.lane_fifo_slots + (core_.pixel_cache == fpga::PixelCache::kWord ? 3 : 0);
  const int batches_of_columns = columns / 4 + 1;
  const double of_long_runs =
      reads_all_columns ? 2 * turnaround * rows / (core_.result_fifo_words + rows * batches_of_columns) : 0;
  const bool takes_turns = arbiter.policy == "round_robin" || arbiter.policy == "age";
  if (!takes_turns && !(is_fixed && is_first)) return of_long_runs;
  // From one batch to the next the matcher takes 4 columns. Meanwhile a word waits for so many reads.
  const double between = 4.0 * geometry_.cycles_per_column * geometry_.folds - rows;
  const double reads_a_run = is_fixed ? 0 : readers;
  double least = std::min(2 * turnaround, 2 * turnaround * between / (reads_a_run + 2 * turnaround));
  for (int batches = 2; batches <= 64; ++batches) {
    double lost = INFINITY;
    for (int runs = 1; runs <= batches; ++runs)
      lost = std::min(
          lost, std::max(2 * turnaround * runs, (batches - 1) * between - reads_a_run * runs + turnaround));
    least = std::min(least, lost / batches);
  }
  return std::max(least, of_long_runs);
}

std::vector<Limit> Frame::limits() const {
  std::vector<Limit> limits;
  const Works all = works();
  for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
    const memory::SsramBankConfig& config = banks_[bank];
    const bool writes = uses(fpga::kResultGroup, bank) && !memory::has_separate_ports(config.kind);
    double ports = 0;  // that read
    for (std::size_t group = 0; group < fpga::kResultGroup; ++group)
      ports += uses(group, bank) ? core_.lanes : 0;
    // A bank of one port has an access a slot at most, as the port itself.
    if (ports == 0 || (ports == 1 && !writes && !config.sdram)) continue;
    const double a_batch = turnaround_a_batch(bank, ports);
    const double cut = a_batch > 0 ? 3.0 * config.turnaround_cycles + geometry_.rows + a_batch : 0;
    const double ahead = ports * (core_.lane_fifo_slots - 1);
    const double queued = writes ? core_.result_fifo_words : 0;
    // `opening`: cycles of the opening of a row. `refresh`: cycles of a refresh and of what follows from it.
    const auto add = [&](double opening, double refresh) {
      const auto interval = config.sdram ? config.sdram->refresh_interval_cycles : std::nullopt;
      const double factor = interval ? *interval / (*interval - refresh) : 1;
      const double refreshes = interval ? 3 * std::abs(refresh) : 0;
      Limit limit;
      for (const Work& work : all[bank]) {
        const double batches = work.reads > 0 ? static_cast<double>(work.words) / geometry_.rows : 0;
        limit.cycles.push_back(factor * (static_cast<double>(work.reads + (writes ? work.words : 0)) +
                                         a_batch * batches + opening * static_cast<double>(work.openings)));
      }
      limit.before = factor * (ahead * (1 + opening) + ports * opening + cut + refreshes);
      limit.after = factor * (queued * (1 + opening) + opening + cut + refreshes);
      limits.push_back(limit);
    };
    if (!config.sdram) {
      add(0, 0);
      continue;
    }
    const double activate = config.sdram->activate_cycles;
    const double precharge = config.sdram->precharge_cycles;
    const double refresh = config.sdram->refresh_cycles;
    add(activate + precharge, refresh - precharge * (config.sdram->internal_banks - 1));
    add(activate, refresh + precharge);
    add(0, refresh + precharge + activate);
  }
  return limits;
}

Count Frame::least_cycles() const {
  const std::vector<Limit> limits = this->limits();
  const double folds = geometry_.folds;
  const double consuming =
      static_cast<double>(geometry_.columns_per_strip()) * geometry_.cycles_per_column * folds;
  double consumed = -1;  // the cycle in which the last slot of the strips so far is consumed, at least
  std::vector<double> accessed(limits.size(), -1);  // and in which its last access is granted, by limit
  for (std::size_t strip = 0; strip < static_cast<std::size_t>(geometry_.strips); ++strip) {
    double next = consumed + consuming;
    for (std::size_t i = 0; i < limits.size(); ++i) {
      if (strip > 0) accessed[i] = std::max(accessed[i], consumed - limits[i].before);
      accessed[i] += limits[i].cycles[strip];
      next = std::max(next, accessed[i] + folds - limits[i].after);
    }
    consumed = next;
  }
  const double last = consumed + static_cast<double>(geometry_.drain_cycles) * folds + geometry_.last_rows;
  return static_cast<Count>(std::floor(last)) + 1 + static_cast<Count>(core_.pipeline_latency_cycles);
}

}  // namespace

std::uint64_t least_frame_cycles(const BoardConfig& board, const FrameAccesses& accesses,
                                 std::uint64_t frame) {
  Count least = Frame(board, accesses, frame).least_cycles();
  for (const ResourceBound& bound : frame_bounds(board, accesses, frame))
    least = std::max(least, bound.cycles);
  return least;
}

}  // namespace stereotlm::platform

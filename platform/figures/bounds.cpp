#include "platform/figures/bounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "models/capture/camera_timing.h"
#include "models/clock.h"
#include "models/fpga/access_pattern.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/placement.h"
#include "models/fpga/register_map.h"
#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/search_bounds.h"

namespace stereotlm::platform {
namespace {

// The fewest bursts of at most `burst_words` words that hold `words` words.
std::uint64_t bursts_of(std::uint64_t words, int burst_words) {
  const auto burst = static_cast<std::uint64_t>(burst_words);
  return (words + burst - 1) / burst;
}

// The clocks that the PCI bus needs for `words` words in bursts of at most `burst_words`: one per word (64
// bits: one per two words), and `clocks_a_burst` more per burst.
std::uint64_t pci_clocks_of(const BoardConfig& board, std::uint64_t words, int burst_words,
                            int clocks_a_burst) {
  const auto words_a_clock = static_cast<std::uint64_t>(board.pci.width_bits / 32);
  return (words + words_a_clock - 1) / words_a_clock +
         bursts_of(words, burst_words) * static_cast<std::uint64_t>(clocks_a_burst);
}

double camera_rate(const BoardConfig& board) {
  if (board.cameras.trigger == CameraTrigger::kFreeRunning) return board.cameras.frame_rate_hz;
  const capture::CameraTiming timing({board.image.width, board.image.height, board.cameras.frame_rate_hz,
                                      capture::CameraTrigger::kOnDemand});
  return 1e12 / static_cast<double>(timing.last_pixel_ps());
}

// Equal transfers over the PCI bus that a frame needs.
struct Transfers {
  std::uint64_t words = 0;
  int burst_words = 1;     // the most in a burst
  int clocks_a_burst = 0;  // address, wait and idle clocks
  int times = 1;           // in a frame
};

// The transfers of a frame, by master: bridge, left and right capture board.
std::vector<std::vector<Transfers>> pci_transfers(const BoardConfig& board, bool whole_pictures) {
  const auto picture =
      static_cast<std::uint64_t>(board.image.width) * static_cast<std::uint64_t>(board.image.height) / 4;
  const bool to_host = board.capture.destination == CaptureDestination::kHostMemory;
  constexpr int kAddressAndIdle = 2;
  const int memory_burst = kAddressAndIdle + board.pci.memory_wait_clocks;
  const int bridge_burst = kAddressAndIdle + board.pci.bridge_wait_clocks;
  const int moved = to_host ? 3 : 1;
  std::vector<std::vector<Transfers>> masters = {
      // Each transfer of the DMA: a descriptor of 4 words, then a picture or result.
      {{4, 4, memory_burst, moved}, {picture, board.bridge.dma_burst_words, memory_burst, moved}}};
  const Transfers captured =
      to_host
          ? Transfers{picture, board.capture.fifo_words, memory_burst}
          : Transfers{picture, std::min(board.capture.fifo_words, board.bridge.posted_words), bridge_burst};
  if (whole_pictures) masters.insert(masters.end(), 2, {captured});
  return masters;
}

struct PciDemand {
  std::uint64_t clocks = 0;
  std::uint64_t bursts = 0;  // of the master with the most
};

// `latency_timer`: a burst ends with the word of this clock; nullopt: no burst is cut.
PciDemand pci_demand(const BoardConfig& board, bool whole_pictures, std::optional<int> latency_timer) {
  const int words_a_clock = board.pci.width_bits / 32;
  PciDemand demand;
  for (const std::vector<Transfers>& master : pci_transfers(board, whole_pictures)) {
    std::uint64_t bursts = 0;
    for (const Transfers& transfers : master) {
      int most = transfers.burst_words;
      if (latency_timer)
        most = std::min(most, words_a_clock * std::max(1, *latency_timer + 2 - transfers.clocks_a_burst));
      const auto times = static_cast<std::uint64_t>(transfers.times);
      demand.clocks += times * pci_clocks_of(board, transfers.words, most, transfers.clocks_a_burst);
      bursts += times * bursts_of(transfers.words, most);
    }
    demand.bursts = std::max(demand.bursts, bursts);
  }
  return demand;
}

// The frame rate that the PCI bus allows. Either the bus serves every transfer of the load when it is due. Or
// the load has a backlog and always requests: then it gets a burst between any two bursts of another master,
// and the latency timer cuts all bursts. A frame may see both, so the smaller number of clocks counts. Of
// each case one transfer of the load may lie partly outside the frame: its clocks are subtracted.
double pci_rate(const BoardConfig& board, bool whole_pictures) {
  const double hz = board.pci.clock_mhz * 1e6;
  const double alone = static_cast<double>(pci_demand(board, whole_pictures, std::nullopt).clocks);
  if (!board.pci.load || board.pci.load->first_us > 0) return hz / alone;
  const PciLoadConfig& load = *board.pci.load;
  const int timer = board.pci.latency_timer_clocks;
  const double wait_clocks = std::floor(load.access_us * board.pci.clock_mhz);
  const double data_clocks = std::ceil(load.burst_words / (board.pci.width_bits / 32.0));
  constexpr double kAddressAndIdle = 2;
  const double pieces = std::ceil(data_clocks / std::max(timer - wait_clocks, 1.0));
  const double cut_transfer = pieces * (kAddressAndIdle + wait_clocks) + data_clocks;
  const PciDemand cut = pci_demand(board, whole_pictures, timer);
  const double backlog =
      static_cast<double>(cut.clocks) + static_cast<double>(cut.bursts) * cut_transfer / pieces;
  const double transfer = kAddressAndIdle + wait_clocks + data_clocks;
  const double share = transfer / (load.interval_us * board.pci.clock_mhz);
  const double clocks = share < 1 ? std::min(alone / (1 - share), backlog) - transfer / (1 - share) : backlog;
  return hz / std::max(alone, clocks - cut_transfer);
}

double bridge_rate(const BoardConfig& board, bool whole_pictures) {
  const auto picture =
      static_cast<std::uint64_t>(board.image.width) * static_cast<std::uint64_t>(board.image.height) / 4;
  // The local bus moves the result and the pair, by DMA or straight from the capture boards. Two words of a
  // burst are at least one local clock apart. The last word of a burst and the first one of the next are four
  // local clocks apart: idle, address, decode and word.
  const bool to_host = board.capture.destination == CaptureDestination::kHostMemory;
  const double pictures = to_host || whole_pictures ? 3 : 1;
  const double words = pictures * static_cast<double>(picture);
  const double bursts = pictures * static_cast<double>(bursts_of(picture, board.bridge.dma_burst_words));
  const double local_us = 1 / board.bridge.local_clock_mhz;
  const double fpga_us = 1 / board.fpga.clock_mhz;
  return 1e6 / std::max(words * fpga_us * local_bus_cycles_a_word(board, board.bridge.local_clock_mhz),
                        bursts * 4 * local_us + (words - bursts) * std::max(local_us, fpga_us));
}

// Calls visit(bank, part, reads) for each part of the buffer of a port, with the reads of its rows in a
// frame.
template <typename Visit>
void for_each_part(const fpga::Placement& buffer, const FrameAccesses& accesses, memory::Port port,
                   const Visit& visit) {
  const std::size_t parts = buffer.parts().size();
  for (std::size_t part = 0; part < parts; ++part) {
    std::uint64_t reads = parts == 1 ? accesses.reads[port] : 0;
    if (parts > 1) {
      const std::vector<std::uint64_t>& of_row = accesses.reads_of_row[port];
      for (std::size_t row = part; row < of_row.size(); row += parts) reads += of_row[row];
    }
    visit(fpga::registers::bank_of(buffer.parts()[part]), part, reads);
  }
}

// Accesses to the banks.
class BankAccesses {
 public:
  explicit BankAccesses(const BoardConfig& board)
      : board_(board), reads_(board.banks.size()), writes_(board.banks.size()) {}

  // Adds those of the core in a frame with these buffers.
  void add_core(const fpga::Placements& placements, const FrameAccesses& accesses) {
    const fpga::CorePorts ports(core_config(board_));
    for (std::size_t port = 0; port < accesses.reads.size(); ++port) {
      for_each_part(
          placements[ports.group_of(port)], accesses, port,
          [&](std::size_t bank, std::size_t /*part*/, std::uint64_t count) { reads_[bank] += count; });
    }
    add_writes(placements[fpga::kResultGroup]);
  }
  // Adds one for each word of a buffer of 8-bit values.
  void add_reads(const fpga::Placement& buffer) { add_words(buffer, reads_); }
  void add_writes(const fpga::Placement& buffer) { add_words(buffer, writes_); }
  std::vector<BankStatistics> statistics() const {
    std::vector<BankStatistics> all(reads_.size());
    for (std::size_t bank = 0; bank < all.size(); ++bank) {
      all[bank].reads = reads_[bank];
      all[bank].writes = writes_[bank];
    }
    return all;
  }
  // The fewest cycles that a bank needs: with separate ports for the larger of the reads and the writes.
  std::uint64_t cycles(std::size_t bank) const {
    return memory::has_separate_ports(board_.banks[bank].kind) ? std::max(reads_[bank], writes_[bank])
                                                               : reads_[bank] + writes_[bank];
  }

 private:
  void add_words(const fpga::Placement& buffer, std::vector<std::uint64_t>& counts) {
    for (std::size_t part = 0; part < buffer.parts().size(); ++part)
      counts[fpga::registers::bank_of(buffer.parts()[part])] +=
          buffer.rows_of_part(part, board_.image.height) * buffer.row_words();
  }

  const BoardConfig& board_;
  std::vector<std::uint64_t> reads_;
  std::vector<std::uint64_t> writes_;
};

// The accesses of the core and of the host to each bank for frames 0..frames-1.
BankAccesses all_accesses(const BoardConfig& board, const FrameAccesses& accesses, bool pairs_are_written,
                          std::uint64_t frames) {
  const fpga::CoreConfig core = core_config(board);
  const fpga::BufferBases buffers = buffer_bases(board);
  BankAccesses all(board);
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const fpga::Placements placements = placements_of(core, buffers.of_frame(frame));
    all.add_core(placements, accesses);
    for (const fpga::Side side : fpga::kSides) {
      if (pairs_are_written) all.add_writes(placements[fpga::pixel_group(side)]);
    }
    all.add_reads(placements[fpga::kResultGroup]);  // by the host
  }
  return all;
}

// The rate at which frames and what the host moves for them take turns. The guide of the searches proves the
// parts (sw/explore/BOUNDS.md, "The computer").
double rate_of_turns(const BoardConfig& board, const FrameAccesses& accesses) {
  const bool to_host = board.capture.destination == CaptureDestination::kHostMemory;
  const fpga::CoreConfig core = core_config(board);
  const fpga::BufferBases buffers = buffer_bases(board);
  const AllocationConfig& allocation = board.allocation;
  const std::size_t inputs = allocation.left_image.size();
  const std::size_t outputs = allocation.disparity.size();
  const double cycle_ps = 1e6 / board.fpga.clock_mhz;
  const bool is_free_running = board.cameras.trigger == CameraTrigger::kFreeRunning;
  const capture::CameraTiming camera(
      {board.image.width, board.image.height, board.cameras.frame_rate_hz, board.cameras.trigger});
  const double capture = static_cast<double>(camera.last_pixel_ps()) / cycle_ps;  // all in cycles
  const double picture = board.image.width / 4.0 * board.image.height *
                         local_bus_cycles_a_word(board, board.bridge.local_clock_mhz);
  const double core_hz = board.fpga.clock_mhz * 1e6;
  // From one capture into a buffer to the next one, so many cycles or more later: periods of `tick_hz`.
  const double tick_hz = is_free_running ? board.cameras.frame_rate_hz : core_hz;
  const auto between_captures = [&](double cycles) {
    return is_free_running ? std::ceil(cycles * tick_hz / core_hz - 1e-9) : cycles;
  };
  const std::uint64_t turn = allocation_period_frames(board);
  double one_after_another = 0;
  double of_copies = 0;
  double of_captures = 0;  // periods
  double of_outputs = 0;
  for (std::uint64_t frame = 0; frame < turn; ++frame) {
    const auto alone = static_cast<double>(least_frame_cycles(board, accesses, frame));
    // With two buffers the frame before has those of the next one.
    const fpga::Placements next = placements_of(core, buffers.of_frame(frame + 1));
    BankAccesses of_frame(board);
    of_frame.add_core(placements_of(core, buffers.of_frame(frame)), accesses);
    for (const fpga::Side side : fpga::kSides) {
      if (inputs == 2) of_frame.add_writes(next[fpga::pixel_group(side)]);
    }
    if (outputs == 2) of_frame.add_reads(next[fpga::kResultGroup]);
    double longest = alone;
    for (std::size_t bank = 0; bank < board.banks.size(); ++bank)
      longest = std::max(longest, static_cast<double>(of_frame.cycles(bank)));
    const double moved = (inputs == 1 ? 2 * picture : 0) + (outputs == 1 ? picture : 0);
    one_after_another += std::max(longest + moved, inputs == 1 && !to_host ? alone + capture : 0);
    of_copies += 2 * picture + alone;
    of_captures += between_captures(capture + alone);
    of_outputs += alone + picture;
  }
  const auto frames = static_cast<double>(turn);
  const double buffers_in = static_cast<double>(inputs);
  const double longest = std::max(
      {one_after_another, to_host ? of_copies / buffers_in : 0, of_outputs / static_cast<double>(outputs)});
  const double of_cameras = to_host ? board.capture.host_frames / between_captures(capture + 2 * picture)
                                    : frames * buffers_in / of_captures;
  return std::min(core_hz * frames / longest, tick_hz * of_cameras);
}

// The rows of a bank of sdram that accesses to these groups touch: bit r for row r.
std::size_t touched_rows(const BoardConfig& board, const FrameAccesses& accesses,
                         const fpga::Placements& placements, std::size_t bank,
                         const std::vector<std::size_t>& groups) {
  const auto row_words = static_cast<std::uint32_t>(board.banks[bank].sdram->row_words);
  std::vector<bool> touched;
  const auto touch = [&](std::size_t first, std::size_t last) {  // words
    if (touched.size() <= last / row_words) touched.resize(last / row_words + 1);
    for (std::size_t row = first / row_words; row <= last / row_words; ++row) touched[row] = true;
  };
  for (const std::size_t group : groups) {
    const auto& rows = accesses.touched[group];
    const fpga::Placement& buffer = placements[group];
    for (std::size_t part = 0; rows.empty() && part < buffer.parts().size(); ++part) {
      const std::size_t first = fpga::registers::first_word_of(buffer.parts()[part]);
      const std::size_t words = buffer.rows_of_part(part, board.image.height) * buffer.row_words();
      if (fpga::registers::bank_of(buffer.parts()[part]) != bank || words == 0) continue;
      touch(first, first + words - 1);
    }
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (buffer.word(row, 0).bank != bank) continue;
      for (std::size_t word = 0; word < rows[row].size(); ++word) {
        if (rows[row][word]) touch(buffer.word(row, word).word, buffer.word(row, word).word);
      }
    }
  }
  return static_cast<std::size_t>(std::count(touched.begin(), touched.end(), true));
}

// The cycles of so many accesses to so many rows of sdram: see ResourceBound.
std::uint64_t sdram_cycles(const memory::SdramTiming& timing, std::uint64_t accesses, std::uint64_t rows) {
  const auto banks = static_cast<std::uint64_t>(timing.internal_banks);
  const std::uint64_t unrefreshed =
      accesses + static_cast<std::uint64_t>(timing.activate_cycles) * (rows > banks ? rows - banks : 0);
  if (!timing.refresh_interval_cycles) return unrefreshed;
  const auto interval = static_cast<std::uint64_t>(*timing.refresh_interval_cycles);
  std::uint64_t cycles = unrefreshed;
  for (std::uint64_t before = 0; before != cycles;) {
    before = cycles;
    const std::uint64_t refreshes = cycles / interval;
    cycles =
        unrefreshed + static_cast<std::uint64_t>(timing.refresh_cycles) * (refreshes > 1 ? refreshes - 1 : 0);
  }
  return cycles;
}

}  // namespace

// A grant is at an edge of the FPGA. The next word's clock is the first one of the local bus at or after it.
// The word requests as that clock ends; the next edge of the FPGA grants it at the earliest. Between bursts
// are three more clocks: idle, address, decode. A later grant never advances the grants behind it. So moving
// the edges of the local bus earlier, until one of them coincides with a grant of the burst, delays no grant.
// It is enough to try the phases with such an edge. Edges are rounded to whole ps: at each of the two waits
// of a word, an edge that is late by less than 1 ps may be in time.
double local_bus_cycles_a_word(const BoardConfig& board, double local_clock_mhz) {
  constexpr int kMostWords = 32;          // longer bursts: pieces of so many words, and a last one
  constexpr double kRoundedPs = 2 + 0.1;  // 0.1: for the rounding of the numbers here
  constexpr double kSamePs = 1e-6;        // times that differ by less are equal
  const double local_ps = 1e6 / local_clock_mhz;
  const double fpga_ps = 1e6 / board.fpga.clock_mhz;
  const int words = std::min(board.bridge.dma_burst_words, kMostWords);
  double piece = INFINITY;   // cycles of `words` words within a burst
  double a_word = INFINITY;  // of bursts of 1..words words, with the clocks between bursts
  for (double aligned = 0; aligned <= piece; ++aligned) {  // the edge of the FPGA
    const double phase_ps = std::fmod(aligned * fpga_ps, local_ps);
    if (aligned > 0 && std::min(phase_ps, local_ps - phase_ps) < kSamePs) break;  // the phases repeat
    const auto next_grant = [&](double grant, int clocks) {
      const double word_clock = std::ceil((grant * fpga_ps - phase_ps - kSamePs) / local_ps);
      return std::ceil((phase_ps + (word_clock + clocks) * local_ps - kRoundedPs) / fpga_ps);
    };
    double grant = 0;
    for (int word = 1; word <= words; ++word) {
      a_word = std::min(a_word, next_grant(grant, 4) / word);
      grant = next_grant(grant, 1);
    }
    piece = std::min(piece, grant);
  }
  return words < board.bridge.dma_burst_words ? std::min(a_word, piece / words) : a_word;
}

std::string local_bus_remark(const BoardConfig& board) {
  const double local = board.bridge.local_clock_mhz;
  const double fpga = board.fpga.clock_mhz;
  const double in_step = clock_in_step(board);
  const auto megabytes = [&](double mhz) { return 4 * fpga / local_bus_cycles_a_word(board, mhz); };
  const bool is_clock = in_step >= 1 && Clock(in_step).divides(Clock(fpga));
  if (!is_clock || megabytes(in_step) < 1.05 * megabytes(local)) return "";
  return fmt::format(
      "local bus: its words wait for edges of two clocks. Beside an FPGA clock of {} MHz\n"
      "  it moves at most {:.1f} MB/s at {} MHz, and {:.1f} MB/s at {} MHz\n",
      fpga, megabytes(local), local, megabytes(in_step), in_step);
}

fpga::AccessPatterns access_patterns(const BoardConfig& board, const Tables* tables) {
  const fpga::AccessPattern pattern(fpga::FrameGeometry(core_config(board)), board.fpga.pixel_cache);
  fpga::AccessPatterns patterns{pattern, pattern};
  if (tables != nullptr && tables->left) patterns[0].set_entries(tables->left->entries.data());
  if (tables != nullptr && tables->right) patterns[1].set_entries(tables->right->entries.data());
  return patterns;
}

FrameAccesses identity_accesses(const BoardConfig& board) {
  const fpga::CoreConfig core = core_config(board);
  const fpga::CorePorts ports(core);
  const fpga::FrameGeometry geometry(core);
  const auto height = static_cast<std::size_t>(core.height);
  const std::uint64_t columns = geometry.columns_per_strip();
  const std::uint64_t pixels =
      core.pixel_cache == fpga::PixelCache::kWord ? columns / kernels::kPixelsPerWord : columns;
  std::vector<std::vector<std::uint64_t>> slots(ports.lanes(),
                                                std::vector<std::uint64_t>(height));  // a column
  for (int strip = 0; strip < geometry.strips; ++strip) {
    for (int k = 0; k < geometry.slots_per_column; ++k) {
      const int row = geometry.first_row_of(strip) + k;
      if (geometry.is_inside(row))
        ++slots[static_cast<std::size_t>(k % core.lanes)][static_cast<std::size_t>(row)];
    }
  }
  FrameAccesses accesses;
  accesses.reads.resize(ports.core_size());
  if (!core.stripes.empty() || std::any_of(board.banks.begin(), board.banks.end(),
                                           [](const BankConfig& bank) { return bank.sdram.has_value(); }))
    accesses.reads_of_row.resize(ports.core_size(), std::vector<std::uint64_t>(height));
  for (memory::Port port = 0; port < ports.result(); ++port) {
    if (!has_group(core, ports.group_of(port))) continue;
    const std::uint64_t a_slot = ports.group(port).stage == fpga::PortStage::kLutReader ? columns : pixels;
    for (std::size_t row = 0; row < height; ++row) {
      const std::uint64_t reads = slots[ports.lane_of(port)][row] * a_slot;
      accesses.reads[port] += reads;
      if (!accesses.reads_of_row.empty()) accesses.reads_of_row[port][row] = reads;
    }
  }
  return accesses;
}

FrameAccesses frame_accesses(const BoardConfig& board, const fpga::AccessPatterns& patterns) {
  FrameAccesses accesses = identity_accesses(board);
  const fpga::CoreConfig core = core_config(board);
  const fpga::CorePorts ports(core);
  for (const fpga::Side side : fpga::kSides) {
    const fpga::AccessPattern& pattern = patterns[fpga::index_of(side)];
    if (pattern.is_identity()) continue;
    for (std::size_t lane = 0; lane < ports.lanes(); ++lane) {
      const memory::Port port = ports.pixel(side, lane);
      accesses.reads[port] = pattern.pixel_accesses(static_cast<int>(lane));
      if (!accesses.reads_of_row.empty())
        accesses.reads_of_row[port] = pattern.pixel_accesses_of_rows()[lane];
    }
    auto& touched = accesses.touched[fpga::pixel_group(side)];
    if (!accesses.reads_of_row.empty())
      touched.assign(static_cast<std::size_t>(core.height),
                     std::vector<bool>(static_cast<std::size_t>(core.width) / kernels::kPixelsPerWord));
    for (int row = 0; row < core.height; ++row) {
      accesses.pixels_of_row[index_of(side)].push_back(pattern.pixel_accesses_of_slots(row));
      for (int column = 0; column < core.width && !touched.empty(); ++column) {
        if (!pattern.needs_pixel(column, row)) continue;
        const std::uint32_t entry = pattern.entry(column, row);
        touched[static_cast<std::size_t>(kernels::entry_row(entry))]
               [static_cast<std::size_t>(kernels::entry_column(entry)) / kernels::kPixelsPerWord] = true;
      }
    }
  }
  return accesses;
}

std::vector<BankStatistics> accesses_of_banks(const BoardConfig& board, const FrameAccesses& accesses,
                                              std::uint64_t frames, bool with_host) {
  if (with_host) return all_accesses(board, accesses, true, frames).statistics();
  const fpga::CoreConfig core = core_config(board);
  const fpga::BufferBases buffers = buffer_bases(board);
  BankAccesses all(board);
  for (std::uint64_t frame = 0; frame < frames; ++frame)
    all.add_core(placements_of(core, buffers.of_frame(frame)), accesses);
  return all.statistics();
}

std::vector<ResourceBound> frame_bounds(const BoardConfig& board, const FrameAccesses& accesses,
                                        std::uint64_t frame) {
  const fpga::CoreConfig core = core_config(board);
  const fpga::FrameGeometry geometry(core);
  const fpga::CorePorts ports(core);
  const fpga::Placements placements = placements_of(core, buffer_bases(board).of_frame(frame));
  const std::vector<memory::SsramBankConfig> banks = ssram_configs(board);
  const auto latency = [&](memory::Port port) {
    const std::size_t bank = fpga::registers::bank_of(placements[ports.group_of(port)].parts().front());
    return static_cast<std::uint64_t>(memory::read_latency_cycles(banks[bank]));
  };
  const auto pipeline = static_cast<std::uint64_t>(board.fpga.pipeline_latency_cycles);
  const auto folds = static_cast<std::uint64_t>(geometry.folds);
  const auto places = static_cast<std::uint64_t>(board.fpga.lane_fifo_slots);
  const std::uint64_t after_last_slot =
      geometry.drain_cycles * folds +
      static_cast<std::uint64_t>(geometry.result_delay_cycles + geometry.last_rows) + pipeline;

  struct BankDemand {
    std::uint64_t reads = 0;
    std::uint64_t writes = 0;
    std::uint64_t after_last_read = UINT64_MAX;  // least number of cycles from a read to the matcher
    std::set<std::size_t> groups;                // port groups that read
  };
  std::map<std::size_t, BankDemand> demands;
  const auto read = [&](memory::Port port, std::uint64_t cycles_to_matcher) {
    const std::size_t group = ports.group_of(port);
    for_each_part(placements[group], accesses, port,
                  [&](std::size_t bank, std::size_t /*part*/, std::uint64_t reads) {
                    if (reads == 0) return;
                    BankDemand& demand = demands[bank];
                    demand.after_last_read = std::min(demand.after_last_read, cycles_to_matcher);
                    demand.reads += reads;
                    demand.groups.insert(group);
                  });
  };
  const auto port_bound = [&ports](memory::Port port, std::uint64_t cycles) {
    return ResourceBound{"port " + ports.name(port), cycles};
  };
  std::uint64_t first_slot = 0;
  std::vector<ResourceBound> bounds;  // first those of the LUT ports
  std::vector<ResourceBound> pixels;
  for (const fpga::Side side : fpga::kSides) {
    const bool has_table = fpga::has_table(core, side);
    for (std::size_t lane = 0; lane < ports.lanes(); ++lane) {
      const memory::Port lut = ports.lut(side, lane);
      const memory::Port pixel = ports.pixel(side, lane);
      const memory::Port table_port = core.joint_tables ? ports.lut(fpga::Side::kLeft, lane) : lut;
      const std::uint64_t in_lane = latency(pixel) + (has_table ? latency(table_port) : 0);
      first_slot = std::max(first_slot, in_lane);
      read(lut, in_lane);
      read(pixel, latency(pixel));
      const std::uint64_t slots = geometry.consumed_slots(static_cast<int>(lane), geometry.consume_cycles);
      const std::uint64_t slot_a_cycle = slots + pipeline;
      const std::uint64_t taking =
          std::max(slot_a_cycle, ((slots - 1) / places + 1) * (in_lane + folds) + after_last_slot);
      if (accesses.reads[lut] > 0) bounds.push_back(port_bound(lut, taking));
      pixels.push_back(port_bound(pixel, has_table ? slot_a_cycle : taking));
    }
  }
  const fpga::Placement& results = placements[fpga::kResultGroup];
  for (std::size_t part = 0; part < results.parts().size(); ++part) {
    const std::uint64_t words = results.rows_of_part(part, geometry.height) * results.row_words();
    if (words != 0) demands[fpga::registers::bank_of(results.parts()[part])].writes += words;
  }

  bounds.insert(bounds.end(), pixels.begin(), pixels.end());
  bounds.push_back(port_bound(ports.result(), geometry.result_words + pipeline));
  for (const auto& [bank, demand] : demands) {
    const BankConfig& config = board.banks[bank];
    // With separate ports the writes are made beside the reads.
    const bool is_beside = memory::has_separate_ports(config.kind);
    std::uint64_t reading = demand.reads;
    std::uint64_t accessing = (is_beside ? 0 : demand.reads) + demand.writes;
    if (config.sdram) {
      std::vector<std::size_t> groups(demand.groups.begin(), demand.groups.end());
      reading = sdram_cycles(*config.sdram, reading, touched_rows(board, accesses, placements, bank, groups));
      if (demand.writes > 0) groups.push_back(fpga::kResultGroup);
      accessing =
          sdram_cycles(*config.sdram, accessing, touched_rows(board, accesses, placements, bank, groups));
    }
    std::uint64_t cycles = accessing + pipeline;
    // The last read is granted after `reading` - 1 other cycles at the earliest. The matcher begins to work
    // on its slot at least `after_last_read` cycles later.
    if (demand.reads > 0)
      cycles = std::max(cycles, reading - 1 + demand.after_last_read + folds + after_last_slot);
    bounds.push_back({resource_of_bank(config.name), cycles});
  }
  bounds.push_back({"matcher", first_slot + geometry.consume_cycles * folds + after_last_slot});
  return bounds;
}

std::vector<RateBound> computer_bounds(const BoardConfig& board, const FrameAccesses& accesses,
                                       bool whole_pictures, std::optional<std::uint64_t> some_frames) {
  const std::uint64_t frames = some_frames.value_or(allocation_period_frames(board));
  const bool to_host = board.capture.destination == CaptureDestination::kHostMemory;
  const BankAccesses of_banks = all_accesses(board, accesses, to_host || whole_pictures, frames);
  std::vector<RateBound> bounds = {{"camera", camera_rate(board)},
                                   {"pci", pci_rate(board, whole_pictures)},
                                   {"bridge", bridge_rate(board, whole_pictures)}};
  for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
    const std::uint64_t cycles = of_banks.cycles(bank);
    if (cycles == 0) continue;
    bounds.push_back(
        {resource_of_bank(board.banks[bank].name),
         board.fpga.clock_mhz * 1e6 * static_cast<double>(frames) / static_cast<double>(cycles)});
  }
  return bounds;
}

void add_system_bound(const BoardConfig& board, const FrameAccesses& accesses, bool whole_pictures,
                      Bound& bound, std::optional<std::uint64_t> frames) {
  bound.system = bound.core;
  bound.system_limited_by = bound.core_limited_by;
  for (const RateBound& part : computer_bounds(board, accesses, whole_pictures, frames)) {
    if (part.frames_per_second >= *bound.system) continue;
    bound.system = part.frames_per_second;
    bound.system_limited_by = part.resource;
  }
}

std::vector<ResourceBound> turn_bounds(const BoardConfig& board, const FrameAccesses& accesses) {
  std::vector<ResourceBound> turn(allocation_period_frames(board));
  for (std::size_t frame = 0; frame < turn.size(); ++frame) {
    for (const ResourceBound& bound : frame_bounds(board, accesses, frame)) {
      if (bound.cycles >= turn[frame].cycles) turn[frame] = bound;
    }
  }
  return turn;
}

Bound core_bound(const BoardConfig& board, const FrameAccesses& accesses,
                 std::optional<std::uint64_t> some_frames) {
  const std::vector<ResourceBound> turn = turn_bounds(board, accesses);
  const std::uint64_t frames = some_frames.value_or(turn.size());
  std::uint64_t total = 0;
  ResourceBound slowest;
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const ResourceBound& its = turn[frame % turn.size()];
    total += its.cycles;
    if (its.cycles > slowest.cycles) slowest = its;
  }
  Bound bound;
  bound.core = board.fpga.clock_mhz * 1e6 * static_cast<double>(frames) / static_cast<double>(total);
  bound.core_limited_by = slowest.resource;
  return bound;
}

double steady_bound(const BoardConfig& board, const FrameAccesses& accesses) {
  Bound bound = core_bound(board, accesses);
  add_system_bound(board, accesses, true, bound);
  return std::min(*bound.system, rate_of_turns(board, accesses));
}

}  // namespace stereotlm::platform

#include "platform/figures/proven_rate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "models/capture/camera_timing.h"
#include "models/clock.h"
#include "models/fpga/placement.h"
#include "models/period.h"
#include "platform/config/buffer_layout.h"

// The names are those of contract 7.12.
namespace stereotlm::platform {
namespace {

constexpr double kPsPerSecond = 1e12;

bool goes_to_host(const BoardConfig& board) {
  return board.capture.destination == CaptureDestination::kHostMemory;
}

// What may make a frame of the core longer.
struct FrameWaits {
  bool meets_host = false;              // in a bank
  std::optional<std::uint64_t> cycles;  // at most; nullopt: not known
};

FrameWaits waits_of_frame(const BoardConfig& board, const FrameAccesses& accesses, std::uint64_t frame) {
  const fpga::CoreConfig core = core_config(board);
  const fpga::BufferBases bases = buffer_bases(board);
  const fpga::Placements its = placements_of(core, bases.of_frame(frame));
  const std::size_t banks = board.banks.size();
  std::vector<int> ports(banks);
  for (std::size_t group = 0; group < fpga::kCoreGroupCount; ++group) {
    for (std::size_t bank = 0; bank < banks && has_group(core, group); ++bank) {
      if ((its[group].banks() >> bank & 1U) != 0) ports[bank] += group == fpga::kResultGroup ? 1 : core.lanes;
    }
  }
  std::vector<std::uint64_t> of_host(banks);  // words that it moves beside the frame
  for (const auto* const list : {&bases.left_images, &bases.right_images, &bases.disparities}) {
    for (std::size_t entry = 0; entry < list->size(); ++entry) {
      if (entry == frame % list->size()) continue;
      const fpga::Placement buffer(core.stripes, (*list)[entry], static_cast<std::uint64_t>(core.width) / 4);
      for (std::size_t part = 0; part < buffer.parts().size(); ++part)
        of_host[fpga::registers::bank_of(buffer.parts()[part])] +=
            buffer.rows_of_part(part, core.height) * buffer.row_words();
    }
  }
  const auto of_core = accesses_of_banks(board, accesses, allocation_period_frames(board));
  FrameWaits waits;
  bool has_sdram = false;
  std::uint64_t at_start = 0;  // of the frame
  int most_turnaround = 0;
  std::uint64_t cycles = 0;
  for (std::size_t bank = 0; bank < banks; ++bank) {
    if (ports[bank] == 0) continue;
    const auto turnaround = static_cast<std::uint64_t>(board.banks[bank].turnaround_cycles);
    has_sdram = has_sdram || board.banks[bank].sdram.has_value();
    waits.meets_host = waits.meets_host || of_host[bank] > 0;
    most_turnaround = std::max(most_turnaround, board.banks[bank].turnaround_cycles);
    at_start += turnaround;
    cycles += (1 + 2 * turnaround) *
              (of_host[bank] + (ports[bank] == 1 ? 0 : of_core[bank].reads + of_core[bank].writes));
  }
  if (has_sdram) return waits;
  // Between two frames the driver makes six accesses or more, of three clocks or more.
  const bool has_pause = 18 / board.pci.clock_mhz >= (most_turnaround + 1) / board.fpga.clock_mhz;
  if (!has_pause) cycles += at_start;
  const bool is_always_alike = has_pause && !waits.meets_host && board.fpga.arbiter.policy != "round_robin";
  waits.cycles = is_always_alike ? 0 : cycles;
  return waits;
}

// How long the steps of a computer take, in ps.
struct Times {
  double answer = 0;                // of the driver: from an event to its last access that follows from it
  double strobe = 0;                // from the driver's access to cycle 0 of the frame
  double capture = 0;               // from the beginning of a camera frame
  double copy = 0;                  // of a pair
  double result = 0;                // read back
  std::vector<double> frames = {};  // of the core, of a turn of the lists
};

double picture_words(const BoardConfig& board) { return board.image.width / 4.0 * board.image.height; }

double last_pixel_ps(const BoardConfig& board) {
  return static_cast<double>(capture::CameraTiming({board.image.width, board.image.height,
                                                    board.cameras.frame_rate_hz, board.cameras.trigger})
                                 .last_pixel_ps());
}

// Each step but the frames takes at least so long. Less than a ps is lost to rounding in each.
Times least_times(const BoardConfig& board) {
  const auto transfer = [&](double words) {
    const double bursts = std::ceil(words / board.bridge.dma_burst_words);
    const double pci_clocks =
        words / (board.pci.width_bits / 32.0) + bursts * (2 + board.pci.memory_wait_clocks);
    return std::max({words * 1e6 / board.bridge.local_clock_mhz, words * 1e6 / board.fpga.clock_mhz,
                     pci_clocks * 1e6 / board.pci.clock_mhz}) -
           4;
  };
  Times times;
  times.capture = last_pixel_ps(board) - 4;
  times.copy = 2 * transfer(picture_words(board));
  times.result = transfer(picture_words(board));
  return times;
}

// Each step but the frames takes at most so long; nullopt: not known. `frame_ps`: of the shortest frame.
std::optional<Times> most_times(const BoardConfig& board, bool meets_host, double frame_ps) {
  const bool to_host = goes_to_host(board);
  const double local = 1e6 / board.bridge.local_clock_mhz + 1;  // 1: all edges are rounded to ps
  const double fpga = 1e6 / board.fpga.clock_mhz + 1;
  const double pci = 1e6 / board.pci.clock_mhz + 1;
  const double posted = board.bridge.posted_words;
  const double burst = board.bridge.dma_burst_words;
  const double fifo = board.capture.fifo_words;

  // The local bus.
  double latency = 0;
  double turnaround = 0;
  double of_sdram = 0;
  const std::vector<bool> used = used_banks(board);
  const std::vector<memory::SsramBankConfig> banks = ssram_configs(board);
  for (std::size_t bank = 0; bank < banks.size(); ++bank) {
    if (!used[bank]) continue;
    latency = std::max<double>(latency, memory::read_latency_cycles(banks[bank]));
    turnaround = std::max<double>(turnaround, banks[bank].turnaround_cycles);
    if (const auto& its = banks[bank].sdram)
      of_sdram = std::max<double>(of_sdram, its->cas_latency + 1 + its->activate_cycles +
                                                2 * its->precharge_cycles + its->refresh_cycles);
  }
  double grant = turnaround + of_sdram;
  if (meets_host) {
    const memory::ArbiterConfig& arbiter = board.fpga.arbiter;
    const bool is_fixed = arbiter.policy == "fixed_priority";
    if (of_sdram > 0 || (is_fixed && arbiter.priority.front() != fpga::kHostGroup)) return std::nullopt;
    if (!is_fixed) grant += static_cast<double>(core_ports(board).core_size()) * (1 + turnaround);
  }
  const bool in_step = Clock(board.bridge.local_clock_mhz).divides(Clock(board.fpga.clock_mhz));
  const double ratio = board.bridge.local_clock_mhz / board.fpga.clock_mhz;  // local clocks of a cycle
  const auto up = [](double number) { return std::ceil(number - 1e-9); };    // 1e-9: of the division
  const auto by_requests = [&](double waits) {
    return local * (1 + up((waits + (in_step ? 0 : 1)) * ratio));
  };
  const double later = meets_host || of_sdram > 0 ? grant : 0;  // cycles that a word after the first waits
  const auto words_time = [&](double count) {
    const double by_grants = 2 * local + (1 + grant) * fpga + (count - 1) * (up(2 / ratio) + later) * fpga;
    return std::min(by_requests(grant) + (count - 1) * by_requests(later), by_grants);
  };
  const double posted_word = 3 * local + words_time(1);
  const double dma = 5 * local + latency * fpga + words_time(burst);
  const double drain = dma + (posted + 5) * posted_word + 2 * local + fpga;

  // The PCI bus.
  const double width = board.pci.width_bits / 32.0;
  const double timer = board.pci.latency_timer_clocks;
  const double memory_wait = board.pci.memory_wait_clocks;
  const double capture_wait = to_host ? memory_wait : board.pci.bridge_wait_clocks;
  const double capture = 2 + capture_wait + std::ceil((to_host ? fifo : std::min(fifo, posted)) / width);
  const double bridge = 2 + memory_wait + std::ceil(std::max(burst, 4.0) / width);
  const double driver = 5 + board.pci.bridge_wait_clocks;
  const double load = board.pci.load ? (3 + std::ceil(board.pci.load->burst_words / width)) * pci +
                                           board.pci.load->access_us * 1e6
                                     : 0;
  const double round = (2 * capture + bridge + driver + 1) * pci + load;

  // The words of the captures.
  const double line_ps = kPsPerSecond / (board.cameras.frame_rate_hz * board.image.height * 35 / 32);
  const double rate = 2 * (board.image.width / 4.0) / line_ps;
  const double behind = 2 * (fifo + board.image.width / 4.0);
  const double open = dma / posted_word + 1;
  const double service = std::min(1 / posted_word, posted / (round + dma));
  const double spare = to_host ? service : service - rate;
  if (spare <= 0) return std::nullopt;
  constexpr double kPostedWrites = 4;  // that start the core
  const double posting = (posted + (to_host ? 0 : behind) + kPostedWrites * (open + service * round)) / spare;

  std::size_t pages = 0;  // that arm a capture
  bool is_striped = false;
  for (const auto* const list : {&board.allocation.left_image, &board.allocation.right_image}) {
    std::size_t most = 0;
    for (const BufferBanks& buffer : *list) most = std::max(most, buffer.banks.size());
    pages += most;
    is_striped = is_striped || most > 1;
  }
  Times times;
  times.answer = 2 * ((23 + static_cast<double>(pages)) * round + drain + posting);
  times.strobe = drain;
  const double cut = std::max(1.0, timer - capture_wait) * width;
  const double attempts = 1 + std::ceil(fifo / (is_striped ? std::min(cut, board.image.width / 4.0) : cut));
  times.capture = last_pixel_ps(board) + 4 + attempts * (round + drain);
  if (!to_host) {
    const double service_then = std::min(1 / posted_word, posted / (round + drain + dma));
    times.capture += (posted + behind + (attempts + 1) * open) / service_then;
  }
  const double pieces = std::ceil(std::ceil(burst / width) / std::max(1.0, timer - memory_wait));
  const double channels = to_host ? 2 : 1;
  const double word_of_capture = pci + (to_host ? 0 : posted_word);
  const double free = 1 - rate * word_of_capture - drain / frame_ps;
  if (frame_ps <= 0 || free <= 0) return std::nullopt;
  const auto transfer = [&](double words, double descriptors) {
    const double bursts = std::ceil(words / burst) + descriptors;
    const double turns = (bursts + descriptors) * pieces * channels;
    return (turns * ((2 * (2 + capture_wait) + bridge + driver + 1) * pci + load) + bursts * channels * dma +
            2 * drain + (behind + posted) * word_of_capture) /
           free;
  };
  std::size_t parts = 1;
  for (const BufferBanks& buffer : board.allocation.disparity) parts = std::max(parts, buffer.banks.size());
  times.copy = transfer(2 * picture_words(board), is_striped ? 2.0 * board.image.height : 2);
  times.result = transfer(picture_words(board), static_cast<double>(parts));
  return times;
}

// Times of the steps of one frame, in units of 1 / numerator ps of the camera's rate: ends of its capture,
// copy, frame of the core and read-back.
using Steps = std::array<Wide, 4>;

// The steps of the first frames, if each takes this long. `period`: of the camera; 1: on demand.
std::vector<Steps> take_turns(const BoardConfig& board, const Times& times, Wide units_a_ps, Wide period,
                              std::size_t frames) {
  const auto units = [units_a_ps](double ps) { return static_cast<Wide>(std::max(ps, 0.0)) * units_a_ps; };
  const std::size_t inputs = board.allocation.left_image.size();
  const std::size_t outputs = board.allocation.disparity.size();
  const auto ring = static_cast<std::size_t>(board.capture.host_frames);
  const bool to_host = goes_to_host(board);
  std::vector<Steps> steps(frames);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const auto ended = [&](std::size_t step, std::size_t back) {
      return frame < back ? Wide{0} : steps[frame - back][step];
    };
    auto& [captured, copied, processed, read_back] = steps[frame];
    const Wide armed =
        std::max(ended(0, 1), to_host ? ended(1, ring) : ended(2, inputs)) + units(times.answer);
    captured = (armed + period - 1) / period * period + units(times.capture);
    copied = to_host ? std::max({captured, ended(1, 1), ended(2, inputs)}) + units(times.answer + times.copy)
                     : captured;
    processed = std::max({copied, ended(2, 1), ended(3, outputs)}) +
                units(times.answer + times.strobe + times.frames[frame % times.frames.size()]);
    read_back = std::max(processed, ended(3, 1)) + units(times.answer + times.result);
  }
  return steps;
}

struct Fraction {
  Wide deliveries = 0;
  Wide periods = 1;
  friend bool operator<(const Fraction& a, const Fraction& b) {
    return a.deliveries * b.periods < b.deliveries * a.periods;
  }
};

// The rate of the steps for ever: at least, or at most.
Fraction rate_of(const BoardConfig& board, const std::vector<Steps>& steps, Wide period, bool at_least) {
  const std::size_t turn = allocation_period_frames(board);
  const std::size_t depth =
      std::max({std::size_t{3}, turn, static_cast<std::size_t>(board.capture.host_frames)});
  const std::size_t from = steps.size() / 4 / turn * turn;
  Fraction rate = at_least ? Fraction{0, 1} : Fraction{1, 0};
  for (std::size_t frames = turn; from + frames < steps.size(); frames += turn) {
    Wide least = steps[from + frames][0] - steps[from][0];
    Wide most = least;
    for (std::size_t back = 0; back < depth; ++back) {
      for (std::size_t step = 0; step < Steps().size(); ++step) {
        const Wide passed = steps[from + frames - back][step] - steps[from - back][step];
        least = std::min(least, passed);
        most = std::max(most, passed);
      }
    }
    const Wide periods = at_least ? (most + period - 1) / period : least / period;
    const Fraction its{frames, periods};
    rate = at_least ? std::max(rate, its) : std::min(rate, its);
  }
  return rate;
}

}  // namespace

bool frames_are_apart(const BoardConfig& board, const FrameAccesses& accesses) {
  for (std::uint64_t frame = 0; frame < allocation_period_frames(board); ++frame) {
    const FrameWaits waits = waits_of_frame(board, accesses, frame);
    if (waits.meets_host || waits.cycles != std::uint64_t{0}) return false;
  }
  return true;
}

std::optional<ProvenRate> proven_rate(const BoardConfig& board, const FrameAccesses& accesses,
                                      const std::vector<std::uint64_t>& frame_cycles, double bound) {
  constexpr std::size_t kFrames = 400;
  const std::uint64_t turn = allocation_period_frames(board);
  if (frame_cycles.size() < turn) return std::nullopt;
  const double cycle_ps = 1e6 / board.fpga.clock_mhz;
  const bool is_free_running = board.cameras.trigger == CameraTrigger::kFreeRunning;
  const DecimalNumber hz = decimal_of(board.cameras.frame_rate_hz);
  const Wide units_a_ps = is_free_running ? hz.numerator : 1;
  const Wide period = is_free_running ? Wide{1'000'000'000'000} * hz.denominator : 1;
  const double periods_a_second = is_free_running ? board.cameras.frame_rate_hz : kPsPerSecond;

  Times least = least_times(board);
  std::vector<double> longest;
  bool meets_host = false;
  bool is_known = true;
  for (std::uint64_t frame = 0; frame < turn; ++frame) {
    std::uint64_t shortest = frame_cycles[frame];
    for (std::uint64_t next = frame; next < frame_cycles.size(); next += turn)
      shortest = std::min(shortest, frame_cycles[next]);
    const FrameWaits waits = waits_of_frame(board, accesses, frame);
    meets_host = meets_host || waits.meets_host;
    is_known = is_known && waits.cycles.has_value();
    const std::uint64_t cycles = waits.cycles.value_or(shortest);
    least.frames.push_back(static_cast<double>(shortest - std::min(cycles, shortest)) * cycle_ps - 2);
    longest.push_back(static_cast<double>(shortest + cycles) * cycle_ps + 2);
  }
  ProvenRate proven;
  const Fraction fastest =
      rate_of(board, take_turns(board, least, units_a_ps, period, kFrames), period, false);
  proven.most = bound;
  if (fastest.periods != 0)
    proven.most = std::min(bound, periods_a_second * static_cast<double>(fastest.deliveries) /
                                      static_cast<double>(fastest.periods));
  std::optional<Times> most;
  if (is_known)
    most = most_times(board, meets_host, *std::min_element(least.frames.begin(), least.frames.end()));
  if (!most) return proven;
  most->frames = longest;
  const Fraction slowest =
      rate_of(board, take_turns(board, *most, units_a_ps, period, kFrames), period, true);
  proven.least =
      periods_a_second * static_cast<double>(slowest.deliveries) / static_cast<double>(slowest.periods);
  if (!is_free_running || slowest < fastest || fastest < slowest) return proven;
  const auto deliveries = static_cast<std::uint64_t>(slowest.deliveries);
  const auto camera_frames = static_cast<std::uint64_t>(slowest.periods);
  const std::uint64_t divisor = std::gcd(deliveries, camera_frames);
  proven.exact = proven.most = proven.least;
  proven.deliveries = deliveries / divisor;
  proven.camera_frames = camera_frames / divisor;
  return proven;
}

}  // namespace stereotlm::platform

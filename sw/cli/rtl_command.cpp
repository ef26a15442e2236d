#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "models/binder.h"
#include "models/fpga/register_map.h"
#include "platform/config/board_keys.h"
#include "platform/config/buffer_layout.h"
#include "sw/cli/command.h"
#include "sw/cli/rtl_files.h"
#include "sw/cli/run_options.h"
#include "sw/files/output_folder.h"
#include "sw/runs/simulation/simulation.h"

namespace stereotlm::cli {
namespace {

using platform::BoardConfig;
using Numbers = std::vector<std::uint64_t>;

constexpr const char* kRtlFooter =
    "Written are the core (rtl/), the top level with the parameters of the board (stereo_fpga.v, board.vh),\n"
    "a test bench with the banks (bench.v, ssram_bank.v, bench.cpp, banks/), what run --source preloaded\n"
    "gives (disparity.hex, cycles.hex), a script for Yosys (synthesis.ys), and a Makefile. In DIR `make`\n"
    "builds the bench with Verilator and runs it: it says whether each disparity, and the cycles of each\n"
    "frame, are those of run. It runs the frames of a turn of the board's lists of buffers. Each shows the\n"
    "pair, the first one of several. `make synthesis` prints what the core takes of the FPGA.";

constexpr std::size_t kMostBanks = 63;
const std::vector<std::string> kPolicies = {"fixed_priority", "round_robin", "age"};  // as in bank_arbiter.v

// A key that the RTL does not have with all of its values.
struct Knob {
  const char* key;
  std::vector<std::string> has;  // the values that the RTL has
  const char* reason;            // "the RTL .."
};

// Reports each knob of the board that the RTL does not have.
void check_knobs(const BoardConfig& board, process::Problems& problems) {
  std::string units = "all";
  if (board.matcher.units == board.matcher.disparities) units = fmt::to_string(board.matcher.disparities);
  const std::vector<Knob> knobs = {
      {"fpga.arbitration", kPolicies, "has no other arbiters"},
      {"fpga.tables", {"separate"}, "reads a table for each side"},
      {"fpga.pixel_cache", {"none"}, "keeps no word that it has read"},
      {"fpga.lanes", {"1"}, "has one lane on each side"},
      {"ssram.banks.NAME.kind",
       {"zbt_pipelined", "zbt_flow_through", "sync_burst"},
       "has banks with one port and without rows"},
      {"matcher.fetch", {"column"}, "fetches columns"},
      {"matcher.units", {units}, "has a module for each disparity"},
      {"matcher.rows", {"1"}, "computes one row of results at once"},
      {"matcher.cost", {"sad"}, "adds absolute differences"},
  };
  for (const platform::BoardValue& value : platform::values_of(board)) {
    const std::string text = platform::value_text(value.value);
    const auto add = [&](const std::string& must, const char* reason) {
      problems.add(fmt::format("{} = {}: must be {}: the RTL {}", value.path, text, must, reason));
    };
    if (platform::is_below(value.path, "allocation") && text.find("rows:") != std::string::npos)
      add("a bank for each buffer", "has no stripes");
    const std::string key = platform::schema_path(value.path);
    for (const Knob& knob : knobs) {
      if (knob.key == key && std::count(knob.has.begin(), knob.has.end(), text) == 0)
        add(platform::listed(knob.has), knob.reason);
    }
  }
  if (board.banks.size() > kMostBanks)
    problems.add(fmt::format("ssram.banks = {} banks: must be {} at most: the RTL has no more",
                             board.banks.size(), kMostBanks));
}

// A Verilog constant with these parts, the first one in the lowest bits.
std::string packed(const Numbers& parts, int bits) {
  std::string text;
  for (auto part = parts.rbegin(); part != parts.rend(); ++part)
    text += fmt::format("{}{}'h{:x}", text.empty() ? "" : ", ", bits, *part);
  return "{" + text + "}";
}

// board.vh. `frames`: those of a turn.
std::string parameters(const BoardConfig& board, std::uint64_t frames) {
  const platform::FpgaConfig& fpga = board.fpga;
  const platform::MatcherConfig& matcher = board.matcher;
  std::string text = fmt::format(
      "// The board {}: parameters and straps of stereo_core.v; for the test bench also the words of each\n"
      "// bank, and the bases of each frame of a turn. Written by stereotlm rtl.\n",
      board.name);
  for (std::size_t bank = 0; bank < board.banks.size(); ++bank)
    text += fmt::format("// {:02}: {}\n", bank, platform::bank_text(board.banks[bank].name));
  const auto define = [&](const char* name, const auto& value) {
    text += fmt::format("`define BOARD_{} {}\n", name, value);
  };
  define("WIDTH", board.image.width);
  define("HEIGHT", board.image.height);
  define("WINDOW", matcher.window);
  define("DISPARITIES", matcher.disparities);
  Numbers weights;
  const kernels::FilterKernel filter = matcher.filter.value_or(kernels::FilterKernel{1, {0}, 0});
  for (const int weight : filter.weights) weights.push_back(static_cast<std::uint16_t>(weight));
  define("HALF", filter.half());
  define("SHIFT", filter.shift);
  define("WEIGHTS", packed(weights, 16));
  define("HAS_CHECK", matcher.lr_tolerance ? 1 : 0);
  define("TOLERANCE", matcher.lr_tolerance.value_or(0));
  define("LEFT_TABLE", board.allocation.left_lut ? 1 : 0);
  define("RIGHT_TABLE", board.allocation.right_lut ? 1 : 0);
  define("LANE_FIFO_SLOTS", fpga.lane_fifo_slots);
  define("RESULT_FIFO_WORDS", fpga.result_fifo_words);
  define("RESULT_DELAY_CYCLES", fpga.result_delay_cycles);
  define("PIPELINE_LATENCY_CYCLES", fpga.pipeline_latency_cycles);
  const auto policy = std::find(kPolicies.begin(), kPolicies.end(), fpga.arbiter.policy);
  define("POLICY", fmt::format("2'd{}", policy - kPolicies.begin()));
  define("PRIORITY_LIST", packed({fpga.arbiter.priority.begin(), fpga.arbiter.priority.end()}, 3));
  Numbers words, turnaround, latency_2;
  for (const memory::SsramBankConfig& bank : platform::ssram_configs(board)) {
    words.push_back(static_cast<std::uint64_t>(bank.words));
    turnaround.push_back(static_cast<std::uint64_t>(bank.turnaround_cycles));
    latency_2.push_back(memory::read_latency_cycles(bank) == 2 ? 1 : 0);
  }
  define("BANKS", words.size());
  define("BANK_WORDS", packed(words, 32));
  define("TURNAROUND", packed(turnaround, 5));
  define("LATENCY_2", packed(latency_2, 1));
  Numbers bases;
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const fpga::FrameBases of_frame = platform::buffer_bases(board).of_frame(frame);
    bases.insert(bases.end(), of_frame.begin(), of_frame.end());
  }
  define("FRAMES", frames);
  define("BASES", packed(bases, 32));
  return text;
}

template <typename Word>
std::string hex_lines(const std::vector<Word>& words) {
  std::string text;
  for (const Word word : words) fmt::format_to(std::back_inserter(text), "{:08x}\n", word);
  return text;
}

std::string hex_lines(const kernels::GrayImage& picture) {
  std::string text;
  for (std::size_t pixel = 0; pixel < picture.pixels.size(); ++pixel)
    fmt::format_to(std::back_inserter(text), "{:02x}{}", picture.pixels[pixel ^ 3U],
                   pixel % 4 == 3 ? "\n" : "");
  return text;
}

// For each bank what is in it at first, as $readmemh() reads it.
std::vector<std::string> bank_contents(const BoardConfig& board, const platform::Tables& tables,
                                       const host::StereoPair& pair) {
  std::vector<std::string> contents(board.banks.size());
  const auto put = [&](std::uint32_t base, const std::string& lines) {
    contents[fpga::registers::bank_of(base)] +=
        fmt::format("@{:x}\n{}", fpga::registers::first_word_of(base), lines);
  };
  const fpga::BufferBases bases = platform::buffer_bases(board);
  if (tables.left) put(*bases.left_lut, hex_lines(tables.left->entries));
  if (tables.right) put(*bases.right_lut, hex_lines(tables.right->entries));
  for (const std::uint32_t base : bases.left_images) put(base, hex_lines(pair.left));
  for (const std::uint32_t base : bases.right_images) put(base, hex_lines(pair.right));
  return contents;
}

struct RtlOptions : Options {
  using Options::Options;
  void check_together(process::Problems& problems) override { run.check_together("rtl --out rtl", problems); }

  RunOptions run{this, nullptr, nullptr};
  Option out = Option(this, "--out", "DIR", "The folder to write: created if missing, else empty",
                      {required("the folder to write")});
};

int rtl(const RtlOptions& options) {
  runs::RunInput input = options.run.load();
  process::Problems problems;
  check_knobs(input.board, problems);
  std::optional<files::OutputFolder> folder;
  problems.attempt("", [&] {
    files::OutputContent content;
    content.called = "--out";
    content.kind.is_own = [](const std::filesystem::path& /*file*/) { return false; };
    content.rule = "must be empty: give another folder";
    content.names = {"*", "rtl/", "rtl/*", "banks/", "banks/*"};
    folder.emplace(options.out.text(), content);
  });
  problems.check();
  const host::StereoPair pair = input.pairs->pair(0);
  runs::PairSource pairs("pair", 1, [&pair](std::uint64_t /*index*/) { return pair; });
  const std::uint64_t frames = platform::allocation_period_frames(input.board);
  Binder binder;
  const auto simulation =
      runs::make_simulation(input.board, input.tables, pairs, {false, fpga::Fidelity::kFast, frames}, binder);
  simulation->run([&] {
    if (process::interrupted()) simulation->end_early();
  });
  if (process::interrupted()) return interrupted("nothing is written");
  for (const auto& [name, text] : rtl_files()) folder->add(std::string(name), text);
  folder->add("board.vh", parameters(input.board, frames));
  folder->add("cycles.hex", hex_lines(simulation->statistics().frame_cycles));
  folder->add("disparity.hex", hex_lines(simulation->last().disparity));
  const std::vector<std::string> contents = bank_contents(input.board, input.tables, pair);
  for (std::size_t bank = 0; bank < contents.size(); ++bank)
    folder->add(fmt::format("banks/{:02}.hex", bank), contents[bank]);
  folder->commit();
  process::print(fmt::format("{0}: the core of {1} in Verilog; make -C {0} compares it with run\n",
                             options.out.text(), input.board.name));
  return kDone;
}

}  // namespace

void add_rtl(Commands& commands) {
  add_command(commands, "rtl",
              "Write the core of a board in Verilog, with a test bench on a pair of pictures", rtl,
              kRtlFooter);
}

}  // namespace stereotlm::cli

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/capture/capture_config.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_ports.h"
#include "models/kernels/filter_kernel.h"
#include "models/kernels/matching_cost.h"
#include "models/memory/bank_energy.h"
#include "models/memory/memory_config.h"

namespace stereotlm::platform {

using capture::CameraTrigger;
// Where captured pictures go.
enum class CaptureDestination { kBoard, kHostMemory };

// One board as its YAML file describes it (contract section 4). Plain values; the defaults are the paper's
// board, preset `fpl2003`. Each field has its unit and range beside it; problems() checks all ranges.
struct ImageConfig {
  int width = 640;   // pixels, 4..8192, a multiple of 4; at most 2048 with a look-up table
  int height = 480;  // pixels, 1..8192; at most 2048 with a look-up table
};

// Keys below `cameras`.
struct CamerasConfig {
  double frame_rate_hz = 29.97;                         // 0.1..1000
  CameraTrigger trigger = CameraTrigger::kFreeRunning;  // `free_running` or `on_demand`
};

// Keys below `capture`.
struct CaptureConfig {
  CaptureDestination destination = CaptureDestination::kBoard;  // `board` or `host_memory`
  int host_frames = 3;          // pairs in the ring in host memory, 1..64; the ring holds at most 1 GiB
  int fifo_words = 140;         // 32-bit words, 1..4096
  int fifo_trigger_words = 32;  // 32-bit words, 1..fifo_words
};

// A traffic generator on the PCI bus: a further master that reads from a device of its own. Times are rounded
// to picoseconds.
struct PciLoadConfig {
  int burst_words = 32;    // 32-bit words per transfer, 1..1024
  double interval_us = 0;  // time from one request to the next, 0..10^9; 0: requests again immediately
  double first_us = 0;     // time of the first request, 0..10^9
  double access_us = 0;    // wait of the bus before the first word of a transfer, 0..10^6
};

// Keys below `pci`.
struct PciConfig {
  double clock_mhz = 33.333;                         // 1..1000
  int latency_timer_clocks = 64;                     // 0..255
  int bridge_wait_clocks = 4;                        // 0..255
  int memory_wait_clocks = 8;                        // 0..255
  int width_bits = 32;                               // 32 or 64
  std::optional<PciLoadConfig> load = std::nullopt;  // nullopt: none
};

// Keys below `bridge`.
struct BridgeConfig {
  double local_clock_mhz = 40;  // 1..1000
  int dma_burst_words = 32;     // 32-bit words, 1..1024
  int posted_words = 64;        // 32-bit words, 1..4096
};

// Keys below `fpga`.
struct FpgaConfig {
  std::string device = "xc2v6000";                         // a name of area::kDevices
  std::string package;                                     // of an xc2v6000, or empty
  double clock_mhz = 40;                                   // 1..1000
  memory::ArbiterConfig arbiter = fpga::core_arbiter();    // the port groups in the order of their priority
  int lane_fifo_slots = 16;                                // slots, 1..64
  int result_fifo_words = 8;                               // 32-bit words, 1..64, at least matcher.rows
  int result_delay_cycles = 0;                             // cycles before the result queue, 0..64
  int pipeline_latency_cycles = 16;                        // cycles, 0..1024
  int lanes = 1;                                           // lanes on each side, 1..16
  bool joint_tables = false;                               // true: one table for both sides
  fpga::PixelCache pixel_cache = fpga::PixelCache::kNone;  // a cache of the last word read, or none
};

// One bank with everything that `ssram.default` supplies filled in.
struct BankConfig {
  std::string name;                                         // a letter, then letters, digits, `-` and `_`
  int words = 524288;                                       // 32-bit words, 1..2^26
  memory::BankKind kind = memory::BankKind::kZbtPipelined;  // kBankTraits has their properties
  int turnaround_cycles = 0;                                // 1..16 if the kind has turnaround, else 0
  std::optional<memory::SdramTiming> sdram = std::nullopt;  // of this kind only
  // memory::BankEnergy, which has the ranges; nullopt: that of the kind
  std::optional<double> standby_mw = std::nullopt;
  std::optional<int> access_pj = std::nullopt;
  std::optional<int> row_pj = std::nullopt;      // of sdram only
  std::optional<int> refresh_pj = std::nullopt;  // of sdram only
};

// What the bank takes: its own figures, and those of its kind in place of what it does not give.
memory::BankEnergy energy_of(const BankConfig& bank);

// The banks of a buffer, by name: one, or 2 to 16 over which its rows are striped (contract 8.2).
struct BufferBanks {
  BufferBanks(std::string bank) : banks{std::move(bank)} {}  // NOLINT: an unstriped buffer is just its bank
  BufferBanks(const char* bank) : BufferBanks(std::string(bank)) {}  // NOLINT: of one bank
  // Banks of one read latency.
  explicit BufferBanks(std::vector<std::string> stripe) : banks(std::move(stripe)) {}

  bool is_striped() const { return banks.size() > 1; }  // whether it has several banks
  friend bool operator==(const BufferBanks& a, const BufferBanks& b) { return a.banks == b.banks; }

  std::vector<std::string> banks;  // row y is in bank number y mod N
};

// The banks of each buffer. The frames use the entries of a list in turn. A list has 1 to 3 entries;
// the two image lists are equally long. A side whose `.._lut` has no value has no look-up table (`none`).
// With joint tables both name the banks of the one table.
struct AllocationConfig {
  std::vector<BufferBanks> left_image = {"bank0", "bank1"};   // one to three entries
  std::vector<BufferBanks> right_image = {"bank2", "bank3"};  // as many entries as left_image
  std::vector<BufferBanks> disparity = {"bank4", "bank5"};    // one to three entries
  std::optional<BufferBanks> left_lut = "bank6";              // nullopt: no table
  std::optional<BufferBanks> right_lut = "bank7";             // nullopt: no table
};

// Keys below `matcher`.
struct MatcherConfig {
  int window = 7;                                                 // odd, 3..31
  int disparities = 80;                                           // 1..254
  std::optional<kernels::FilterKernel> filter = kernels::log7();  // nullopt: none
  fpga::Fetch fetch = fpga::Fetch::kColumn;                       // columns of pixels, or a line buffer
  std::optional<int> lr_tolerance = 0;                            // 0..253; nullopt: off
  std::optional<int> units;                                       // modules, 1..disparities; nullopt: all
  int rows = 1;                // rows of results at once, 1..16; 1 unless the fetch is kColumn
  kernels::MatchingCost cost;  // `sad`, `ssd`, `zncc` or census
};

// A whole board.
struct BoardConfig {
  std::string name = "fpl2003";  // in results and messages; not empty
  ImageConfig image;             // size of the pictures
  CamerasConfig cameras;         // rate and trigger
  CaptureConfig capture;         // capture boards
  PciConfig pci;                 // bus and its load
  BridgeConfig bridge;           // bridge and local bus
  FpgaConfig fpga;               // core
  std::vector<BankConfig> banks = {{"bank0"}, {"bank1"}, {"bank2"}, {"bank3"},
                                   {"bank4"}, {"bank5"}, {"bank6"}, {"bank7"}};  // 1..64, in the file's order
  AllocationConfig allocation;  // which bank holds which buffer
  MatcherConfig matcher;        // window, disparities, cost
};

bool operator==(const BoardConfig& a, const BoardConfig& b);
inline bool operator!=(const BoardConfig& a, const BoardConfig& b) { return !(a == b); }

// Returns every broken rule as `path.of.key = value: rule`: first those of single values in the order of the
// keys, then those between keys. Empty if the board can be built. The rules are those for reading the file
// to_yaml(board). All other functions that take a board expect one without problems.
std::vector<std::string> problems(const BoardConfig& board);
// Returns the board. Throws std::invalid_argument with all problems() if there are any.
const BoardConfig& require_valid(const BoardConfig& board);

// The number of frames after which all allocation lists start over: the least common multiple of their
// lengths.
std::uint64_t allocation_period_frames(const BoardConfig& board);

// The configurations of the banks' modules, in the order of the board.
std::vector<memory::SsramBankConfig> ssram_configs(const BoardConfig& board);

// The configuration of the core.
fpga::CoreConfig core_config(const BoardConfig& board);
// The ports of the core, and that of the host.
inline fpga::CorePorts core_ports(const BoardConfig& board) { return fpga::CorePorts(board.fpga.lanes); }

}  // namespace stereotlm::platform

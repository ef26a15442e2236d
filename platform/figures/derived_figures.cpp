#include "platform/figures/derived_figures.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "models/clock.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/placement.h"
#include "models/memory/bank_traits.h"
#include "platform/config/board_area.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

std::uint64_t sum_of(const std::vector<std::uint64_t>& numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0});
}

constexpr double kPsPerSecond = 1e12;
constexpr double kPsPerMs = 1e9;

double seconds(std::uint64_t ps) { return static_cast<double>(ps) / kPsPerSecond; }

// Percentiles by nearest rank, in milliseconds.
Percentiles percentiles(std::vector<std::uint64_t> values_ps) {
  std::sort(values_ps.begin(), values_ps.end());
  const auto rank = [&values_ps](std::size_t percent) {
    const std::size_t place = (values_ps.size() * percent + 99) / 100;
    return static_cast<double>(values_ps[std::max<std::size_t>(place, 1) - 1]) / kPsPerMs;
  };
  return {rank(0), rank(50), rank(95), rank(99), rank(100)};
}

// [lane][row]: the slots of a lane that lie in this row of the image; behind the lanes the words of results.
std::vector<std::vector<std::uint64_t>> slots_of_rows(const fpga::CoreConfig& core) {
  const fpga::FrameGeometry geometry(core);
  const auto lanes = static_cast<std::size_t>(geometry.lanes);
  std::vector<std::vector<std::uint64_t>> slots(
      lanes + 1, std::vector<std::uint64_t>(static_cast<std::size_t>(geometry.height)));
  for (int strip = 0; strip < geometry.strips; ++strip) {
    for (int k = 0; k < geometry.slots_per_column; ++k) {
      const int row = geometry.first_row_of(strip) + k;
      if (geometry.is_inside(row))
        ++slots[static_cast<std::size_t>(k) % lanes][static_cast<std::size_t>(row)];
    }
  }
  slots.back().assign(slots.back().size(), 1);
  return slots;
}

std::uint64_t latency_ps(const Delivery& delivery) { return delivery.host_ps - delivery.capture_ps; }

}  // namespace

std::uint64_t steady_frames(std::uint64_t frames, std::uint64_t turn) {
  return frames < 2 * turn ? 0 : (frames - turn) / turn * turn;
}

std::optional<SteadyRate> steady_rate(const std::vector<Delivery>& deliveries, std::uint64_t turn) {
  SteadyRate steady;
  steady.frames = steady_frames(deliveries.size(), turn);
  if (steady.frames == 0) return std::nullopt;
  const auto before = deliveries.end() - 1 - static_cast<std::ptrdiff_t>(steady.frames);
  const auto [least, greatest] =
      std::minmax_element(before, deliveries.end(),
                          [](const Delivery& a, const Delivery& b) { return latency_ps(a) < latency_ps(b); });
  const std::uint64_t window_ps = deliveries.back().host_ps - before->host_ps;
  steady.frames_per_second = static_cast<double>(steady.frames) / seconds(window_ps);
  steady.uncertainty = steady.frames_per_second *
                       static_cast<double>(latency_ps(*greatest) - latency_ps(*least)) /
                       static_cast<double>(window_ps);
  return steady;
}

void derive_figures(const BoardConfig& board, Statistics& statistics) {
  const std::uint64_t all_cycles = sum_of(statistics.frame_cycles);
  statistics.board = board.name;
  statistics.frames = statistics.frame_cycles.size();
  statistics.cycles =
      all_cycles - statistics.frames * static_cast<std::uint64_t>(board.fpga.pipeline_latency_cycles);
  const auto cycles = static_cast<double>(statistics.cycles);
  for (std::size_t index = 0; index < board.banks.size(); ++index) {
    BankStatistics& bank = statistics.banks[index];
    bank.name = board.banks[index].name;
    bank.ports = memory::traits_of(board.banks[index].kind).ports;
    const bool has_rows = board.banks[index].sdram.has_value();
    for (auto* const counter : {&bank.row_cycles, &bank.refresh_cycles})
      *counter = has_rows ? std::optional(counter->value_or(0)) : std::nullopt;
    if (statistics.cycles == 0) continue;
    bank.utilization = static_cast<double>(bank.busy_cycles) / cycles;
    bank.megabytes_per_second =
        4.0 * static_cast<double>(bank.reads + bank.writes) * board.fpga.clock_mhz / cycles;
  }
  const fpga::CorePorts ports = core_ports(board);
  for (std::size_t port = 0; port < ports.size(); ++port) statistics.ports[port].name = ports.name(port);
  if (statistics.frames > 0) {
    statistics.frames_per_second.core =
        board.fpga.clock_mhz * 1e6 * static_cast<double>(statistics.frames) / static_cast<double>(all_cycles);
  }
  statistics.area = area_of(board);
}

void derive_energy(const BoardConfig& board, Statistics& statistics) {
  EnergyStatistics& all = statistics.energy;
  all.buffers.resize(kBufferKeys.size());
  for (std::size_t i = 0; i < kBufferKeys.size(); ++i) all.buffers[i].name = name_of(static_cast<Buffer>(i));
  if (!statistics.computer) {
    all.time_ps = Clock(board.fpga.clock_mhz).edge_ps(statistics.cycles);
    const fpga::CorePorts ports = core_ports(board);
    for (BufferStatistics& buffer : all.buffers) {
      buffer.bytes = 0;
      for (std::size_t port = 0; port < ports.core_size(); ++port)
        buffer.bytes += ports.group(port).buffer == buffer.name ? 4 * statistics.ports[port].grants : 0;
    }
  }
  const auto frames = static_cast<double>(std::max<std::uint64_t>(statistics.frames, 1));
  all.memory_pj = 0;
  const std::vector<bool> used = used_banks(board);
  for (std::size_t index = 0; index < board.banks.size(); ++index) {
    std::optional<BankEnergyStatistics>& bank = statistics.banks[index].energy;
    bank = used[index] ? std::optional(bank.value_or(BankEnergyStatistics())) : std::nullopt;
    if (!bank) continue;
    if (!statistics.computer) bank->accesses = statistics.banks[index].reads + statistics.banks[index].writes;
    const bool has_rows = board.banks[index].sdram.has_value();
    for (auto* const counter : {&bank->rows_opened, &bank->refreshes})
      *counter = has_rows ? std::optional(counter->value_or(0)) : std::nullopt;
    bank->energy_pj = memory::energy_pj(energy_of(board.banks[index]), all.time_ps, bank->accesses,
                                        bank->rows_opened.value_or(0), bank->refreshes.value_or(0));
    all.memory_pj += bank->energy_pj;
  }
  const auto energy = static_cast<double>(all.memory_pj);
  for (BankStatistics& bank : statistics.banks) {
    if (auto& its = bank.energy)
      its->energy_percent = 100 * static_cast<double>(its->energy_pj) / std::max(energy, 1.0);
  }
  all.memory_mj_per_frame = energy / 1e9 / frames;
  all.memory_mw = 1e3 * energy / std::max(static_cast<double>(all.time_ps), 1.0);
  std::uint64_t bytes = 0;
  for (BufferStatistics& buffer : all.buffers) {
    bytes += buffer.bytes;
    buffer.megabytes_per_frame = static_cast<double>(buffer.bytes) / 1e6 / frames;
  }
  all.megabytes_per_frame = static_cast<double>(bytes) / 1e6 / frames;
}

void derive_delivery_figures(const std::vector<Delivery>& deliveries, std::uint64_t turn,
                             Statistics& statistics) {
  statistics.energy.time_ps = deliveries.back().host_ps;
  statistics.frames_per_second.system =
      static_cast<double>(deliveries.size()) / seconds(deliveries.back().host_ps);
  statistics.frames_per_second.steady = steady_rate(deliveries, turn);
  std::vector<std::uint64_t> latencies_ps;
  latencies_ps.reserve(deliveries.size());
  for (const Delivery& delivery : deliveries) latencies_ps.push_back(latency_ps(delivery));
  statistics.computer->capture_to_host_ms = percentiles(std::move(latencies_ps));
}

void audit_core(const Statistics& statistics, Audit& audit) {
  std::map<std::string, std::uint64_t> blamed;  // by the port's name
  for (const BlameRow& row : statistics.blame) blamed[row.port] += row.cycles;
  for (const PortStatistics& port : statistics.ports) {
    const std::string name = "port " + port.name;
    audit.equal(name + ": sum of its states",
                port.grants + port.stall_cycles + port.passed_cycles + port.idle_cycles +
                    port.blocked_cycles + port.starved_cycles,
                "cycles", statistics.cycles);
    audit.equal(name + ": stall_cycles", port.stall_cycles, "blamed by the arbiters", blamed[port.name]);
  }
  for (const BankStatistics& bank : statistics.banks) {
    audit.equal("bank " + bank.name +
                    (bank.row_cycles ? ": busy + turnaround + row + refresh + idle cycles"
                                     : ": busy + turnaround + idle cycles"),
                bank.busy_cycles + bank.turnaround_cycles + bank.row_cycles.value_or(0) +
                    bank.refresh_cycles.value_or(0) + bank.idle_cycles,
                "cycles", statistics.cycles);
  }
}

void audit_energy(const Statistics& statistics, Audit& audit) {
  std::uint64_t of_banks = 0;
  for (const BankStatistics& bank : statistics.banks) of_banks += bank.energy ? 4 * bank.energy->accesses : 0;
  std::uint64_t of_buffers = 0;
  for (const BufferStatistics& buffer : statistics.energy.buffers) of_buffers += buffer.bytes;
  audit.equal("energy: bytes of the buffers", of_buffers, "4 * accesses of the banks", of_banks);
}

void audit_computer(const ComputerStatistics& computer, Audit& audit) {
  audit.at_most("pci: busy_clocks", computer.pci_busy_clocks, "clocks", computer.pci_clocks);
  audit.at_most("bridge: local_busy_clocks", computer.local_busy_clocks, "local_clocks",
                computer.local_clocks);
  for (const CameraStatistics& camera : computer.cameras) {
    audit.equal("camera " + camera.name + ": frames", camera.frames, "captured and dropped",
                camera.captured_frames + camera.dropped_frames);
    audit.equal("camera " + camera.name + ": dropped_frames", camera.dropped_frames, "sum of its reasons",
                camera.dropped_not_armed + camera.dropped_busy + camera.dropped_by_partner);
  }
}

std::vector<std::vector<std::uint64_t>> core_accesses(const BoardConfig& board,
                                                      const Statistics& statistics) {
  const fpga::CoreConfig core = core_config(board);
  const fpga::CorePorts ports(core);
  std::vector<std::vector<std::uint64_t>> accesses(ports.core_size(),
                                                   std::vector<std::uint64_t>(board.banks.size()));
  const fpga::BufferBases buffers = buffer_bases(board);
  const std::uint64_t frames = statistics.frames;
  const std::uint64_t turn = allocation_period_frames(board);
  const std::vector<std::vector<std::uint64_t>> slots = slots_of_rows(core);
  for (std::uint64_t frame = 0; frame < std::min(frames, turn); ++frame) {
    const fpga::Placements placements = placements_of(core, buffers.of_frame(frame));
    const std::uint64_t uses = frames / turn + (frame < frames % turn ? 1 : 0);
    for (std::size_t port = 0; port < ports.core_size(); ++port) {
      const std::vector<std::uint32_t>& parts = placements[ports.group_of(port)].parts();
      const std::vector<std::uint64_t>& of_row =
          slots[port == ports.result() ? ports.lanes() : ports.lane_of(port)];
      std::uint64_t left = statistics.ports[port].grants / frames;
      std::uint64_t left_slots = sum_of(of_row);
      for (std::size_t part = 0; part < parts.size(); ++part) {
        std::uint64_t of_part = 0;
        for (std::size_t row = part; row < of_row.size(); row += parts.size()) of_part += of_row[row];
        const std::uint64_t grants = left_slots == 0 ? 0 : left * of_part / left_slots;
        left -= grants;
        left_slots -= of_part;
        accesses[port][fpga::registers::bank_of(parts[part])] += grants * uses;
      }
    }
  }
  return accesses;
}

void audit_accesses(const BoardConfig& board, const Statistics& statistics, Audit& audit) {
  const std::vector<std::vector<std::uint64_t>> accesses = core_accesses(board, statistics);
  for (std::size_t port = 0; port < accesses.size(); ++port) {
    audit.equal("port " + statistics.ports[port].name + ": grants, equally many in each frame",
                sum_of(accesses[port]), "grants", statistics.ports[port].grants);
  }
  std::uint64_t of_host = 0;
  const bool is_exact = core_config(board).stripes.empty();
  for (std::size_t index = 0; index < board.banks.size(); ++index) {
    const BankStatistics& bank = statistics.banks[index];
    std::uint64_t of_core = 0;
    for (const std::vector<std::uint64_t>& of_port : accesses) of_core += of_port[index];
    if (is_exact)
      audit.at_most("bank " + bank.name + ": accesses of the core's ports", of_core, "reads + writes",
                    bank.reads + bank.writes);
    audit.at_most("bank " + bank.name + ": reads + writes", bank.reads + bank.writes,
                  "accesses that fit into busy_cycles",
                  bank.busy_cycles * static_cast<std::uint64_t>(bank.ports));
    audit.at_most("bank " + bank.name + ": contended_cycles", bank.contended_cycles, "cycles",
                  statistics.cycles);
    of_host += bank.reads + bank.writes - of_core;
  }
  audit.equal("port host: grants", statistics.ports.back().grants,
              "accesses of the banks that are not of the core", of_host);
}

}  // namespace stereotlm::platform

#pragma once

#include <tuple>

#include "models/area/area.h"
#include "platform/figures/statistics.h"
#include "sw/stats/accuracy.h"
#include "sw/stats/json_fields.h"

// The keys of stats.json (sw/report/README.md), in their order.
namespace stereotlm::area {

using stats::Field;

constexpr auto fields_of(const Area* /*type*/) {
  return std::tuple(
      Field{"slices", &Area::slices, "of the FPGA that the core takes"},
      Field{"slices_percent", &Area::slices_percent, "of the slices of fpga.device"},
      Field{"luts", &Area::luts, "look-up tables that the core takes"},
      Field{"flip_flops", &Area::flip_flops, "that the core takes"},
      Field{"block_rams", &Area::block_rams, "that the core takes"},
      Field{"block_rams_percent", &Area::block_rams_percent, "of the block RAMs of fpga.device"},
      Field{"multipliers", &Area::multipliers, "that the core takes"},
      Field{"multipliers_percent", &Area::multipliers_percent, "of the multipliers of fpga.device"},
      Field{"pins", &Area::pins, "only with fpga.package", stats::from_one},
      Field{"pins_percent", &Area::pins_percent, "of the pins of fpga.package"});
}

}  // namespace stereotlm::area

namespace stereotlm::platform {

using stats::Field;
using stats::Part;

constexpr auto fields_of(const BankEnergyStatistics* /*type*/) {
  using Bank = BankEnergyStatistics;
  return std::tuple(Field{"accesses", &Bank::accesses, "reads and writes in energy.time_ps"},
                    Field{"rows_opened", &Bank::rows_opened, "only of sdram"},
                    Field{"refreshes", &Bank::refreshes, "only of sdram"},
                    Field{"energy_pj", &Bank::energy_pj, "of the bank in energy.time_ps"},
                    Field{"energy_percent", &Bank::energy_percent, "of all banks", stats::percentage});
}

constexpr auto fields_of(const BufferStatistics* /*type*/) {
  return std::tuple(
      Field{"name", &BufferStatistics::name},
      Field{"bytes", &BufferStatistics::bytes, "read and written in energy.time_ps"},
      Field{"megabytes_per_frame", &BufferStatistics::megabytes_per_frame, "read and written, 10^6 bytes"});
}

constexpr auto fields_of(const EnergyStatistics* /*type*/) {
  using Energy = EnergyStatistics;
  return std::tuple(Field{"time_ps", &Energy::time_ps,
                          "the counted cycles; with cameras from power-up to the last delivery"},
                    Field{"memory_pj", &Energy::memory_pj, "of all banks in energy.time_ps"},
                    Field{"memory_mj_per_frame", &Energy::memory_mj_per_frame, "of all banks for a frame"},
                    Field{"memory_mw", &Energy::memory_mw, "mean power of all banks"},
                    Field{"megabytes_per_frame", &Energy::megabytes_per_frame, "of all buffers, 10^6 bytes"},
                    Field{"buffers", &Energy::buffers});
}

constexpr auto fields_of(const BankStatistics* /*type*/) {
  using Bank = BankStatistics;
  return std::tuple(
      Field{"name", &Bank::name}, Field{"reads", &Bank::reads, "granted reads"},
      Field{"writes", &Bank::writes, "granted writes"},
      Field{"busy_cycles", &Bank::busy_cycles, "with one or more accesses"},
      Field{"turnaround_cycles", &Bank::turnaround_cycles, "without access because of turnaround"},
      Field{"row_cycles", &Bank::row_cycles, "only of sdram"},
      Field{"refresh_cycles", &Bank::refresh_cycles, "only of sdram"},
      Field{"idle_cycles", &Bank::idle_cycles, "all other cycles"},
      Field{"contended_cycles", &Bank::contended_cycles,
            "with two or more requests for one port of the bank"},
      Field{"utilization", &Bank::utilization, "busy_cycles / cycles", stats::share},
      Field{"megabytes_per_second", &Bank::megabytes_per_second, "read and written, 10^6 bytes"},
      Field{"energy", &Bank::energy, "only of a bank that holds a buffer"});
}

constexpr auto fields_of(const PortStatistics* /*type*/) {
  using Port = PortStatistics;
  return std::tuple(Field{"name", &Port::name},
                    Field{"grants", &Port::grants, "cycles with an access granted"},
                    Field{"stall_cycles", &Port::stall_cycles, "with a request that is not granted"},
                    Field{"passed_cycles", &Port::passed_cycles, "with a slot handled without an access"},
                    Field{"idle_cycles", &Port::idle_cycles, "with nothing to do"},
                    Field{"blocked_cycles", &Port::blocked_cycles, "in which its lane can take no slot"},
                    Field{"starved_cycles", &Port::starved_cycles, "all other cycles"});
}

constexpr auto fields_of(const BlameRow* /*type*/) {
  return std::tuple(Field{"port", &BlameRow::port}, Field{"bank", &BlameRow::bank},
                    Field{"by", &BlameRow::by, "a port, `turnaround`, `row` or `refresh`"},
                    Field{"cycles", &BlameRow::cycles});
}

constexpr auto fields_of(const PciMasterStatistics* /*type*/) {
  using Master = PciMasterStatistics;
  return std::tuple(
      Field{"name", &Master::name}, Field{"transactions", &Master::transactions, "bursts"},
      Field{"words", &Master::words, "moved words"},
      Field{"wait_clocks", &Master::wait_clocks, "from each request to its address clock, summed"});
}

constexpr auto fields_of(const CameraStatistics* /*type*/) {
  using Camera = CameraStatistics;
  return std::tuple(
      Field{"name", &Camera::name}, Field{"frames", &Camera::frames, "that have begun"},
      Field{"captured_frames", &Camera::captured_frames, "taken by a capture"},
      Field{"dropped_frames", &Camera::dropped_frames, "not taken by a capture"},
      Field{"dropped_pixels", &Camera::dropped_pixels, "lost because the FIFO of the capture board was full"},
      Field{"dropped_not_armed", &Camera::dropped_not_armed, "frames: the capture board was not armed"},
      Field{"dropped_busy", &Camera::dropped_busy, "frames: the capture before still ran"},
      Field{"dropped_by_partner", &Camera::dropped_by_partner, "frames: the other side could not start"});
}

constexpr auto fields_of(const Percentiles* /*type*/) {
  return std::tuple(Field{"min", &Percentiles::min, "the least"},
                    Field{"p50", &Percentiles::p50, "half are not greater"},
                    Field{"p95", &Percentiles::p95, "95 % are not greater"},
                    Field{"p99", &Percentiles::p99, "99 % are not greater"},
                    Field{"max", &Percentiles::max, "the greatest"});
}

constexpr auto fields_of(const SteadyRate* /*type*/) {
  return std::tuple(
      Field{"steady", &SteadyRate::frames_per_second, "of the whole computer without its start-up",
            stats::above_zero},
      Field{"steady_uncertainty", &SteadyRate::uncertainty, "what the window of steady leaves open"});
}

constexpr auto fields_of(const ProvenRate* /*type*/) {
  return std::tuple(
      Field{"exact", &ProvenRate::exact, "in the long run, where it is proven", stats::above_zero},
      Field{"exact_delivered_frames", &ProvenRate::deliveries, "exact: so many in exact_camera_frames"},
      Field{"exact_camera_frames", &ProvenRate::camera_frames, "exact: exact_delivered_frames in so many"},
      Field{"exact_least", &ProvenRate::least, "proven lower bound of the rate in the long run"},
      Field{"exact_most", &ProvenRate::most, "proven upper bound of the rate in the long run"});
}

constexpr auto fields_of(const FramesPerSecond* /*type*/) {
  return std::tuple(
      Field{"core", &FramesPerSecond::core, "frames / the time in which the core runs", stats::above_zero},
      Field{"system", &FramesPerSecond::system, "deliveries / time of the last delivery", stats::above_zero},
      stats::Merged{&FramesPerSecond::steady}, stats::Merged{&FramesPerSecond::proven});
}

constexpr auto fields_of(const Bound* /*type*/) {
  return std::tuple(Field{"core", &Bound::core, "upper bound of frames_per_second.core", stats::above_zero},
                    Field{"core_limited_by", &Bound::core_limited_by, "the resource that sets bound.core"},
                    Field{"system", &Bound::system,
                          "upper bound of frames_per_second.steady, of whole pictures", stats::above_zero},
                    Field{"system_limited_by", &Bound::system_limited_by,
                          "the resource that sets bound.system", nullptr, stats::Presence::kUnlessEmpty});
}

constexpr auto fields_of(const ComputerStatistics* /*type*/) {
  using Computer = ComputerStatistics;
  return std::tuple(
      Part{"pci",
           std::tuple(Field{"clocks", &Computer::pci_clocks, "whole clocks from power-up"},
                      Field{"busy_clocks", &Computer::pci_busy_clocks, "address, wait and data clocks"},
                      Field{"masters", &Computer::pci_masters})},
      Part{"bridge",
           std::tuple(
               Field{"posted_words", &Computer::posted_words, "that masters wrote into the bridge"},
               Field{"dma_words", &Computer::dma_words, "that the DMA of the bridge moved"},
               Field{"local_clocks", &Computer::local_clocks, "whole local clocks from power-up"},
               Field{"local_busy_clocks", &Computer::local_busy_clocks, "local clocks that are not idle"})},
      Field{"cameras", &Computer::cameras},
      Part{"latency_ms", std::tuple(Field{"capture_to_host", &Computer::capture_to_host_ms})});
}

constexpr auto fields_of(const Statistics* /*type*/) {
  return std::tuple(
      Field{"board", &Statistics::board, "name of the board"},
      Field{"fidelity", &Statistics::fidelity, "fast or cycle",
            [] {
              return stats::one_of_words({"fast", "cycle"});
            }},
      Field{"frames", &Statistics::frames, "that were simulated", stats::from_one},
      Field{"cycles", &Statistics::cycles, "counted cycles of all frames"},
      Field{"frame_cycles", &Statistics::frame_cycles, "of each frame, a list",
            [] { return stats::list_of(stats::count(), 1); }},
      Field{"frames_per_second", &Statistics::frames_per_second},
      Field{"bound", &Statistics::bound,
            "frames per second; system: of the frames of steady, without it of those delivered"},
      Field{"banks", &Statistics::banks}, Field{"ports", &Statistics::ports},
      Field{"blame", &Statistics::blame}, Field{"energy", &Statistics::energy, kEnergyIsOf},
      stats::Merged{&Statistics::computer}, Field{"area", &Statistics::area},
      Field{"failed", &Statistics::failed, "identities that do not hold",
            [] { return stats::list_of(stats::text(), 1); }, stats::Presence::kUnlessEmpty});
}

}  // namespace stereotlm::platform

namespace stereotlm::stats {

constexpr auto fields_of(const Accuracy* /*type*/) {
  return std::tuple(
      Field{"bad_1_percent", &Accuracy::bad_1_percent,
            "share of the answered pixels that are wrong by more than 1 disparity", percentage},
      Field{"bad_2_percent", &Accuracy::bad_2_percent,
            "share of the answered pixels that are wrong by more than 2 disparities", percentage},
      Field{"answered_percent", &Accuracy::answered_percent,
            "share of the known, visible pixels that have a disparity", percentage});
}

}  // namespace stereotlm::stats

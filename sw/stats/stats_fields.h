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
      Field{"slices", &Area::slices}, Field{"slices_percent", &Area::slices_percent},
      Field{"luts", &Area::luts}, Field{"flip_flops", &Area::flip_flops},
      Field{"block_rams", &Area::block_rams}, Field{"block_rams_percent", &Area::block_rams_percent},
      Field{"multipliers", &Area::multipliers}, Field{"multipliers_percent", &Area::multipliers_percent},
      Field{"pins", &Area::pins, "only with fpga.package", stats::from_one},
      Field{"pins_percent", &Area::pins_percent, "of the pins of fpga.package"});
}

}  // namespace stereotlm::area

namespace stereotlm::platform {

using stats::Field;
using stats::Part;

constexpr auto fields_of(const BankEnergyStatistics* /*type*/) {
  using Bank = BankEnergyStatistics;
  return std::tuple(
      Field{"accesses", &Bank::accesses}, Field{"rows_opened", &Bank::rows_opened, "only of sdram"},
      Field{"refreshes", &Bank::refreshes, "only of sdram"}, Field{"energy_pj", &Bank::energy_pj},
      Field{"energy_percent", &Bank::energy_percent, "of all banks", stats::percentage});
}

constexpr auto fields_of(const BufferStatistics* /*type*/) {
  return std::tuple(Field{"name", &BufferStatistics::name}, Field{"bytes", &BufferStatistics::bytes},
                    Field{"megabytes_per_frame", &BufferStatistics::megabytes_per_frame});
}

constexpr auto fields_of(const EnergyStatistics* /*type*/) {
  using Energy = EnergyStatistics;
  return std::tuple(
      Field{"time_ps", &Energy::time_ps}, Field{"memory_pj", &Energy::memory_pj},
      Field{"memory_mj_per_frame", &Energy::memory_mj_per_frame}, Field{"memory_mw", &Energy::memory_mw},
      Field{"megabytes_per_frame", &Energy::megabytes_per_frame}, Field{"buffers", &Energy::buffers});
}

constexpr auto fields_of(const BankStatistics* /*type*/) {
  using Bank = BankStatistics;
  return std::tuple(
      Field{"name", &Bank::name}, Field{"reads", &Bank::reads}, Field{"writes", &Bank::writes},
      Field{"busy_cycles", &Bank::busy_cycles}, Field{"turnaround_cycles", &Bank::turnaround_cycles},
      Field{"row_cycles", &Bank::row_cycles, "only of sdram"},
      Field{"refresh_cycles", &Bank::refresh_cycles, "only of sdram"},
      Field{"idle_cycles", &Bank::idle_cycles}, Field{"contended_cycles", &Bank::contended_cycles},
      Field{"utilization", &Bank::utilization, "", stats::share},
      Field{"megabytes_per_second", &Bank::megabytes_per_second},
      Field{"energy", &Bank::energy, "only of a bank that holds a buffer"});
}

constexpr auto fields_of(const PortStatistics* /*type*/) {
  using Port = PortStatistics;
  return std::tuple(Field{"name", &Port::name}, Field{"grants", &Port::grants},
                    Field{"stall_cycles", &Port::stall_cycles}, Field{"passed_cycles", &Port::passed_cycles},
                    Field{"idle_cycles", &Port::idle_cycles}, Field{"blocked_cycles", &Port::blocked_cycles},
                    Field{"starved_cycles", &Port::starved_cycles});
}

constexpr auto fields_of(const BlameRow* /*type*/) {
  return std::tuple(Field{"port", &BlameRow::port}, Field{"bank", &BlameRow::bank},
                    Field{"by", &BlameRow::by, "a port, `turnaround`, `row` or `refresh`"},
                    Field{"cycles", &BlameRow::cycles});
}

constexpr auto fields_of(const PciMasterStatistics* /*type*/) {
  using Master = PciMasterStatistics;
  return std::tuple(Field{"name", &Master::name}, Field{"transactions", &Master::transactions},
                    Field{"words", &Master::words}, Field{"wait_clocks", &Master::wait_clocks});
}

constexpr auto fields_of(const CameraStatistics* /*type*/) {
  using Camera = CameraStatistics;
  return std::tuple(
      Field{"name", &Camera::name}, Field{"frames", &Camera::frames},
      Field{"captured_frames", &Camera::captured_frames}, Field{"dropped_frames", &Camera::dropped_frames},
      Field{"dropped_pixels", &Camera::dropped_pixels},
      Field{"dropped_not_armed", &Camera::dropped_not_armed}, Field{"dropped_busy", &Camera::dropped_busy},
      Field{"dropped_by_partner", &Camera::dropped_by_partner});
}

constexpr auto fields_of(const Percentiles* /*type*/) {
  return std::tuple(Field{"min", &Percentiles::min}, Field{"p50", &Percentiles::p50},
                    Field{"p95", &Percentiles::p95}, Field{"p99", &Percentiles::p99},
                    Field{"max", &Percentiles::max});
}

constexpr auto fields_of(const SteadyRate* /*type*/) {
  return std::tuple(Field{"steady", &SteadyRate::frames_per_second, "", stats::above_zero},
                    Field{"steady_uncertainty", &SteadyRate::uncertainty});
}

constexpr auto fields_of(const FramesPerSecond* /*type*/) {
  return std::tuple(Field{"core", &FramesPerSecond::core, "", stats::above_zero},
                    Field{"system", &FramesPerSecond::system, "", stats::above_zero},
                    stats::Merged{&FramesPerSecond::steady});
}

constexpr auto fields_of(const Bound* /*type*/) {
  return std::tuple(
      Field{"core", &Bound::core, "", stats::above_zero}, Field{"core_limited_by", &Bound::core_limited_by},
      Field{"system", &Bound::system, "", stats::above_zero},
      Field{"system_limited_by", &Bound::system_limited_by, "", nullptr, stats::Presence::kUnlessEmpty});
}

constexpr auto fields_of(const ComputerStatistics* /*type*/) {
  using Computer = ComputerStatistics;
  return std::tuple(Part{"pci", std::tuple(Field{"clocks", &Computer::pci_clocks},
                                           Field{"busy_clocks", &Computer::pci_busy_clocks},
                                           Field{"masters", &Computer::pci_masters})},
                    Part{"bridge", std::tuple(Field{"posted_words", &Computer::posted_words},
                                              Field{"dma_words", &Computer::dma_words},
                                              Field{"local_clocks", &Computer::local_clocks},
                                              Field{"local_busy_clocks", &Computer::local_busy_clocks})},
                    Field{"cameras", &Computer::cameras},
                    Part{"latency_ms", std::tuple(Field{"capture_to_host", &Computer::capture_to_host_ms})});
}

constexpr auto fields_of(const Statistics* /*type*/) {
  return std::tuple(
      Field{"board", &Statistics::board},
      Field{"fidelity", &Statistics::fidelity, "",
            [] {
              return stats::one_of_words({"fast", "cycle"});
            }},
      Field{"frames", &Statistics::frames, "", stats::from_one}, Field{"cycles", &Statistics::cycles},
      Field{"frame_cycles", &Statistics::frame_cycles, "", [] { return stats::list_of(stats::count(), 1); }},
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
  return std::tuple(Field{"bad_1_percent", &Accuracy::bad_1_percent, "", percentage},
                    Field{"bad_2_percent", &Accuracy::bad_2_percent, "", percentage},
                    Field{"answered_percent", &Accuracy::answered_percent, "", percentage});
}

}  // namespace stereotlm::stats

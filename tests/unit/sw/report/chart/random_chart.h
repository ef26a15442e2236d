#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sw/report/chart/chart_layout.h"
#include "tests/support/random_board.h"

namespace stereotlm::report {

// A board for drawings, in which everything that changes the chart varies. Its banks hold their buffers.
inline platform::BoardConfig random_chart_board(test::SplitMix64& random) {
  platform::BoardConfig board;
  const int banks = random.mostly_small(1, 16, 64);
  board.banks.clear();
  for (int i = 0; i < banks; ++i) {
    platform::BankConfig bank;
    bank.name =
        std::string(static_cast<std::size_t>(random.mostly_small(1, 8, 60)), random.chance(50) ? 'W' : 'i') +
        std::to_string(i);
    bank.kind = static_cast<memory::BankKind>(random.between(0, 3));
    bank.turnaround_cycles = memory::traits_of(bank.kind).has_turnaround ? random.between(1, 16) : 0;
    bank.words = 1 << 26;
    board.banks.push_back(bank);
  }
  const auto any_bank = [&] {
    return board.banks[static_cast<std::size_t>(random.between(0, banks - 1))].name;
  };
  const auto list = [&](int length) {
    std::vector<std::string> names;
    for (int i = 0; i < length; ++i) names.push_back(any_bank());
    return names;
  };
  const int pairs = random.between(1, 3);
  board.allocation = {list(pairs), list(pairs), list(random.between(1, 3)), any_bank(), any_bank()};
  board.fpga.joint_tables = random.chance(30);
  if (board.fpga.joint_tables) {
    board.allocation.right_lut = board.allocation.left_lut;
  } else {
    if (random.chance(30)) board.allocation.left_lut.reset();
    if (random.chance(30)) board.allocation.right_lut.reset();
  }
  board.name =
      std::string(static_cast<std::size_t>(random.mostly_small(1, 20, 300)), random.chance(50) ? 'm' : '<');
  board.image = {4 * random.between(1, 512), random.between(1, 2048)};
  board.cameras.frame_rate_hz = random.between(1, 1000);
  board.capture.destination =
      random.chance(50) ? platform::CaptureDestination::kBoard : platform::CaptureDestination::kHostMemory;
  board.capture.fifo_words = random.between(1, 4096);
  board.pci.width_bits = random.chance(50) ? 32 : 64;
  board.pci.clock_mhz = random.between(1, 1000) + 0.333;
  board.bridge.local_clock_mhz = random.between(1, 1000) + 0.125;
  board.fpga.clock_mhz = random.between(1, 1000);
  if (random.chance(50))
    board.pci.load = platform::PciLoadConfig{random.between(1, 1024), random.between(0, 1000) * 1e6, 0, 0};
  board.fpga.lane_fifo_slots = random.between(1, 64);
  board.fpga.pixel_cache = random.chance(50) ? fpga::PixelCache::kNone : fpga::PixelCache::kWord;
  if (random.chance(30)) board.matcher.filter.reset();
  if (random.chance(30)) board.matcher.fetch = fpga::Fetch::kLineBuffer;
  if (random.chance(30)) board.matcher.lr_tolerance.reset();
  if (random.chance(50)) board.matcher.units = random.between(1, board.matcher.disparities);
  if (board.matcher.fetch == fpga::Fetch::kColumn) board.matcher.rows = random.between(1, 8);
  if (random.chance(30)) board.matcher.cost = {kernels::CostKind::kCensus, 7};
  return board;
}

// The links of a port have up to its peak in all.
inline ChartTraffic random_chart_traffic(const platform::BoardConfig& board, ChartExtent extent,
                                         test::SplitMix64& random) {
  ChartTraffic traffic;
  traffic.extent = extent;
  std::map<std::string, double> free;  // % of the peak, by the block from which the link comes
  for (const ChartLink& link : chart_links(board, extent)) {
    double& left = free.try_emplace(link.from, 100).first->second;
    const double percent = random.chance(20) ? 0 : left * random.between(0, 100) / 100;
    left -= percent;
    traffic.megabytes_per_second[link.id()] = link.peak * percent / 100;
  }
  for (const platform::BankConfig& bank : board.banks) traffic.busy_percent["bank-" + bank.name] = 12.34;
  for (const fpga::CorePort& port : fpga::kPorts)
    traffic.waits_percent[std::string("port-") + port.name] = 100;
  traffic.busy_percent["part-pci"] = traffic.busy_percent["part-local_bus"] = 99.99;
  traffic.limiting = {"bank-" + board.banks.front().name};
  traffic.summary = {"18.60 frames/s steady, 17.50 including start-up; 1000000 frames",
                     "bound 18.60 frames/s, set by bank " + board.banks.front().name};
  return traffic;
}

}  // namespace stereotlm::report

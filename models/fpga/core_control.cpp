#include "models/fpga/core_control.h"

#include <stdexcept>

namespace stereotlm::fpga {
namespace {

const CoreConfig& checked(const CoreConfig& config) {
  if (const auto found = problems(config); !found.empty()) throw std::invalid_argument(found.front());
  return config;
}

}  // namespace

CoreControl::CoreControl(const CoreConfig& config)
    : geometry_(checked(config)),
      left_(geometry_, config.left_table, config.lane_fifo_slots),
      right_(geometry_, config.right_table, config.lane_fifo_slots),
      match_(geometry_),
      result_(geometry_, config.result_fifo_words) {}

void CoreControl::start_frame(const FrameLatencies& latencies) {
  left_.start_frame(latencies.left_lut, latencies.left_image);
  right_.start_frame(latencies.right_lut, latencies.right_image);
  match_.start_frame();
  result_.start_frame();
}

CoreControl::Counts CoreControl::counts() const {
  Counts counts;
  for (std::size_t port = 0; port < counts.size(); ++port)
    counts[port] = port_cycles(static_cast<memory::Port>(port));
  return counts;
}

CoreControl::Counts CoreControl::difference(const Counts& after, const Counts& before) {
  Counts difference;
  for (std::size_t port = 0; port < difference.size(); ++port)
    difference[port] = after[port].since(before[port]);
  return difference;
}

void CoreControl::count(const Counts& counts, std::uint64_t times) {
  using memory::index_of;
  using memory::Port;
  left_.count(counts[index_of(Port::kLeftLut)], counts[index_of(Port::kLeftPixel)], times);
  right_.count(counts[index_of(Port::kRightLut)], counts[index_of(Port::kRightPixel)], times);
  result_.count(counts[index_of(Port::kResult)], times);
}

void CoreControl::skip_to(const State& state, std::uint64_t columns, std::uint64_t words) {
  const std::uint64_t slots =
      match_.draining() ? 0 : columns * static_cast<std::uint64_t>(geometry_.slots_per_column);
  left_.skip_to(state.left, slots);
  right_.skip_to(state.right, slots);
  match_.skip_columns(columns);
  result_.skip_to(state.rest >> 8U, words);
}

const PortCycles& CoreControl::port_cycles(memory::Port port) const {
  using memory::Port;
  switch (port) {
    case Port::kLeftLut:
      return left_.lut_cycles();
    case Port::kRightLut:
      return right_.lut_cycles();
    case Port::kLeftPixel:
      return left_.pixel_cycles();
    case Port::kRightPixel:
      return right_.pixel_cycles();
    case Port::kResult:
      return result_.cycles();
    case Port::kHost:
      break;
  }
  return host_cycles_;
}

}  // namespace stereotlm::fpga

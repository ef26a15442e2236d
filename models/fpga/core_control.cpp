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

void CoreControl::count(const Decision& decision, memory::PortMask granted, std::uint64_t cycles) {
  using memory::Port;
  const auto is_granted = [granted](Port port) { return (granted & memory::mask_of(port)) != 0; };
  left_.count(decision.left, is_granted(Port::kLeftLut), is_granted(Port::kLeftPixel), cycles);
  right_.count(decision.right, is_granted(Port::kRightLut), is_granted(Port::kRightPixel), cycles);
  result_.count(decision.result, is_granted(Port::kResult), cycles);
}

void CoreControl::skip_columns(std::uint64_t columns) {
  // What is written in the meantime is what has left.
  if (match_.word_leaves()) result_.skip_words(columns / 4);
  if (!match_.draining()) {
    left_.skip_columns(columns);
    right_.skip_columns(columns);
  }
  match_.skip_columns(columns);
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

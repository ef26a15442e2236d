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

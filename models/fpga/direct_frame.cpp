#include "models/fpga/direct_frame.h"

#include <algorithm>

#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"

namespace stereotlm::fpga {
namespace {

std::size_t pixels_of(const CoreConfig& config) {
  return static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.height);
}

}  // namespace

DirectFrame::DirectFrame(const CoreConfig& config, bool has_pixels)
    : config_(config), patterns_{AccessPattern(FrameGeometry(config)), AccessPattern(FrameGeometry(config))} {
  if (!has_pixels) return;
  pipeline_ = std::make_unique<kernels::StereoPipeline>(
      config.width, config.height,
      kernels::StereoConfig{config.window, config.disparities, config.filter, config.lr_tolerance,
                            config.cost});
  disparities_.resize(pixels_of(config));
}

void DirectFrame::set_buffers(const FrameBases& bases) {
  for (std::size_t port = 0; port < kCorePortCount; ++port) {
    if (!has_port(config_, port)) continue;
    const std::uint64_t first = registers::base_address(bases[port]);
    buffers_[port] = {first, first + pixels_of(config_) * kPorts[port].bytes_per_pixel};
  }
}

bool DirectFrame::disparities_are_apart() const {
  const AddressRange& disparities = buffers_[kResultPort];
  return std::count_if(buffers_.begin(), buffers_.end(), [&disparities](const AddressRange& buffer) {
           return buffer.overlaps(disparities);
         }) == 1;  // itself
}

bool DirectFrame::read(const Memory& memory) {
  bool is_readable = memory.disparities != nullptr;
  for (const Side side : kSides) {
    const std::size_t index = index_of(side);
    const bool has_table = has_port(config_, lut_port(side));
    if (has_table && !read_table(side, memory.tables[index])) is_readable = false;
    if (memory.images[index] == nullptr) is_readable = false;
  }
  if (is_readable && pipeline_) {
    pipeline_->run(memory.images[0], memory.images[1], memory.tables[0].entries, memory.tables[1].entries,
                   disparities_.data());
  }
  return is_readable;
}

bool DirectFrame::read_table(Side side, const Table& table) {
  if (table.entries == nullptr) return false;
  bool& is_valid = table_is_valid_[index_of(side)];
  if (table.may_have_changed) {
    is_valid =
        kernels::entries_point_inside(table.entries, pixels_of(config_), config_.width, config_.height);
    if (is_valid) patterns_[index_of(side)].set_entries(table.entries);
  }
  return is_valid;
}

std::optional<memory::Port> DirectFrame::hazard_with(const AddressRange& words, bool write) const {
  for (std::size_t port = 0; port < kCorePortCount; ++port) {
    const bool is_exclusive = write || kPorts[port].write;
    if (is_exclusive && buffers_[port].overlaps(words)) return port;
  }
  return std::nullopt;
}

void DirectFrame::write(std::uint8_t* disparities) const {
  std::copy(disparities_.begin(), disparities_.end(), disparities);
}

std::optional<std::uint64_t> DirectFrame::answered() const {
  if (!has_pixels()) return std::nullopt;
  return static_cast<std::uint64_t>(
      std::count_if(disparities_.begin(), disparities_.end(),
                    [](std::uint8_t disparity) { return disparity != kernels::kInvalidDisparity; }));
}

}  // namespace stereotlm::fpga

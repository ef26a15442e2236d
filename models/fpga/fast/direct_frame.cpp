#include "models/fpga/fast/direct_frame.h"

#include <algorithm>

#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"

namespace stereotlm::fpga {
namespace {

std::size_t pixels_of(const CoreConfig& config) {
  return static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.height);
}

}  // namespace

DirectFrame::DirectFrame(const CoreConfig& config, bool has_pixels, memory::DirectBanks& banks)
    : config_(checked(config)),
      banks_(banks),
      patterns_{AccessPattern(FrameGeometry(config), config.pixel_cache),
                AccessPattern(FrameGeometry(config), config.pixel_cache)} {
  if (!has_pixels) return;
  pipeline_ = std::make_unique<kernels::StereoPipeline>(
      config.width, config.height,
      kernels::StereoConfig{config.window, config.disparities, config.filter, config.lr_tolerance,
                            config.cost});
  disparities_.resize(pixels_of(config));
}

void DirectFrame::set_buffers(const FrameBases& bases) {
  for (std::size_t group = 0; group < kCoreGroupCount; ++group) {
    if (!has_group(config_, group)) continue;
    const std::uint64_t first = registers::base_address(bases[group]);
    buffers_[group] = {first, first + pixels_of(config_) * kPortGroups[group].bytes_per_pixel};
  }
}

bool DirectFrame::disparities_are_apart() const {
  const AddressRange& disparities = buffers_[kResultGroup];
  return std::count_if(buffers_.begin(), buffers_.end(), [&disparities](const AddressRange& buffer) {
           return buffer.overlaps(disparities);
         }) == 1;  // itself
}

bool DirectFrame::read(const kernels::JointOffsets& offsets) {
  const unsigned char* const left = buffer(pixel_group(Side::kLeft));
  const unsigned char* const right = buffer(pixel_group(Side::kRight));
  const bool is_readable =
      read_tables(offsets) && left != nullptr && right != nullptr && buffer(kResultGroup) != nullptr;
  if (is_readable && pipeline_) pipeline_->run(left, right, entries_[0], entries_[1], disparities_.data());
  return is_readable;
}

// Reads both tables even if one is not readable: may_have_changed() reports a change only once.
bool DirectFrame::read_tables(const kernels::JointOffsets& offsets) {
  bool is_readable = true;
  for (const Side side : kSides) {
    const std::size_t group = lut_group(side);
    if (!has_group(config_, group)) continue;
    const auto* const entries = reinterpret_cast<const std::uint32_t*>(buffer(group));
    const bool may_have_changed =
        entries != nullptr && banks_.may_have_changed(group, buffers_[group].first, buffers_[group].end);
    if (config_.joint_tables) return decode_joint_table(entries, may_have_changed, offsets);
    if (!read_table(side, entries, may_have_changed)) is_readable = false;
  }
  return is_readable;
}

bool DirectFrame::decode_joint_table(const std::uint32_t* words, bool may_have_changed,
                                     const kernels::JointOffsets& offsets) {
  if (words == nullptr) return false;
  may_have_changed = may_have_changed || offsets != joint_offsets_ || joint_entries_[0].empty();
  if (may_have_changed) {
    joint_offsets_ = offsets;
    for (std::vector<std::uint32_t>& entries : joint_entries_) entries.resize(pixels_of(config_));
    std::size_t pixel = 0;
    for (int row = 0; row < config_.height; ++row) {
      for (int column = 0; column < config_.width; ++column, ++pixel) {
        joint_entries_[0][pixel] = kernels::left_entry(words[pixel], column, row, offsets);
        joint_entries_[1][pixel] = kernels::right_entry(words[pixel], column, row, offsets);
      }
    }
  }
  const bool left_is_readable = read_table(Side::kLeft, joint_entries_[0].data(), may_have_changed);
  return read_table(Side::kRight, joint_entries_[1].data(), may_have_changed) && left_is_readable;
}

bool DirectFrame::read_table(Side side, const std::uint32_t* entries, bool may_have_changed) {
  const std::size_t index = index_of(side);
  entries_[index] = entries;
  if (entries == nullptr) return false;
  bool& is_valid = table_is_valid_[index];
  if (may_have_changed) {
    is_valid = kernels::entries_point_inside(entries, pixels_of(config_), config_.width, config_.height);
    if (is_valid) patterns_[index].set_entries(entries);
  }
  return is_valid;
}

std::optional<std::size_t> DirectFrame::hazard_with(const AddressRange& words, bool write) const {
  for (std::size_t group = 0; group < kCoreGroupCount; ++group) {
    const bool is_exclusive = write || kPortGroups[group].write;
    if (is_exclusive && buffers_[group].overlaps(words)) return group;
  }
  return std::nullopt;
}

bool DirectFrame::write() const {
  if (pipeline_ == nullptr) return true;
  unsigned char* const disparities = buffer(kResultGroup);
  if (disparities == nullptr) return false;
  std::copy(disparities_.begin(), disparities_.end(), disparities);
  return true;
}

}  // namespace stereotlm::fpga

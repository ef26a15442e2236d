#include "models/fpga/fast/direct_frame.h"

#include <algorithm>

#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"

namespace stereotlm::fpga {
namespace {

std::size_t pixels_of(const CoreConfig& config) {
  return static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.height);
}

bool overlaps_any(const AddressRange& range, const std::vector<AddressRange>& others) {
  return std::any_of(others.begin(), others.end(),
                     [&range](const AddressRange& other) { return range.overlaps(other); });
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
  placements_ = placements_of(config_, bases);
  for (std::size_t group = 0; group < kCoreGroupCount; ++group) {
    buffers_[group].clear();
    if (!has_group(config_, group)) continue;
    const Placement& buffer = placements_[group];
    for (std::size_t part = 0; part < buffer.parts().size(); ++part) {
      const std::uint64_t first = registers::base_address(buffer.parts()[part]);
      const std::uint64_t words = buffer.rows_of_part(part, config_.height) * buffer.row_words();
      if (words != 0) buffers_[group].push_back({first, first + 4 * words});
    }
  }
}

bool DirectFrame::disparities_are_apart() const {
  for (std::size_t group = 0; group < kResultGroup; ++group) {
    for (const AddressRange& disparities : buffers_[kResultGroup]) {
      if (overlaps_any(disparities, buffers_[group])) return false;
    }
  }
  return true;
}

bool DirectFrame::is_direct(std::size_t group) const {
  for (std::size_t number = 0; number < buffers_[group].size(); ++number) {
    if (part(group, number) == nullptr) return false;
  }
  return true;
}

template <class Byte, class Visit>
void DirectFrame::for_each_row(std::size_t group, Byte* whole, const Visit& visit) const {
  const std::size_t parts = placements_[group].parts().size();
  const std::size_t bytes = 4 * placements_[group].row_words();
  for (std::size_t number = 0; number < buffers_[group].size(); ++number) {
    unsigned char* row = part(group, number);
    for (auto place = number; place < static_cast<std::size_t>(config_.height); place += parts, row += bytes)
      visit(row, whole + place * bytes);
  }
}

const unsigned char* DirectFrame::buffer(std::size_t group, bool may_have_changed) {
  if (!is_direct(group)) return nullptr;
  if (placements_[group].parts().size() == 1) return part(group, 0);
  std::vector<unsigned char>& collected = collected_[group];
  const std::size_t bytes = 4 * placements_[group].row_words();
  if (may_have_changed || collected.empty()) {
    collected.resize(bytes * static_cast<std::size_t>(config_.height));
    for_each_row(group, collected.data(),
                 [bytes](const unsigned char* row, unsigned char* to) { std::copy_n(row, bytes, to); });
  }
  return collected.data();
}

bool DirectFrame::read(const kernels::JointOffsets& offsets) {
  const std::size_t left = pixel_group(Side::kLeft);
  const std::size_t right = pixel_group(Side::kRight);
  const bool is_readable =
      read_tables(offsets) && is_direct(left) && is_direct(right) && is_direct(kResultGroup);
  if (is_readable && pipeline_) {
    const auto table = [this](std::size_t side) {
      return patterns_[side].is_identity() ? nullptr : entries_[side];
    };
    pipeline_->run(buffer(left, true), buffer(right, true), table(0), table(1), disparities_.data());
  }
  return is_readable;
}

// Reads both tables even if one is not readable: may_have_changed() reports a change only once.
bool DirectFrame::read_tables(const kernels::JointOffsets& offsets) {
  bool is_readable = true;
  for (const Side side : kSides) {
    const std::size_t group = lut_group(side);
    if (!has_group(config_, group)) continue;
    bool may_have_changed = false;
    for (std::size_t number = 0; is_direct(group) && number < buffers_[group].size(); ++number) {
      const AddressRange& range = buffers_[group][number];
      const std::size_t watch = group + number * kCoreGroupCount;
      may_have_changed = banks_.may_have_changed(watch, range.first, range.end) || may_have_changed;
    }
    const auto* const entries = reinterpret_cast<const std::uint32_t*>(buffer(group, may_have_changed));
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
    if (is_exclusive && overlaps_any(words, buffers_[group])) return group;
  }
  return std::nullopt;
}

bool DirectFrame::write() const {
  if (pipeline_ == nullptr) return true;
  if (!is_direct(kResultGroup)) return false;
  if (placements_[kResultGroup].parts().size() == 1) {
    std::copy(disparities_.begin(), disparities_.end(), part(kResultGroup, 0));
  } else {
    const std::size_t bytes = 4 * placements_[kResultGroup].row_words();
    for_each_row(kResultGroup, disparities_.data(),
                 [bytes](unsigned char* row, const std::uint8_t* from) { std::copy_n(from, bytes, row); });
  }
  return true;
}

}  // namespace stereotlm::fpga

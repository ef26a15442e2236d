#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "models/address_range.h"
#include "models/fpga/access_pattern.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_ports.h"
#include "models/kernels/joint_table.h"
#include "models/kernels/stereo_pipeline.h"
#include "models/memory/direct_banks.h"

namespace stereotlm::fpga {

// The data of a frame that works directly on memory: tables and pictures are read when the frame starts, and
// disparities are written back with its last write. Plain C++.
class DirectFrame {
 public:
  // `has_pixels`: whether disparities are computed. `banks` outlives this object. Throws
  // std::invalid_argument if the configuration has problems.
  DirectFrame(const CoreConfig& config, bool has_pixels, memory::DirectBanks& banks);

  // To be called when a frame starts: sets its buffers.
  void set_buffers(const FrameBases& bases);
  // Whether the buffer of the disparities overlaps no other buffer.
  bool disparities_are_apart() const;
  // Reads tables and pictures, and computes the disparities. Returns false if that cannot be done: direct
  // access is not granted, or an entry of a table points outside the image. `offsets`: without effect unless
  // the tables are joint.
  bool read(const kernels::JointOffsets& offsets);

  // Checks an access of another master to `words` while the frame runs. It is a hazard if it would observe
  // when the frame reads or writes its data. Returns the port group whose buffer it accesses if it is one,
  // else nothing.
  std::optional<std::size_t> hazard_with(const AddressRange& words, bool write) const;

  // The accesses of the frame's slots.
  const AccessPatterns& patterns() const { return patterns_; }
  // Writes the disparities of the frame to their buffer. Returns false if direct access is not granted any
  // more.
  bool write() const;

 private:
  // The buffer of a port group; null if direct access is not granted.
  unsigned char* buffer(std::size_t group) const {
    return banks_.direct(buffers_[group].first, buffers_[group].end - buffers_[group].first);
  }
  bool read_tables(const kernels::JointOffsets& offsets);
  bool decode_joint_table(const std::uint32_t* words, bool may_have_changed,
                          const kernels::JointOffsets& offsets);
  bool read_table(Side side, const std::uint32_t* entries, bool may_have_changed);

  CoreConfig config_;
  memory::DirectBanks& banks_;
  // [port group]: the buffer that it accesses; empty if there is none.
  std::array<AddressRange, kCoreGroupCount> buffers_{};
  AccessPatterns patterns_;
  // [side]: the entries of the frame; null if the side has no table.
  std::array<const std::uint32_t*, 2> entries_{};
  std::array<std::vector<std::uint32_t>, 2> joint_entries_;  // [side]: entries of joint tables
  kernels::JointOffsets joint_offsets_{};                    // with which they were decoded
  std::array<bool, 2> table_is_valid_{true, true};           // [side]: no entry points outside the image
  std::unique_ptr<kernels::StereoPipeline> pipeline_;
  std::vector<std::uint8_t> disparities_;
};

}  // namespace stereotlm::fpga

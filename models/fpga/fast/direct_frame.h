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
#include "models/fpga/placement.h"
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
  // The bytes of the part of a buffer, of its rows in their order; null if direct access is not granted.
  unsigned char* part(std::size_t group, std::size_t part) const {
    const AddressRange& range = buffers_[group][part];
    return banks_.direct(range.first, range.end - range.first);
  }
  // Whether direct access is granted to all parts of the buffer.
  bool is_direct(std::size_t group) const;
  // The buffer, row by row; null if direct access is not granted. `may_have_changed`: the rows of a striped
  // buffer are collected anew.
  const unsigned char* buffer(std::size_t group, bool may_have_changed);
  // Calls visit(bytes of the row in its part, bytes of the row in `whole`) for each row of a striped buffer.
  template <class Byte, class Visit>
  void for_each_row(std::size_t group, Byte* whole, const Visit& visit) const;
  bool read_tables(const kernels::JointOffsets& offsets);
  bool decode_joint_table(const std::uint32_t* words, bool may_have_changed,
                          const kernels::JointOffsets& offsets);
  bool read_table(Side side, const std::uint32_t* entries, bool may_have_changed);

  CoreConfig config_;
  memory::DirectBanks& banks_;
  Placements placements_;
  // [port group][part]: the buffer that it accesses; none if there is none.
  std::array<std::vector<AddressRange>, kCoreGroupCount> buffers_;
  std::array<std::vector<unsigned char>, kCoreGroupCount> collected_;  // striped buffers, row by row
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

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/fpga/register_map.h"
#include "models/memory/memory_config.h"

namespace stereotlm::fpga {

// The sides of the stereo rig: left 0, right 1.
enum class Side : std::uint8_t { kLeft, kRight };
inline constexpr std::array<Side, 2> kSides = {Side::kLeft, Side::kRight};
constexpr std::size_t index_of(Side side) { return static_cast<std::size_t>(side); }

// The stage behind a port.
enum class PortStage : std::uint8_t { kLutReader, kPixelReader, kResultWriter, kLocalBus };

// A port group: the ports of the FPGA on the SSRAM banks with the same stage and side. It has a port for each
// lane, or a single one. In a frame all ports of a group access one buffer, in one direction.
struct PortGroup {
  const char* name;                   // in board files, results and messages
  PortStage stage;                    // what the port serves
  Side side;                          // of readers; without meaning for other stages
  const char* buffer;                 // name of the buffer
  std::uint64_t base_register;        // register_map.h: bank and first word of the buffer
  std::uint64_t bytes_per_pixel;      // of the buffer
  bool write;                         // direction of all accesses
  bool (*exists)(const CoreConfig&);  // whether a core of this configuration has it
};

constexpr bool always(const CoreConfig& /*config*/) { return true; }  // for groups that every core has

// All port groups, in the order in which results list their ports. Masks, routes, buffers, blame, counts,
// board files and reports follow from this table. The groups of the core come first; the last one is the
// host's, which has no buffer of its own.
inline constexpr std::array kPortGroups = {
    PortGroup{"left_lut", PortStage::kLutReader, Side::kLeft, "left_lut", registers::kLeftLutBase, 4, false,
              [](const CoreConfig& config) { return config.left_table; }},
    PortGroup{"right_lut", PortStage::kLutReader, Side::kRight, "right_lut", registers::kRightLutBase, 4,
              false, [](const CoreConfig& config) { return config.right_table && !config.joint_tables; }},
    PortGroup{"left_pixel", PortStage::kPixelReader, Side::kLeft, "left_image", registers::kLeftImageBase, 1,
              false, always},
    PortGroup{"right_pixel", PortStage::kPixelReader, Side::kRight, "right_image", registers::kRightImageBase,
              1, false, always},
    PortGroup{"result", PortStage::kResultWriter, Side::kLeft, "disparity", registers::kDisparityBase, 1,
              true, always},
    PortGroup{"host", PortStage::kLocalBus, Side::kLeft, "", 0, 0, false, always},
};
inline constexpr std::size_t kGroupCount = kPortGroups.size();  // the groups of the core and that of the host
inline constexpr std::size_t kCoreGroupCount = kGroupCount - 1;  // the groups of the core

// Index of the port group of a stage; the side distinguishes the readers.
constexpr std::size_t group_of(PortStage stage, Side side = Side::kLeft) {
  std::size_t group = 0;
  while (kPortGroups[group].stage != stage || kPortGroups[group].side != side) ++group;
  return group;
}
// Port groups: of the readers of tables and of pixels, of the result writer, of the host.
constexpr std::size_t lut_group(Side side) { return group_of(PortStage::kLutReader, side); }
constexpr std::size_t pixel_group(Side side) { return group_of(PortStage::kPixelReader, side); }
inline constexpr std::size_t kResultGroup = group_of(PortStage::kResultWriter);
inline constexpr std::size_t kHostGroup = group_of(PortStage::kLocalBus);
static_assert(kHostGroup == kCoreGroupCount, "the host's group is the last one");

constexpr bool has_group(const CoreConfig& config, std::size_t group) {  // whether it exists
  return kPortGroups[group].exists(config);
}
constexpr bool has_table(const CoreConfig& config, Side side) {  // whether the side has a look-up table
  return side == Side::kLeft ? config.left_table : config.right_table;
}

// The ports of a core with this number of lanes on each side: those of each port group, one group after the
// other. With one lane, the index of a port is that of its group.
class CorePorts {
 public:
  // Throws std::invalid_argument outside kLanesRule.
  explicit CorePorts(int lanes) : lanes_(static_cast<std::size_t>(kLanesRule.required("lanes", lanes))) {}
  explicit CorePorts(const CoreConfig& config) : CorePorts(config.lanes) {}
  // With this core_size().
  static CorePorts of_core_size(std::size_t ports) {
    return CorePorts(static_cast<int>((ports - 1) / kReaderGroups));
  }

  std::size_t size() const { return core_size() + 1; }                  // ports, the host's included
  std::size_t core_size() const { return kReaderGroups * lanes_ + 1; }  // without the host's port
  std::size_t lanes() const { return lanes_; }                          // on each side
  // The ports of a lane: for its table, and for its picture.
  memory::Port lut(Side side, std::size_t lane) const { return lut_group(side) * lanes_ + lane; }
  memory::Port pixel(Side side, std::size_t lane) const { return pixel_group(side) * lanes_ + lane; }
  memory::Port result() const { return kReaderGroups * lanes_; }  // of the results
  memory::Port host() const { return core_size(); }               // port of the local bus
  // The only port of a group, or that of a lane.
  memory::Port port(std::size_t group, std::size_t lane = 0) const {
    return group < kReaderGroups ? group * lanes_ + lane : core_size() - (kHostGroup - group);
  }

  std::size_t group_of(memory::Port port) const {  // index of its port group
    return port < kReaderGroups * lanes_ ? port / lanes_ : kHostGroup - (host() - port);
  }
  const PortGroup& group(memory::Port port) const { return kPortGroups[group_of(port)]; }  // its port group
  // 0 for a port whose group has no other.
  std::size_t lane_of(memory::Port port) const { return port < result() ? port % lanes_ : 0; }
  // "left_lut", or with several lanes "left_lut.0".
  std::string name(memory::Port port) const {
    const std::string name = group(port).name;
    return lanes_ == 1 || port >= result() ? name : name + '.' + std::to_string(lane_of(port));
  }

 private:
  static constexpr std::size_t kReaderGroups = kResultGroup;

  std::size_t lanes_;
};
static_assert(kResultGroup == 4 && kResultGroup + 1 == kHostGroup, "the readers come first");
static_assert(4 * kLanesRule.max + 2 <= memory::kMostPorts);

// The arbiters of the paper's board, with a priority list of groups.
inline memory::ArbiterConfig core_arbiter() {
  return {"fixed_priority",
          {kHostGroup, kResultGroup, pixel_group(Side::kLeft), pixel_group(Side::kRight),
           lut_group(Side::kLeft), lut_group(Side::kRight)}};
}
// The arbiters of a core, from a priority list of groups: each stands for its ports, lane 0 first.
inline memory::ArbiterConfig arbiter_of_ports(const memory::ArbiterConfig& of_groups,
                                              const CorePorts& ports) {
  memory::ArbiterConfig arbiter = {of_groups.policy, {}};
  for (const std::size_t group : of_groups.priority) {
    const bool has_lanes = group < kResultGroup;
    for (std::size_t lane = 0; lane < (has_lanes ? ports.lanes() : 1); ++lane)
      arbiter.priority.push_back(ports.port(group, lane));
  }
  return arbiter;
}

// The base registers of one frame: for each port group of the core the bank and the first word of its buffer,
// as in register_map.h. Without meaning for a group that does not exist.
using FrameBases = std::array<std::uint32_t, kCoreGroupCount>;

// Bank and first word of each buffer of a board, as the base registers and the bridge's descriptors take
// them: bits 31..26 bank, 25..0 first word; of a striped buffer those of its first part. The buffers of a
// list are used in turn, frame by frame.
struct BufferBases {
  std::vector<std::uint32_t> left_images;           // a list, used in turn
  std::vector<std::uint32_t> right_images;          // as many as left_images
  std::vector<std::uint32_t> disparities;           // a list, used in turn
  std::optional<std::uint32_t> left_lut;            // nullopt: the side has no table of its own
  std::optional<std::uint32_t> right_lut;           // nullopt: the side has no table of its own
  std::vector<std::vector<std::uint32_t>> stripes;  // CoreConfig::stripes
  bool has_joint_tables = false;  // left_lut is one table for both sides; right_lut is nullopt

  // The base registers of frame number `frame`.
  FrameBases of_frame(std::uint64_t frame) const {
    const auto in_turn = [frame](const std::vector<std::uint32_t>& list) {
      return list[frame % list.size()];
    };
    return {left_lut.value_or(0), right_lut.value_or(0), in_turn(left_images), in_turn(right_images),
            in_turn(disparities)};
  }
};

}  // namespace stereotlm::fpga

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "models/fpga/core_config.h"
#include "models/fpga/register_map.h"
#include "models/memory/memory_config.h"

namespace stereotlm::fpga {

enum class Side : std::uint8_t { kLeft, kRight };
inline constexpr std::array<Side, 2> kSides = {Side::kLeft, Side::kRight};
constexpr std::size_t index_of(Side side) { return static_cast<std::size_t>(side); }

// The stage behind a port.
enum class PortStage : std::uint8_t { kLutReader, kPixelReader, kResultWriter, kLocalBus };

// A port of the FPGA on the SSRAM banks. In a frame a port of the core accesses one buffer, in one direction.
struct CorePort {
  const char* name;  // in board files, results and messages
  PortStage stage;
  Side side;                      // of a reader; without meaning for other stages
  const char* buffer;             // name of the buffer
  std::uint64_t base_register;    // register_map.h: bank and first word of the buffer
  std::uint64_t bytes_per_pixel;  // of the buffer
  bool write;                     // direction of all accesses
  bool (*exists)(const CoreConfig&);
};

constexpr bool always(const CoreConfig& /*config*/) { return true; }

// All ports, in the order in which results list them. Masks, routes, buffers, blame, counts, board files and
// reports follow from this table. The core's own ports come first; the last one is the host's, which has no
// buffer of its own.
inline constexpr std::array kPorts = {
    CorePort{"left_lut", PortStage::kLutReader, Side::kLeft, "left_lut", registers::kLeftLutBase, 4, false,
             [](const CoreConfig& config) { return config.left_table; }},
    CorePort{"right_lut", PortStage::kLutReader, Side::kRight, "right_lut", registers::kRightLutBase, 4,
             false, [](const CoreConfig& config) { return config.right_table && !config.joint_tables; }},
    CorePort{"left_pixel", PortStage::kPixelReader, Side::kLeft, "left_image", registers::kLeftImageBase, 1,
             false, always},
    CorePort{"right_pixel", PortStage::kPixelReader, Side::kRight, "right_image", registers::kRightImageBase,
             1, false, always},
    CorePort{"result", PortStage::kResultWriter, Side::kLeft, "disparity", registers::kDisparityBase, 1, true,
             always},
    CorePort{"host", PortStage::kLocalBus, Side::kLeft, "", 0, 0, false, always},
};
inline constexpr std::size_t kPortCount = kPorts.size();
inline constexpr std::size_t kCorePortCount = kPortCount - 1;
static_assert(kPortCount <= memory::kMostPorts);

// Index of the port of a stage; the side distinguishes the readers.
constexpr memory::Port port_of(PortStage stage, Side side = Side::kLeft) {
  memory::Port port = 0;
  while (kPorts[port].stage != stage || kPorts[port].side != side) ++port;
  return port;
}
inline constexpr std::array<memory::Port, 2> kLutPorts = {port_of(PortStage::kLutReader, Side::kLeft),
                                                          port_of(PortStage::kLutReader, Side::kRight)};
inline constexpr std::array<memory::Port, 2> kPixelPorts = {port_of(PortStage::kPixelReader, Side::kLeft),
                                                            port_of(PortStage::kPixelReader, Side::kRight)};
inline constexpr memory::Port kResultPort = port_of(PortStage::kResultWriter);
inline constexpr memory::Port kHostPort = port_of(PortStage::kLocalBus);
static_assert(kHostPort == kCorePortCount, "the host's port is the last one");

constexpr memory::Port lut_port(Side side) { return kLutPorts[index_of(side)]; }
constexpr memory::Port pixel_port(Side side) { return kPixelPorts[index_of(side)]; }
constexpr bool has_port(const CoreConfig& config, memory::Port port) { return kPorts[port].exists(config); }
constexpr bool has_table(const CoreConfig& config, Side side) {
  return side == Side::kLeft ? config.left_table : config.right_table;
}

// The arbiters of the paper's board.
inline memory::ArbiterConfig core_arbiter() {
  return {"fixed_priority",
          {kHostPort, kResultPort, kPixelPorts[0], kPixelPorts[1], kLutPorts[0], kLutPorts[1]}};
}

// The base registers of one frame: for each port of the core the bank and the first word of its buffer, as in
// register_map.h. Without meaning for a port that does not exist.
using FrameBases = std::array<std::uint32_t, kCorePortCount>;

}  // namespace stereotlm::fpga

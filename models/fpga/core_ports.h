#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/fpga/register_map.h"
#include "models/kernels/words.h"
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

// Bank and first word of each buffer of a board, as the base registers and the bridge's descriptors take
// them: bits 31..26 bank, 25..0 first word. The buffers of a list are used in turn, frame by frame.
struct BufferBases {
  std::vector<std::uint32_t> left_images;
  std::vector<std::uint32_t> right_images;  // as many as left_images
  std::vector<std::uint32_t> disparities;
  std::optional<std::uint32_t> left_lut;  // nullopt: the side has no table of its own
  std::optional<std::uint32_t> right_lut;
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

// Byte addresses in the buffers of a frame, relative to the first byte of the buffer (contract section 1).
//
// The entry of a pixel in a look-up table. Pixels are counted row by row.
constexpr std::uint64_t entry_offset(std::uint64_t pixel) { return 4 * pixel; }
// The word of a picture that holds a pixel.
constexpr std::uint64_t pixel_word_offset(std::uint64_t pixel) { return pixel / kernels::kPixelsPerWord * 4; }
// A word of the disparities. Words are counted row by row.
constexpr std::uint64_t result_word_offset(std::uint64_t place) { return 4 * place; }

}  // namespace stereotlm::fpga

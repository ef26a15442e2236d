#include "platform/config/computer_parts.h"

#include <cmath>

#include "models/capture/capture_registers.h"
#include "models/fpga/local_bus_control.h"
#include "models/pci/bridge_registers.h"
#include "platform/config/buffer_layout.h"
#include "platform/config/device_map.h"

namespace stereotlm::platform {

// The registers of the capture boards have as many wait clocks as the bridge.
pci::PciBusConfig pci_config(const BoardConfig& board, std::uint64_t host_memory_bytes) {
  const DeviceMap map;
  const auto window = [](std::uint64_t base, std::uint64_t bytes, int wait_clocks) {
    return pci::PciWindow{static_cast<std::uint32_t>(base), static_cast<std::uint32_t>(bytes), wait_clocks};
  };
  const int bridge_wait = board.pci.bridge_wait_clocks;
  pci::PciBusConfig config;
  config.clock_mhz = board.pci.clock_mhz;
  config.latency_timer_clocks = board.pci.latency_timer_clocks;
  config.width_bits = board.pci.width_bits;
  config.masters.assign(kPciMasterNames.begin(), kPciMasterNames.begin() + kTrafficGenerator);
  config.windows = {window(map.host_memory, host_memory_bytes, board.pci.memory_wait_clocks),
                    window(map.bridge_slave, pci::bridge::kSlaveWindowBytes, bridge_wait),
                    window(map.bridge_registers, pci::bridge::kRegisterWindowBytes, bridge_wait),
                    window(map.left_capture, capture::registers::kEnd, bridge_wait),
                    window(map.right_capture, capture::registers::kEnd, bridge_wait)};
  if (board.pci.load) {
    config.masters.emplace_back(kPciMasterNames[kTrafficGenerator]);
    config.windows.push_back(
        window(map.traffic_generator, 4 * static_cast<std::uint64_t>(board.pci.load->burst_words), 0));
  }
  return config;
}

std::optional<pci::TrafficGeneratorConfig> traffic_config(const BoardConfig& board) {
  const std::optional<PciLoadConfig>& load = board.pci.load;
  if (!load) return std::nullopt;
  const auto ps = [](double us) { return static_cast<std::uint64_t>(std::llround(us * 1e6)); };
  return pci::TrafficGeneratorConfig{static_cast<std::uint32_t>(DeviceMap().traffic_generator),
                                     load->burst_words, ps(load->first_us), ps(load->interval_us),
                                     ps(load->access_us)};
}

pci::PciBridgeConfig bridge_config(const BoardConfig& board) {
  return {board.bridge.dma_burst_words, board.bridge.posted_words, fpga::kLocalRegisters,
          buffer_ranges(board), static_cast<std::uint64_t>(board.image.width)};
}

capture::CameraConfig camera_config(const BoardConfig& board) {
  return {board.image.width, board.image.height, board.cameras.frame_rate_hz, board.cameras.trigger};
}

capture::CaptureBoardConfig capture_config(const BoardConfig& board) {
  return {board.capture.fifo_words, board.capture.fifo_trigger_words};
}

}  // namespace stereotlm::platform

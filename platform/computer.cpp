#include "platform/computer.h"

#include <cmath>

#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

enum Window : std::size_t {
  kHostMemory,
  kBridgeSlave,
  kBridgeRegisters,
  kLeftRegisters,
  kRightRegisters,
  kTrafficDevice
};
enum Interrupt : std::size_t { kBridgeInterrupt, kLeftInterrupt, kRightInterrupt, kInterruptCount };

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
  config.masters = {"host", "left_capture", "right_capture", "bridge"};
  config.windows = {window(map.host_memory, host_memory_bytes, board.pci.memory_wait_clocks),
                    window(map.bridge_slave, pci::bridge::kSlaveWindowBytes, bridge_wait),
                    window(map.bridge_registers, pci::bridge::kRegisterWindowBytes, bridge_wait),
                    window(map.left_capture, capture::registers::kEnd, bridge_wait),
                    window(map.right_capture, capture::registers::kEnd, bridge_wait)};
  if (board.pci.load) {
    config.masters.emplace_back("load");
    config.windows.push_back(
        window(map.traffic_generator, 4 * static_cast<std::uint64_t>(board.pci.load->burst_words), 0));
  }
  return config;
}

std::unique_ptr<pci::TrafficGenerator> make_traffic_generator(const std::optional<PciLoadConfig>& load) {
  if (!load) return nullptr;
  const auto ps = [](double us) { return static_cast<std::uint64_t>(std::llround(us * 1e6)); };
  const pci::TrafficGeneratorConfig config = {static_cast<std::uint32_t>(DeviceMap().traffic_generator),
                                              load->burst_words, ps(load->first_us), ps(load->interval_us),
                                              ps(load->access_us)};
  return std::make_unique<pci::TrafficGenerator>("load", config);
}

pci::PciBridgeConfig bridge_config(const BoardConfig& board) {
  return {board.bridge.dma_burst_words, board.bridge.posted_words, fpga::kLocalRegisters,
          buffer_ranges(board)};
}

capture::CameraConfig camera_config(const BoardConfig& board) {
  return {board.image.width, board.image.height, board.cameras.frame_rate_hz, board.cameras.trigger};
}

capture::CaptureBoardConfig capture_config(const BoardConfig& board) {
  return {board.capture.fifo_words, board.capture.fifo_trigger_words};
}

}  // namespace

Computer::Computer(const sc_core::sc_module_name& name, const BoardConfig& config,
                   std::uint64_t host_memory_bytes, host::Program& program, capture::CameraSource& left,
                   capture::CameraSource& right, Binder& binder, fpga::Fidelity fidelity)
    : sc_module(name),
      board("board", config, binder, fidelity),
      pci_bus("pci_bus", pci_config(config, host_memory_bytes)),
      bridge("bridge", bridge_config(config)),
      host_memory("host_memory", host_memory_bytes),
      host_bridge("host_bridge"),
      cpu("cpu", {kInterruptCount, DeviceMap().host_memory}, program),
      left_camera("left_camera", camera_config(config), left),
      right_camera("right_camera", camera_config(config), right),
      left_capture("left_capture", capture_config(config)),
      right_capture("right_capture", capture_config(config)),
      traffic_generator(make_traffic_generator(config.pci.load)) {
  bind_pci(binder);
  bind_capture();
  binder.bind(cpu.bus, host_bridge.cpu, "cpu_to_host_bridge");
  binder.bind(cpu.host_memory, host_memory.port, "cpu_to_host_memory");
  binder.bind(bridge.local, board.core.local_bus, "bridge_to_local_bus");
  board.core.done(done_);
  bridge.doorbell(done_);
  cpu.interrupts[kBridgeInterrupt].bind(bridge.interrupt);
  cpu.interrupts[kLeftInterrupt].bind(left_capture.interrupt);
  cpu.interrupts[kRightInterrupt].bind(right_capture.interrupt);
}

void Computer::bind_pci(Binder& binder) {
  host_bridge.pci.bind(pci_bus.slots[kHost]);
  left_capture.pci.bind(pci_bus.slots[kLeftCapture]);
  right_capture.pci.bind(pci_bus.slots[kRightCapture]);
  bridge.pci.bind(pci_bus.slots[kBridge]);
  binder.bind(pci_bus.targets[kHostMemory], host_memory.port, "pci_to_host_memory");
  binder.bind(pci_bus.targets[kBridgeSlave], bridge.slave, "pci_to_bridge_slave");
  binder.bind(pci_bus.targets[kBridgeRegisters], bridge.registers, "pci_to_bridge_registers");
  binder.bind(pci_bus.targets[kLeftRegisters], left_capture.registers, "pci_to_left_capture");
  binder.bind(pci_bus.targets[kRightRegisters], right_capture.registers, "pci_to_right_capture");
  pci_bus.stops[kBridgeSlave].bind(bridge.stop);
  if (traffic_generator) {
    traffic_generator->pci.bind(pci_bus.slots[kTrafficGenerator]);
    binder.bind(pci_bus.targets[kTrafficDevice], traffic_generator->device, "pci_to_load");
  }
}

void Computer::bind_capture() {
  const auto bind = [](capture::Camera& camera, capture::CaptureBoard& grabber) {
    camera.frames_out.bind(grabber.frames_in);
    camera.lines_out.bind(grabber.lines_in);
    grabber.takes_out.bind(camera.takes_in);
  };
  bind(left_camera, left_capture);
  bind(right_camera, right_capture);
  // The trigger of the left capture board starts both cameras.
  left_capture.triggers_out.bind(left_camera.triggers_in);
  left_capture.triggers_out.bind(right_camera.triggers_in);
  left_capture.partner.bind(right_capture.as_partner);
  right_capture.partner.bind(left_capture.as_partner);
}

}  // namespace stereotlm::platform

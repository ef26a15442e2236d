#include "platform/assembly/computer.h"

#include "platform/config/computer_parts.h"

namespace stereotlm::platform {

constexpr std::size_t kInterrupts = 3;  // of the bridge and of both capture boards

Computer::Computer(const sc_core::sc_module_name& name, const BoardConfig& config,
                   std::uint64_t host_memory_bytes, host::Program& program, capture::CameraSource& left,
                   capture::CameraSource& right, Binder& binder, fpga::Fidelity fidelity)
    : sc_module(name),
      board("board", config, binder, fidelity),
      pci_bus("pci_bus", pci_config(config, host_memory_bytes)),
      bridge("bridge", bridge_config(config)),
      host_memory("host_memory", host_memory_bytes),
      host_bridge("host_bridge"),
      cpu("cpu", {kInterrupts, DeviceMap().host_memory}, program),
      left_camera("left_camera", camera_config(config), left),
      right_camera("right_camera", camera_config(config), right),
      left_capture("left_capture", capture_config(config)),
      right_capture("right_capture", capture_config(config)) {
  if (const auto traffic = traffic_config(config))
    traffic_generator = std::make_unique<pci::TrafficGenerator>("load", *traffic);
  bind_pci(binder);
  bind_capture();
  binder.bind(cpu.bus, host_bridge.cpu, "cpu_to_host_bridge");
  binder.bind(cpu.host_memory, host_memory.port, "cpu_to_host_memory");
  binder.bind(bridge.local, board.core.local_bus, "bridge_to_local_bus");
  board.core.done(done_);
  bridge.doorbell(done_);
  cpu.interrupts[0].bind(bridge.interrupt);
  cpu.interrupts[1].bind(left_capture.interrupt);
  cpu.interrupts[2].bind(right_capture.interrupt);
}

ComputerControls Computer::controls() {
  return {pci_bus.control(),
          bridge.control(),
          board.core.local_bus_port().control(),
          board.core.frames(),
          {&left_capture.control(), &right_capture.control()},
          {&left_camera.control(), &right_camera.control()}};
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
    grabber.camera.bind(camera.link);
  };
  bind(left_camera, left_capture);
  bind(right_camera, right_capture);
  // The trigger of the left capture board starts both cameras.
  left_capture.triggered.bind(left_camera.link);
  left_capture.triggered.bind(right_camera.link);
  left_capture.partner.bind(right_capture.as_partner);
  right_capture.partner.bind(left_capture.as_partner);
}

}  // namespace stereotlm::platform

#pragma once

#include <cstdint>
#include <string>
#include <systemc>
#include <tlm>

#include "models/binder.h"
#include "models/clock.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_datapath.h"
#include "models/fpga/fast/fast_core.h"
#include "models/fpga/frame_run.h"
#include "models/fpga/host_port.h"
#include "models/fpga/local_bus.h"
#include "models/fpga/register_file.h"
#include "models/kernel_time.h"
#include "models/memory/crossbar.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The configuration of a StereoCore.
struct StereoCoreConfig {
  CoreConfig core;                                       // configuration of the stages
  memory::CrossbarConfig memory = {core_arbiter(), {}};  // arbiters and banks
  LocalBusConfig local_bus;                              // clock and counted buffers
  Fidelity fidelity = Fidelity::kCycle;                  // how frames are simulated
  std::uint64_t stall_timeout_cycles = std::uint64_t{1}
                                       << 26U;  // cycles without progress after which a frame stalls
};

// The whole FPGA (paper figures 5 and 6): the stages, the crossbar in front of the SSRAM banks, the local
// bus, the register file, and the one clocked process that steps them. Stages exchange data through streams,
// reach memory through the crossbar's sockets, and move data when CoreControl decides so.
//
// At Fidelity::kCycle the process runs ahead of the kernel, up to the next pending event and by at most 8192
// cycles (also past the end of an sc_start()); every access carries its own time. The process sleeps while no
// frame runs and no word waits at the local bus.
//
// At the other fidelities the process fast-forwards (FastCore), and a frame works directly on memory:
// - A hazard is reported with SC_REPORT_ERROR (type /stereotlm/core). Where errors are not thrown, the frame
//   ends with the error flag of register_map.h.
// - A frame is stepped cycle by cycle if memory grants no direct access, if its buffers overlap, if its
//   tables point outside the image, or if it begins within a burst that is a hazard.
// - If only the local bus can start a frame, all words of a burst are in place with the first one.
//
// A frame stalls if for stall_timeout_cycles the matcher works in no cycle and no result is written: the
// arbiters never grant one of its ports. The stall is reported with SC_REPORT_ERROR (type /stereotlm/core),
// at most 8192 cycles late at Fidelity::kCycle, at most 2^22 at the others.
class StereoCore : public sc_core::sc_module, private FastCore::Board {
 public:
  // The registers of register_map.h, accessed without the local bus and without its time; may stay unbound.
  tlm::tlm_target_socket<32, tlm::tlm_base_protocol_types, 1, sc_core::SC_ZERO_OR_MORE_BOUND> registers{
      "registers"};
  tlm::tlm_target_socket<32> local_bus{"local_bus"};        // local_bus.h: the banks and the registers
  sc_core::sc_vector<tlm::tlm_initiator_socket<32>> banks;  // in the order of the configuration
  sc_core::sc_out<bool> done{"done"};                       // interrupt

  // `binder` binds the stages to the crossbar. Throws std::invalid_argument if the configuration has
  // problems, if the banks have another clock than the core, or if the arbiters do not have all ports.
  StereoCore(const sc_core::sc_module_name& name, const StereoCoreConfig& config, Binder& binder);

  Fidelity fidelity() const { return config_.fidelity; }                // the configured fidelity
  const memory::Crossbar& crossbar() const { return crossbar_; }        // between the stages and the banks
  const CoreDatapath& datapath() const { return datapath_; }            // the modules of the stages
  const HostPort& host_port() const { return host_port_; }              // of the local bus
  const Clock& clock() const { return clock_; }                         // of the core and of the banks
  const RegisterFile& register_file() const { return register_file_; }  // registers of the core
  LocalBus& local_bus_port() { return local_bus_; }                     // the core's end of the local bus
  const LocalBus& local_bus_port() const { return local_bus_; }         // the core's end of the local bus
  // The frames, to observe and to record them.
  FrameRun& frames() { return frames_; }
  const FrameRun& frames() const { return frames_; }
  const CoreControl& control() const { return frames_.control(); }
  // Frames that were stepped cycle by cycle, at any fidelity.
  std::uint64_t stepped_frames() const { return stepped_frames_; }

  // Advances control() to the present, for observers of a running frame.
  void catch_up();

 private:
  void end_of_elaboration() override { host_port_.set_only_master(registers.size() == 0); }

  void start_frame(const FrameStart& start);
  void route_host(const HostRoute& route);

  std::uint64_t horizon_ps() const override;
  void frame_ended(bool failed) override;
  void failed(const std::string& why) override;
  void stalled(std::uint64_t cycles) override;

  void run();
  bool fast_forwards() const;
  void fast_forward();
  void run_cycles();
  bool step(std::uint64_t edge_ps, const sc_core::sc_time& at);
  bool host_reads_where_core_writes(memory::PortMask granted) const;
  void wait_until(std::uint64_t time_ps) { wait(kernel_time::to_time(time_ps) - sc_core::sc_time_stamp()); }
  void wait_for_request_until(std::uint64_t time_ps);

  StereoCoreConfig config_;
  Clock clock_;
  CorePorts ports_;
  memory::Crossbar crossbar_;
  FrameRun frames_{config_.core, config_.memory.banks, crossbar_.arbitration(), config_.stall_timeout_cycles};
  RegisterFile register_file_{"register_file"};
  LocalBus local_bus_{"local_bus_port", config_.local_bus, config_.memory.banks.size()};
  CoreDatapath datapath_;
  HostPort host_port_{local_bus_.control(), crossbar_, crossbar_.arbitration(), frames_, clock_};
  FastCore fast_core_{config_.core,
                      has_pixels(config_.fidelity),
                      frames_,
                      host_port_,
                      local_bus_.control(),
                      crossbar_,
                      clock_,
                      *this};
  StreamIn<FrameStart, StereoCore, &StereoCore::start_frame> start_in_{"start_in", this};
  StreamIn<HostRoute, StereoCore, &StereoCore::route_host> route_in_{"route_in", this};

  bool is_direct_ = false;           // the frame that was started last works directly on memory
  std::uint64_t errors_before_ = 0;  // refused accesses before that frame
  std::uint64_t stepped_frames_ = 0;
  sc_core::sc_event start_event_{"start_event"};
};

}  // namespace stereotlm::fpga

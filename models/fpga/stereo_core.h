#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <systemc>
#include <tlm>
#include <utility>
#include <vector>

#include "models/binder.h"
#include "models/clock.h"
#include "models/fpga/access_pattern.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_control.h"
#include "models/fpga/core_timing.h"
#include "models/fpga/fidelity.h"
#include "models/fpga/local_bus.h"
#include "models/fpga/log_filter.h"
#include "models/fpga/lr_check.h"
#include "models/fpga/lut_reader.h"
#include "models/fpga/pixel_reader.h"
#include "models/fpga/register_file.h"
#include "models/fpga/result_packer.h"
#include "models/fpga/result_writer.h"
#include "models/fpga/row_buffer.h"
#include "models/fpga/row_profile.h"
#include "models/fpga/sad_array.h"
#include "models/fpga/select_min_chain.h"
#include "models/fpga/select_min_tree.h"
#include "models/fpga/sequencer.h"
#include "models/kernels/stereo_pipeline.h"
#include "models/memory/crossbar.h"
#include "models/stream.h"
#include "models/words_by_range.h"

namespace stereotlm::fpga {

struct StereoCoreConfig {
  CoreConfig core;
  memory::CrossbarConfig memory;
  LocalBusConfig local_bus;
  Fidelity fidelity = Fidelity::kCycle;
  std::uint64_t stall_timeout_cycles = std::uint64_t{1} << 26U;  // of a frame that makes no progress
};

// The whole FPGA (paper figures 5 and 6): the stages, the crossbar in front of the SSRAM banks, the register
// file, and the one clocked process that steps them. Stages exchange data through streams, reach memory
// through the crossbar's sockets, and move when CoreControl says so.
//
// At Fidelity::kCycle the process runs ahead of the kernel, up to the next pending event and by at most 8192
// cycles (also past the end of an sc_start()); every access carries its own time. The process sleeps while no
// frame runs and no word waits at the local bus.
//
// At the other fidelities the process fast-forwards. It advances a frame only when a word at the local bus
// contends for a bank of the frame, and when the frame may have ended. The frame works directly on memory:
// - It reads pictures and tables at the start strobe.
// - It writes the disparities with the last write, or early, but never before a pending event that could
//   observe them.
// - A burst of the local bus that would observe the difference is a hazard: it writes what the frame reads,
//   or touches the disparities. It is reported with SC_REPORT_ERROR (type /stereotlm/core). Where errors are
//   not thrown, the frame ends with the error flag of register_map.h.
// - A frame is stepped cycle by cycle if memory grants no direct access, if its buffers overlap, if its
//   tables point outside the image, or if it begins within a burst that is a hazard. If only the local bus
//   can start a frame, all words of a burst are in place with the first one.
//
// A frame stalls if no slot is consumed and no result is written for stall_timeout_cycles: the arbiters never
// grant one of its ports. The stall is reported with SC_REPORT_ERROR (type /stereotlm/core), at most 8192
// cycles late at Fidelity::kCycle, at most 2^22 at the others.
class StereoCore : public sc_core::sc_module {
 public:
  // register_map.h, without the local bus and its time; may stay unbound.
  tlm::tlm_target_socket<32, tlm::tlm_base_protocol_types, 1, sc_core::SC_ZERO_OR_MORE_BOUND> registers{
      "registers"};
  tlm::tlm_target_socket<32> local_bus{"local_bus"};        // local_bus.h: the banks and the registers
  sc_core::sc_vector<tlm::tlm_initiator_socket<32>> banks;  // in the order of the configuration
  sc_core::sc_out<bool> done{"done"};                       // interrupt

  // `binder` binds the stages to the crossbar. Throws std::invalid_argument if the configuration has
  // problems, or the banks another clock than the core.
  StereoCore(const sc_core::sc_module_name& name, const StereoCoreConfig& config, Binder& binder);

  const CoreControl& control() const { return timing_.control(); }
  Fidelity fidelity() const { return config_.fidelity; }
  const memory::Crossbar& crossbar() const { return crossbar_; }
  // frame_cycles of every finished frame.
  const std::vector<std::uint64_t>& frame_cycles() const { return frame_cycles_; }
  // Cycle 0 of the frame that was started last, in cycles of the clock from time 0.
  std::uint64_t first_cycle() const { return first_cycle_; }
  // From the next frame on, records when each row of results is complete. take_rows() returns the frames
  // finished since its last call; the caller takes them regularly, or they fill memory.
  void record_rows() { timing_.rows().turn_on(); }
  std::vector<RowProfile> take_rows() { return std::exchange(row_profiles_, {}); }
  // Frames that were stepped cycle by cycle, at any fidelity.
  std::uint64_t stepped_frames() const { return stepped_frames_; }
  // Which bank each port requests, and to which port it has lost that bank most often.
  std::string waits() const;
  // Brings control() up to the present, for observers of a running frame. Provisional until a burst contends
  // for a bank of the frame, or the frame ends:
  // - A pass on an uncontended pixel port counts as a grant, in the arbiters' reads too, and waits() shows it
  //   as a request.
  // - Words of a burst for an uncontended bank count as idle cycles of the host port.
  void catch_up();

  // The stages, for their statistics. A LUT reader or row buffer that the configuration does not need is
  // null.
  const Sequencer& sequencer() const { return sequencer_; }
  const LutReader* left_lut_reader() const { return left_lut_.get(); }
  const LutReader* right_lut_reader() const { return right_lut_.get(); }
  const PixelReader& left_pixel_reader() const { return left_pixel_; }
  const PixelReader& right_pixel_reader() const { return right_pixel_; }
  const LogFilter& left_filter() const { return left_filter_; }
  const LogFilter& right_filter() const { return right_filter_; }
  const RowBuffer* left_row_buffer() const { return left_rows_.get(); }
  const RowBuffer* right_row_buffer() const { return right_rows_.get(); }
  const SadArray& sad_array() const { return sad_array_; }
  const SelectMinChain& select_min_chain() const { return select_min_chain_; }
  const SelectMinTree& select_min_tree() const { return select_min_tree_; }
  const LrCheck& lr_check() const { return lr_check_; }
  const ResultPacker& result_packer() const { return result_packer_; }
  const ResultWriter& result_writer() const { return result_writer_; }
  const RegisterFile& register_file() const { return register_file_; }
  const LocalBus& local_bus_port() const { return local_bus_; }

 private:
  enum class State { kIdle, kRunning, kFinishing };

  void bind_memory(Binder& binder);
  void bind_streams();
  void start_frame(const FrameStart& start);
  void route_host(const HostRoute& route);
  bool has_bank(std::uint32_t base) const;
  int latency_of(std::uint32_t base) const;

  using Buffers =
      std::array<AddressRange, memory::kPortCount>;  // [port that uses it]; empty if there is none
  Buffers buffers_of(const FrameStart& start) const;
  const AddressRange& buffer_of(memory::Port port) const { return buffers_[memory::index_of(port)]; }
  bool read_frame();
  const std::uint32_t* read_table(LutReader& reader, memory::Port port, AccessPattern& pattern,
                                  bool& is_valid);
  bool buffers_are_apart() const;
  void write_frame();
  void count_frame(std::uint64_t answered);
  std::optional<memory::Port> hazard_with(const HostRoute& route) const;
  void check_burst(const HostRoute& route);
  void fail(const std::string& text);

  void run();
  bool fast_forwards() const;
  void check_progress();
  void run_ahead();
  void fast_forward();
  bool nobody_else_starts() const { return registers.size() == 0; }
  bool host_contends() const;
  void serve_contended();
  void serve_uncontended(std::uint64_t now_ps);
  void move_burst();
  void serve_word(std::uint64_t cycle, std::uint64_t edge_ps, std::uint64_t now_ps);
  void serve_in_step(std::uint64_t first_cycle);
  void count_served(std::uint64_t end_cycle, bool in_frame);
  void finish_cycles(std::uint64_t end_cycle);
  void finish_frame(std::uint64_t now_ps);
  bool step(std::uint64_t edge_ps, const sc_core::sc_time& at);
  void move(const CoreControl::Decision& decision, memory::PortMask granted, const sc_core::sc_time& at);
  void join_host();
  bool access_host(std::uint64_t cycle, const sc_core::sc_time& at);
  void end_frame();
  std::uint64_t access_errors() const;

  StereoCoreConfig config_;
  Clock clock_;
  std::uint64_t period_ps_;
  sc_core::sc_time period_;
  memory::Crossbar crossbar_{"crossbar", config_.memory};
  CoreTiming timing_{config_.core, crossbar_.arbitration()};
  RegisterFile register_file_{"register_file"};
  LocalBus local_bus_{"local_bus_port", config_.local_bus, config_.memory.banks.size()};
  Sequencer sequencer_{"sequencer"};
  std::unique_ptr<LutReader> left_lut_;
  std::unique_ptr<LutReader> right_lut_;
  PixelReader left_pixel_{"left_pixel", config_.core.width};
  PixelReader right_pixel_{"right_pixel", config_.core.width};
  LogFilter left_filter_{"left_filter", config_.core};
  LogFilter right_filter_{"right_filter", config_.core};
  std::unique_ptr<RowBuffer> left_rows_;
  std::unique_ptr<RowBuffer> right_rows_;
  SadArray sad_array_{"sad_array", config_.core};
  SelectMinChain select_min_chain_{"select_min_chain", config_.core.disparities};
  SelectMinTree select_min_tree_{"select_min_tree"};
  LrCheck lr_check_{"lr_check", config_.core};
  ResultPacker result_packer_{"result_packer"};
  ResultWriter result_writer_{"result_writer", config_.core.result_fifo_words};
  StreamIn<FrameStart, StereoCore, &StereoCore::start_frame> start_in_{"start_in", this};
  StreamIn<HostRoute, StereoCore, &StereoCore::route_host> route_in_{"route_in", this};

  State state_ = State::kIdle;
  std::uint64_t cycle_ = 0;        // of the clock, the next to run
  std::uint64_t first_cycle_ = 0;  // of the running frame
  std::uint64_t done_cycle_ = 0;   // the first after the finishing frame
  std::uint64_t work_ = 0;         // done by the last check of progress
  std::uint64_t work_cycle_ = 0;   // of the check that found some
  std::uint64_t errors_before_ = 0;
  HostRoute host_route_;                 // of the burst on the local bus
  bool host_is_routed_ = false;          // the host port takes part in the arbitration
  std::uint64_t host_read_latency_ = 2;  // cycles, of the host's bank

  // The other fidelities.
  bool direct_frame_ = false;  // the running frame works directly on memory
  bool failed_ = false;        // its result may differ from that at Fidelity::kCycle
  std::uint64_t stepped_frames_ = 0;
  std::uint64_t writes_before_ = 0;  // writes granted to the result port before the running frame
  std::uint64_t next_check_ps_ = 0;  // the running frame cannot have ended before
  AccessPattern left_pattern_{FrameGeometry(config_.core)};
  AccessPattern right_pattern_{FrameGeometry(config_.core)};
  bool left_table_is_valid_ = true;
  bool right_table_is_valid_ = true;
  Buffers buffers_;  // of the running frame
  std::unique_ptr<kernels::StereoPipeline> pipeline_;
  std::vector<std::uint8_t> disparities_;  // of the running frame
  bool burst_is_moved_ = false;  // the data of the burst is in place; its words are still to be counted
  // Words of the local bus that were served in an uncontended bank, until it is known in which cycles the
  // running frame ends.
  struct Served {
    std::uint64_t cycle;
    std::uint64_t cycles;  // number of cycles, from `cycle` on
    memory::BankArbiter::Outcome outcome;
  };
  std::vector<Served> served_;
  std::size_t served_bank_ = 0;
  sc_core::sc_event start_event_{"start_event"};
  std::vector<std::uint64_t> frame_cycles_;
  std::vector<RowProfile> row_profiles_;  // not yet taken
};

}  // namespace stereotlm::fpga

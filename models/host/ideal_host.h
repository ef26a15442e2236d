#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <cstdint>
#include <optional>
#include <systemc>
#include <vector>

#include "models/fpga/core_ports.h"
#include "models/host/frame_source.h"
#include "models/kernels/gray_image.h"
#include "models/kernels/joint_table.h"
#include "models/kernels/rectification_table.h"
#include "models/memory/word_access.h"

namespace stereotlm::host {

// The configuration of an IdealHost.
struct IdealHostConfig {
  int width = 0;              // pixels
  int height = 0;             // pixels
  std::uint64_t frames = 1;   // frames to run
  bool pixels = true;         // false: no pictures are requested or loaded, and results are empty
  fpga::BufferBases buffers;  // where pictures, tables and results lie
};

// Runs frames on a core without a modelled computer (contract section 2, `preloaded`). The tables are in
// their banks before cycle 0. Pictures enter and results leave their buffers in zero time, and each frame
// starts when the last one ends. The host accesses registers by b_transport, the memory by debug transport.
//
// SC_REPORT_ERROR (type /stereotlm/ideal_host) reports: a picture of the wrong size, a core that does not
// start or that reports an error, a register or memory that refuses an access. The host then stops, and
// finished() stays false. Where errors are not thrown, it goes on after a refused access.
class IdealHost : public sc_core::sc_module {
 public:
  tlm_utils::simple_initiator_socket<IdealHost> registers{"registers"};  // to the registers of the core
  tlm_utils::simple_initiator_socket<IdealHost> memory{"memory"};        // the banks, by debug transport
  sc_core::sc_in<bool> done{"done"};                                     // interrupt of the core

  // The tables, `source` and `sink` outlive the host. A side without rectification has a null table. Joint
  // tables need both tables, which the host joins. Throws std::invalid_argument if a list of buffers is
  // empty, if a side has a table without a buffer or a buffer without a table, or if the tables cannot be
  // joined.
  IdealHost(const sc_core::sc_module_name& name, const IdealHostConfig& config,
            const kernels::RectificationTable* left_table, const kernels::RectificationTable* right_table,
            FrameSource& source, FrameSink& sink);

  std::uint64_t frames_done() const { return frames_done_; }        // whose results have been taken
  bool finished() const { return frames_done_ == config_.frames; }  // whether all frames are done

 private:
  void run();
  void load_tables();
  void load_table(std::uint32_t base, const std::vector<std::uint32_t>& words, std::uint64_t base_register);
  bool load_pictures(std::uint32_t left, std::uint32_t right);
  // start_frame() and end_frame() return false after an error that stops the host.
  bool start_frame();
  bool end_frame();
  void write_register(std::uint64_t address, std::uint32_t value);
  std::uint32_t read_status();
  // Moves a whole buffer, and reports an error if the memory refuses a part of it. A write does not change
  // `bytes`.
  void debug(tlm::tlm_command command, std::uint32_t base, const void* bytes, std::size_t size);

  IdealHostConfig config_;
  const kernels::RectificationTable* left_table_;
  const kernels::RectificationTable* right_table_;
  std::optional<kernels::JointTable> joint_table_;
  FrameSource& source_;
  FrameSink& sink_;
  memory::WordAccess access_{registers};
  kernels::GrayImage disparity_;
  std::uint64_t frames_done_ = 0;
};

}  // namespace stereotlm::host

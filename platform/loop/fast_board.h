#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "models/clock.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_registers.h"
#include "models/fpga/fast/fast_core.h"
#include "models/fpga/frame_run.h"
#include "models/fpga/host_port.h"
#include "models/fpga/local_bus_control.h"
#include "models/memory/arbitration.h"
#include "models/memory/direct_banks.h"
#include "models/memory/ram.h"
#include "platform/config/board_config.h"
#include "platform/figures/collect.h"

namespace stereotlm::platform {

// The board of board.h at fidelity fast or timing, without modules and without the kernel: the same controls,
// bound directly. Only the local bus reaches it. Its frames always work directly on memory; one that cannot
// is an error.
class FastBoard : private fpga::LocalBusControl::Core,
                  private fpga::CoreRegisters::Starter,
                  private fpga::FastCore::Board,
                  private memory::DirectBanks {
 public:
  // `ring(now_ps)`: the core's interrupt rises. Throws std::invalid_argument if the board has problems.
  FastBoard(const BoardConfig& config, fpga::Fidelity fidelity, std::function<void(std::uint64_t)> ring);
  FastBoard(const FastBoard&) = delete;
  FastBoard& operator=(const FastBoard&) = delete;

  fpga::LocalBusControl& local_bus() { return local_bus_; }
  const fpga::LocalBusControl& local_bus() const { return local_bus_; }
  // The frames, to observe and to record them.
  fpga::FrameRun& frames() { return frames_; }
  const fpga::FrameRun& frames() const { return frames_; }

  // The time of the next step(), which may be the present.
  std::uint64_t next_ps() const {
    return local_bus_.word_waits() ? std::min(next_ps_, local_bus_.request_ps()) : next_ps_;
  }
  // Whether that step ends a frame. Else it comes after everything else that happens at its time.
  bool ends_frame_next() const { return frames_.is_finishing(); }
  // Advances the core. Throws std::runtime_error if a frame stalls or needs Fidelity::kCycle.
  void step(std::uint64_t now_ps);

  // Advances the running frame to `now_ps`, for observers. See StereoCore::catch_up().
  void catch_up(std::uint64_t now_ps);

  // To be called between two frames, at this time.
  BoardCounters counters(std::uint64_t now_ps) const;

 private:
  void route(const fpga::HostRoute& route) override { fast_core_.route(route); }
  bool access_bank(std::uint64_t at_ps, bool write, std::uint64_t address, std::uint32_t& word) override;
  bool access_register(std::uint64_t now_ps, bool write, std::uint64_t address, std::uint32_t& word) override;

  void start_frame(const fpga::FrameStart& start) override;

  // Other events may follow at any time.
  std::uint64_t horizon_ps() const override { return now_ps_; }
  void frame_ended(bool failed) override;
  [[noreturn]] void failed(const std::string& why) override;
  void stalled(std::uint64_t cycles) override;

  unsigned char* direct(std::uint64_t address, std::uint64_t bytes) override;
  void allow_access(memory::Port /*port*/) override {}

  fpga::CoreConfig config_;
  std::vector<memory::SsramBankConfig> bank_configs_;
  std::function<void(std::uint64_t)> ring_;
  Clock clock_;
  std::deque<memory::Ram> banks_;
  memory::Arbitration arbitration_;
  fpga::FrameRun frames_;
  fpga::CoreRegisters registers_{*this};
  fpga::LocalBusControl local_bus_;
  fpga::HostPort host_port_{local_bus_, *this, arbitration_, frames_, clock_};
  fpga::FastCore fast_core_;
  std::uint64_t now_ps_ = 0;  // time of the last step
  std::uint64_t next_ps_;
};

}  // namespace stereotlm::platform

#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "models/fpga/core_ports.h"
#include "models/host/frame_source.h"
#include "models/kernels/gray_image.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "tests/integration/rtl/rtl_core.h"

namespace stereotlm::test {

// A verilated core with the banks of a board. Its frames are those of `--source preloaded`.
class RtlBoard {
 public:
  // Called with each cycle of a frame, up to its last write.
  using Observer = std::function<void(std::uint64_t frame, const RtlOutputs& outputs)>;

  RtlBoard(const platform::BoardConfig& board, const platform::Tables& tables, RtlCore& core);

  // Runs the next frame, and returns its disparities. `last`: no frame follows. Throws std::runtime_error if
  // the frame takes more than `most_cycles`.
  kernels::GrayImage run_frame(const host::StereoPair& pair, bool last, std::uint64_t most_cycles,
                               const Observer& observer);
  RtlInputs& inputs() { return inputs_; }  // of the next cycle: an observer may set those of the host
  const std::vector<std::uint32_t>& words(std::size_t bank) const { return banks_[bank].words; }
  // Of the frames that have ended, pipeline_latency_cycles included.
  const std::vector<std::uint64_t>& frame_cycles() const { return frame_cycles_; }

 private:
  // A bank gives kNothing in a cycle in which it has nothing to give.
  static constexpr std::uint32_t kNothing = 0xBAD0'BAD0;
  struct Bank {
    std::vector<std::uint32_t> words;
    std::array<std::uint32_t, 2> coming = {kNothing, kNothing};  // read one and two cycles ago
  };

  std::uint32_t& word_at(std::uint32_t base, std::size_t word);
  void load(std::uint32_t base, const std::vector<std::uint8_t>& pixels);
  const RtlOutputs& step();

  platform::BoardConfig board_;
  fpga::BufferBases buffers_;
  RtlCore& core_;
  std::vector<Bank> banks_;
  RtlInputs inputs_;
  std::vector<std::uint64_t> frame_cycles_;
};

}  // namespace stereotlm::test

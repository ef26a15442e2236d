#include "platform/preloaded_system.h"

#include <stdexcept>

#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

using kernels::RectificationTable;

host::IdealHostConfig host_config(const BoardConfig& board, std::uint64_t frames, fpga::Fidelity fidelity) {
  host::IdealHostConfig config;
  config.width = board.image.width;
  config.height = board.image.height;
  config.frames = frames;
  config.pixels = fidelity != fpga::Fidelity::kTiming;
  config.buffers = buffer_bases(board);
  return config;
}

const RectificationTable* pointer_to(const std::optional<RectificationTable>& table) {
  return table ? &*table : nullptr;
}

const BoardConfig& checked(const BoardConfig& board, const Tables& tables) {
  check_tables(board, tables);
  return board;
}

}  // namespace

PreloadedSystem::PreloadedSystem(const sc_core::sc_module_name& name, const BoardConfig& config,
                                 const Tables& tables, std::uint64_t frames, host::FrameSource& source,
                                 host::FrameSink& sink, Binder& binder, fpga::Fidelity fidelity)
    : sc_module(name),
      board("board", checked(config, tables), binder, fidelity),
      host("host", host_config(config, frames, fidelity), pointer_to(tables.left), pointer_to(tables.right),
           source, sink) {
  binder.bind(host.registers, board.core.registers, "host_to_registers");
  binder.bind(host.memory, board.core.local_bus, "host_to_local_bus");
  board.core.done(done_);
  host.done(done_);
}

}  // namespace stereotlm::platform

#include "platform/assembly/preloaded_system.h"

#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

using kernels::RectificationTable;

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
      host(
          "host",
          {config.image.width, config.image.height, frames, fpga::has_pixels(fidelity), buffer_bases(config)},
          pointer_to(tables.left), pointer_to(tables.right), source, sink) {
  binder.bind(host.registers, board.core.registers, "host_to_registers");
  binder.bind(host.memory, board.core.local_bus, "host_to_local_bus");
  board.core.done(done_);
  host.done(done_);
}

}  // namespace stereotlm::platform

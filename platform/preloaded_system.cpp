#include "platform/preloaded_system.h"

#include <stdexcept>

#include "platform/frame_buffers.h"

namespace stereotlm::platform {
namespace {

using kernels::RectificationTable;

host::IdealHostConfig host_config(const BoardConfig& board, std::uint64_t frames, fpga::Fidelity fidelity) {
  host::IdealHostConfig config;
  config.width = board.image.width;
  config.height = board.image.height;
  config.frames = frames;
  config.pixels = fidelity != fpga::Fidelity::kTiming;
  config.buffers = frame_buffers(board);
  return config;
}

const RectificationTable* checked(const std::optional<RectificationTable>& table, const BoardConfig& board,
                                  const char* side) {
  if (!table) return nullptr;
  const std::string where = std::string(side) + " table: ";
  if (table->width != board.image.width || table->height != board.image.height) {
    throw std::invalid_argument(where + std::to_string(table->width) + " x " + std::to_string(table->height) +
                                ": must be of the size of the images, " + std::to_string(board.image.width) +
                                " x " + std::to_string(board.image.height));
  }
  if (const auto found = kernels::problems(*table); !found.empty())
    throw std::invalid_argument(where + found.front());
  return &*table;
}

}  // namespace

PreloadedSystem::PreloadedSystem(const sc_core::sc_module_name& name, const BoardConfig& config,
                                 const Tables& tables, std::uint64_t frames, host::FrameSource& source,
                                 host::FrameSink& sink, Binder& binder, fpga::Fidelity fidelity)
    : sc_module(name),
      board("board", config, binder, fidelity),
      host("host", host_config(config, frames, fidelity), checked(tables.left, config, "left"),
           checked(tables.right, config, "right"), source, sink) {
  binder.bind(host.registers, board.core.registers, "host_to_registers");
  binder.bind(host.memory, board.core.local_bus, "host_to_local_bus");
  board.core.done(done_);
  host.done(done_);
}

}  // namespace stereotlm::platform

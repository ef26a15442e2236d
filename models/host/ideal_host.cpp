#include "models/host/ideal_host.h"

#include <cstdio>
#include <stdexcept>
#include <string>

#include "models/fpga/placement.h"
#include "models/fpga/register_map.h"

namespace stereotlm::host {
namespace {

namespace registers_of = fpga::registers;

void report(const std::string& text) { SC_REPORT_ERROR("/stereotlm/ideal_host", text.c_str()); }

std::uint32_t in_turn(const std::vector<std::uint32_t>& list, std::uint64_t frame) {
  return list[frame % list.size()];
}

const kernels::RectificationTable* checked(const kernels::RectificationTable* table, bool expected,
                                           const char* side) {
  if ((table != nullptr) != expected) {
    throw std::invalid_argument(std::string(side) +
                                (expected ? " table missing" : " table given, but no buffer"));
  }
  return table;
}

}  // namespace

IdealHost::IdealHost(const sc_core::sc_module_name& name, const IdealHostConfig& config,
                     const kernels::RectificationTable* left_table,
                     const kernels::RectificationTable* right_table, FrameSource& source, FrameSink& sink)
    : sc_module(name),
      config_(config),
      left_table_(checked(left_table, config.buffers.left_lut.has_value(), "left")),
      right_table_(checked(right_table,
                           config.buffers.right_lut.has_value() || config.buffers.has_joint_tables, "right")),
      source_(source),
      sink_(sink),
      disparity_(config.pixels ? config.width : 0, config.pixels ? config.height : 0) {
  SC_HAS_PROCESS(IdealHost);
  if (config.buffers.left_images.empty() || config.buffers.right_images.empty() ||
      config.buffers.disparities.empty()) {
    throw std::invalid_argument(std::string(this->name()) + ": a list of buffers is empty");
  }
  if (config.buffers.has_joint_tables) joint_table_ = kernels::join_tables(*left_table_, *right_table_);
  SC_THREAD(run);
}

void IdealHost::run() {
  load_tables();
  while (!finished()) {
    if (!start_frame()) return;
    wait(done.posedge_event());
    if (!end_frame()) return;
  }
}

void IdealHost::load_tables() {
  const fpga::BufferBases& buffers = config_.buffers;
  if (joint_table_) {
    for (const auto& [address, value] : registers_of::joint_offsets(joint_table_->offsets))
      write_register(address, value);
    load_table(*buffers.left_lut, joint_table_->words, registers_of::kLeftLutBase);
    return;
  }
  if (buffers.left_lut) load_table(*buffers.left_lut, left_table_->entries, registers_of::kLeftLutBase);
  if (buffers.right_lut) load_table(*buffers.right_lut, right_table_->entries, registers_of::kRightLutBase);
}

void IdealHost::load_table(std::uint32_t base, const std::vector<std::uint32_t>& words,
                           std::uint64_t base_register) {
  debug(tlm::TLM_WRITE_COMMAND, base, words.data(), words.size() * sizeof(std::uint32_t));
  write_register(base_register, base);
}

bool IdealHost::load_pictures(std::uint32_t left, std::uint32_t right) {
  const StereoPair& pair = source_.pair(frames_done_);
  for (const kernels::GrayImage* image : {&pair.left, &pair.right}) {
    if (image->width == config_.width && image->height == config_.height) continue;
    report("frame " + std::to_string(frames_done_) + ": picture of " + std::to_string(image->width) + " x " +
           std::to_string(image->height) + " for images of " + std::to_string(config_.width) + " x " +
           std::to_string(config_.height));
    return false;
  }
  debug(tlm::TLM_WRITE_COMMAND, left, pair.left.pixels.data(), pair.left.pixels.size());
  debug(tlm::TLM_WRITE_COMMAND, right, pair.right.pixels.data(), pair.right.pixels.size());
  return true;
}

bool IdealHost::start_frame() {
  const std::uint32_t left = in_turn(config_.buffers.left_images, frames_done_);
  const std::uint32_t right = in_turn(config_.buffers.right_images, frames_done_);
  if (config_.pixels && !load_pictures(left, right)) return false;
  write_register(registers_of::kLeftImageBase, left);
  write_register(registers_of::kRightImageBase, right);
  const std::uint32_t disparity = in_turn(config_.buffers.disparities, frames_done_);
  write_register(registers_of::kDisparityBase, disparity);
  write_register(registers_of::kControl, registers_of::kControlAcknowledge | registers_of::kControlStart);
  if ((read_status() & registers_of::kStatusBusy) != 0) return true;
  std::string bases;
  const auto add = [&bases](const char* name, const std::optional<std::uint32_t>& value) {
    if (!value) return;
    char text[40];
    std::snprintf(text, sizeof text, "%s%s 0x%08x", bases.empty() ? "" : ", ", name, *value);
    bases += text;
  };
  add("left_image", left);
  add("right_image", right);
  add("disparity", disparity);
  add("left_lut", config_.buffers.left_lut);
  add("right_lut", config_.buffers.right_lut);
  report("frame " + std::to_string(frames_done_) + ": the core refuses to start with the bases " + bases);
  return false;
}

bool IdealHost::end_frame() {
  if ((read_status() & registers_of::kStatusError) != 0) {
    report("frame " + std::to_string(frames_done_) + ": the core reports an error");
    return false;
  }
  if (config_.pixels) {
    debug(tlm::TLM_READ_COMMAND, in_turn(config_.buffers.disparities, frames_done_), disparity_.pixels.data(),
          disparity_.pixels.size());
  }
  const std::uint64_t frame = frames_done_++;
  sink_.take(frame, disparity_);
  return true;
}

void IdealHost::write_register(std::uint64_t address, std::uint32_t value) {
  sc_core::sc_time delay;
  if (!access_.write(address, value, delay)) {
    report("register " + std::to_string(address) + " refuses a write");
  }
}

std::uint32_t IdealHost::read_status() {
  sc_core::sc_time delay;
  if (!access_.read(registers_of::kStatus, delay)) {
    report("register " + std::to_string(registers_of::kStatus) + " refuses a read");
  }
  return access_.word();
}

void IdealHost::debug(tlm::tlm_command command, std::uint32_t base, const void* bytes, std::size_t size) {
  const std::size_t row_bytes = size / static_cast<std::size_t>(config_.height);
  const fpga::Placement buffer(config_.buffers.stripes, base, row_bytes / 4);
  const bool is_striped = buffer.parts().size() > 1;
  const std::size_t length = is_striped ? row_bytes : size;  // of an access: a row, or all
  auto* const data = static_cast<unsigned char*>(const_cast<void*>(bytes));
  std::size_t moved = 0;
  for (std::size_t first = 0; first < size; first += length) {
    tlm::tlm_generic_payload access;
    access.set_command(command);
    access.set_address(buffer.address(first / row_bytes, 0));
    access.set_data_ptr(data + first);
    access.set_data_length(static_cast<unsigned>(length));
    access.set_streaming_width(static_cast<unsigned>(length));
    moved += memory->transport_dbg(access);
  }
  if (moved != size) {
    report("the buffer at base " + std::to_string(base) + " takes " + std::to_string(moved) + " of " +
           std::to_string(size) + " bytes");
  }
}

}  // namespace stereotlm::host

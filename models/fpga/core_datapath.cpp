#include "models/fpga/core_datapath.h"

#include <string>

namespace stereotlm::fpga {
namespace {

using memory::PortMask;

std::string name_of(Side side) { return side == Side::kLeft ? "left" : "right"; }

constexpr bool has(PortMask mask, memory::Port port) { return (mask & memory::mask_of(port)) != 0; }

}  // namespace

CoreDatapath::Lane::Lane(const CoreConfig& config, Side side)
    : has_table(fpga::has_table(config, side)),
      pixel_reader((name_of(side) + "_pixel").c_str(), config),
      filter((name_of(side) + "_filter").c_str(), config) {
  if (has_port(config, lut_port(side))) {
    lut_reader =
        std::make_unique<LutReader>((name_of(side) + "_lut").c_str(), config.width, config.joint_tables);
  }
  if (config.cost.kind == kernels::CostKind::kCensus)
    census = std::make_unique<Census>((name_of(side) + "_census").c_str(), config);
  if (config.fetch == Fetch::kLineBuffer) {
    row_buffer = std::make_unique<RowBuffer>((name_of(side) + "_rows").c_str(), config);
  }
}

CoreDatapath::CoreDatapath(const CoreConfig& config, memory::Crossbar& crossbar, Binder& binder)
    : config_(config), crossbar_(crossbar) {
  bind_memory(binder);
  bind_streams();
}

void CoreDatapath::bind_memory(Binder& binder) {
  const auto bind = [this, &binder](InitiatorSocket& from, memory::Port port) {
    binder.bind(from, crossbar_.ports[port], std::string(kPorts[port].name) + "_to_crossbar");
  };
  for (const Side side : kSides) {
    Lane& lane = lanes_[index_of(side)];
    if (lane.lut_reader) bind(lane.lut_reader->port, lut_port(side));
    bind(lane.pixel_reader.port, pixel_port(side));
  }
  bind(result_writer_.port, kResultPort);
}

void CoreDatapath::bind_streams() {
  const std::array<sc_core::sc_export<StreamIf<PixelColumn>>*, 2> columns_of = {&cost_array_.left_in,
                                                                                &cost_array_.right_in};
  for (const Side side : kSides) {
    Lane& lane = lanes_[index_of(side)];
    const auto bind_slots = [this, side](auto& slots_in) {
      side == Side::kLeft ? sequencer_.left_out.bind(slots_in) : sequencer_.right_out.bind(slots_in);
    };
    auto& columns = *columns_of[index_of(side)];
    if (lane.lut_reader) {
      bind_slots(lane.lut_reader->slots_in);
      lane.lut_reader->entries_out.bind(lane.pixel_reader.entries_in);
    } else if (lane.has_table) {
      lanes_[0].lut_reader->right_entries_out.bind(lane.pixel_reader.entries_in);
    } else {
      bind_slots(lane.pixel_reader.slots_in);
    }
    lane.pixel_reader.pixels_out.bind(lane.filter.pixels_in);
    StreamOut<PixelColumn>* last_out = &lane.filter.columns_out;
    if (lane.census) {
      last_out->bind(lane.census->columns_in);
      last_out = &lane.census->columns_out;
    }
    if (lane.row_buffer) {
      last_out->bind(lane.row_buffer->columns_in);
      last_out = &lane.row_buffer->columns_out;
    }
    last_out->bind(columns);
  }
  cost_array_.chain_out.bind(select_min_chain_.sums_in);
  cost_array_.tree_out.bind(select_min_tree_.sums_in);
  select_min_chain_.matches_out.bind(lr_check_.right_in);
  select_min_tree_.matches_out.bind(lr_check_.left_in);
  lr_check_.disparities_out.bind(result_packer_.disparities_in);
  result_packer_.words_out.bind(result_writer_.words_in);
}

void CoreDatapath::start_frame(const FrameBases& bases, const kernels::JointOffsets& offsets) {
  const auto aim = [this, &bases](memory::Port port) {
    crossbar_.aim(port, registers::bank_of(bases[port]), kPorts[port].write);
    return registers::base_address(bases[port]);
  };
  for (const Side side : kSides) {
    Lane& lane = lanes_[index_of(side)];
    if (lane.lut_reader) lane.lut_reader->start_frame(aim(lut_port(side)), offsets);
    lane.pixel_reader.start_frame(aim(pixel_port(side)));
    lane.filter.start_frame();
    if (lane.census) lane.census->start_frame();
    if (lane.row_buffer) lane.row_buffer->start_frame();
  }
  result_writer_.start_frame(aim(kResultPort));
  cost_array_.start_frame();
  select_min_chain_.start_frame();
  lr_check_.start_frame();
  result_packer_.start_frame();
}

PixelNeeds CoreDatapath::move(const CoreControl& control, const CoreControl::Decision& decision,
                              PortMask granted, const sc_core::sc_time& at) {
  const auto moving = static_cast<PortMask>(granted | decision.passes());
  const auto take_slot = [&](Side side) {
    if (has(moving, lut_port(side))) issue(side, control, at);
  };
  const auto handle_slot = [&](Side side, Lane& lane) {
    if (!has(moving, pixel_port(side))) return;
    lane.has_table ? lane.pixel_reader.handle(at) : issue(side, control, at);
  };
  Lane& left = lanes_[0];
  Lane& right = lanes_[1];
  take_slot(Side::kLeft);
  take_slot(Side::kRight);
  const PixelNeeds needs_pixel = {left.pixel_reader.needs_access(), right.pixel_reader.needs_access()};
  handle_slot(Side::kLeft, left);
  handle_slot(Side::kRight, right);
  if (has(granted, kResultPort)) result_writer_.write(at);
  if (!decision.consume) return needs_pixel;
  if (decision.drain) {
    left.pixel_reader.release_blank();
    right.pixel_reader.release_blank();
  } else {
    left.pixel_reader.release();
    right.pixel_reader.release();
  }
  return needs_pixel;
}

std::uint64_t CoreDatapath::errors() const {
  std::uint64_t errors = result_writer_.errors();
  for (const Lane& lane : lanes_) {
    errors += lane.pixel_reader.errors();
    if (lane.lut_reader) errors += lane.lut_reader->errors();
  }
  return errors;
}

}  // namespace stereotlm::fpga

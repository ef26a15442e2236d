#include "models/fpga/core_datapath.h"

#include <algorithm>
#include <string>
#include <utility>

namespace stereotlm::fpga {
namespace {

using memory::has;
using memory::PortMask;

std::string name_of(Side side) { return side == Side::kLeft ? "left" : "right"; }

// "left_pixel", or with several lanes "left_pixel_0".
std::string module_name(const CorePorts& ports, memory::Port port) {
  std::string name = ports.name(port);
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

}  // namespace

CoreDatapath::SideStages::SideStages(const CoreConfig& config, Side side)
    : has_table(fpga::has_table(config, side)), filter((name_of(side) + "_filter").c_str(), config) {
  const CorePorts ports(config);
  for (std::size_t lane = 0; lane < ports.lanes(); ++lane) {
    Readers readers;
    if (has_group(config, lut_group(side))) {
      readers.lut =
          std::make_unique<LutReader>(module_name(ports, ports.lut(side, lane)).c_str(), config.joint_tables);
    }
    readers.pixel = std::make_unique<PixelReader>(module_name(ports, ports.pixel(side, lane)).c_str(), config,
                                                  static_cast<int>(lane));
    lanes.push_back(std::move(readers));
  }
  if (config.cost.kind == kernels::CostKind::kCensus)
    census = std::make_unique<Census>((name_of(side) + "_census").c_str(), config);
  if (config.fetch == Fetch::kLineBuffer) {
    row_buffer = std::make_unique<RowBuffer>((name_of(side) + "_rows").c_str(), config);
  }
}

CoreDatapath::CoreDatapath(const CoreConfig& config, bool has_pixels, memory::Crossbar& crossbar,
                           Binder& binder)
    : config_(config), crossbar_(crossbar), ports_(config) {
  if (!has_pixels) blank_matcher_ = std::make_unique<BlankMatcher>("blank_matcher", config);
  for (const SideStages& stages : sides_) {
    for (const Readers& readers : stages.lanes) pixel_readers_.push_back(readers.pixel.get());
  }
  bind_memory(binder);
  bind_streams();
}

void CoreDatapath::bind_memory(Binder& binder) {
  const auto bind = [this, &binder](InitiatorSocket& from, memory::Port port) {
    binder.bind(from, crossbar_.ports[port], module_name(ports_, port) + "_to_crossbar");
  };
  for (const Side side : kSides) {
    for (std::size_t lane = 0; lane < ports_.lanes(); ++lane) {
      const Readers& readers = sides_[index_of(side)].lanes[lane];
      if (readers.lut) bind(readers.lut->port, ports_.lut(side, lane));
      bind(readers.pixel->port, ports_.pixel(side, lane));
    }
  }
  bind(result_writer_.port, ports_.result());
}

void CoreDatapath::bind_streams() {
  const std::array<sc_core::sc_export<StreamIf<PixelColumn>>*, 2> columns_of = {&cost_array_.left_in,
                                                                                &cost_array_.right_in};
  for (const Side side : kSides) {
    SideStages& stages = sides_[index_of(side)];
    for (std::size_t lane = 0; lane < ports_.lanes(); ++lane) {
      Readers& readers = stages.lanes[lane];
      auto& slots_out = sequencer_.slots_out[index_of(side) * ports_.lanes() + lane];
      if (readers.lut) {
        slots_out.bind(readers.lut->slots_in);
        readers.lut->entries_out.bind(readers.pixel->entries_in);
      } else if (stages.has_table) {
        sides_[0].lanes[lane].lut->right_entries_out.bind(readers.pixel->entries_in);
      } else {
        slots_out.bind(readers.pixel->slots_in);
      }
      if (!blank_matcher_) {
        readers.pixel->pixels_out.bind(stages.filter.pixels_in);
      } else if (side == Side::kLeft) {
        readers.pixel->pixels_out.bind(blank_matcher_->left_in);
      } else {
        readers.pixel->pixels_out.bind(blank_matcher_->right_in);
      }
    }
    StreamOut<PixelColumn>* last_out = &stages.filter.columns_out;
    if (stages.census) {
      last_out->bind(stages.census->columns_in);
      last_out = &stages.census->columns_out;
    }
    if (stages.row_buffer) {
      last_out->bind(stages.row_buffer->columns_in);
      last_out = &stages.row_buffer->columns_out;
    }
    last_out->bind(*columns_of[index_of(side)]);
  }
  cost_array_.chain_out.bind(select_min_chain_.sums_in);
  cost_array_.tree_out.bind(select_min_tree_.sums_in);
  select_min_chain_.matches_out.bind(lr_check_.right_in);
  select_min_tree_.matches_out.bind(lr_check_.left_in);
  if (blank_matcher_) {
    blank_matcher_->right_matches_out.bind(lr_check_.right_in);
    blank_matcher_->left_matches_out.bind(lr_check_.left_in);
  }
  lr_check_.disparities_out.bind(result_packer_.disparities_in);
  result_packer_.words_out.bind(result_writer_.words_in);
}

void CoreDatapath::start_frame(const FrameBases& bases, const kernels::JointOffsets& offsets) {
  const Placements placements = placements_of(config_, bases);
  const auto aim = [&](memory::Port port) -> const Placement& {
    const std::size_t group = ports_.group_of(port);
    crossbar_.aim(port, registers::bank_of(bases[group]), kPortGroups[group].write);
    return placements[group];
  };
  for (const Side side : kSides) {
    SideStages& stages = sides_[index_of(side)];
    for (std::size_t lane = 0; lane < ports_.lanes(); ++lane) {
      const Readers& readers = stages.lanes[lane];
      if (readers.lut) readers.lut->start_frame(aim(ports_.lut(side, lane)), offsets);
      readers.pixel->start_frame(aim(ports_.pixel(side, lane)));
    }
    stages.filter.start_frame();
    if (stages.census) stages.census->start_frame();
    if (stages.row_buffer) stages.row_buffer->start_frame();
  }
  result_writer_.start_frame(aim(ports_.result()));
  cost_array_.start_frame();
  select_min_chain_.start_frame();
  lr_check_.start_frame();
  if (blank_matcher_) blank_matcher_->start_frame();
  result_packer_.start_frame();
}

PixelNeeds CoreDatapath::move(const CoreControl& control, const CoreControl::Decision& decision,
                              PortMask granted, const sc_core::sc_time& at) {
  return pixel_readers_.size() == 2 ? move_lanes<2>(control, decision, granted, at)
                                    : move_lanes<0>(control, decision, granted, at);
}

// `kLanes`: as in CoreControl::decide_lanes().
template <std::size_t kLanes>
PixelNeeds CoreDatapath::move_lanes(const CoreControl& control, const CoreControl::Decision& decision,
                                    PortMask granted, const sc_core::sc_time& at) {
  const std::size_t lanes = kLanes != 0 ? kLanes : pixel_readers_.size();
  PixelReader* const* const readers = pixel_readers_.data();
  const auto moving = static_cast<std::uint64_t>(granted | decision.passes);  // readers: ports 0..63 at most
  PixelNeeds needs_pixel = 0;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    if ((moving >> lane & 1U) != 0) issue(lane, control, at);  // the LUT port of a lane has the same number
    needs_pixel |= PixelNeeds{readers[lane]->needs_access()} << lane;
  }
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    if ((moving >> (lanes + lane) & 1U) == 0) continue;
    control.lane(lane).has_table() ? readers[lane]->handle(at) : issue(lane, control, at);
  }
  if (has(granted, 2 * lanes)) result_writer_.write(at);
  if (!decision.consume) return needs_pixel;
  const auto consumed = static_cast<std::size_t>(kLanes == 2 ? 1 : control.match().lanes());  // of each side
  for (std::size_t first = 0; first < lanes; first += lanes / 2) {
    for (std::size_t lane = first; lane < first + consumed; ++lane)
      decision.drain ? readers[lane]->release_blank() : readers[lane]->release();
  }
  return needs_pixel;
}

std::uint64_t CoreDatapath::errors() const {
  std::uint64_t errors = result_writer_.errors();
  for (const SideStages& stages : sides_) {
    for (const Readers& readers : stages.lanes) {
      errors += readers.pixel->errors();
      if (readers.lut) errors += readers.lut->errors();
    }
  }
  return errors;
}

}  // namespace stereotlm::fpga

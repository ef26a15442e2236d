#include "sw/driver/stereo_driver.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "models/capture/capture_registers.h"
#include "models/fpga/core_config.h"
#include "models/fpga/register_map.h"
#include "models/pci/bridge_registers.h"
#include "platform/config/buffer_layout.h"
#include "platform/config/device_map.h"

namespace stereotlm::driver {
namespace {

namespace bridge_map = pci::bridge;
namespace capture_map = capture::registers;
namespace core_map = fpga::registers;

constexpr int kToBoard = 0;  // numbers of the DMA channels
constexpr int kToHost = 1;
constexpr std::uint64_t kDescriptorBytes = 16;
constexpr std::uint64_t kChainsBytes = 4096;  // of both chains, rounded up to a multiple of this

// A capture writes through an aperture, whose page stays as it is.
static_assert(fpga::kWidthRule.max * fpga::kHeightRule.max <= std::int64_t{bridge_map::kApertureBytes});

constexpr platform::DeviceMap kDevices;
constexpr std::uint64_t kBridge = kDevices.bridge_registers;
constexpr std::uint64_t kCore = kDevices.bridge_slave + bridge_map::kCoreRegisters;

std::uint64_t image_bytes(const platform::BoardConfig& board) {
  return static_cast<std::uint64_t>(board.image.width) * static_cast<std::uint64_t>(board.image.height);
}

bool captures_to_host(const platform::BoardConfig& board) {
  return board.capture.destination == platform::CaptureDestination::kHostMemory;
}

// Bytes of a channel's chain. The longest is the copy of a striped pair: a descriptor for each row. Any other
// has one for each part of two tables.
std::uint64_t chain_bytes(const platform::BoardConfig& board) {
  const bool is_striped = !platform::stripes_of(board).empty();
  const auto descriptors = static_cast<std::uint64_t>(is_striped ? std::max(2 * board.image.height, 32) : 16);
  return descriptors * kDescriptorBytes;
}

// Host memory holds, in this order: the chains of both DMA channels, the tables, the ring, the results.
std::uint64_t tables_start(const platform::BoardConfig& board) {
  return (2 * chain_bytes(board) + kChainsBytes - 1) / kChainsBytes * kChainsBytes;
}
std::uint64_t ring_start(const platform::BoardConfig& board) {
  return tables_start(board) + 2 * 4 * image_bytes(board);
}
std::uint64_t results_start(const platform::BoardConfig& board) {
  const int pairs = captures_to_host(board) ? board.capture.host_frames : 0;
  return ring_start(board) + static_cast<std::uint64_t>(pairs) * 2 * image_bytes(board);
}

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error("stereo driver: " + what); }

}  // namespace

std::uint64_t host_memory_bytes(const platform::BoardConfig& board) {
  return results_start(board) + board.allocation.disparity.size() * image_bytes(board);
}

StereoDriver::StereoDriver(const platform::BoardConfig& board, std::uint64_t frames,
                           const std::vector<std::uint32_t>* left_table,
                           const std::vector<std::uint32_t>* right_table, Deliver deliver)
    : board_(board),
      buffers_(platform::buffer_bases(board)),
      captures_to_host_(captures_to_host(board)),
      frames_(frames),
      left_table_(left_table),
      right_table_(right_table),
      deliver_(std::move(deliver)) {
  const auto check = [this](const char* side, bool is_used, const std::vector<std::uint32_t>* table) {
    const std::size_t entries = table != nullptr ? table->size() : 0;
    const std::uint64_t expected = is_used ? image_bytes(board_) : 0;
    if (entries != expected) {
      throw std::invalid_argument(std::string(side) + " table = " + std::to_string(entries) +
                                  " entries: must have " + std::to_string(expected));
    }
  };
  check("left", buffers_.left_lut.has_value(), left_table_);
  check("right", buffers_.right_lut.has_value() || buffers_.has_joint_tables, right_table_);
  if (!buffers_.has_joint_tables) return;
  const auto table = [this](const std::vector<std::uint32_t>& entries) {
    return kernels::RectificationTable{board_.image.width, board_.image.height, entries};
  };
  kernels::JointTable joint = kernels::join_tables(table(*left_table_), table(*right_table_));
  joint_table_ = std::move(joint.words);
  joint_offsets_ = joint.offsets;
}

void StereoDriver::run(host::HostBus& bus) {
  bus_ = &bus;
  upload_tables();
  bus_->write(kBridge + bridge_map::kInterruptEnable, bridge_map::kAllInterrupts);
  start_what_can_be();
  const Progress& read_backs = of(Activity::kReadBack);
  while (read_backs.ended < frames_) {
    bus.wait_for_interrupt();
    handle_interrupts();
    if (read_backs.ended < frames_) start_what_can_be();
  }
}

std::string StereoDriver::under_way() const {
  std::string text;
  const auto add = [&text](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
  const auto add_activity = [&](const std::string& what, Activity activity) {
    if (!of(activity).idle()) add(what + ' ' + std::to_string(of(activity).ended));
  };
  if (uploading_) add("the upload of the tables");
  add_activity("capture", Activity::kCapture);
  add_activity("copy of pair", Activity::kCopy);
  add_activity("core with frame", Activity::kFrame);
  add_activity("read-back of frame", Activity::kReadBack);
  return text.empty() ? "nothing" : text;
}

void StereoDriver::upload_tables() {
  std::vector<Piece> pieces;
  std::uint64_t host = tables_start(board_);
  const std::uint64_t row_bytes = 4 * static_cast<std::uint64_t>(board_.image.width);
  const auto add = [&](const std::optional<std::uint32_t>& lut, const std::vector<std::uint32_t>* table) {
    if (!lut) return;
    const fpga::Placement buffer(buffers_.stripes, *lut, row_bytes / 4);
    add_parts(buffer, host, false, pieces);
    const auto* const from = reinterpret_cast<const std::uint8_t*>(table->data());
    std::uint8_t* to = bus_->memory(kDevices.host_memory + host, table->size() * 4);
    for (const std::uint64_t row : rows_by_part(buffer)) {
      std::memcpy(to, from + row * row_bytes, row_bytes);
      to += row_bytes;
    }
    host += table->size() * 4;
  };
  if (buffers_.has_joint_tables) {
    for (const auto& [address, value] : core_map::joint_offsets(joint_offsets_))
      bus_->write(kCore + address, value);
    add(buffers_.left_lut, &joint_table_);
  } else {
    add(buffers_.left_lut, left_table_);
    add(buffers_.right_lut, right_table_);
  }
  if (pieces.empty()) return;
  const std::uint32_t done = bridge_map::kDmaDone << unsigned{kToBoard};
  const std::uint32_t error = bridge_map::kDmaError << unsigned{kToBoard};
  bus_->write(kBridge + bridge_map::kInterruptEnable, done | error);
  uploading_ = true;
  start_dma(kToBoard, pieces);
  bus_->wait_for_interrupt();
  uploading_ = false;
  const std::uint32_t status = bus_->read(kBridge + bridge_map::kInterruptStatus);
  if ((status & error) != 0) fail("the tables could not be uploaded");
  bus_->write(kBridge + bridge_map::kInterruptStatus, status);
}

void StereoDriver::handle_interrupts() {
  const std::uint32_t status = bus_->read(kBridge + bridge_map::kInterruptStatus);
  if (status != 0) bus_->write(kBridge + bridge_map::kInterruptStatus, status);
  for (const int channel : {kToBoard, kToHost}) {
    if ((status & bridge_map::kDmaError << static_cast<unsigned>(channel)) != 0) {
      fail("DMA channel " + std::to_string(channel) + " has met an error");
    }
  }
  if ((status & bridge_map::kPostedError) != 0) fail("the board has refused a write");
  if ((status & bridge_map::kDoorbell) != 0) {
    if ((bus_->read(kCore + core_map::kStatus) & core_map::kStatusError) != 0)
      fail("the core has met an error");
    ++of(Activity::kFrame).ended;
    core_to_acknowledge_ = true;
  }
  if ((status & bridge_map::kDmaDone << unsigned{kToBoard}) != 0) ++of(Activity::kCopy).ended;
  if ((status & bridge_map::kDmaDone << unsigned{kToHost}) != 0) end_read_back();
  if (!of(Activity::kCapture).idle()) handle_captures();
}

void StereoDriver::handle_captures() {
  const std::array<std::uint64_t, 2> boards = {kDevices.left_capture, kDevices.right_capture};
  for (std::size_t side = 0; side < boards.size(); ++side) {
    if (side_done_[side]) continue;
    const std::uint32_t status = bus_->read(boards[side] + capture_map::kStatus);
    if ((status & capture_map::kStatusWordsLost) != 0) fail("a capture board could not write its words");
    if ((status & capture_map::kStatusDone) == 0) continue;
    bus_->write(boards[side] + capture_map::kStatus, capture_map::kStatusDone);
    side_done_[side] = true;
  }
  if (!side_done_[0] || !side_done_[1]) return;
  side_done_ = {};
  ++of(Activity::kCapture).ended;
  const auto frame = [this](std::uint64_t board) {
    const std::uint64_t high = bus_->read(board + capture_map::kFrameNumberHigh);
    return high << 32U | bus_->read(board + capture_map::kFrameNumberLow);
  };
  camera_frames_.push_back(frame(boards[0]));
  if (frame(boards[1]) != camera_frames_.back()) fail("the capture boards have taken different frames");
}

void StereoDriver::start_what_can_be() {
  start_core();
  arm_capture();
  copy_pair();
  read_back();
}

bool StereoDriver::begin(Activity activity, std::initializer_list<Condition> conditions) {
  const std::uint64_t number = of(activity).begun;
  std::vector<platform::Awaited> awaited;
  for (const Condition& condition : conditions) {
    if (number < condition.back) continue;
    awaited.push_back({condition.activity, number - condition.back, condition.reason});
    if (of(condition.activity).ended <= awaited.back().number) return false;
  }
  ++of(activity).begun;  // before the first access, in which start_no_more() may be called
  if (observer_ != nullptr) observer_->starts(activity, awaited);
  return true;
}

void StereoDriver::start_core() {
  const std::uint64_t frame = frames_started();
  const bool starts =
      frame < frames_ &&
      begin(Activity::kFrame, {{Activity::kFrame, 1, "core"},
                               {captures_to_host_ ? Activity::kCopy : Activity::kCapture, 0, "pair"},
                               {Activity::kReadBack, buffers_.disparities.size(), "output_buffer"}});
  if (starts) {
    const auto input = static_cast<std::size_t>(frame % buffers_.left_images.size());
    bus_->write(kCore + core_map::kLeftImageBase, buffers_.left_images[input]);
    bus_->write(kCore + core_map::kRightImageBase, buffers_.right_images[input]);
    bus_->write(kCore + core_map::kDisparityBase,
                buffers_.disparities[static_cast<std::size_t>(frame % buffers_.disparities.size())]);
    if (frame == 0 && buffers_.left_lut) bus_->write(kCore + core_map::kLeftLutBase, *buffers_.left_lut);
    if (frame == 0 && buffers_.right_lut) bus_->write(kCore + core_map::kRightLutBase, *buffers_.right_lut);
  }
  if (!starts && !core_to_acknowledge_) return;
  bus_->write(kCore + core_map::kControl, (core_to_acknowledge_ ? core_map::kControlAcknowledge : 0U) |
                                              (starts ? core_map::kControlStart : 0U));
  core_to_acknowledge_ = false;
}

void StereoDriver::arm_capture() {
  const std::uint64_t capture = of(Activity::kCapture).begun;
  const std::size_t inputs = buffers_.left_images.size();
  const Condition buffer =
      captures_to_host_
          ? Condition{Activity::kCopy, static_cast<std::uint64_t>(board_.capture.host_frames), "ring"}
          : Condition{Activity::kFrame, inputs, "input_buffer"};
  if (!begin(Activity::kCapture, {{Activity::kCapture, 1, "capture"}, buffer})) return;
  std::uint64_t left = 0;
  std::uint64_t right = 0;
  if (captures_to_host_) {
    left = kDevices.host_memory + pair_in_host(capture);
    right = left + image_bytes(board_);
  } else {
    const auto input = static_cast<std::size_t>(capture % inputs);
    write_pages(0, buffers_.left_images[input]);
    write_pages(4, buffers_.right_images[input]);
    left = kDevices.bridge_slave;
    right = left + bridge_map::kApertureBytes;
  }
  bus_->write(kDevices.left_capture + capture_map::kBufferAddress, static_cast<std::uint32_t>(left));
  bus_->write(kDevices.right_capture + capture_map::kBufferAddress, static_cast<std::uint32_t>(right));
  bus_->write(kDevices.right_capture + capture_map::kControl, capture_map::kControlArm);
  bus_->write(
      kDevices.left_capture + capture_map::kControl,
      capture_map::kControlArm |
          (board_.cameras.trigger == platform::CameraTrigger::kOnDemand ? capture_map::kControlTrigger : 0U));
}

void StereoDriver::copy_pair() {
  const std::uint64_t pair = of(Activity::kCopy).begun;
  const std::size_t inputs = buffers_.left_images.size();
  if (!captures_to_host_ || !begin(Activity::kCopy, {{Activity::kCopy, 1, "copy"},
                                                     {Activity::kCapture, 0, "pair"},
                                                     {Activity::kFrame, inputs, "input_buffer"}})) {
    return;
  }
  const auto input = static_cast<std::size_t>(pair % inputs);
  const std::uint64_t host = pair_in_host(pair);
  std::vector<Piece> pieces;
  add_picture(buffers_.left_images[input], host, pieces);
  add_picture(buffers_.right_images[input], host + image_bytes(board_), pieces);
  start_dma(kToBoard, pieces);
}

void StereoDriver::read_back() {
  const std::uint64_t frame = of(Activity::kReadBack).begun;
  if (!begin(Activity::kReadBack, {{Activity::kReadBack, 1, "read_back"}, {Activity::kFrame, 0, "frame"}}))
    return;
  const auto output = static_cast<std::size_t>(frame % buffers_.disparities.size());
  std::vector<Piece> pieces;
  add_parts(picture_at(buffers_.disparities[output]), result_in_host(frame), true, pieces);
  start_dma(kToHost, pieces);
}

void StereoDriver::end_read_back() {
  const std::uint64_t frame = of(Activity::kReadBack).ended++;
  const std::uint8_t* pixels =
      bus_->memory(kDevices.host_memory + result_in_host(frame), image_bytes(board_));
  const fpga::Placement buffer =
      picture_at(buffers_.disparities[static_cast<std::size_t>(frame % buffers_.disparities.size())]);
  if (buffer.parts().size() > 1) {
    result_.resize(image_bytes(board_));
    const auto row_bytes = static_cast<std::uint64_t>(board_.image.width);
    for (const std::uint64_t row : rows_by_part(buffer)) {
      std::memcpy(result_.data() + row * row_bytes, pixels, row_bytes);
      pixels += row_bytes;
    }
    pixels = result_.data();
  }
  deliver_({frame, camera_frames_[static_cast<std::size_t>(frame)], pixels});
}

fpga::Placement StereoDriver::picture_at(std::uint32_t base) const {
  return {buffers_.stripes, base, static_cast<std::uint64_t>(board_.image.width) / 4};
}

std::vector<std::uint64_t> StereoDriver::rows_by_part(const fpga::Placement& buffer) const {
  std::vector<std::uint64_t> rows;
  for (std::size_t part = 0; part < buffer.parts().size(); ++part) {
    for (auto row = part; row < static_cast<std::size_t>(board_.image.height); row += buffer.parts().size())
      rows.push_back(row);
  }
  return rows;
}

void StereoDriver::add_parts(const fpga::Placement& buffer, std::uint64_t host, bool to_host,
                             std::vector<Piece>& pieces) const {
  for (std::size_t part = 0; part < buffer.parts().size(); ++part) {
    const std::uint64_t words = buffer.rows_of_part(part, board_.image.height) * buffer.row_words();
    if (words == 0) continue;
    pieces.push_back({host, buffer.parts()[part], words, to_host});
    host += 4 * words;
  }
}

// The bridge has no stride: a striped picture takes a descriptor for each row.
void StereoDriver::add_picture(std::uint32_t base, std::uint64_t host, std::vector<Piece>& pieces) const {
  const fpga::Placement buffer = picture_at(base);
  if (buffer.parts().size() == 1) return add_parts(buffer, host, false, pieces);
  for (const std::uint64_t row : rows_by_part(buffer)) {
    const std::uint64_t words = buffer.row_words();
    pieces.push_back(
        {host + 4 * row * words, static_cast<std::uint32_t>(buffer.address(row, 0) / 4), words, false});
  }
}

void StereoDriver::write_pages(std::uint64_t aperture, std::uint32_t base) {
  const fpga::Placement buffer = picture_at(base);
  for (std::size_t part = 0; part < buffer.parts().size(); ++part) {
    if (buffer.rows_of_part(part, board_.image.height) == 0) continue;
    bus_->write(kBridge + (part == 0 ? bridge_map::kPage : bridge_map::kNextPage) + aperture,
                buffer.parts()[part]);
  }
}

void StereoDriver::start_dma(int channel, const std::vector<Piece>& pieces) {
  const std::uint64_t chain =
      kDevices.host_memory + static_cast<std::uint64_t>(channel) * chain_bytes(board_);
  std::uint8_t* to = bus_->memory(chain, pieces.size() * kDescriptorBytes);
  for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
    const bool last = piece + 1 == pieces.size();
    const std::array<std::uint32_t, 4> descriptor = {
        static_cast<std::uint32_t>(kDevices.host_memory + pieces[piece].host), pieces[piece].board,
        static_cast<std::uint32_t>(pieces[piece].words) | (pieces[piece].to_host ? bridge_map::kToPci : 0U),
        last ? 0U : static_cast<std::uint32_t>(chain + (piece + 1) * kDescriptorBytes)};
    std::memcpy(to + piece * kDescriptorBytes, descriptor.data(), kDescriptorBytes);
  }
  const std::uint64_t registers = static_cast<std::uint64_t>(channel) * bridge_map::kChannelStride;
  bus_->write(kBridge + bridge_map::kDmaDescriptor + registers, static_cast<std::uint32_t>(chain));
  bus_->write(kBridge + bridge_map::kDmaControl + registers, 1);
}

std::uint64_t StereoDriver::pair_in_host(std::uint64_t capture) const {
  return ring_start(board_) +
         capture % static_cast<std::uint64_t>(board_.capture.host_frames) * 2 * image_bytes(board_);
}

std::uint64_t StereoDriver::result_in_host(std::uint64_t frame) const {
  return results_start(board_) + frame % buffers_.disparities.size() * image_bytes(board_);
}

}  // namespace stereotlm::driver

#include "tests/support/plain_computer.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "tests/support/plain_bridge.h"
#include "tests/support/plain_events.h"
#include "tests/support/plain_load.h"

namespace stereotlm::test {
namespace {

// Bus addresses, in words: host memory from 0 on, then the bridge's slave window.
constexpr std::uint64_t kSlaveWindow = std::uint64_t{1} << 31U;

class HostMemory : public PlainTarget {
 public:
  void write(std::uint64_t word, const PlainWords& words) override {
    std::copy(words.begin(), words.end(), at(word, words.size()));
  }
  void read(std::uint64_t word, std::size_t count, PlainTime /*end_ps*/,
            std::function<void(PlainWords)> answer) override {
    const auto first = at(word, count);
    answer(PlainWords(first, first + static_cast<std::ptrdiff_t>(count)));
  }
  PlainWords::iterator at(std::uint64_t word, std::size_t count) {
    if (words_.size() < word + count) words_.resize(word + count);
    return words_.begin() + static_cast<std::ptrdiff_t>(word);
  }

 private:
  PlainWords words_;
};

// The processor. A register access is a PCI transaction of one word, repeated until the target takes it.
class Processor : private PlainMaster {
 public:
  Processor(PlainEvents& events, PlainPciBus& bus, std::function<bool()> interrupt)
      : events_(events), bus_(bus), interrupt_(std::move(interrupt)), master_(bus.add(*this)) {}

  std::uint32_t read(PlainTarget& target, std::uint64_t word, int wait_clocks) {
    return access({false, &target, wait_clocks, word, {0}});
  }
  void write(PlainTarget& target, std::uint64_t word, std::uint32_t value, int wait_clocks) {
    access({true, &target, wait_clocks, word, {value}});
  }
  void wait_for_interrupt() {
    while (!interrupt_()) events_.run_next();
  }

 private:
  std::uint32_t access(PlainBurst burst) {
    burst_ = std::move(burst);
    ended_ = false;
    bus_.request(master_);
    while (!ended_) events_.run_next();
    return word_;
  }
  PlainBurst burst() override { return burst_; }
  void ended(const PlainWords& words) override {
    if (words.empty()) {
      bus_.request(master_);
      return;
    }
    word_ = words.front();
    ended_ = true;
  }

  PlainEvents& events_;
  PlainPciBus& bus_;
  std::function<bool()> interrupt_;
  std::size_t master_;
  PlainBurst burst_;
  bool ended_ = false;
  std::uint32_t word_ = 0;
};

class Computer {
 public:
  explicit Computer(const PlainComputerInput& input)
      : input_(input),
        places_(plain_places(input.board.core)),
        bus_(events_, input.pci_clock_mhz, input.latency_timer_clocks, input.pci_width_bits),
        processor_(events_, bus_, [this] { return bridge_.interrupt() || left_.done() || right_.done(); }),
        left_(events_, bus_, capture_config(input)),
        right_(events_, bus_, capture_config(input)),
        board_(events_, input.board, [this] { bridge_.ring(); }),
        bridge_(events_, bus_, board_, host_memory_,
                {input.local_clock_mhz, static_cast<std::size_t>(input.dma_burst_words),
                 static_cast<std::size_t>(input.posted_words), input.memory_wait_clocks, words_of_row()}),
        left_registers_(left_, place_of(), [this] { frame_begins(); }),
        right_registers_(right_, place_of(), [] {}) {
    if (input.load) load_.emplace(events_, bus_, *input.load);
    if (!input.on_demand) await_frame();
  }

  PlainComputerResult run() {
    run_program();
    events_.run_effects_of_now();
    return result();
  }

 private:
  // The numbers of operations that have begun and that have ended.
  struct Stage {
    std::uint64_t begun = 0;
    std::uint64_t ended = 0;
    bool idle() const { return begun == ended; }
  };
  static constexpr std::size_t kToBoard = 0;
  static constexpr std::size_t kToHost = 1;

  static PlainCaptureConfig capture_config(const PlainComputerInput& input) {
    return {{input.board.core.width, input.board.core.height, input.frame_rate_hz},
            input.fifo_words,
            input.fifo_trigger_words};
  }
  std::function<PlainPicturePlace(std::uint32_t)> place_of() {
    return [this](std::uint32_t word) -> PlainPicturePlace {
      if (word >= kSlaveWindow)
        return {&bridge_.slave(), input_.bridge_wait_clocks, word - kSlaveWindow,
                bridge_.is_striped(word - kSlaveWindow)};
      return {&host_memory_, input_.memory_wait_clocks, word};
    };
  }

  // The cameras.

  void await_frame() {
    events_.at(plain_frame_ps(input_.frame_rate_hz, camera_frames_), PlainPhase::kEffects, [this] {
      frame_begins();
      await_frame();
    });
  }
  void frame_begins() {
    const std::uint64_t number = camera_frames_++;
    undecided_ = true;
    events_.at(events_.now(), PlainPhase::kDecisions, [this, number] { decide(number); });
  }
  // Both captures take the frame that has just begun, or neither.
  void decide(std::uint64_t number) {
    undecided_ = false;
    const bool left_ready = left_.readiness() == PlainCaptureBoard::Readiness::kReady;
    const bool right_ready = right_.readiness() == PlainCaptureBoard::Readiness::kReady;
    if (left_ready && right_ready) begins_ps_[number] = events_.now();
    const PicturePair pair = left_ready && right_ready ? input_.pictures(number) : PicturePair{};
    left_.frame_begins(number, right_ready, pair.left);
    right_.frame_begins(number, left_ready, pair.right);
  }

  // The program (sw/driver/README.md).

  void run_program() {
    upload_tables();
    write(PlainBridgeRegister::kInterruptEnable, ~std::uint32_t{0});
    start_what_can_be();
    while (read_backs_.ended < frames()) {
      processor_.wait_for_interrupt();
      handle_interrupts();
      if (read_backs_.ended < frames()) start_what_can_be();
    }
  }

  void upload_tables() {
    const PlainCycleInput& core = input_.board.core;
    std::vector<PlainDescriptor> chain;
    std::uint64_t host = tables_start();
    const auto add = [&](const PlainParts& parts, const PlainWords& table) {
      add_parts(chain, parts, host, core.width, false);
      for (const int row : rows_by_part(parts)) {
        const auto first = table.begin() + row * core.width;
        host_memory_.write(host, PlainWords(first, first + core.width));
        host += static_cast<std::uint64_t>(core.width);
      }
    };
    if (core.joint_tables) {
      const ReferenceJointTable table = plain_joint_table(core);
      std::uint64_t word = core_word(PlainCoreRegister::kMiddle);
      for (const int middle : {table.left.x, table.left.y, table.right.x, table.right.y})
        processor_.write(bridge_.slave(), word++, static_cast<std::uint32_t>(middle),
                         input_.bridge_wait_clocks);
      add(places_.left_lut, table.words);
    } else {
      add(places_.left_lut, plain_table(core, core.left_lut, core.left_table));
      add(places_.right_lut, plain_table(core, core.right_lut, core.right_table));
    }
    if (chain.empty()) return;
    write(PlainBridgeRegister::kInterruptEnable, kPlainDmaDone);
    start_dma(kToBoard, chain);
    processor_.wait_for_interrupt();
    write(PlainBridgeRegister::kInterruptStatus, read_status());
  }

  void handle_interrupts() {
    const std::uint32_t status = read_status();
    if (status != 0) write(PlainBridgeRegister::kInterruptStatus, status);
    if ((status & kPlainDoorbell) != 0) {
      processor_.read(bridge_.slave(), core_word(PlainCoreRegister::kStatus), input_.bridge_wait_clocks);
      ++frames_.ended;
      acknowledges_ = true;
    }
    if ((status & kPlainDmaDone << kToBoard) != 0) ++copies_.ended;
    if ((status & kPlainDmaDone << kToHost) != 0) deliver();
    if (read_backs_.ended < frames() && !captures_.idle()) handle_captures();
  }

  void handle_captures() {
    for (std::size_t side = 0; side < 2; ++side) {
      PlainCaptureRegisters& registers = side == 0 ? left_registers_ : right_registers_;
      if (side_done_[side] || (read(registers, PlainCaptureRegister::kStatus) & kPlainDone) == 0) continue;
      write(registers, PlainCaptureRegister::kStatus, kPlainDone);
      side_done_[side] = true;
    }
    if (!side_done_[0] || !side_done_[1]) return;
    side_done_ = {};
    ++captures_.ended;
    const auto frame = [this](PlainCaptureRegisters& registers) {
      const std::uint64_t high = read(registers, PlainCaptureRegister::kFrameHigh);
      return high << 32U | read(registers, PlainCaptureRegister::kFrameLow);
    };
    captured_.push_back(frame(left_registers_));
    if (frame(right_registers_) != captured_.back())
      throw std::logic_error("plain computer: the two sides have captured different frames");
  }

  void start_what_can_be() {
    start_core();
    arm_capture();
    copy_pair();
    read_back();
  }

  void start_core() {
    const PlainCycleInput& core = input_.board.core;
    const std::uint64_t frame = frames_.begun;
    const std::uint64_t pairs = input_.capture_to_host ? copies_.ended : captures_.ended;
    const bool starts = frames_.idle() && frame < frames() && frame < pairs &&
                        frame < read_backs_.ended + core.disparity.size();
    if (starts) {
      ++frames_.begun;
      const auto input = static_cast<std::size_t>(frame % core.left_image.size());
      const auto output = static_cast<std::size_t>(frame % core.disparity.size());
      write(PlainCoreRegister::kLeftImage, first_word(places_.left_image[input]));
      write(PlainCoreRegister::kRightImage, first_word(places_.right_image[input]));
      write(PlainCoreRegister::kDisparity, first_word(places_.disparity[output]));
      if (frame == 0 && core.left_lut) write(PlainCoreRegister::kLeftLut, first_word(places_.left_lut));
      if (frame == 0 && core.right_lut && !core.joint_tables)
        write(PlainCoreRegister::kRightLut, first_word(places_.right_lut));
    }
    if (starts || acknowledges_) write(PlainCoreRegister::kControl, starts ? kPlainStart : 0);
    acknowledges_ = false;
  }

  void arm_capture() {
    const PlainCycleInput& core = input_.board.core;
    const std::uint64_t capture = captures_.begun;
    if (!captures_.idle()) return;
    std::uint64_t left = 0;
    std::uint64_t right = 0;
    if (input_.capture_to_host) {
      if (capture >= copies_.ended + static_cast<std::uint64_t>(input_.host_frames)) return;
      left = pair_in_host(capture);
      right = left + picture_words();
    } else {
      if (capture >= frames_.ended + core.left_image.size()) return;
      const auto input = static_cast<std::size_t>(capture % core.left_image.size());
      write_pages(places_.left_image[input], 0);
      write_pages(places_.right_image[input], kPlainMostParts);
      left = kSlaveWindow;
      right = kSlaveWindow + kPlainApertureWords;
    }
    ++captures_.begun;
    write(left_registers_, PlainCaptureRegister::kBuffer, static_cast<std::uint32_t>(left));
    write(right_registers_, PlainCaptureRegister::kBuffer, static_cast<std::uint32_t>(right));
    write(right_registers_, PlainCaptureRegister::kControl, kPlainArm);
    write(left_registers_, PlainCaptureRegister::kControl,
          kPlainArm | (input_.on_demand ? kPlainTrigger : 0));
  }

  void copy_pair() {
    const PlainCycleInput& core = input_.board.core;
    const std::uint64_t pair = copies_.begun;
    if (!input_.capture_to_host || !copies_.idle() || pair >= captures_.ended ||
        pair >= frames_.ended + core.left_image.size()) {
      return;
    }
    ++copies_.begun;
    const auto input = static_cast<std::size_t>(pair % core.left_image.size());
    const std::uint64_t host = pair_in_host(pair);
    std::vector<PlainDescriptor> chain;
    add_picture(chain, places_.left_image[input], host);
    add_picture(chain, places_.right_image[input], host + picture_words());
    start_dma(kToBoard, chain);
  }

  void read_back() {
    const PlainCycleInput& core = input_.board.core;
    const std::uint64_t frame = read_backs_.begun;
    if (!read_backs_.idle() || frame >= frames_.ended) return;
    ++read_backs_.begun;
    const auto output = static_cast<std::size_t>(frame % core.disparity.size());
    std::vector<PlainDescriptor> chain;
    add_parts(chain, places_.disparity[output], result_in_host(frame), words_of_row(), true);
    start_dma(kToHost, chain);
  }

  void deliver() {
    const std::uint64_t frame = read_backs_.ended++;
    PlainDelivery delivery;
    delivery.camera_frame = captured_[static_cast<std::size_t>(frame)];
    delivery.begin_ps = begins_ps_.at(delivery.camera_frame);
    delivery.host_ps = events_.now();
    auto words = host_memory_.at(result_in_host(frame), picture_words());
    delivery.disparity.resize(4 * picture_words());
    for (const int row : rows_by_part(places_.disparity[frame % places_.disparity.size()])) {
      auto pixel = delivery.disparity.begin() + row * input_.board.core.width;
      for (int word = 0; word < words_of_row(); ++word, ++words) {
        for (unsigned byte = 0; byte < 4; ++byte) *pixel++ = static_cast<std::uint8_t>(*words >> (8 * byte));
      }
    }
    deliveries_.push_back(std::move(delivery));
  }

  // The rows of a table or a result in the order in which host memory holds them: part by part.
  std::vector<int> rows_by_part(const PlainParts& parts) const {
    std::vector<int> rows;
    for (std::size_t part = 0; part < parts.size(); ++part) {
      for (auto row = static_cast<int>(part); row < input_.board.core.height;
           row += static_cast<int>(parts.size()))
        rows.push_back(row);
    }
    return rows;
  }

  // One descriptor for each part that has rows.
  void add_parts(std::vector<PlainDescriptor>& chain, const PlainParts& parts, std::uint64_t host,
                 int words_of_row, bool to_host) const {
    for (std::size_t part = 0; part < parts.size(); ++part) {
      const int rows = plain_rows(parts.size(), part, input_.board.core.height);
      if (rows == 0) continue;
      const auto words = static_cast<std::uint64_t>(rows * words_of_row);
      chain.push_back({host, plain_board_word(parts[part]), to_host, words});
      host += words;
    }
  }

  // One descriptor for each row of a striped picture, part by part: the ring holds it row by row.
  void add_picture(std::vector<PlainDescriptor>& chain, const PlainParts& parts, std::uint64_t host) const {
    if (parts.size() == 1) return add_parts(chain, parts, host, words_of_row(), false);
    const auto words = static_cast<std::uint64_t>(words_of_row());
    for (const int row : rows_by_part(parts)) {
      chain.push_back({host + static_cast<std::uint64_t>(row) * words,
                       plain_board_word(plain_word(parts, row, 0, words_of_row())), false, words});
    }
  }

  // The page of each part that has rows.
  void write_pages(const PlainParts& parts, std::uint64_t page0) {
    for (std::size_t part = 0; part < parts.size(); ++part) {
      if (plain_rows(parts.size(), part, input_.board.core.height) == 0) continue;
      write_bridge(page0 + part, static_cast<std::uint32_t>(plain_board_word(parts[part])));
    }
  }

  void start_dma(std::size_t channel, const std::vector<PlainDescriptor>& chain) {
    bridge_.set_chain(channel, chain);
    const std::uint64_t words = channel * kPlainChannelWords;
    write_bridge(static_cast<std::uint64_t>(PlainBridgeRegister::kDescriptor0) + words, 0);
    write_bridge(static_cast<std::uint64_t>(PlainBridgeRegister::kControl0) + words, 1);
  }

  // Accesses to registers.

  void write(PlainBridgeRegister which, std::uint32_t value) {
    write_bridge(static_cast<std::uint64_t>(which), value);
  }
  void write_bridge(std::uint64_t word, std::uint32_t value) {
    processor_.write(bridge_.registers(), word, value, input_.bridge_wait_clocks);
  }
  std::uint32_t read_status() {
    return processor_.read(bridge_.registers(),
                           static_cast<std::uint64_t>(PlainBridgeRegister::kInterruptStatus),
                           input_.bridge_wait_clocks);
  }
  static std::uint64_t core_word(PlainCoreRegister which) {
    return kPlainCoreWindow + static_cast<std::uint64_t>(which);
  }
  void write(PlainCoreRegister which, std::uint32_t value) {
    processor_.write(bridge_.slave(), core_word(which), value, input_.bridge_wait_clocks);
  }
  void write(PlainCaptureRegisters& registers, PlainCaptureRegister which, std::uint32_t value) {
    processor_.write(registers, static_cast<std::uint64_t>(which), value, input_.bridge_wait_clocks);
  }
  std::uint32_t read(PlainCaptureRegisters& registers, PlainCaptureRegister which) {
    return processor_.read(registers, static_cast<std::uint64_t>(which), input_.bridge_wait_clocks);
  }

  // Host memory: descriptors, tables, pairs, results.

  std::uint64_t frames() const { return static_cast<std::uint64_t>(input_.frames); }
  std::uint64_t picture_words() const {
    return static_cast<std::uint64_t>(input_.board.core.width) *
           static_cast<std::uint64_t>(input_.board.core.height) / 4;
  }
  int words_of_row() const { return input_.board.core.width / 4; }
  std::uint64_t tables_start() const { return 64; }
  std::uint64_t pair_in_host(std::uint64_t pair) const {
    const std::uint64_t slot = pair % static_cast<std::uint64_t>(input_.host_frames);
    return tables_start() + (8 + 2 * slot) * picture_words();
  }
  std::uint64_t result_in_host(std::uint64_t frame) const {
    const std::uint64_t pairs = static_cast<std::uint64_t>(input_.host_frames);
    return tables_start() + (8 + 2 * pairs + frame % input_.board.core.disparity.size()) * picture_words();
  }
  static std::uint32_t first_word(const PlainParts& parts) {
    return static_cast<std::uint32_t>(plain_board_word(parts.front()));
  }

  PlainComputerResult result() {
    if (undecided_) {
      left_.drop_frame();
      right_.drop_frame();
    }
    PlainComputerResult result;
    result.core = board_.core_result();
    result.deliveries = deliveries_;
    result.pci_clocks = bus_.clocks();
    result.pci_busy_clocks = bus_.busy_clocks();
    for (std::size_t master = 0; master < (input_.load ? 5 : 4); ++master)
      result.masters.push_back(bus_.stats(master));
    const PlainBridge::Stats bridge = bridge_.stats();
    result.posted_words = bridge.posted_words;
    result.dma_words = bridge.dma_words;
    result.local_clocks = bridge.local_clocks;
    result.local_busy_clocks = bridge.local_busy_clocks;
    result.cameras = {PlainComputerResult::Camera{camera_frames_, left_.stats()},
                      PlainComputerResult::Camera{camera_frames_, right_.stats()}};
    result.pci_bursts = bus_.bursts();
    result.local_bursts = bridge_.local_bursts();
    result.posted_levels = bridge_.posted_levels();
    result.fifo_levels = {left_.levels(), right_.levels()};
    return result;
  }

  const PlainComputerInput& input_;
  PlainPlaces places_;
  PlainEvents events_;
  HostMemory host_memory_;
  PlainPciBus bus_;  // its masters in the order of the contract: host, captures, bridge, load
  Processor processor_;
  PlainCaptureBoard left_;
  PlainCaptureBoard right_;
  PlainBoard board_;
  PlainBridge bridge_;
  PlainCaptureRegisters left_registers_;
  PlainCaptureRegisters right_registers_;
  std::optional<PlainLoadMaster> load_;

  std::uint64_t camera_frames_ = 0;               // begun
  bool undecided_ = false;                        // decide() has not yet run for the last of them
  std::map<std::uint64_t, PlainTime> begins_ps_;  // of captured frames

  Stage captures_;
  Stage copies_;
  Stage frames_;
  Stage read_backs_;
  std::array<bool, 2> side_done_{};
  bool acknowledges_ = false;
  std::vector<std::uint64_t> captured_;  // camera frames
  std::vector<PlainDelivery> deliveries_;
};

}  // namespace

PlainComputerResult run_plain_computer(const PlainComputerInput& input) { return Computer(input).run(); }

}  // namespace stereotlm::test

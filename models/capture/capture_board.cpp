#include "models/capture/capture_board.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "models/clock.h"
#include "models/kernels/words.h"
#include "models/register_access.h"

namespace stereotlm::capture {
namespace {

std::uint64_t now_ps() { return Clock::to_ps(sc_core::sc_time_stamp()); }

void report(const sc_core::sc_object& board, const std::string& text) {
  SC_REPORT_ERROR("/stereotlm/capture_board", (std::string(board.name()) + ": " + text).c_str());
}

bool is_error(pci::BurstEnd end) {
  return end == pci::BurstEnd::kMasterAbort || end == pci::BurstEnd::kTargetError;
}

}  // namespace

CaptureBoard::CaptureBoard(const sc_core::sc_module_name& name, const CaptureBoardConfig& config)
    : sc_module(name), fifo_(config) {
  SC_HAS_PROCESS(CaptureBoard);
  SC_METHOD(decide);
  sensitive << decision_;
  dont_initialize();
  SC_METHOD(proceed);
  sensitive << finish_due_;
  dont_initialize();
  registers.register_b_transport(this, &CaptureBoard::transport);
  registers.register_transport_dbg(this, &CaptureBoard::debug);
  as_partner.bind(*this);
  interrupt.bind(*this);
}

CaptureBoard::Stats CaptureBoard::stats() const {
  Stats stats = stats_;
  CaptureFifo fifo = fifo_;
  if (bus_state_ == BusState::kBurst) {
    leave(fifo, pci->transferred());
  } else if (capturing_) {
    fifo.advance(now_ps());
  }
  stats.dropped_pixels = fifo.dropped_pixels();
  return stats;
}

tlm::tlm_response_status CaptureBoard::check(const tlm::tlm_generic_payload& access) {
  const std::uint64_t address = access.get_address();
  const tlm::tlm_response_status status = check_register_access(access, registers::kEnd);
  if (status != tlm::TLM_OK_RESPONSE) return status;
  const bool write_only = address == registers::kControl;
  const bool read_only = address >= registers::kFrameNumberLow;
  if (access.is_read() ? write_only : read_only) return tlm::TLM_COMMAND_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

void CaptureBoard::transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  const tlm::tlm_response_status status = check(access);
  access.set_response_status(status);
  if (status != tlm::TLM_OK_RESPONSE) {
    ++stats_.refused_accesses;
    return;
  }
  std::uint32_t value = 0;
  if (access.is_read()) {
    value = read(access.get_address());
    std::memcpy(access.get_data_ptr(), &value, 4);
  } else {
    std::memcpy(&value, access.get_data_ptr(), 4);
    write(access.get_address(), value, delay);
  }
}

unsigned CaptureBoard::debug(tlm::tlm_generic_payload& access) {
  if (!access.is_read() || check(access) != tlm::TLM_OK_RESPONSE) return 0;
  const std::uint32_t value = read(access.get_address());
  std::memcpy(access.get_data_ptr(), &value, 4);
  return 4;
}

std::uint32_t CaptureBoard::read(std::uint64_t address) const {
  const Capture last = last_capture_.value_or(Capture{});
  switch (address) {
    case registers::kStatus:
      return (armed_ ? registers::kStatusArmed : 0U) | (capturing_ ? registers::kStatusCapturing : 0U) |
             (done_ ? registers::kStatusDone : 0U) | (words_lost_ ? registers::kStatusWordsLost : 0U) |
             (arm_refused_ ? registers::kStatusArmRefused : 0U);
    case registers::kBufferAddress:
      return buffer_address_;
    case registers::kFrameNumberLow:
      return static_cast<std::uint32_t>(last.frame);
    case registers::kFrameNumberHigh:
      return static_cast<std::uint32_t>(last.frame >> 32U);
    case registers::kDroppedPixels:
      return static_cast<std::uint32_t>(last.dropped_pixels);
    default:
      return static_cast<std::uint32_t>(last.lost_words);
  }
}

void CaptureBoard::write(std::uint64_t address, std::uint32_t value, const sc_core::sc_time& delay) {
  if (address == registers::kBufferAddress) {
    buffer_address_ = value;
    return;
  }
  if (address == registers::kStatus) {
    done_ = done_ && (value & registers::kStatusDone) == 0;
    words_lost_ = words_lost_ && (value & registers::kStatusWordsLost) == 0;
    arm_refused_ = arm_refused_ && (value & registers::kStatusArmRefused) == 0;
    interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
    return;
  }
  if ((value & registers::kControlArm) != 0) arm(now_ps() + Clock::to_ps(delay));
  if ((value & registers::kControlTrigger) != 0) {
    for (int camera = 0; camera < triggers_out.size(); ++camera) triggers_out[camera]->push({delay});
  }
}

void CaptureBoard::arm(std::uint64_t time_ps) {
  if (armed_ || buffer_address_ % 4 != 0) {
    arm_refused_ = true;
    return;
  }
  armed_ = true;
  armed_ps_ = time_ps;
  armed_address_ = buffer_address_;
}

void CaptureBoard::take_frame(const VideoFrame& frame) {
  frame_ = frame;
  readiness_.reset();
  undecided_ = true;
  decision_.notify(Clock::to_time(1));
}

CaptureBoard::Readiness CaptureBoard::readiness() {
  if (!readiness_) {
    const std::uint64_t begin_ps = frame_->begin_ps;
    if (!armed_ || armed_ps_ > begin_ps) {
      readiness_ = Readiness::kNotArmed;
    } else if (capturing_ || (last_capture_ && last_capture_->end_ps > begin_ps)) {
      readiness_ = Readiness::kBusy;
    } else {
      readiness_ = Readiness::kReady;
    }
  }
  return *readiness_;
}

bool CaptureBoard::can_start(std::uint64_t frame, std::uint64_t begin_ps) {
  if (!frame_ || frame_->number != frame || frame_->begin_ps != begin_ps) return false;
  return readiness() == Readiness::kReady;
}

void CaptureBoard::decide() {
  undecided_ = false;
  const bool partner_can = partner.size() == 0 || partner->can_start(frame_->number, frame_->begin_ps);
  switch (readiness()) {
    case Readiness::kNotArmed:
      ++stats_.dropped_not_armed;
      return;
    case Readiness::kBusy:
      ++stats_.dropped_busy;
      return;
    case Readiness::kReady:
      break;
  }
  if (partner_can) {
    start();
  } else {
    ++stats_.dropped_by_partner;
  }
}

void CaptureBoard::start() {
  ++stats_.started_frames;
  armed_ = false;
  capturing_ = true;
  address_ = armed_address_;
  capture_ = {frame_->number, frame_->begin_ps, 0, fifo_.dropped_pixels(), 0};
  lines_.clear();
  fifo_.begin_frame(*frame_->timing, frame_->begin_ps);
  takes_out->push({frame_->number});
}

void CaptureBoard::take_line(const VideoLine& line) {
  if (!capturing_ || line.row != static_cast<int>(lines_.size())) {
    report(*this, "line " + std::to_string(line.row) + " came: no capture expects it");
    return;
  }
  lines_.push_back(line.pixels);
  proceed();
}

void CaptureBoard::proceed() {
  if (bus_state_ != BusState::kIdle) return;
  const std::uint64_t now = now_ps();
  fifo_.advance(now);
  const auto next = fifo_.next_ps();
  if (!next) return;
  if (!fifo_.finishes_next()) {
    bus_state_ = BusState::kRequested;
    requested_ps_ = *next;
    pci->request(*this, *next);
  } else if (*next > now) {
    finish_due_.notify(Clock::to_time(*next - now));
  } else {
    finish(now);
  }
}

void CaptureBoard::finish(std::uint64_t now) {
  capturing_ = false;
  ++stats_.captured_frames;
  capture_.end_ps = now;
  capture_.dropped_pixels = fifo_.dropped_pixels() - capture_.dropped_pixels;
  last_capture_ = capture_;
  done_ = true;
  interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
}

pci::PciBurst CaptureBoard::begin_burst(std::uint64_t address_clock_ps) {
  if (bus_state_ != BusState::kRequested || address_clock_ps < requested_ps_) {
    report(*this, "bus granted from " + std::to_string(address_clock_ps) +
                      " ps on: must have been asked for by then");
    return {};
  }
  bus_state_ = BusState::kBurst;
  ++stats_.bursts;
  fifo_.advance(address_clock_ps);
  burst_words_.resize(static_cast<std::size_t>(fifo_.grant(burst_)));
  std::uint32_t* to = burst_words_.data();
  for (const LineWords& line : burst_) {
    const std::uint8_t* pixel =
        lines_[static_cast<std::size_t>(line.row)] + std::ptrdiff_t{line.first} * kernels::kPixelsPerWord;
    for (int word = 0; word < line.count; ++word, pixel += kernels::kPixelsPerWord)
      *to++ = kernels::word_of_pixels(pixel);
  }
  const auto line = static_cast<std::uint64_t>(burst_.front().row);
  const auto word = static_cast<std::uint64_t>(burst_.front().first);
  return {true, address_ + 4 * (line * fifo_.words_per_line() + word), &burst_words_};
}

bool CaptureBoard::fits(const pci::BurstResult& result) const {
  if (bus_state_ != BusState::kBurst) return false;
  switch (result.end) {
    case pci::BurstEnd::kComplete:
      return result.words == burst_words_.size();
    case pci::BurstEnd::kLatencyTimer:
      return result.words > 0 && result.words < burst_words_.size();
    case pci::BurstEnd::kDisconnect:
      return result.words < burst_words_.size();
    case pci::BurstEnd::kMasterAbort:
    case pci::BurstEnd::kTargetError:
      break;
  }
  return result.words == 0;
}

// The words that the bus has transferred by now have left the FIFO, each at the end of its data clock.
void CaptureBoard::leave(CaptureFifo& fifo, const pci::BurstResult& transferred) const {
  const Clock& clock = pci->clock();
  fifo.leave(now_ps(), static_cast<int>(transferred.words), [&transferred, &clock](std::uint64_t time_ps) {
    // Edges after first_data_clock, up to the time.
    const std::uint64_t edges = clock.edge_at_or_after(time_ps + 1) - 1;
    if (edges <= transferred.first_data_clock) return 0;
    return static_cast<int>(std::min<std::uint64_t>(edges - transferred.first_data_clock, transferred.words));
  });
}

void CaptureBoard::end_burst(const pci::BurstResult& result) {
  if (!fits(result)) {
    report(*this, "a burst ended with " + std::to_string(result.words) + " words: none such is running");
    return;
  }
  bus_state_ = BusState::kIdle;
  const std::uint64_t now = now_ps();
  if (is_error(result.end)) {
    const int words = static_cast<int>(burst_words_.size());
    fifo_.leave(now, words, [now, words](std::uint64_t time_ps) { return time_ps < now ? 0 : words; });
    ++stats_.bus_errors;
    stats_.lost_words += burst_words_.size();
    capture_.lost_words += burst_words_.size();
    words_lost_ = true;
    interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
  } else {
    leave(fifo_, result);
    stats_.words += result.words;
  }
  proceed();
}

}  // namespace stereotlm::capture

#include "models/capture/capture_control.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "models/capture/capture_registers.h"

namespace stereotlm::capture {

namespace {

// Whether there is a register at this byte address, and whether it has this direction.
bool allows(bool write, std::uint64_t address) {
  return write ? address < registers::kFrameNumberLow
               : address != registers::kControl && address < registers::kEnd;
}

}  // namespace

CaptureControl::CaptureControl(const CaptureBoardConfig& config) : fifo_(config) {
  burst_words_.reserve(static_cast<std::size_t>(config.fifo_words));
}

void CaptureControl::bind(pci::PciSlot& slot, FrameCamera& camera) {
  slot_ = &slot;
  camera_ = &camera;
}

void CaptureControl::step(std::uint64_t now_ps) {
  if (finish_ps_ == now_ps) {
    finish_ps_ = kNever;
    fifo_.advance(now_ps);
    finish(now_ps);
  }
  if (decision_ps_ == now_ps) {
    decision_ps_ = kNever;
    decide(now_ps);
  }
  next_ps_ = std::min(decision_ps_, finish_ps_);
}

pci::PciAnswer CaptureControl::access(std::uint64_t /*now_ps*/, const pci::PciAccess& access,
                                      std::uint64_t at_ps) {
  if (access.count != 1 || !allows(access.write, access.address)) {
    ++stats_.refused_accesses;
    return {at_ps, false};
  }
  if (access.write) {
    write_register(at_ps, access.address, *access.words);
  } else {
    *access.words = read_register(access.address);
  }
  return {at_ps, true};
}

std::uint32_t CaptureControl::read_register(std::uint64_t address) const {
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

void CaptureControl::write_register(std::uint64_t time_ps, std::uint64_t address, std::uint32_t value) {
  switch (address) {
    case registers::kBufferAddress:
      buffer_address_ = value;
      return;
    case registers::kStatus: {
      const bool interrupted = interrupt();
      done_ = done_ && (value & registers::kStatusDone) == 0;
      words_lost_ = words_lost_ && (value & registers::kStatusWordsLost) == 0;
      arm_refused_ = arm_refused_ && (value & registers::kStatusArmRefused) == 0;
      if (observer_ != nullptr && interrupted && !interrupt()) observer_->interrupt_cleared(time_ps);
      return;
    }
    default:
      if ((value & registers::kControlArm) != 0) arm(time_ps);
      if ((value & registers::kControlTrigger) == 0) return;
      for (FrameCamera* const camera : triggered_) camera->trigger(time_ps);
  }
}

void CaptureControl::arm(std::uint64_t time_ps) {
  if (armed_ || buffer_address_ % 4 != 0) {
    arm_refused_ = true;
    return;
  }
  armed_ = true;
  armed_ps_ = time_ps;
  armed_address_ = buffer_address_;
}

void CaptureControl::begin_frame(const VideoFrame& frame) {
  frame_ = frame;
  if (observer_ != nullptr) observer_->frame_begun(frame.number, frame.begin_ps);
  readiness_ = Readiness::kNotEvaluated;
  decision_ps_ = frame.begin_ps + 1;
  next_ps_ = std::min(decision_ps_, finish_ps_);
}

CaptureControl::Readiness CaptureControl::readiness() {
  if (readiness_ == Readiness::kNotEvaluated) {
    const std::uint64_t begin_ps = frame_.begin_ps;
    if (!armed_ || armed_ps_ > begin_ps) {
      readiness_ = Readiness::kNotArmed;
    } else if (capturing() || (last_capture() && last_capture()->end_ps > begin_ps)) {
      readiness_ = Readiness::kBusy;
    } else {
      readiness_ = Readiness::kReady;
    }
  }
  return readiness_;
}

bool CaptureControl::can_start(std::uint64_t frame, std::uint64_t begin_ps) {
  if (frame_.timing == nullptr || frame_.number != frame || frame_.begin_ps != begin_ps) return false;
  return readiness() == Readiness::kReady;
}

void CaptureControl::decide(std::uint64_t now_ps) {
  const bool partner_can = partner_ == nullptr || partner_->can_start(frame_.number, frame_.begin_ps);
  switch (readiness()) {
    case Readiness::kNotArmed:
      return drop(DropReason::kNotArmed, stats_.dropped_not_armed);
    case Readiness::kBusy:
      return drop(DropReason::kBusy, stats_.dropped_busy);
    default:
      partner_can ? start(now_ps) : drop(DropReason::kPartner, stats_.dropped_by_partner);
  }
}

void CaptureControl::drop(DropReason reason, std::uint64_t& count) {
  ++count;
  if (observer_ != nullptr) observer_->frame_dropped(frame_.number, frame_.begin_ps, reason);
}

void CaptureControl::start(std::uint64_t now_ps) {
  ++stats_.started_frames;
  armed_ = false;
  capturing_ = true;
  address_ = armed_address_;
  capture_ = {frame_.number, frame_.begin_ps, 0, fifo_.dropped_pixels(), 0, stats_.words};
  if (observer_ != nullptr) observer_->capture_begun(frame_.number, frame_.begin_ps);
  fifo_.begin_frame(*frame_.timing, frame_.begin_ps);
  if (!camera_->take(frame_.number)) return;  // this capture never ends
  fifo_.advance(now_ps);
  proceed(now_ps);
}

// Called while no burst runs. If the frame has words left, requests the bus for the time at which the FIFO
// needs it. Else finishes the capture.
void CaptureControl::proceed(std::uint64_t now_ps) {
  const std::uint64_t next_ps = fifo_.next_ps();
  if (!fifo_.finishes_next()) {
    bus_state_ = BusState::kRequested;
    requested_ps_ = next_ps;
    slot_->request(*this, next_ps);
  } else if (next_ps > now_ps) {
    finish_ps_ = next_ps;
    next_ps_ = std::min(decision_ps_, finish_ps_);
  } else {
    finish(now_ps);
  }
}

void CaptureControl::finish(std::uint64_t now_ps) {
  ++stats_.captured_frames;
  capture_.end_ps = now_ps;
  capture_.dropped_pixels = fifo_.dropped_pixels() - capture_.dropped_pixels;
  capture_.words = stats_.words - capture_.words;
  capturing_ = false;
  done_ = true;
  last_capture_ = capture_;
  if (observer_ != nullptr) observer_->capture_ended(capture_);
}

pci::PciBurst CaptureControl::begin_burst(std::uint64_t address_clock_ps) {
  if (bus_state_ != BusState::kRequested || address_clock_ps < requested_ps_) {
    throw std::logic_error("bus granted at " + std::to_string(address_clock_ps) +
                           " ps: must have been requested by then");
  }
  bus_state_ = BusState::kBurst;
  ++stats_.bursts;
  fifo_.advance(address_clock_ps);
  const FrameWords words = fifo_.grant();
  burst_words_.resize(static_cast<std::size_t>(words.count));
  camera_->copy_words(words.first, words.count, burst_words_.data());
  return {true, address_ + 4 * static_cast<std::uint64_t>(words.first), &burst_words_};
}

bool CaptureControl::fits(const pci::BurstResult& result) const {
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

void CaptureControl::end_burst(const pci::BurstResult& result) {
  if (!fits(result)) {
    throw std::logic_error("a burst ended with " + std::to_string(result.words) +
                           " words: no such burst runs");
  }
  bus_state_ = BusState::kIdle;
  if (is_error(result.end)) {
    fifo_.lose(result.end_ps, static_cast<int>(burst_words_.size()));
    ++stats_.bus_errors;
    stats_.lost_words += burst_words_.size();
    capture_.lost_words += burst_words_.size();
    words_lost_ = true;
  } else {
    fifo_.transfer(result.end_ps, result, slot_->clock());
    stats_.words += result.words;
  }
  proceed(result.end_ps);
}

CaptureFifo CaptureControl::fifo_at(std::uint64_t now_ps) const {
  CaptureFifo fifo = fifo_;
  if (bus_state_ == BusState::kBurst) {
    fifo.transfer(now_ps, slot_->transferred(now_ps), slot_->clock());
  } else if (capturing()) {
    fifo.advance(now_ps);
  }
  return fifo;
}

CaptureControl::Stats CaptureControl::stats(std::uint64_t now_ps) const {
  Stats stats = stats_;
  stats.dropped_pixels = fifo_at(now_ps).dropped_pixels();
  return stats;
}

}  // namespace stereotlm::capture

#include "models/capture/capture_board.h"

#include <algorithm>
#include <string>

#include "models/clock.h"
#include "models/kernel_time.h"
#include "models/kernels/words.h"

namespace stereotlm::capture {
namespace {

void report(const sc_core::sc_object& board, const std::string& text) {
  SC_REPORT_ERROR("/stereotlm/capture_board", (std::string(board.name()) + ": " + text).c_str());
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
  registers.register_b_transport(this, &CaptureBoard::access_registers);
  registers.register_transport_dbg(this, &CaptureBoard::debug_registers);
  as_partner.bind(*this);
  interrupt.bind(register_file_);
}

CaptureBoard::Stats CaptureBoard::stats() const {
  Stats stats = stats_;
  CaptureFifo fifo = fifo_;
  if (bus_state_ == BusState::kBurst) {
    leave(fifo, pci->transferred(kernel_time::now_ps()));
  } else if (register_file_.capturing()) {
    fifo.advance(kernel_time::now_ps());
  }
  stats.dropped_pixels = fifo.dropped_pixels();
  return stats;
}

void CaptureBoard::access_registers(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  if (register_file_.access(access, delay)) {
    for (int camera = 0; camera < triggers_out.size(); ++camera) triggers_out[camera]->push({delay});
  }
  if (!access.is_response_ok()) ++stats_.refused_accesses;
}

void CaptureBoard::take_frame(const VideoFrame& frame) {
  frame_ = frame;
  readiness_.reset();
  undecided_ = true;
  decision_.notify(kernel_time::to_time(1));
}

CaptureBoard::Readiness CaptureBoard::readiness() {
  if (!readiness_) {
    const std::uint64_t begin_ps = frame_->begin_ps;
    if (!register_file_.armed_at(begin_ps)) {
      readiness_ = Readiness::kNotArmed;
    } else if (register_file_.capturing() || (last_capture() && last_capture()->end_ps > begin_ps)) {
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
  address_ = register_file_.start();
  capture_ = {frame_->number, frame_->begin_ps, 0, fifo_.dropped_pixels(), 0};
  lines_.clear();
  fifo_.begin_frame(*frame_->timing, frame_->begin_ps);
  takes_out->push({frame_->number});
}

void CaptureBoard::take_line(const VideoLine& line) {
  if (!register_file_.capturing() || line.row != static_cast<int>(lines_.size())) {
    report(*this, "line " + std::to_string(line.row) + " came: no capture expects it");
    return;
  }
  lines_.push_back(line.pixels);
  proceed();
}

// Unless the board has requested the bus or runs a burst: requests the bus for the time at which the FIFO
// needs it, or finishes the capture when the FIFO has finished.
void CaptureBoard::proceed() {
  if (bus_state_ != BusState::kIdle) return;
  const std::uint64_t now = kernel_time::now_ps();
  fifo_.advance(now);
  const auto next = fifo_.next_ps();
  if (!next) return;
  if (!fifo_.finishes_next()) {
    bus_state_ = BusState::kRequested;
    requested_ps_ = *next;
    pci->request(*this, *next);
  } else if (*next > now) {
    finish_due_.notify(kernel_time::to_time(*next - now));
  } else {
    finish(now);
  }
}

void CaptureBoard::finish(std::uint64_t now_ps) {
  ++stats_.captured_frames;
  capture_.end_ps = now_ps;
  capture_.dropped_pixels = fifo_.dropped_pixels() - capture_.dropped_pixels;
  register_file_.finish(capture_);
}

pci::PciBurst CaptureBoard::begin_burst(std::uint64_t address_clock_ps) {
  if (bus_state_ != BusState::kRequested || address_clock_ps < requested_ps_) {
    report(*this,
           "bus granted at " + std::to_string(address_clock_ps) + " ps: must have been requested by then");
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

// Removes the words transferred by now from the FIFO, each at the end of its data clock.
void CaptureBoard::leave(CaptureFifo& fifo, const pci::BurstResult& transferred) const {
  const Clock& clock = pci->clock();
  fifo.leave(kernel_time::now_ps(), static_cast<int>(transferred.words),
             [&transferred, &clock](std::uint64_t time_ps) {
               // One word leaves at each clock edge after the beginning of first_data_clock.
               const std::uint64_t edges = clock.edge_at_or_after(time_ps + 1) - 1;
               if (edges <= transferred.first_data_clock) return 0;
               return static_cast<int>(
                   std::min<std::uint64_t>(edges - transferred.first_data_clock, transferred.words));
             });
}

void CaptureBoard::end_burst(const pci::BurstResult& result) {
  if (!fits(result)) {
    report(*this, "a burst ended with " + std::to_string(result.words) + " words: no such burst runs");
    return;
  }
  bus_state_ = BusState::kIdle;
  const std::uint64_t now = kernel_time::now_ps();
  if (is_error(result.end)) {
    const int words = static_cast<int>(burst_words_.size());
    fifo_.leave(now, words, [now, words](std::uint64_t time_ps) { return time_ps < now ? 0 : words; });
    ++stats_.bus_errors;
    stats_.lost_words += burst_words_.size();
    capture_.lost_words += burst_words_.size();
    register_file_.lose_words();
  } else {
    leave(fifo_, result);
    stats_.words += result.words;
  }
  proceed();
}

}  // namespace stereotlm::capture

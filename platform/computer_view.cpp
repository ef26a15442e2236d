#include "platform/computer_view.h"

namespace stereotlm::platform {

ComputerCounters ComputerView::counters() {
  const ComputerControls of = controls();
  const std::uint64_t now = now_ps();
  const auto camera = [&](std::size_t side) {
    return ComputerCounters::Camera{of.cameras[side]->stats().frames, of.captures[side]->undecided(),
                                    of.captures[side]->stats(now)};
  };
  return {board_counters(),
          of.pci_bus.stats(now),
          of.bridge.stats(),
          of.local_bus.stats(now),
          {of.bridge.words_taken().words(), of.bridge.words_held().words(),
           of.local_bus.words_to_grant().words(), of.local_bus.words_granted().words()},
          {camera(0), camera(1)}};
}

std::uint64_t ComputerView::work_done() {
  catch_up();
  const ComputerControls of = controls();
  return of.core.control().work() + words_for_results(of.pci_bus.stats(now_ps()));
}

void ComputerView::record(Timeline& timeline) {
  const ComputerControls of = controls();
  for (std::size_t side = 0; side < of.captures.size(); ++side)
    of.captures[side]->observe(timeline.capture_board(side));
  of.bridge.observe(timeline.bridge());
  of.core.observe(timeline.core());
}

void ComputerView::trace_buses(BusTrace& trace) {
  const ComputerControls of = controls();
  of.pci_bus.observe(trace.pci_bus());
  of.bridge.observe(trace.bridge());
  of.local_bus.observe(trace.local_bus());
  of.core.observe(trace.core());
  for (std::size_t side = 0; side < of.captures.size(); ++side)
    of.captures[side]->observe(trace.capture_fifo(side));
  trace.set_show_words([captures = of.captures](std::uint64_t now) {
    for (const capture::CaptureControl* const capture : captures) capture->show_words(now);
  });
}

}  // namespace stereotlm::platform

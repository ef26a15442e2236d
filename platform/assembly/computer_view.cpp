#include "platform/assembly/computer_view.h"

#include <utility>

namespace stereotlm::platform {

ComputerCounters ComputerControls::counters(BoardCounters board, std::uint64_t now_ps) const {
  const auto camera = [&](std::size_t side) {
    return ComputerCounters::Camera{cameras[side]->stats().frames, captures[side]->undecided(),
                                    captures[side]->stats(now_ps)};
  };
  return {std::move(board),
          pci_bus.stats(now_ps),
          bridge.stats(),
          local_bus.stats(now_ps),
          {bridge.words_taken().words(), bridge.words_held().words(), local_bus.words_to_grant().words(),
           local_bus.words_granted().words()},
          {camera(0), camera(1)}};
}

void ComputerView::record(Timeline& timeline) {
  const ComputerControls of = controls();
  for (std::size_t side = 0; side < of.captures.size(); ++side)
    of.captures[side]->observe(timeline.capture_board(side));
  of.bridge.observe(timeline);
  of.core.observe(timeline);
}

void ComputerView::trace_buses(BusTrace& trace) {
  const ComputerControls of = controls();
  of.pci_bus.observe(trace);
  of.bridge.observe(trace);
  of.local_bus.observe(trace);
  of.core.observe(trace);
  for (std::size_t side = 0; side < of.captures.size(); ++side)
    of.captures[side]->observe(trace.capture_fifo(side));
  trace.set_show_words([captures = of.captures](std::uint64_t now) {
    for (const capture::CaptureControl* const capture : captures) capture->show_words(now);
  });
}

std::uint64_t ComputerView::work_done() {
  const ComputerControls of = controls();
  return of.core.work() + words_for_results(of.pci_bus.stats(now_ps()));
}

}  // namespace stereotlm::platform

#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <systemc>
#include <vector>

#include "models/clock.h"
#include "models/pci/pci_slot_if.h"

namespace stereotlm::test {

// How the test bus treats a request.
struct BusTurn {
  std::uint64_t busy_clocks = 0;  // clocks of other masters, from the first clock at or after the request
  std::uint64_t wait_clocks = 0;  // between the address clock and the first data clock
  std::size_t limit = std::numeric_limits<std::size_t>::max();  // after so many words `cut` ends the burst
  pci::BurstEnd cut = pci::BurstEnd::kLatencyTimer;
};

// A PCI bus with one slot, which follows the test's plan and records each burst.
class TestBus : public sc_core::sc_module, private pci::PciSlotIf {
 public:
  struct Burst {
    std::uint64_t requested_ps = 0;
    std::uint64_t address_clock_ps = 0;
    std::uint64_t address = 0;
    std::vector<std::uint32_t> words;
    pci::BurstResult result;
    std::uint64_t end_ps = 0;
  };

  pci::PciSlotExport slot{"slot"};
  std::function<BusTurn(std::size_t request)> plan;  // turn of each request
  BusTurn turn;                                      // turn of every request, if there is no plan
  std::vector<Burst> bursts;                         // the last one may be running
  std::vector<std::uint64_t> requests_ps;            // the last one may wait
  std::map<std::uint64_t, std::uint32_t> memory;     // written words by address

  TestBus(const sc_core::sc_module_name& name, double clock_mhz);

  const Clock& clock() const override { return clock_; }
  pci::BurstResult transferred(std::uint64_t now_ps) const override;
  // The time at which a word of a burst has left its master.
  std::uint64_t left_ps(const Burst& burst, std::size_t word) const {
    return clock_.edge_ps(burst.result.first_data_clock + word + 1);
  }
  // For calls that break the rules.
  pci::PciMasterIf& master() { return *master_; }

 private:
  using PciSlotIf::request;
  void request(pci::PciMasterIf& master, std::uint64_t from_ps) override;
  void ask();
  void begin();
  void end();

  Clock clock_;
  pci::PciMasterIf* master_ = nullptr;
  BusTurn turn_;
  std::uint64_t address_clock_ = 0;
  std::uint64_t free_clock_ = 0;  // the first after the last burst
  sc_core::sc_event ask_{"ask_for_burst"};
  sc_core::sc_event begin_{"begin_burst"};
  sc_core::sc_event end_{"end_burst"};
};

}  // namespace stereotlm::test

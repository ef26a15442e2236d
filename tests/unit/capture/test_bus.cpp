#include "tests/unit/capture/test_bus.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace stereotlm::test {

TestBus::TestBus(const sc_core::sc_module_name& name, double clock_mhz) : sc_module(name), clock_(clock_mhz) {
  SC_HAS_PROCESS(TestBus);
  SC_METHOD(ask);
  sensitive << ask_;
  dont_initialize();
  SC_METHOD(begin);
  sensitive << begin_;
  dont_initialize();
  SC_METHOD(end);
  sensitive << end_;
  dont_initialize();
  slot.bind(*this);
}

void TestBus::request(pci::PciMasterIf& master, std::uint64_t from_ps) {
  EXPECT_EQ(requests_ps.size(), bursts.size()) << "second request at " << sc_core::sc_time_stamp();
  EXPECT_GE(from_ps, kernel_time::now_ps());
  master_ = &master;
  if (from_ps > kernel_time::now_ps()) {
    ask_.notify(kernel_time::to_time(from_ps - kernel_time::now_ps()));
  } else {
    ask();
  }
}

// Called at the time of the request.
void TestBus::ask() {
  turn_ = plan ? plan(requests_ps.size()) : turn;
  requests_ps.push_back(kernel_time::now_ps());
  address_clock_ = std::max(clock_.edge_at_or_after(kernel_time::now_ps()) + turn_.busy_clocks, free_clock_);
  begin_.notify(kernel_time::to_time(clock_.edge_ps(address_clock_) - kernel_time::now_ps()));
}

void TestBus::begin() {
  Burst burst;
  burst.requested_ps = requests_ps.back();
  burst.address_clock_ps = clock_.edge_ps(address_clock_);
  const pci::PciBurst asked = master_->begin_burst(burst.address_clock_ps);
  ASSERT_TRUE(asked.write);
  ASSERT_NE(asked.words, nullptr);
  ASSERT_FALSE(asked.words->empty());
  burst.address = asked.address;
  burst.words = *asked.words;
  pci::BurstResult& result = burst.result;
  result.end = turn_.limit < burst.words.size() ? turn_.cut : pci::BurstEnd::kComplete;
  result.words = std::min(turn_.limit, burst.words.size());
  result.first_data_clock = address_clock_ + 1 + turn_.wait_clocks;
  const std::uint64_t end_clock = result.first_data_clock + std::max<std::size_t>(result.words, 1);
  burst.end_ps = clock_.edge_ps(end_clock);
  free_clock_ = end_clock + 1;
  bursts.push_back(burst);
  end_.notify(kernel_time::to_time(burst.end_ps - kernel_time::now_ps()));
}

pci::BurstResult TestBus::transferred(std::uint64_t now_ps) const {
  pci::BurstResult so_far = bursts.back().result;
  const auto has_left = [this, now_ps](std::size_t word) { return left_ps(bursts.back(), word) <= now_ps; };
  while (so_far.words > 0 && !has_left(so_far.words - 1)) --so_far.words;
  return so_far;
}

void TestBus::end() {
  const Burst& burst = bursts.back();
  for (std::size_t i = 0; i < burst.result.words; ++i) memory[burst.address + 4 * i] = burst.words[i];
  pci::BurstResult result = burst.result;
  result.end_ps = burst.end_ps;
  master_->end_burst(result);
}

}  // namespace stereotlm::test

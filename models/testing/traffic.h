#pragma once

#include <cstdint>
#include <istream>
#include <random>
#include <systemc>
#include <vector>

#include "models/testing/test_host.h"

namespace stereotlm::test {

// One access of an initiator: it begins `pause` after the response of the one before.
struct TrafficAccess {
  sc_core::sc_time pause;     // since the response of the one before
  bool write = false;         // true: a write; false: a read
  std::uint64_t address = 0;  // of the first byte, a multiple of 4
  std::size_t words = 1;      // of 32 bits
};

// Accesses of `words` words each to addresses that follow each other: `first`, first + stride, .. Throws
// std::invalid_argument if a number is out of range.
std::vector<TrafficAccess> strided_traffic(std::uint64_t first, std::uint64_t stride, std::size_t count,
                                           bool write, std::size_t words = 1);

// What random_traffic() draws from. Every seed gives the same accesses on every machine.
struct RandomTraffic {
  std::uint64_t seed = 0;          // of the random numbers
  std::size_t count = 100;         // accesses
  std::uint64_t first = 0;         // address
  std::uint64_t memory_words = 0;  // behind `first`; at least most_words
  std::size_t most_words = 1;      // of an access
  unsigned writes_percent = 50;    // of the accesses
  sc_core::sc_time longest_pause;  // half of the accesses have no pause
};
// Throws std::invalid_argument if a number is out of range, such as accesses without a place.
std::vector<TrafficAccess> random_traffic(const RandomTraffic& from);

// A recorded trace: lines `pause in ns,read or write,address,words`, and a first line with these names:
// pause_ns,direction,address,words. Numbers are integers, also hexadecimal (0x..). Blanks around a value,
// empty lines, CRLF and a byte order mark are allowed. Throws std::invalid_argument with the number of the
// line, the value and the rule; a byte that is no visible character of ASCII is shown as <0x..>.
std::vector<TrafficAccess> traffic_of_csv(std::istream& csv);

// An initiator that makes these accesses, one after the other, with b_transport or nb_transport. The words
// that it writes are random. An access that is refused is a failure (failure.h).
class TrafficInitiator : public sc_core::sc_module {
 public:
  // The interface: b_transport or nb_transport.
  enum class Style { kBlocking, kNonBlocking };

  // The words that it writes follow from a fixed seed.
  TrafficInitiator(const sc_core::sc_module_name& name, std::vector<TrafficAccess> accesses,
                   Style style = Style::kBlocking);

  tlm::tlm_initiator_socket<32>& socket() { return host_.socket; }  // to be bound to a target
  bool is_done() const { return is_done_; }      // whether all accesses have their responses
  sc_core::sc_time end() const { return end_; }  // of the last response

 private:
  void run();
  TestHost::Answer make(const TrafficAccess& access);

  TestHost host_{"host"};
  std::vector<TrafficAccess> accesses_;
  Style style_;
  std::mt19937_64 random_;  // of the words that are written
  bool is_done_ = false;
  sc_core::sc_time end_;
};

}  // namespace stereotlm::test

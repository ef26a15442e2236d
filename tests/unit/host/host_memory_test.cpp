#include "models/host/host_memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <stdexcept>
#include <vector>

#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"

namespace stereotlm::host {
namespace {

using sc_core::sc_time;
using test::TestHost;
using Words = std::vector<std::uint32_t>;

constexpr std::uint64_t kBytes = 64;

// Memory with two initiators, each behind a monitor. ssram_bank_test.cpp tests memory::RamTarget: what it
// refuses, byte enables and direct access.
class HostMemoryTest : public testing::Test {
 protected:
  HostMemoryTest() {
    binder.bind(host.socket, memory.port, "host_to_memory");
    binder.bind(other.socket, memory.port, "other_to_memory");
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }
  test::MonitoringBinder binder;
  TestHost host{"test_host"};
  TestHost other{"other_host"};
  HostMemory memory{"memory", kBytes};
};

TEST_F(HostMemoryTest, KeepsWordsOfAnyNumberOfInitiatorsInNoTime) {
  const sc_time before(3, sc_core::SC_NS);
  EXPECT_EQ(host.write(8, 0xDEAD'BEEF, before).at, before);
  const auto answer = other.read(8, before);
  EXPECT_EQ(answer.word, 0xDEAD'BEEFU);
  EXPECT_EQ(answer.at, before);
  EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(memory.stats().reads, 1U);
  EXPECT_EQ(memory.stats().writes, 1U);
}

TEST_F(HostMemoryTest, TakesAnyNumberOfWordsAtOnce) {
  for (const std::uint32_t count : {1U, 2U, 5U, 14U}) {  // 14: up to the last word
    Words words(count);
    for (std::uint32_t i = 0; i < count; ++i) words[i] = 100 * count + i;
    EXPECT_EQ(host.write_words(8, words).status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(host.debug_read(8, count), words);
    const auto answer = host.read_words(8, count);
    EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(answer.words, words);
    EXPECT_EQ(answer.at, sc_core::SC_ZERO_TIME);
  }
}

TEST_F(HostMemoryTest, WritesTheEnabledBytesOnly) {
  std::array<unsigned char, 4> enables = {TLM_BYTE_DISABLED, TLM_BYTE_ENABLED, TLM_BYTE_ENABLED, 0};
  std::uint32_t word = 0xAAAA'AAAA;
  tlm::tlm_generic_payload payload;
  payload.set_write();
  payload.set_address(8);
  payload.set_data_ptr(reinterpret_cast<unsigned char*>(&word));
  payload.set_data_length(4);
  payload.set_streaming_width(4);
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(4);
  sc_time delay;
  host.socket->b_transport(payload, delay);
  EXPECT_EQ(host.debug_read(8, 1), Words{0x00AA'AA00});
}

// Half a gigabyte, of which three words are touched. An address sanitizer adds an eighth.
TEST(HostMemory, OccupiesNoMemoryForPagesThatAreNotTouched) {
  test::MonitoringBinder binder;
  TestHost host("test_host");
  rusage before{};
  getrusage(RUSAGE_SELF, &before);
  constexpr std::uint64_t kLarge = std::uint64_t{1} << 29U;
  HostMemory memory("memory", kLarge);
  binder.bind(host.socket, memory.port, "host_to_memory");
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  host.write(0, 1);
  host.write(kLarge - 4, 2);
  EXPECT_EQ(host.read(kLarge - 4).word, 2U);
  EXPECT_EQ(host.read(kLarge / 2).word, 0U);
  rusage after{};
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 128 * 1024);  // KiB
}

TEST(HostMemory, RefusesASizeOutsideItsRule) {
  EXPECT_THROW(HostMemory("a", 0), std::invalid_argument);
  EXPECT_THROW(HostMemory("b", 6), std::invalid_argument);
  EXPECT_THROW(HostMemory("c", (std::uint64_t{1} << 31U) + 4), std::invalid_argument);
  EXPECT_NO_THROW(HostMemory("d", 4));
}

}  // namespace
}  // namespace stereotlm::host

#include "models/host/host_memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <memory>
#include <stdexcept>
#include <vector>

#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
#include "tests/support/refused_access.h"

namespace stereotlm::host {
namespace {

using sc_core::sc_time;
using test::TestHost;
using Words = std::vector<std::uint32_t>;

constexpr std::uint64_t kBytes = 64;

// Memory with two initiators, each behind a monitor. ssram_bank_test.cpp tests memory::RamTarget.
class HostMemoryTest : public testing::Test {
 protected:
  void build(const test::ProtocolOptions& options = {}) {
    binder = std::make_unique<test::MonitoringBinder>(options);
    binder->bind(host.socket, memory.port, "host_to_memory");
    binder->bind(other.socket, memory.port, "other_to_memory");
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }
  std::unique_ptr<test::MonitoringBinder> binder;
  TestHost host{"test_host"};
  TestHost other{"other_host"};
  HostMemory memory{"memory", kBytes};
};

TEST_F(HostMemoryTest, KeepsWordsOfAnyNumberOfInitiatorsInNoTime) {
  build();
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
  build();
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

TEST_F(HostMemoryTest, MovesTheEnabledBytesOnly) {
  build();
  host.debug_write(8, {0x1111'1111, 0x2222'2222});
  // A pattern that is not as long as a word: bytes 0, 3 and 6 are disabled.
  std::array<unsigned char, 3> enables = {TLM_BYTE_DISABLED, TLM_BYTE_ENABLED, TLM_BYTE_ENABLED};
  Words words = {0xAAAA'AAAA, 0xBBBB'BBBB};
  tlm::tlm_generic_payload payload;
  payload.set_address(8);
  payload.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
  payload.set_data_length(8);
  payload.set_streaming_width(8);
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(3);
  sc_time delay;
  payload.set_command(tlm::TLM_WRITE_COMMAND);
  host.socket->b_transport(payload, delay);
  EXPECT_EQ(host.debug_read(8, 2), (Words{0x11AA'AA11, 0xBB22'BBBB}));
  words = {0, 0};
  payload.set_command(tlm::TLM_READ_COMMAND);
  payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  payload.set_dmi_allowed(false);
  host.socket->b_transport(payload, delay);
  EXPECT_EQ(words, (Words{0x00AA'AA00, 0xBB00'BBBB}));
}

TEST_F(HostMemoryTest, RefusesIncorrectAccesses) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  test::ProtocolOptions options;
  options.whole_words = false;
  build(options);
  using Refused = test::RefusedAccess;
  std::vector<Refused> refused;
  for (const auto command : {tlm::TLM_READ_COMMAND, tlm::TLM_WRITE_COMMAND}) {
    for (const std::uint64_t address : {kBytes - 4, kBytes, std::uint64_t{1} << 40U, UINT64_MAX - 7})
      refused.push_back({tlm::TLM_ADDRESS_ERROR_RESPONSE, command, address, 8, 8});
    refused.push_back({tlm::TLM_ADDRESS_ERROR_RESPONSE, command, 0, kBytes + 4, kBytes + 4});
    for (const std::uint64_t address : {1U, 2U, 3U})
      refused.push_back({tlm::TLM_ADDRESS_ERROR_RESPONSE, command, address});
    for (const unsigned length : {0U, 1U, 5U, 6U, 7U})
      refused.push_back({tlm::TLM_BURST_ERROR_RESPONSE, command, 8, length, 8});
    refused.push_back({tlm::TLM_BURST_ERROR_RESPONSE, command, 8, 8, 4});
    refused.push_back({tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE, command, 8, 4, 4, 0});
  }
  refused.push_back({tlm::TLM_COMMAND_ERROR_RESPONSE, tlm::TLM_IGNORE_COMMAND});
  for (const Refused& access : refused) test::expect_refused(host.socket, access);
  EXPECT_EQ(memory.stats().errors, refused.size());
  EXPECT_EQ(memory.stats().reads, 0U);
  EXPECT_EQ(memory.stats().writes, 0U);
  EXPECT_EQ(host.debug_read(0, kBytes / 4), Words(kBytes / 4));
  EXPECT_EQ(binder->take_violations().size(), 4U);  // lengths of 0, of data and of byte enables
}

TEST_F(HostMemoryTest, GrantsItselfForDirectAccess) {
  build();
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(host.dmi(12, dmi));
  EXPECT_EQ(dmi.get_start_address(), 0U);
  EXPECT_EQ(dmi.get_end_address(), kBytes - 1);
  EXPECT_TRUE(dmi.is_read_write_allowed());
  EXPECT_EQ(dmi.get_read_latency(), sc_core::SC_ZERO_TIME);
  dmi.get_dmi_ptr()[12] = 9;
  EXPECT_EQ(other.read(12).word, 9U);
  EXPECT_FALSE(host.dmi(kBytes, dmi));
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

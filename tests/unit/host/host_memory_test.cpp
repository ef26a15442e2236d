#include "models/host/host_memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <memory>
#include <stdexcept>
#include <vector>

#include "tests/support/monitoring_binder.h"
#include "tests/support/test_host.h"

namespace stereotlm::host {
namespace {

using sc_core::sc_time;
using test::TestHost;

constexpr std::uint64_t kBytes = 64;

// Memory under a monitor, and a payload for a correct read of words 2 and 3 to start from.
class HostMemoryTest : public testing::Test {
 protected:
  void build(const test::ProtocolOptions& options = {}) {
    binder = std::make_unique<test::MonitoringBinder>(options);
    binder->bind(host.socket, memory.port, "host_to_memory");
    binder->bind(other.socket, memory.port, "other_to_memory");
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
    payload.set_command(tlm::TLM_READ_COMMAND);
    payload.set_address(8);
    payload.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
    payload.set_data_length(8);
    payload.set_streaming_width(8);
  }
  static test::ProtocolOptions anything() {
    test::ProtocolOptions options;
    options.whole_words = false;
    options.streaming_bursts = true;
    return options;
  }
  tlm::tlm_response_status send() {
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    payload.set_dmi_allowed(false);
    host.socket->b_transport(payload, delay);
    EXPECT_EQ(delay, sc_core::SC_ZERO_TIME);
    return payload.get_response_status();
  }
  void expect_refused(tlm::tlm_response_status status) {
    const auto errors = memory.stats().errors;
    payload.set_command(tlm::TLM_WRITE_COMMAND);
    EXPECT_EQ(send(), status);
    payload.set_command(tlm::TLM_READ_COMMAND);
    EXPECT_EQ(send(), status);
    EXPECT_EQ(memory.stats().errors, errors + 2);
    EXPECT_EQ(memory.stats().writes, 0U);
    EXPECT_EQ(host.debug_read(0, kBytes / 4), std::vector<std::uint32_t>(kBytes / 4));
  }

  std::unique_ptr<test::MonitoringBinder> binder;
  TestHost host{"test_host"};
  TestHost other{"other_host"};
  HostMemory memory{"memory", kBytes};
  tlm::tlm_generic_payload payload;
  std::vector<std::uint32_t> words = std::vector<std::uint32_t>(kBytes / 4 + 1, 0xFFFF'FFFF);
  std::array<unsigned char, 4> enables{};
  sc_time delay;
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
  for (std::uint32_t i = 0; i < words.size(); ++i) words[i] = 100 + i;
  for (const unsigned count : {1U, 2U, 5U, 14U}) {
    payload.set_command(tlm::TLM_WRITE_COMMAND);
    payload.set_data_length(4 * count);
    payload.set_streaming_width(4 * count);
    EXPECT_EQ(send(), tlm::TLM_OK_RESPONSE);
    const std::vector<std::uint32_t> expected(words.begin(), words.begin() + count);
    EXPECT_EQ(host.debug_read(8, count), expected);
    std::vector<std::uint32_t> read(count);
    payload.set_command(tlm::TLM_READ_COMMAND);
    payload.set_data_ptr(reinterpret_cast<unsigned char*>(read.data()));
    EXPECT_EQ(send(), tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(read, expected);
    payload.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
  }
}

TEST_F(HostMemoryTest, MovesTheEnabledBytesOnly) {
  build();
  host.debug_write(8, {0x1111'1111, 0x2222'2222});
  enables = {TLM_BYTE_DISABLED, TLM_BYTE_ENABLED, TLM_BYTE_ENABLED, TLM_BYTE_ENABLED};
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(3);  // a pattern that is not the word's: bytes 0, 3 and 6 are disabled
  words = {0xAAAA'AAAA, 0xBBBB'BBBB};
  payload.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
  payload.set_command(tlm::TLM_WRITE_COMMAND);
  EXPECT_EQ(send(), tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(host.debug_read(8, 2), (std::vector<std::uint32_t>{0x11AA'AA11, 0xBB22'BBBB}));
  words = {0, 0};
  payload.set_command(tlm::TLM_READ_COMMAND);
  EXPECT_EQ(send(), tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(words, (std::vector<std::uint32_t>{0x00AA'AA00, 0xBB00'BBBB}));
}

TEST_F(HostMemoryTest, AnswersUpToItsLastWordAndRefusesWhatLiesBehind) {
  build();
  payload.set_address(kBytes - 8);
  EXPECT_EQ(send(), tlm::TLM_OK_RESPONSE);
  for (const std::uint64_t address : {kBytes - 4, kBytes, std::uint64_t{1} << 40U, UINT64_MAX - 7}) {
    payload.set_address(address);
    expect_refused(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  }
}

TEST_F(HostMemoryTest, RefusesAnAccessLargerThanItself) {
  build();
  payload.set_address(0);
  payload.set_data_length(kBytes + 4);
  payload.set_streaming_width(kBytes + 4);
  expect_refused(tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

TEST_F(HostMemoryTest, RefusesAnAddressBetweenWords) {
  build(anything());
  for (const unsigned address : {1U, 2U, 3U}) {
    payload.set_address(address);
    expect_refused(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  }
}

TEST_F(HostMemoryTest, RefusesALengthThatIsNotAWholeNumberOfWords) {
  build(anything());
  for (const unsigned length : {1U, 5U, 6U, 7U}) {
    payload.set_data_length(length);
    expect_refused(tlm::TLM_BURST_ERROR_RESPONSE);
  }
  payload.set_data_length(0);
  expect_refused(tlm::TLM_BURST_ERROR_RESPONSE);
  EXPECT_EQ(binder->take_violations().size(), 2U);
}

TEST_F(HostMemoryTest, RefusesAStreamingWidthBelowTheLength) {
  build(anything());
  payload.set_streaming_width(4);
  expect_refused(tlm::TLM_BURST_ERROR_RESPONSE);
}

TEST_F(HostMemoryTest, RefusesByteEnablesOfLengthZero) {
  build();
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(0);
  expect_refused(tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
  EXPECT_EQ(binder->take_violations().size(), 2U);
}

TEST_F(HostMemoryTest, RefusesACommandThatDoesNothing) {
  build();
  payload.set_command(tlm::TLM_IGNORE_COMMAND);
  EXPECT_EQ(send(), tlm::TLM_COMMAND_ERROR_RESPONSE);
  EXPECT_EQ(memory.stats().errors, 1U);
}

TEST_F(HostMemoryTest, CompletesANonBlockingAccessAtOnce) {
  build();
  EXPECT_EQ(host.request(tlm::TLM_WRITE_COMMAND, 8, 77, sc_time(1, sc_core::SC_NS)), tlm::TLM_COMPLETED);
  EXPECT_EQ(host.request(tlm::TLM_READ_COMMAND, 8), tlm::TLM_COMPLETED);
  ASSERT_EQ(host.answers.size(), 2U);
  EXPECT_EQ(host.answers[0].at, sc_time(1, sc_core::SC_NS));
  EXPECT_EQ(host.answers[1].word, 77U);
}

TEST_F(HostMemoryTest, GivesDebugTransportAsMuchAsItHas) {
  build();
  EXPECT_EQ(host.debug_write(kBytes - 8, {1, 2, 3}), 8U);
  EXPECT_EQ(host.debug_read(kBytes - 8, 3), (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(host.debug_read(kBytes, 1), std::vector<std::uint32_t>{});
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

// Half a gigabyte, of which three words are touched; an address sanitizer adds an eighth.
TEST(HostMemory, CostsNothingForPagesThatAreNotTouched) {
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

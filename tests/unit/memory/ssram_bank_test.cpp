#include "models/memory/ssram_bank.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <locale>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>

#include "models/access_rules.h"
#include "models/clock.h"
#include "models/kernel_time.h"
#include "models/memory/word_access.h"
#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
#include "tests/support/refused_access.h"

namespace stereotlm::memory {

void PrintTo(const SsramBankConfig& bank, std::ostream* out) {
  *out << traits_of(bank.kind).name << "_at_" << std::lround(bank.clock_mhz) << "_MHz";
}

namespace {

using sc_core::sc_time;
using test::TestHost;
using testing::HasSubstr;

constexpr std::uint32_t kWords = 16;

// A bank under a monitor, and a payload for a correct read of word 1 to start from.
class SsramBankTest : public testing::Test {
 protected:
  void build(const SsramBankConfig& config, const test::ProtocolOptions& options = {}) {
    binder = std::make_unique<test::MonitoringBinder>(options);
    bank = std::make_unique<SsramBank>("bank", config);
    binder->bind(host.socket, bank->port, "host_to_bank");
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
    payload.set_command(tlm::TLM_READ_COMMAND);
    payload.set_address(4);
    payload.set_data_ptr(data.data());
    payload.set_data_length(4);
    payload.set_streaming_width(4);
  }
  void build() { build({kWords}); }

  // Sends the payload, and returns the time that the bank adds.
  sc_time transport() {
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    payload.set_dmi_allowed(false);
    sc_time delay(7, sc_core::SC_NS);
    host.socket->b_transport(payload, delay);
    return delay - sc_time(7, sc_core::SC_NS);
  }

  std::unique_ptr<test::MonitoringBinder> binder;
  TestHost host{"test_host"};
  std::unique_ptr<SsramBank> bank;
  tlm::tlm_generic_payload payload;
  std::array<unsigned char, 8> data{};
  std::array<unsigned char, 4> enables{};
};

class SsramBankTimes : public SsramBankTest, public testing::WithParamInterface<SsramBankConfig> {};

TEST_P(SsramBankTimes, AddsItsReadLatencyToAReadAndACycleToEachFurtherWord) {
  build(GetParam());
  const Clock clock(GetParam().clock_mhz);
  const auto edge = [&](std::uint64_t number) { return kernel_time::to_time(clock.edge_ps(number)); };
  const auto latency = static_cast<std::uint64_t>(read_latency_cycles(GetParam()));
  for (std::uint64_t first = 0; first < 99; ++first) {  // ends with an edge if it begins with one
    EXPECT_EQ(host.write(8, 0xDEAD'BEEF, edge(first)).at, edge(first));
    const TestHost::Answer answer = host.read(8, edge(first));
    EXPECT_EQ(answer.at, edge(first + latency));
    EXPECT_EQ(answer.word, 0xDEAD'BEEFU);
    EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
    host.request(tlm::TLM_WRITE_COMMAND, 8, {1, 2, 3, 4, 5}, edge(first));
    EXPECT_EQ(host.answers.back().at, edge(first + 4));
    host.request(tlm::TLM_READ_COMMAND, 12, std::vector<std::uint32_t>(3), edge(first));
    EXPECT_EQ(host.answers.back().at, edge(first + latency + 2));
    EXPECT_EQ(host.answers.back().words, (std::vector<std::uint32_t>{2, 3, 4}));
  }
  const sc_time before(300, sc_core::SC_PS);
  EXPECT_EQ(host.read(8, before).at, before + edge(1 + latency) - edge(1));
  EXPECT_EQ(bank->stats().reads, 99U * 4 + 1);
  EXPECT_EQ(bank->stats().writes, 99U * 6);
  EXPECT_EQ(bank->stats().errors, 0U);
}

INSTANTIATE_TEST_SUITE_P(SsramBank, SsramBankTimes,
                         testing::Values(SsramBankConfig{kWords, BankKind::kZbtPipelined, 0, 40},
                                         SsramBankConfig{kWords, BankKind::kZbtPipelined, 0, 33.333},
                                         SsramBankConfig{kWords, BankKind::kZbtFlowThrough, 0, 1000},
                                         SsramBankConfig{kWords, BankKind::kSyncBurst, 2, 40}),
                         [](const auto& suite) { return testing::PrintToString(suite.param); });

TEST_F(SsramBankTest, HoldsZerosAtFirstAndThenEachWordByItself) {
  build();
  EXPECT_EQ(host.debug_read(0, kWords), std::vector<std::uint32_t>(kWords));
  for (std::uint32_t word = 0; word < kWords; ++word) host.write(word * 4, 0x1111'0000 + word);
  for (std::uint32_t word = 0; word < kWords; ++word) {
    EXPECT_EQ(host.read(word * 4).word, 0x1111'0000 + word);
    EXPECT_EQ(bank->words()[word], 0x1111'0000 + word);
  }
}

TEST_F(SsramBankTest, AnswersTheLastWordAndRefusesTheNextAddress) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  build();
  EXPECT_EQ(host.write((kWords - 1) * 4, 0).status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(host.write(kWords * 4, 1).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(host.read(kWords * 4).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(host.read(std::uint64_t{1} << 40U).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(host.read_words((kWords - 1) * 4, 2).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(bank->stats().errors, 4U);
}

TEST_F(SsramBankTest, RefusesAccessesThatAreNoWholeWords) {
  test::ExpectedReport refusal("/stereotlm/refused_access");
  test::ProtocolOptions streaming;
  streaming.whole_words = false;
  build({kWords}, streaming);
  const auto read = tlm::TLM_READ_COMMAND;
  const auto write = tlm::TLM_WRITE_COMMAND;
  const test::RefusedAccess refused[] = {
      {tlm::TLM_ADDRESS_ERROR_RESPONSE, write, 1},
      {tlm::TLM_ADDRESS_ERROR_RESPONSE, write, 2},
      {tlm::TLM_ADDRESS_ERROR_RESPONSE, read, 7},
      {tlm::TLM_BURST_ERROR_RESPONSE, write, 4, 1, 8},
      {tlm::TLM_BURST_ERROR_RESPONSE, read, 4, 5, 8},
      {tlm::TLM_BURST_ERROR_RESPONSE, read, 4, 4, 3},
      {tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE, read, 4, 4, 4, 0},
      {tlm::TLM_COMMAND_ERROR_RESPONSE, tlm::TLM_IGNORE_COMMAND, 4},
  };
  for (const test::RefusedAccess& access : refused) test::expect_refused(host.socket, access);
  EXPECT_EQ(refusal.text(),
            "bank: TLM_ADDRESS_ERROR_RESPONSE for a write of 4 bytes at address 0x1: the address must be a "
            "multiple of 4; later refusals are not reported");
  payload.set_data_ptr(nullptr);
  transport();
  EXPECT_EQ(payload.get_response_status(), tlm::TLM_GENERIC_ERROR_RESPONSE);
  EXPECT_EQ(bank->stats().errors, std::size(refused) + 1);
  EXPECT_EQ(bank->stats().reads + bank->stats().writes, 0U);
  EXPECT_EQ(host.debug_read(0, kWords), std::vector<std::uint32_t>(kWords));
  EXPECT_EQ(binder->take_violations().size(), 2U);  // byte enables of no length, and no data
}

TEST_F(SsramBankTest, IsReportedWithoutSeparatorsInALocaleThatGroupsDigits) {
  struct Grouping : std::numpunct<char> {
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  std::locale::global(std::locale(std::locale(), new Grouping));
  test::ExpectedReport refusal("/stereotlm/refused_access");
  build();
  sc_core::sc_start(sc_time(1'234'567, sc_core::SC_PS));
  payload.set_address(0x7ffd'e068'981a);
  transport();
  EXPECT_THAT(refusal.text(), HasSubstr("a read of 4 bytes at address 0x7ffde068981a: "));
  EXPECT_THAT(binder->take_violations().at(0),
              HasSubstr("_monitor at 1234567 ps: b_transport: address = 0x7ffde068981a: "));
}

// The report names the first rule that an access breaks.
TEST(AccessRules, NamesTheFirstRuleThatAnAccessBreaks) {
  std::array<unsigned char, 8> data{};
  tlm::tlm_generic_payload access;
  access.set_command(tlm::TLM_IGNORE_COMMAND);
  access.set_byte_enable_ptr(data.data());
  access.set_address(66);
  AccessRules rules = {64, true, false};
  std::vector<std::string> named;
  const auto name = [&] { named.emplace_back(broken_rule(access, rules).text); };
  name(), access.set_read();
  name(), access.set_data_ptr(data.data());
  name(), access.set_data_length(8);
  name(), rules.one_word = false;
  name(), access.set_streaming_width(8);
  name(), rules.byte_enables = true;
  name(), access.set_byte_enable_length(4);
  name(), access.set_address(60);
  name(), access.set_address(56);
  name();
  EXPECT_EQ(named, (std::vector<std::string>{
                       "must be a read or a write", "the data pointer must not be null",
                       "the length must be whole words of 4 bytes", "the length must be one word of 4 bytes",
                       "the streaming width must be at least the length", "byte enables are not taken",
                       "the length of the byte enables must not be 0", "the address must be a multiple of 4",
                       "all bytes must be in the target", ""}));
}

TEST_F(SsramBankTest, MovesOnlyTheBytesThatAreEnabledAndRepeatsShortByteEnables) {
  build();
  host.write(4, 0x4433'2211);
  enables = {TLM_BYTE_DISABLED, TLM_BYTE_ENABLED, TLM_BYTE_DISABLED, TLM_BYTE_ENABLED};
  data = {0xA0, 0xA1, 0xA2, 0xA3};
  payload.set_command(tlm::TLM_WRITE_COMMAND);
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(4);
  transport();
  EXPECT_EQ(host.read(4).word, 0xA333'A111U);
  payload.set_command(tlm::TLM_READ_COMMAND);
  payload.set_byte_enable_length(2);
  data = {0xB0, 0xB1, 0xB2, 0xB3};
  transport();
  EXPECT_EQ(data, (std::array<unsigned char, 8>{0xB0, 0xA1, 0xB2, 0xA3}));
}

TEST_F(SsramBankTest, GivesDebugTransportAnyLengthUpToItsEnd) {
  build();
  EXPECT_EQ(host.debug_write((kWords - 2) * 4, {1, 2}), 8U);
  EXPECT_EQ(host.debug_write((kWords - 1) * 4, {3, 4}), 4U);
  EXPECT_EQ(host.debug_write(kWords * 4, {5}), 0U);
  EXPECT_EQ(host.debug_read((kWords - 2) * 4, 5), (std::vector<std::uint32_t>{1, 3}));
  EXPECT_EQ(host.debug_read(kWords * 4, 1), (std::vector<std::uint32_t>{}));
  host.debug_write(4, {0x4433'2211});
  payload.set_address(6);
  payload.set_data_length(3);
  EXPECT_EQ(host.socket->transport_dbg(payload), 3U);
  EXPECT_EQ(data, (std::array<unsigned char, 8>{0x33, 0x44, 0x00}));
  payload.set_command(tlm::TLM_IGNORE_COMMAND);
  EXPECT_EQ(host.socket->transport_dbg(payload), 0U);
  EXPECT_EQ(bank->stats().reads + bank->stats().writes + bank->stats().errors, 0U);
}

TEST_F(SsramBankTest, OffersAndGrantsDirectAccessToTheWholeBankAndNotBeyond) {
  build();
  transport();
  EXPECT_TRUE(payload.is_dmi_allowed());
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(host.dmi((kWords - 1) * 4, dmi));
  EXPECT_EQ(dmi.get_start_address(), 0U);
  EXPECT_EQ(dmi.get_end_address(), kWords * 4 - 1);
  EXPECT_TRUE(dmi.is_read_write_allowed());
  EXPECT_EQ(dmi.get_read_latency(), sc_time(50, sc_core::SC_NS));
  EXPECT_EQ(dmi.get_write_latency(), sc_core::SC_ZERO_TIME);
  reinterpret_cast<std::uint32_t*>(dmi.get_dmi_ptr())[3] = 42;
  EXPECT_EQ(host.read(12).word, 42U);
  // The monitor asks for the refused range too: it must contain the address.
  EXPECT_FALSE(host.dmi(kWords * 4, dmi));
}

TEST_F(SsramBankTest, CompletesANonBlockingAccessAtOnce) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  build();
  EXPECT_EQ(host.request(tlm::TLM_WRITE_COMMAND, 8, 77, sc_time(1, sc_core::SC_NS)), tlm::TLM_COMPLETED);
  EXPECT_EQ(host.request(tlm::TLM_READ_COMMAND, 8), tlm::TLM_COMPLETED);
  ASSERT_EQ(host.answers.size(), 2U);
  EXPECT_EQ(host.answers[0].at, sc_time(1, sc_core::SC_NS));
  EXPECT_EQ(host.answers[1].word, 77U);
  EXPECT_EQ(host.answers[1].at, sc_time(50, sc_core::SC_NS));
  EXPECT_EQ(host.request(tlm::TLM_READ_COMMAND, kWords * 4), tlm::TLM_COMPLETED);
  EXPECT_EQ(host.answers[2].status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

TEST(SsramBank, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(SsramBank("bank", SsramBankConfig{0}), std::invalid_argument);
}

TEST_F(SsramBankTest, ServesAWordAccessRepeatedly) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  build();
  WordAccess access(host.socket);
  sc_time delay;
  EXPECT_TRUE(access.write(4, 9, delay));
  EXPECT_TRUE(access.read(4, delay));
  EXPECT_EQ(access.word(), 9U);
  EXPECT_FALSE(access.read(kWords * 4, delay));
  EXPECT_EQ(access.status(), tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(access.word(), 0U);
  EXPECT_EQ(delay, sc_time(50, sc_core::SC_NS));
}

}  // namespace
}  // namespace stereotlm::memory

#include "models/testing/traffic.h"

#include <algorithm>
#include <charconv>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "models/access_text.h"
#include "models/kernel_time.h"
#include "models/testing/failure.h"

namespace stereotlm::test {
namespace {

// A number of 0..most. std::uniform_int_distribution differs from library to library.
std::uint64_t draw(std::mt19937_64& random, std::uint64_t most) { return random() % (most + 1); }

void require(bool holds, const char* what, std::uint64_t value, const std::string& rule) {
  if (!holds) throw std::invalid_argument(what + (" = " + std::to_string(value) + ": must be " + rule));
}

constexpr const char* kColumns = "pause_ns,direction,address,words";
constexpr std::uint64_t kMostWords = UINT32_MAX / 4;  // a payload counts its bytes in 32 bits

// Shows each byte that is no visible character of ASCII as <0x..>.
[[noreturn]] void refuse(std::size_t line, const std::string& problem) {
  std::string text = "line " + std::to_string(line) + ": ";
  for (const char byte : problem)
    text +=
        byte >= ' ' && byte <= '~' ? std::string(1, byte) : "<" + hex(static_cast<unsigned char>(byte)) + ">";
  throw std::invalid_argument(text);
}

// The values of a line, without the blanks around them.
std::vector<std::string> values_of(const std::string& text) {
  constexpr const char* kBlanks = " \t\r";
  std::vector<std::string> values;
  std::istringstream row(text + ',');
  for (std::string value; std::getline(row, value, ',');) {
    value.erase(0, value.find_first_not_of(kBlanks));
    values.push_back(value.erase(value.find_last_not_of(kBlanks) + 1));
  }
  return values;
}

std::uint64_t number_of(const std::string& text, const char* what, std::size_t line, std::uint64_t least,
                        std::uint64_t most) {
  const bool is_hex = text.rfind("0x", 0) == 0;
  const char* const end = text.data() + text.size();
  std::uint64_t number = 0;
  const auto result = std::from_chars(text.data() + (is_hex ? 2 : 0), end, number, is_hex ? 16 : 10);
  if (result.ec != std::errc() || result.ptr != end || number < least || number > most) {
    refuse(line, std::string(what) + " = " + text + ": must be an integer of " + std::to_string(least) +
                     ".." + std::to_string(most));
  }
  return number;
}

TrafficAccess access_of(const std::vector<std::string>& values, std::size_t line) {
  const std::uint64_t ns = sc_core::sc_time(1, sc_core::SC_NS).value();
  if (ns == 0) refuse(line, "pause_ns: needs a time resolution of 1 ns or finer");
  if (values.size() != 4) refuse(line, std::to_string(values.size()) + " values: must be " + kColumns);
  TrafficAccess access;
  access.pause =
      sc_core::sc_time::from_value(ns * number_of(values[0], "pause_ns", line, 0, UINT64_MAX / ns));
  access.write = values[1] == "write";
  if (!access.write && values[1] != "read")
    refuse(line, "direction = " + values[1] + ": must be read or write");
  access.address = number_of(values[2], "address", line, 0, UINT64_MAX);
  if (access.address % 4 != 0) refuse(line, "address = " + values[2] + ": must be a multiple of 4");
  access.words = number_of(values[3], "words", line, 1, kMostWords);
  if (access.words - 1 > (UINT64_MAX - access.address) / 4)
    refuse(line, "address = " + values[2] + ": the access must end at 2^64 or before it");
  return access;
}

}  // namespace

std::vector<TrafficAccess> strided_traffic(std::uint64_t first, std::uint64_t stride, std::size_t count,
                                           bool write, std::size_t words) {
  require(first % 4 == 0, "first", first, "a multiple of 4");
  require(stride % 4 == 0, "stride", stride, "a multiple of 4");
  require(words > 0 && words <= kMostWords, "words", words, "1.." + std::to_string(kMostWords));
  std::vector<TrafficAccess> accesses;
  for (std::size_t number = 0; number < count; ++number)
    accesses.push_back({{}, write, first + number * stride, words});
  return accesses;
}

std::vector<TrafficAccess> random_traffic(const RandomTraffic& from) {
  require(from.first % 4 == 0, "first", from.first, "a multiple of 4");
  const std::uint64_t places = (UINT64_MAX - from.first) / 4 + 1;
  require(from.memory_words <= places, "memory_words", from.memory_words, "0.." + std::to_string(places));
  const std::uint64_t most_words = std::min(from.memory_words, kMostWords);
  require(from.most_words > 0 && from.most_words <= most_words, "most_words", from.most_words,
          "1.." + std::to_string(most_words) + ", which memory_words limits too");
  require(from.writes_percent <= 100, "writes_percent", from.writes_percent, "0..100");
  std::mt19937_64 random(from.seed);
  std::vector<TrafficAccess> accesses;
  for (std::size_t number = 0; number < from.count; ++number) {
    TrafficAccess access;
    access.words = 1 + draw(random, from.most_words - 1);
    access.address = from.first + 4 * draw(random, from.memory_words - access.words);
    access.write = draw(random, 99) < from.writes_percent;
    const std::uint64_t pause = draw(random, from.longest_pause.value());
    if (draw(random, 1) == 1) access.pause = sc_core::sc_time::from_value(pause);
    accesses.push_back(access);
  }
  return accesses;
}

std::vector<TrafficAccess> traffic_of_csv(std::istream& csv) {
  std::vector<TrafficAccess> accesses;
  std::size_t line = 0;
  for (std::string text; std::getline(csv, text);) {
    if (++line == 1 && text.rfind("\xEF\xBB\xBF", 0) == 0) text.erase(0, 3);  // byte order mark
    const std::vector<std::string> values = values_of(text);
    if (line > 1 && values != std::vector<std::string>(1))
      accesses.push_back(access_of(values, line));
    else if (line == 1 && values != values_of(kColumns))
      refuse(1, text + ": must be " + kColumns);
  }
  if (line == 0 || csv.bad()) refuse(line + 1, "cannot be read: must be " + std::string(kColumns));
  return accesses;
}

TrafficInitiator::TrafficInitiator(const sc_core::sc_module_name& name, std::vector<TrafficAccess> accesses,
                                   Style style)
    : sc_module(name), accesses_(std::move(accesses)), style_(style) {
  SC_HAS_PROCESS(TrafficInitiator);
  SC_THREAD(run);
}

void TrafficInitiator::run() {
  for (const TrafficAccess& access : accesses_) {
    wait(access.pause);
    const TestHost::Answer answer = make(access);
    if (answer.status != tlm::TLM_OK_RESPONSE) {
      fail(std::string(name()) + " at " + kernel_time::text_of(sc_core::sc_time_stamp()) + ": access " +
           std::to_string(&access - accesses_.data()) + " at address " + std::to_string(access.address) +
           " was refused");
    }
    if (answer.at > sc_core::sc_time_stamp()) wait(answer.at - sc_core::sc_time_stamp());
  }
  end_ = sc_core::sc_time_stamp();
  is_done_ = true;
}

TestHost::Answer TrafficInitiator::make(const TrafficAccess& access) {
  std::vector<std::uint32_t> words(access.words);
  for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(random_());
  if (style_ == Style::kNonBlocking) {
    return host_.access(access.write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND, access.address,
                        std::move(words));
  }
  return access.write ? host_.write_words(access.address, std::move(words))
                      : host_.read_words(access.address, access.words);
}

}  // namespace stereotlm::test

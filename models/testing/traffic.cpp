#include "models/testing/traffic.h"

#include <algorithm>
#include <charconv>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

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

// A line of a trace, for its messages.
class TraceLine {
 public:
  TraceLine(const std::string& text, std::size_t number) : number_(number) {
    std::istringstream cells(text + ',');
    for (std::string cell; std::getline(cells, cell, ',');) {
      constexpr const char* kBlanks = " \t\r";
      cell.erase(0, cell.find_first_not_of(kBlanks));
      cells_.push_back(cell.erase(cell.find_last_not_of(kBlanks) + 1));
    }
  }

  bool is_blank() const { return cells_.size() == 1 && cells_[0].empty(); }
  std::string text() const {
    std::string text;
    for (const std::string& cell : cells_) text += (text.empty() ? "" : ",") + cell;
    return text;
  }

  TrafficAccess access() const {
    if (cells_.size() != 4) fail(std::to_string(cells_.size()) + " values: must be " + kColumns);
    const sc_core::sc_time ns(1, sc_core::SC_NS);
    TrafficAccess access;
    access.pause =
        sc_core::sc_time::from_value(integer(0, "pause_ns", 0, UINT64_MAX / ns.value()) * ns.value());
    access.write = cells_[1] == "write";
    if (!access.write && cells_[1] != "read") fail("direction = " + cells_[1] + ": must be read or write");
    access.address = integer(2, "address", 0, UINT64_MAX);
    if (access.address % 4 != 0) fail("address = " + cells_[2] + ": must be a multiple of 4");
    access.words = integer(3, "words", 1, kMostWords);
    if (access.words - 1 > (UINT64_MAX - access.address) / 4)
      fail("address = " + cells_[2] + ": the access must end at 2^64 or before it");
    return access;
  }

  // Characters that a reader does not see are shown as their bytes.
  [[noreturn]] void fail(const std::string& problem) const {
    std::string text = "line " + std::to_string(number_) + ": ";
    for (const char byte : problem) {
      const bool is_visible = byte >= ' ' && byte <= '~';
      constexpr const char* kDigits = "0123456789abcdef";
      const auto value = static_cast<unsigned char>(byte);
      text +=
          is_visible ? std::string(1, byte) : std::string("\\x") + kDigits[value / 16] + kDigits[value % 16];
    }
    throw std::invalid_argument(text);
  }

 private:
  std::uint64_t integer(std::size_t cell, const char* name, std::uint64_t least, std::uint64_t most) const {
    const std::string& text = cells_[cell];
    const bool is_hex = text.rfind("0x", 0) == 0;
    std::uint64_t number = 0;
    const auto [end, error] =
        std::from_chars(text.data() + (is_hex ? 2 : 0), text.data() + text.size(), number, is_hex ? 16 : 10);
    if (error != std::errc() || end != text.data() + text.size() || number < least || number > most) {
      fail(std::string(name) + " = " + text + ": must be an integer of " + std::to_string(least) + ".." +
           std::to_string(most));
    }
    return number;
  }

  std::size_t number_;
  std::vector<std::string> cells_;  // without blanks around them
};

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
  constexpr const char* kByteOrderMark = "\xEF\xBB\xBF";
  std::vector<TrafficAccess> accesses;
  bool has_columns = false;
  std::size_t number = 1;
  for (std::string text; std::getline(csv, text); ++number) {
    if (number == 1 && text.rfind(kByteOrderMark, 0) == 0) text.erase(0, 3);
    const TraceLine line(text, number);
    if (!has_columns && line.text() != kColumns) line.fail(line.text() + ": must be " + kColumns);
    if (has_columns && !line.is_blank()) accesses.push_back(line.access());
    has_columns = true;
  }
  if (csv.bad() || !has_columns)
    TraceLine("", number).fail(has_columns ? "cannot be read" : std::string("missing: must be ") + kColumns);
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
      fail(std::string(name()) + " at " + sc_core::sc_time_stamp().to_string() + ": access " +
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

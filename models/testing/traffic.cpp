#include "models/testing/traffic.h"

#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "models/kernel_time.h"
#include "models/testing/failure.h"

namespace stereotlm::test {
namespace {

// A number of 0..most. std::uniform_int_distribution differs from library to library.
std::uint64_t draw(std::mt19937_64& random, std::uint64_t most) { return random() % (most + 1); }

void require(bool holds, const char* what, std::uint64_t value, const std::string& rule) {
  if (!holds) throw std::invalid_argument(what + (" = " + std::to_string(value) + ": must be " + rule));
}

std::uint64_t number_of(const std::string& text, const char* what, std::size_t line) {
  std::size_t end = 0;
  std::uint64_t number = 0;
  if (!text.empty() && text.front() >= '0' && text.front() <= '9') {
    try {
      number = std::stoull(text, &end, text.rfind("0x", 0) == 0 ? 16 : 10);
    } catch (const std::logic_error&) {
      end = 0;
    }
  }
  if (end == 0 || end != text.size()) {
    throw std::invalid_argument("line " + std::to_string(line) + ": " + what + " = " + text +
                                ": must be a whole number");
  }
  return number;
}

TrafficAccess access_of(const std::string& text, std::size_t line) {
  std::vector<std::string> fields;
  std::istringstream row(text);
  for (std::string field; std::getline(row, field, ',');) fields.push_back(field);
  if (!fields.empty() && !fields.back().empty() && fields.back().back() == '\r') fields.back().pop_back();
  const auto problem = [&](const std::string& what) {
    return std::invalid_argument("line " + std::to_string(line) + ": " + what);
  };
  if (fields.size() != 4)
    throw problem(std::to_string(fields.size()) + " values: must be pause_ns,direction,address,words");
  TrafficAccess access;
  access.pause =
      sc_core::sc_time(static_cast<double>(number_of(fields[0], "pause_ns", line)), sc_core::SC_NS);
  if (fields[1] != "read" && fields[1] != "write")
    throw problem("direction = " + fields[1] + ": must be read or write");
  access.write = fields[1] == "write";
  access.address = number_of(fields[2], "address", line);
  if (access.address % 4 != 0) throw problem("address = " + fields[2] + ": must be a multiple of 4");
  access.words = number_of(fields[3], "words", line);
  if (access.words == 0) throw problem("words = 0: must be 1 or more");
  return access;
}

}  // namespace

std::vector<TrafficAccess> strided_traffic(std::uint64_t first, std::uint64_t stride, std::size_t count,
                                           bool write, std::size_t words) {
  require(first % 4 == 0, "first", first, "a multiple of 4");
  require(stride % 4 == 0, "stride", stride, "a multiple of 4");
  require(words > 0, "words", words, "1 or more");
  std::vector<TrafficAccess> accesses;
  for (std::size_t number = 0; number < count; ++number)
    accesses.push_back({{}, write, first + number * stride, words});
  return accesses;
}

std::vector<TrafficAccess> random_traffic(const RandomTraffic& from) {
  require(from.first % 4 == 0, "first", from.first, "a multiple of 4");
  require(from.most_words > 0 && from.most_words <= from.memory_words, "most_words", from.most_words,
          "1..memory_words, which is " + std::to_string(from.memory_words));
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
  std::size_t line = 1;
  std::string text;
  if (!std::getline(csv, text) || text != "pause_ns,direction,address,words")
    throw std::invalid_argument("line 1: " + text + ": must be pause_ns,direction,address,words");
  while (std::getline(csv, text)) accesses.push_back(access_of(text, ++line));
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

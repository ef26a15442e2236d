#include "models/pci/posted_writes.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>
#include <utility>

#include "models/pci/bridge_registers.h"

namespace stereotlm::pci {
namespace {

// A word and its address.
using Entry = std::pair<std::uint64_t, std::uint32_t>;

// The words that the next burst takes: up to `most`, at contiguous addresses in one bank.
std::vector<std::uint32_t> next_burst(const std::deque<Entry>& queue, std::size_t most) {
  std::vector<std::uint32_t> words;
  const std::uint64_t first = queue.front().first;
  while (words.size() < std::min(most, queue.size())) {
    const auto& [address, word] = queue[words.size()];
    if (address != first + 4 * words.size()) break;
    if (address / bridge::kBankBytes != first / bridge::kBankBytes) break;
    words.push_back(word);
  }
  return words;
}

// The addresses of the words that wait.
std::vector<std::uint64_t> waiting(const PostedWrites& posted) {
  std::vector<std::uint64_t> addresses;
  for (const PostedWrites::Run& run : posted.waiting()) {
    for (std::size_t word = 0; word < run.words; ++word) addresses.push_back(run.address + 4 * word);
  }
  return addresses;
}

// Bursts end at the longest length, where addresses jump and at the end of a bank. Words that are pushed
// while a burst is sent are not part of it.
TEST(PostedWrites, SendsTheSameBurstsAsAQueueOfSingleWords) {
  constexpr std::size_t kPlaces = 24;
  std::mt19937 random(1);
  const auto below = [&random](std::size_t end) { return static_cast<std::size_t>(random() % end); };
  PostedWrites posted(kPlaces);
  std::deque<Entry> plain;
  std::uint64_t address = bridge::kBankBytes - 400;
  std::uint32_t value = 0;
  PostedWrites::Burst burst;
  std::vector<std::uint32_t> sent;
  for (int i = 0; i < 20'000; ++i) {
    if (below(2) == 0 && plain.size() < kPlaces) {
      if (below(3) == 0) address = bridge::kBankBytes - 4 * below(20);
      std::vector<std::uint32_t> words(1 + below(kPlaces - plain.size()));
      for (std::size_t word = 0; word < words.size(); ++word) {
        words[word] = ++value;
        plain.emplace_back(address + 4 * word, words[word]);
      }
      posted.push(address, words.data(), words.size());
      address += 4 * words.size();
    } else if (!sent.empty()) {
      ASSERT_EQ(std::vector<std::uint32_t>(burst.words, burst.words + burst.count), sent);
      posted.sent();
      plain.erase(plain.begin(), plain.begin() + static_cast<std::ptrdiff_t>(sent.size()));
      sent.clear();
    } else if (!plain.empty()) {
      const std::size_t most = 1 + below(10);
      sent = next_burst(plain, most);
      burst = posted.send(most);
      ASSERT_EQ(burst.address, plain.front().first);
      ASSERT_EQ(std::vector<std::uint32_t>(burst.words, burst.words + burst.count), sent);
    }
    ASSERT_EQ(posted.words(), plain.size());
    ASSERT_EQ(posted.words_being_sent(), sent.size());
    ASSERT_EQ(posted.waits(), plain.size() > sent.size());
    std::vector<std::uint64_t> expected;
    for (std::size_t word = sent.size(); word < plain.size(); ++word) expected.push_back(plain[word].first);
    ASSERT_EQ(waiting(posted), expected);
  }
}

}  // namespace
}  // namespace stereotlm::pci

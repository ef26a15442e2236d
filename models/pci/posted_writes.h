#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stereotlm::pci {

// The words of posted writes that wait in the bridge for the local bus, in order, each with its address
// there. A burst keeps its places until it has been sent. Plain C++; once built it allocates nothing but what
// waiting() returns.
class PostedWrites {
 public:
  // The first words that wait, as far as their addresses follow each other in one bank.
  struct Burst {
    std::uint64_t address = 0;  // bytes on the local bus
    std::uint32_t* words = nullptr;
    std::size_t count = 0;
  };
  struct Run {
    std::uint64_t address = 0;
    std::size_t words = 0;  // from there on
  };

  explicit PostedWrites(std::size_t places);

  std::size_t words() const { return words_.size(); }
  std::size_t words_being_sent() const { return sending_; }
  bool waits() const { return words_.size() > sending_; }
  // Of the words that wait, and are not being sent.
  std::vector<Run> waiting() const;

  // `words`: of `count`, not more than there are free places.
  void push(std::uint64_t address, const void* words, std::size_t count);
  // Of at most `most` words, at least one; while some wait, and none are being sent. Its words stay where
  // they are until sent().
  Burst send(std::size_t most);
  void sent();

 private:
  std::vector<std::uint32_t> words_;
  std::vector<Run> runs_;  // their addresses; neighbours are one run
  std::size_t sending_ = 0;
};

}  // namespace stereotlm::pci

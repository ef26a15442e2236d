#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stereotlm::pci {

// A queue of posted writes: the words that wait in PciBridge for the local bus, each with its address on that
// bus. The words of a burst keep their places until the burst has been sent. Plain C++. After construction
// only waiting() allocates memory.
class PostedWrites {
 public:
  // The words of a burst: the oldest ones, as far as their addresses are contiguous and in one bank.
  struct Burst {
    std::uint64_t address = 0;  // byte address on the local bus
    std::uint32_t* words = nullptr;
    std::size_t count = 0;
  };
  // Words at contiguous addresses.
  struct Run {
    std::uint64_t address = 0;  // byte address of the first word
    std::size_t words = 0;
  };

  explicit PostedWrites(std::size_t places);

  std::size_t words() const { return words_.size(); }
  std::size_t words_being_sent() const { return sending_; }
  // Whether there are words that are not being sent.
  bool waits() const { return words_.size() > sending_; }
  // The words that wait and are not being sent.
  std::vector<Run> waiting() const;

  // Appends `count` words, not more than there are free places.
  void push(std::uint64_t address, const void* words, std::size_t count);
  // Begins a burst of 1..most words. To be called if waits(), and no burst is being sent. The words stay in
  // place until sent().
  Burst send(std::size_t most);
  // Ends the burst: its words leave the queue.
  void sent();

 private:
  std::vector<std::uint32_t> words_;
  std::vector<Run> runs_;    // addresses of words_; contiguous words are one run
  std::size_t sending_ = 0;  // words of the burst that is being sent
};

}  // namespace stereotlm::pci

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

  std::size_t places() const { return places_; }
  std::size_t words() const { return count_; }
  std::size_t words_being_sent() const { return sending_; }
  // Whether there are words that are not being sent.
  bool waits() const { return count_ > sending_; }
  // The words that wait and are not being sent.
  std::vector<Run> waiting() const;

  // Appends words, at most as many as there are free places.
  void push(std::uint64_t address, const void* words, std::size_t count);
  // Begins a burst of 1..most words. To be called if waits(), and no burst is being sent. The words stay in
  // place until sent().
  Burst send(std::size_t most);
  // Ends the burst: its words leave the queue.
  void sent();

 private:
  // The place that is `count` places behind `place`.
  std::size_t behind(std::size_t place, std::size_t count) const {
    const std::size_t next = place + count;
    return next < places_ ? next : next - places_;
  }
  Run& last_run() { return runs_[behind(first_run_, run_count_ - 1)]; }

  std::size_t places_;
  // A ring of places_ words. Behind it are as many places for copies of its first words: a burst that begins
  // before the end of the ring is contiguous.
  std::vector<std::uint32_t> words_;
  std::size_t first_ = 0;  // place of the oldest word
  std::size_t count_ = 0;
  std::vector<Run> runs_;  // a ring of places_ runs: addresses of words_; contiguous words are one run
  std::size_t first_run_ = 0;
  std::size_t run_count_ = 0;
  std::size_t sending_ = 0;  // words of the burst that is being sent
};

}  // namespace stereotlm::pci

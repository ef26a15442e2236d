#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "models/pci/bridge_registers.h"

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

  explicit PostedWrites(std::size_t places) : places_(places), words_(2 * places) { runs_.reserve(places); }

  std::size_t places() const { return places_; }
  std::size_t words() const { return end_ - first_; }
  std::size_t words_being_sent() const { return sending_; }
  // Whether there are words that are not being sent.
  bool waits() const { return words() > sending_; }
  // The words that wait and are not being sent.
  std::vector<Run> waiting() const {
    std::vector<Run> runs = runs_;
    if (!runs.empty()) take(runs.front());
    return runs;
  }

  // Appends words, at most as many as there are free places.
  void push(std::uint64_t address, const void* words, std::size_t count) {
    std::memcpy(words_.data() + end_, words, 4 * count);
    end_ += count;
    if (!runs_.empty() && runs_.back().address + 4 * runs_.back().words == address) {
      runs_.back().words += count;
    } else {
      Run& run = runs_.emplace_back();
      run.address = address;
      run.words = count;
    }
  }
  // Begins a burst of 1..most words. To be called if waits(), and no burst is being sent. The words stay in
  // place until sent().
  Burst send(std::size_t most) {
    const Run& run = runs_.front();
    const std::size_t in_bank = (bridge::kBankBytes - run.address % bridge::kBankBytes) / 4;
    sending_ = std::min({run.words, most, in_bank});
    return {run.address, words_.data() + first_, sending_};
  }
  // Ends the burst: its words leave the queue.
  void sent() {
    take(runs_.front());
    if (runs_.front().words == 0) runs_.erase(runs_.begin());
    first_ += sending_;
    sending_ = 0;
    if (first_ < places_) return;
    std::memmove(words_.data(), words_.data() + first_, 4 * words());
    end_ -= first_;
    first_ = 0;
  }

 private:
  void take(Run& run) const {
    run.address += 4 * sending_;
    run.words -= sending_;
  }

  std::size_t places_;
  std::vector<std::uint32_t> words_;
  std::size_t first_ = 0;    // index of the oldest word
  std::size_t end_ = 0;      // index behind the latest one
  std::vector<Run> runs_;    // the addresses of the words; contiguous words are one run
  std::size_t sending_ = 0;  // words of the burst that is being sent
};

}  // namespace stereotlm::pci

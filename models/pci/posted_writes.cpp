#include "models/pci/posted_writes.h"

#include <algorithm>
#include <cstring>

#include "models/pci/bridge_registers.h"

namespace stereotlm::pci {
namespace {

// The number of words between an address and the end of its bank.
std::size_t words_in_bank(std::uint64_t address) {
  return static_cast<std::size_t>((bridge::kBankBytes - address % bridge::kBankBytes) / 4);
}

}  // namespace

PostedWrites::PostedWrites(std::size_t places) {
  words_.reserve(places);
  runs_.reserve(places);
}

std::vector<PostedWrites::Run> PostedWrites::waiting() const {
  std::vector<Run> runs = runs_;
  if (sending_ == 0) return runs;
  runs.front().address += 4 * sending_;
  runs.front().words -= sending_;
  return runs;
}

void PostedWrites::push(std::uint64_t address, const void* words, std::size_t count) {
  const std::size_t before = words_.size();
  words_.resize(before + count);
  std::memcpy(words_.data() + before, words, 4 * count);
  if (!runs_.empty() && runs_.back().address + 4 * runs_.back().words == address) {
    runs_.back().words += count;
  } else {
    runs_.push_back({address, count});
  }
}

PostedWrites::Burst PostedWrites::send(std::size_t most) {
  const Run& run = runs_.front();
  sending_ = std::min({run.words, most, words_in_bank(run.address)});
  return {run.address, words_.data(), sending_};
}

void PostedWrites::sent() {
  Run& run = runs_.front();
  run.address += 4 * sending_;
  run.words -= sending_;
  if (run.words == 0) runs_.erase(runs_.begin());
  words_.erase(words_.begin(), words_.begin() + static_cast<std::ptrdiff_t>(sending_));
  sending_ = 0;
}

}  // namespace stereotlm::pci

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

PostedWrites::PostedWrites(std::size_t places) : places_(places), words_(2 * places_), runs_(places_) {}

std::vector<PostedWrites::Run> PostedWrites::waiting() const {
  std::vector<Run> runs;
  for (std::size_t run = 0; run < run_count_; ++run) runs.push_back(runs_[behind(first_run_, run)]);
  if (sending_ == 0) return runs;
  runs.front().address += 4 * sending_;
  runs.front().words -= sending_;
  return runs;
}

void PostedWrites::push(std::uint64_t address, const void* words, std::size_t count) {
  const std::size_t place = behind(first_, count_);
  const std::size_t to_end = std::min(count, places_ - place);
  const auto* const bytes = static_cast<const unsigned char*>(words);
  std::memcpy(words_.data() + place, bytes, 4 * to_end);
  if (to_end < count) std::memcpy(words_.data(), bytes + 4 * to_end, 4 * (count - to_end));
  count_ += count;
  if (run_count_ != 0 && last_run().address + 4 * last_run().words == address) {
    last_run().words += count;
  } else {
    ++run_count_;
    last_run() = {address, count};
  }
}

PostedWrites::Burst PostedWrites::send(std::size_t most) {
  const Run& run = runs_[first_run_];
  sending_ = std::min({run.words, most, words_in_bank(run.address)});
  if (first_ + sending_ > places_)
    std::memcpy(words_.data() + places_, words_.data(), 4 * (first_ + sending_ - places_));
  return {run.address, words_.data() + first_, sending_};
}

void PostedWrites::sent() {
  Run& run = runs_[first_run_];
  run.address += 4 * sending_;
  run.words -= sending_;
  if (run.words == 0) {
    first_run_ = behind(first_run_, 1);
    --run_count_;
  }
  first_ = behind(first_, sending_);
  count_ -= sending_;
  sending_ = 0;
}

}  // namespace stereotlm::pci

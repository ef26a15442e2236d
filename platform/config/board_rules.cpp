#include "platform/config/board_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "platform/config/board_keys.h"

namespace stereotlm::platform {
namespace {

class RuleChecker {
 public:
  RuleChecker(const BoardConfig& board, const std::function<bool(const std::string&)>& is_valid)
      : board_(board), is_valid_(is_valid) {}

  std::vector<BrokenRule> check() {
    check_trigger();
    check_bank_depths();
    check_list_lengths();
    check_bank_names();
    return std::move(found_);
  }

 private:
  bool all_valid(const std::vector<std::string>& paths) const {
    return std::all_of(paths.begin(), paths.end(), is_valid_);
  }

  void check_trigger() {
    const std::vector<std::string> involved = {"capture.fifo_trigger_words", "capture.fifo_words"};
    const CaptureConfig& capture = board_.capture;
    if (!all_valid(involved) || capture.fifo_trigger_words <= capture.fifo_words) return;
    found_.push_back({fmt::format("capture.fifo_trigger_words = {}: 1..fifo_words, which is {}",
                                  capture.fifo_trigger_words, capture.fifo_words),
                      involved});
  }

  void check_bank_depths() {
    if (!all_valid({"image.width", "image.height", "ssram.banks"})) return;
    std::vector<Buffer> known = buffers(board_.allocation);
    known.erase(std::remove_if(known.begin(), known.end(),
                               [this](const Buffer& buffer) { return !is_valid_(buffer.key); }),
                known.end());
    for (const BankConfig& bank : board_.banks) {
      std::uint64_t needed = 0;
      for (const Buffer& buffer : known) {
        if (buffer.bank == bank.name) needed += buffer_words(buffer, board_.image);
      }
      if (needed > static_cast<std::uint64_t>(bank.words)) report_depth(bank, known, needed);
    }
  }

  void report_depth(const BankConfig& bank, const std::vector<Buffer>& known, std::uint64_t needed) {
    std::vector<std::string> involved = {fmt::format("ssram.banks.{}.words", bank.name)};
    if (!is_valid_(involved.front())) return;
    std::vector<std::string> held;
    for (const Buffer& buffer : known) {
      if (buffer.bank != bank.name) continue;
      involved.push_back(buffer.path());
      held.push_back(buffer.path().substr(buffer.path().find('.') + 1));
    }
    involved.insert(involved.end(), {"image.width", "image.height"});
    found_.push_back(
        {fmt::format("{} = {}: {} words missing, its buffers ({}) need {}", involved.front(), bank.words,
                     needed - static_cast<std::uint64_t>(bank.words), fmt::join(held, ", "), needed),
         involved});
  }

  void check_list_lengths() {
    const std::vector<std::string> involved = {"allocation.right_image", "allocation.left_image"};
    const AllocationConfig& allocation = board_.allocation;
    if (!all_valid(involved) || allocation.right_image.size() == allocation.left_image.size()) return;
    found_.push_back({fmt::format("allocation.right_image = {}: must be as long as left_image, which is {}",
                                  list_text(allocation.right_image), list_text(allocation.left_image)),
                      involved});
  }

  void check_bank_names() {
    if (!is_valid_("ssram.banks")) return;
    std::vector<std::string> names;
    names.reserve(board_.banks.size());
    for (const BankConfig& bank : board_.banks) names.push_back(bank.name);
    for (const Buffer& buffer : buffers(board_.allocation)) {
      if (!is_valid_(buffer.key) || std::find(names.begin(), names.end(), buffer.bank) != names.end())
        continue;
      found_.push_back({fmt::format("{} = {}: not a bank of this board{}", buffer.key, buffer.bank,
                                    nearest_text(buffer.bank, names)),
                        {buffer.path(), "ssram.banks"}});
    }
  }

  const BoardConfig& board_;
  const std::function<bool(const std::string&)>& is_valid_;
  std::vector<BrokenRule> found_;
};

}  // namespace

std::vector<BrokenRule> broken_rules(const BoardConfig& board,
                                     const std::function<bool(const std::string&)>& is_valid) {
  return RuleChecker(board, is_valid).check();
}

std::vector<Buffer> buffers(const AllocationConfig& allocation) {
  std::vector<Buffer> all;
  const auto add_list = [&all](const char* key, const std::vector<std::string>& banks) {
    for (std::size_t i = 0; i < banks.size(); ++i) all.push_back({key, static_cast<int>(i), banks[i]});
  };
  const auto add_table = [&all](const char* key, const std::optional<std::string>& bank) {
    if (bank) all.push_back({key, -1, *bank});
  };
  add_list("allocation.left_image", allocation.left_image);
  add_list("allocation.right_image", allocation.right_image);
  add_list("allocation.disparity", allocation.disparity);
  add_table("allocation.left_lut", allocation.left_lut);
  add_table("allocation.right_lut", allocation.right_lut);
  return all;
}

std::uint64_t buffer_words(const Buffer& buffer, const ImageConfig& image) {
  const auto pixels = static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
  return buffer.index < 0 ? pixels : pixels / 4;
}

std::string list_text(const std::vector<std::string>& words) {
  return fmt::format("[{}]", fmt::join(words, ", "));
}

}  // namespace stereotlm::platform

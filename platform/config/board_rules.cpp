#include "platform/config/board_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "platform/config/board_keys.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

class RuleChecker {
 public:
  RuleChecker(const BoardConfig& board, const std::function<bool(const std::string&)>& is_valid)
      : board_(board), is_valid_(is_valid) {}

  std::vector<BrokenRule> check() {
    check_trigger();
    check_host_ring();
    check_image_size("image.width", board_.image.width, fpga::kWidthWithTableRule);
    check_image_size("image.height", board_.image.height, fpga::kHeightWithTableRule);
    check_units();
    check_rows();
    check_joint_tables();
    // Deeper banks would not help tables that are too large anyhow.
    if (!is_too_large_for_tables_) check_bank_depths();
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

  // Host memory holds tables and results beside the ring.
  void check_host_ring() {
    const std::vector<std::string> involved = {"capture.host_frames", "capture.destination", "image.width",
                                               "image.height"};
    if (!all_valid(involved) || board_.capture.destination != CaptureDestination::kHostMemory) return;
    constexpr std::int64_t kMostBytes = std::int64_t{1} << 30;
    const ImageConfig& image = board_.image;
    const std::int64_t most_pairs = kMostBytes / (std::int64_t{2} * image.width * image.height);
    if (board_.capture.host_frames <= most_pairs) return;
    found_.push_back(
        {fmt::format("capture.host_frames = {}: at most {} pairs of {}x{} pixels, because the ring in host "
                     "memory may have {} MiB",
                     board_.capture.host_frames, most_pairs, image.width, image.height, kMostBytes >> 20),
         involved});
  }

  // The keys of both tables that the board has.
  std::vector<std::string> keys_of_tables() const {
    std::vector<std::string> keys;
    if (board_.allocation.left_lut) keys.emplace_back(key_of(Buffer::kLeftLut));
    if (board_.allocation.right_lut) keys.emplace_back(key_of(Buffer::kRightLut));
    return keys;
  }

  void check_image_size(const std::string& key, int value, const kernels::IntegerRule& rule) {
    const std::vector<std::string> tables = keys_of_tables();
    if (tables.empty() || value <= rule.max) return;
    std::vector<std::string> involved = {key};
    involved.insert(involved.end(), tables.begin(), tables.end());
    if (!all_valid(involved)) return;
    is_too_large_for_tables_ = true;
    found_.push_back(
        {fmt::format("{} = {}: at most {} with a look-up table; set {} to none, or a smaller image", key,
                     value, rule.max, fmt::join(tables, " and ")),
         involved});
  }

  void check_units() {
    const MatcherConfig& matcher = board_.matcher;
    const std::vector<std::string> involved = {"matcher.units", "matcher.disparities"};
    if (!all_valid(involved) || fpga::has_units_for(matcher.units, matcher.disparities)) return;
    found_.push_back({fmt::format("matcher.units = {}: 1..disparities, which is {}, or all", *matcher.units,
                                  matcher.disparities),
                      involved});
  }

  void check_rows() {
    const MatcherConfig& matcher = board_.matcher;
    const std::vector<std::string> with_fetch = {"matcher.rows", "matcher.fetch"};
    if (!fpga::can_fetch_rows(matcher.fetch, matcher.rows) && all_valid(with_fetch)) {
      found_.push_back({fmt::format("matcher.rows = {}: must be 1 where matcher.fetch is line_buffer; with "
                                    "column it may be {}",
                                    matcher.rows, fpga::kRowsRule.text()),
                        with_fetch});
    }
    const std::vector<std::string> with_queue = {"fpga.result_fifo_words", "matcher.rows"};
    if (!fpga::can_queue_rows(board_.fpga.result_fifo_words, matcher.rows) && all_valid(with_queue)) {
      found_.push_back(
          {fmt::format("fpga.result_fifo_words = {}: at least {}, a word for each of the rows that "
                       "are computed at once; or fewer matcher.rows",
                       board_.fpga.result_fifo_words, matcher.rows),
           with_queue});
    }
  }

  void check_joint_tables() {
    const auto& left = board_.allocation.left_lut;
    const auto& right = board_.allocation.right_lut;
    if (!board_.fpga.joint_tables || (left && left == right)) return;
    const Buffer wrong = left ? Buffer::kRightLut : Buffer::kLeftLut;
    const Buffer other = left ? Buffer::kLeftLut : Buffer::kRightLut;
    const std::vector<std::string> involved = {key_of(wrong), key_of(other), "fpga.tables"};
    if (!all_valid(involved)) return;
    const std::optional<std::string>& bank = left ? left : right;
    const std::string rule = bank ? fmt::format("must be {}, the bank of {}", *bank, name_of(other))
                                  : "must be a bank, and right_lut the same bank";
    found_.push_back({fmt::format("{} = {}: {}, because fpga.tables is joint; or set fpga.tables to separate",
                                  key_of(wrong), left ? right.value_or("none") : "none", rule),
                      involved});
  }

  void check_bank_depths() {
    if (!all_valid({"image.width", "image.height", "ssram.banks"})) return;
    std::vector<PlacedBuffer> known = buffers(board_);
    known.erase(
        std::remove_if(known.begin(), known.end(),
                       [this](const PlacedBuffer& buffer) { return !is_valid_(key_of(buffer.buffer)); }),
        known.end());
    for (const BankConfig& bank : board_.banks) {
      std::uint64_t needed = 0;
      for (const PlacedBuffer& buffer : known) {
        if (buffer.bank == bank.name) needed += buffer_words(buffer, board_.image);
      }
      if (needed > static_cast<std::uint64_t>(bank.words)) report_depth(bank, known, needed);
    }
  }

  void report_depth(const BankConfig& bank, const std::vector<PlacedBuffer>& known, std::uint64_t needed) {
    std::vector<std::string> involved = {fmt::format("ssram.banks.{}.words", bank.name)};
    if (!is_valid_(involved.front())) return;
    std::vector<std::string> held;
    std::vector<std::uint64_t> tables;  // their words
    for (const PlacedBuffer& buffer : known) {
      if (buffer.bank != bank.name) continue;
      involved.push_back(buffer.path());
      held.push_back(buffer.label());
      if (buffer.index < 0) tables.push_back(buffer_words(buffer, board_.image));
    }
    involved.insert(involved.end(), {"image.width", "image.height"});
    const std::uint64_t missing = needed - static_cast<std::uint64_t>(bank.words);
    std::string text = fmt::format("{} = {}: {} words missing, its buffers ({}) need {}", involved.front(),
                                   bank.words, missing, fmt::join(held, ", "), needed);
    if (tables.size() == 2 && missing <= tables.front()) {
      involved.emplace_back("fpga.tables");
      text += "; set fpga.tables to joint, or give the bank more words, or one of the tables another bank";
    }
    found_.push_back({std::move(text), involved});
  }

  void check_list_lengths() {
    const std::vector<std::string> involved = {key_of(Buffer::kRightImage), key_of(Buffer::kLeftImage)};
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
    for (const PlacedBuffer& buffer : buffers(board_)) {
      if (!is_valid_(key_of(buffer.buffer)) ||
          std::find(names.begin(), names.end(), buffer.bank) != names.end())
        continue;
      found_.push_back({fmt::format("{} = {}: not a bank of this board{}", key_of(buffer.buffer), buffer.bank,
                                    nearest_text(buffer.bank, names)),
                        {buffer.path(), "ssram.banks"}});
    }
  }

  const BoardConfig& board_;
  const std::function<bool(const std::string&)>& is_valid_;
  std::vector<BrokenRule> found_;
  bool is_too_large_for_tables_ = false;
};

}  // namespace

std::vector<BrokenRule> broken_rules(const BoardConfig& board,
                                     const std::function<bool(const std::string&)>& is_valid) {
  return RuleChecker(board, is_valid).check();
}

std::string list_text(const std::vector<std::string>& words) {
  return fmt::format("[{}]", fmt::join(words, ", "));
}

}  // namespace stereotlm::platform

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "platform/config/board_area.h"
#include "platform/config/board_reader.h"
#include "platform/config/buffer_layout.h"
#include "platform/yaml/words.h"

namespace stereotlm::platform {
namespace {

std::string text_of(const BufferBanks& in) {
  return in.is_striped() ? fmt::format("{{rows: [{}]}}", fmt::join(in.banks, ", ")) : in.banks.front();
}

std::string list_text(const std::vector<BufferBanks>& list) {
  std::vector<std::string> texts;
  for (const BufferBanks& in : list) texts.push_back(text_of(in));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

class RuleChecker {
 public:
  RuleChecker(const BoardConfig& board, const std::function<bool(const std::string&)>& is_valid)
      : board_(board), is_valid_(is_valid) {}

  std::vector<BrokenRule> check() {
    const bool fits_width = check_image_size("image.width", board_.image.width, fpga::kWidthWithTableRule);
    const bool fits_height =
        check_image_size("image.height", board_.image.height, fpga::kHeightWithTableRule);
    check_capture();
    check_result_queue();
    // Deeper banks would not help tables that are too large anyhow.
    if (fits_width && fits_height) check_bank_depths();
    check_list_lengths();
    check_bank_names();
    check_pins();
    check_stripes();
    check_refreshes();
    check_joint_tables();
    check_matcher();
    return std::move(found_);
  }

 private:
  bool all_valid(const std::vector<std::string>& paths) const {
    return std::all_of(paths.begin(), paths.end(), is_valid_);
  }

  // Adds the broken rule, with this text, if it is not kept, and all values that it involves are valid by
  // themselves. Returns false if it has added the rule.
  template <typename... Values>
  bool require(bool is_kept, const std::vector<std::string>& involved, fmt::format_string<Values...> text,
               Values&&... values) {
    if (is_kept || !all_valid(involved)) return true;
    found_.push_back({fmt::format(text, std::forward<Values>(values)...), involved});
    return false;
  }

  void check_capture() {
    const CaptureConfig& capture = board_.capture;
    require(capture.fifo_trigger_words <= capture.fifo_words,
            {"capture.fifo_trigger_words", "capture.fifo_words"},
            "capture.fifo_trigger_words = {}: 1..fifo_words, which is {}", capture.fifo_trigger_words,
            capture.fifo_words);
    if (capture.destination != CaptureDestination::kHostMemory) return;
    constexpr std::int64_t kMostBytes = std::int64_t{1} << 30;  // host memory also holds tables and results
    const ImageConfig& image = board_.image;
    const std::int64_t pair_bytes = std::max(std::int64_t{2} * image.width * image.height, std::int64_t{1});
    require(capture.host_frames <= kMostBytes / pair_bytes,
            {"capture.host_frames", "capture.destination", "image.width", "image.height"},
            "capture.host_frames = {}: at most {} pairs of {}x{} pixels, because the ring in host memory may "
            "have {} MiB",
            capture.host_frames, kMostBytes / pair_bytes, image.width, image.height, kMostBytes >> 20);
  }

  bool check_image_size(const std::string& key, int value, const kernels::IntegerRule& rule) {
    if (value <= rule.max) return true;
    std::vector<std::string> tables;
    if (board_.allocation.left_lut) tables.emplace_back(key_of(Buffer::kLeftLut));
    if (board_.allocation.right_lut) tables.emplace_back(key_of(Buffer::kRightLut));
    std::vector<std::string> involved = {key};
    involved.insert(involved.end(), tables.begin(), tables.end());
    return require(tables.empty(), involved,
                   "{} = {}: at most {} with a look-up table; set {} to none, or a smaller image", key, value,
                   rule.max, fmt::join(tables, " and "));
  }

  void check_matcher() {
    const MatcherConfig& matcher = board_.matcher;
    require(fpga::has_units_for(matcher.units, matcher.disparities), {"matcher.units", "matcher.disparities"},
            "matcher.units = {}: 1..disparities, which is {}, or all", matcher.units.value_or(0),
            matcher.disparities);
    require(fpga::can_fetch_rows(matcher.fetch, matcher.rows), {"matcher.rows", "matcher.fetch"},
            "matcher.rows = {}: must be 1 where matcher.fetch is line_buffer; with column it may be {}",
            matcher.rows, fpga::kRowsRule.text());
    const int lanes = board_.fpga.lanes;
    require(fpga::can_divide_columns(matcher.fetch, lanes), {"fpga.lanes", "matcher.fetch"},
            "fpga.lanes = {}: must be 1 where matcher.fetch is line_buffer; with column it may be {}", lanes,
            fpga::kLanesRule.text());
    const int slots = matcher.window + matcher.rows - 1;
    std::vector<std::string> of_column = {"fpga.lanes", "matcher.window"};
    if (matcher.rows != 1) of_column.emplace_back("matcher.rows");  // it may be left out
    require(matcher.fetch == fpga::Fetch::kLineBuffer || lanes <= slots, of_column,
            "fpga.lanes = {}: at most {}, the slots of a column (matcher.window + matcher.rows - 1)", lanes,
            slots);
  }

  void check_result_queue() {
    const int words = board_.fpga.result_fifo_words;
    const int rows = board_.matcher.rows;
    require(
        fpga::can_queue_rows(words, rows), {"fpga.result_fifo_words", "matcher.rows"},
        "fpga.result_fifo_words = {}: at least {}, a word for each of the rows that are computed at once; "
        "or fewer matcher.rows",
        words, rows);
  }

  void check_joint_tables() {
    if (!board_.fpga.joint_tables) return;
    const auto& left = board_.allocation.left_lut;
    const auto& right = board_.allocation.right_lut;
    const Buffer wrong = left ? Buffer::kRightLut : Buffer::kLeftLut;
    const Buffer other = left ? Buffer::kLeftLut : Buffer::kRightLut;
    const auto& in = left ? left : right;
    const std::string rule = in ? fmt::format("must be {}, the bank{} of {}", text_of(*in),
                                              in->is_striped() ? "s" : "", name_of(other))
                                : "must be a bank, and right_lut the same bank";
    require(left && left == right, {key_of(wrong), key_of(other), "fpga.tables"},
            "{} = {}: {}, because fpga.tables is joint; or set fpga.tables to separate", key_of(wrong),
            left && right ? text_of(*right) : "none", rule);
  }

  void check_bank_depths() {
    if (!all_valid({"image.width", "image.height", "ssram.banks"})) return;
    for (const BankConfig& bank : board_.banks) {
      const std::string words = fmt::format("ssram.banks.{}.words", bank.name);
      std::vector<std::string> involved = {words};
      std::vector<std::string> held;
      std::uint64_t needed = 0;
      std::vector<std::uint64_t> tables;  // their words
      for (const PlacedBuffer& buffer : buffers(board_)) {
        if (buffer.bank != bank.name || !is_valid_(key_of(buffer.buffer))) continue;
        involved.push_back(buffer.path());
        held.push_back(buffer.label());
        needed += buffer_words(buffer, board_.image);
        if (buffer.index < 0) tables.push_back(buffer_words(buffer, board_.image));
      }
      const auto depth = static_cast<std::uint64_t>(bank.words);
      if (needed <= depth || !is_valid_(words)) continue;
      involved.insert(involved.end(), {"image.width", "image.height"});
      std::string text = fmt::format("{} = {}: {} words missing, its buffers ({}) need {}", words, bank.words,
                                     needed - depth, fmt::join(held, ", "), needed);
      if (tables.size() == 2 && needed - depth <= tables.front()) {
        involved.emplace_back("fpga.tables");
        text += "; set fpga.tables to joint, or give the bank more words, or one of the tables another bank";
      }
      found_.push_back({std::move(text), involved});
    }
  }

  void check_list_lengths() {
    const AllocationConfig& allocation = board_.allocation;
    require(allocation.right_image.size() == allocation.left_image.size(),
            {key_of(Buffer::kRightImage), key_of(Buffer::kLeftImage)},
            "allocation.right_image = {}: must be as long as left_image, which is {}",
            list_text(allocation.right_image), list_text(allocation.left_image));
  }

  void check_bank_names() {
    if (!is_valid_("ssram.banks")) return;
    std::vector<std::string> names;
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

  void check_pins() {
    const area::Package* const package = area::find_package(board_.fpga.package);
    if (package == nullptr) return;
    const std::string device(area::kDeviceWithPackages);
    const bool has_package = require(board_.fpga.device == device, {"fpga.package", "fpga.device"},
                                     "fpga.package = {}: only where fpga.device is {}, and it is {}",
                                     package->name, device, board_.fpga.device);
    if (!has_package || !is_valid_("ssram.banks")) return;
    const int pins = pins_of(board_);
    require(pins <= package->user_pins, {"fpga.package"},
            "fpga.package = {}: {} pins missing: the board needs {}, and it has {}", package->name,
            pins - package->user_pins, pins, package->user_pins);
  }

  // A lane waits as long for each part of a buffer.
  void check_stripes() {
    if (!is_valid_("ssram.banks")) return;
    const std::vector<memory::SsramBankConfig> banks = ssram_configs(board_);
    const auto bank_of = [this](const PlacedBuffer& part) {
      return static_cast<std::size_t>(
          std::find_if(board_.banks.begin(), board_.banks.end(),
                       [&](const BankConfig& bank) { return bank.name == part.bank; }) -
          board_.banks.begin());
    };
    std::size_t first = 0;
    for (const PlacedBuffer& part : buffers(board_)) {
      const std::size_t bank = bank_of(part);
      if (bank == banks.size()) continue;  // check_bank_names()
      if (part.part == 0) first = bank;
      const int cycles = memory::read_latency_cycles(banks[bank]);
      const int of_first = memory::read_latency_cycles(banks[first]);
      const std::string kind = below(below("ssram.banks", part.bank), "kind");
      require(part.parts == 1 || cycles == of_first, {part.path(), kind},
              "{} = {}: its read latency is {}, that of {} is {}; all banks of a stripe need one",
              part.path(), part.bank, cycles, bank_text(board_.banks[first].name), of_first);
    }
  }

  void check_refreshes() {
    if (!is_valid_("ssram.banks")) return;
    for (const BankConfig& bank : board_.banks) {
      if (!bank.sdram || !bank.sdram->refresh_interval_cycles) continue;
      const int least = memory::least_refresh_interval(*bank.sdram);
      const std::string path = below(below("ssram.banks", bank.name), "refresh_interval_cycles");
      const int interval = *bank.sdram->refresh_interval_cycles;
      require(interval >= least, {path},
              "{} = {}: at least {}, or no access might ever be granted: a refresh, and the opening of two "
              "rows",
              path, interval, least);
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

}  // namespace stereotlm::platform

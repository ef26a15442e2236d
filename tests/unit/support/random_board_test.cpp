#include "tests/support/random_board.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>

namespace stereotlm::test {
namespace {

constexpr std::uint64_t kSeeds = 1500;

bool names_a_bank_twice(const std::vector<int>& list) {
  return std::set<int>(list.begin(), list.end()).size() < list.size();
}

std::size_t banks_in_use(const RandomBoard& board) {
  std::set<int> banks;
  for (const auto* list : {&board.left_image, &board.right_image, &board.disparity}) {
    banks.insert(list->begin(), list->end());
  }
  for (const auto& bank : {board.left_lut, board.right_lut}) {
    if (bank) banks.insert(*bank);
  }
  return banks.size();
}

std::size_t buffers(const RandomBoard& board) {
  return 2 * board.left_image.size() + board.disparity.size() + (board.left_lut ? 1U : 0U) +
         (board.right_lut ? 1U : 0U);
}

bool has_invalid_entries(const std::optional<std::vector<std::uint32_t>>& table) {
  return table && std::any_of(table->begin(), table->end(), [](std::uint32_t e) { return e >> 31U == 0; });
}

template <typename Enumerator>
std::string number_of(Enumerator value) {
  return std::to_string(static_cast<int>(value));
}

// Every kind of board that a comparison must not miss is drawn at least once in a hundred.
TEST(RandomBoard, CoversEveryKindOfBoard) {
  std::map<std::string, int> seen = {{"fixed_priority", 0}, {"round_robin", 0}, {"age", 0}};
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const RandomBoard board = make_random_board(seed);
    const int half = board.filter ? (board.filter->size - 1) / 2 : 0;
    const int radius = (board.window - 1) / 2;
    seen["fetch " + number_of(board.fetch)]++;
    seen[name_of(board.arbitration)]++;
    std::set<PlainBankKind> kinds;
    for (const PlainBank& bank : board.banks) kinds.insert(bank.kind);
    for (const PlainBankKind kind : kinds) seen["bank kind " + number_of(kind)]++;
    seen["several kinds"] += kinds.size() > 1 ? 1 : 0;
    seen["no filter"] += board.filter ? 0 : 1;
    seen["filter larger than window"] += half > radius ? 1 : 0;
    seen["filter smaller than window"] += board.filter && half < radius ? 1 : 0;
    seen["extreme weights"] += board.filter && *std::max_element(board.filter->weights.begin(),
                                                                 board.filter->weights.end()) == 32767;
    seen["check off"] += board.lr_tolerance ? 0 : 1;
    seen["tolerance"] += board.lr_tolerance.value_or(0) > 0 ? 1 : 0;
    seen["disparities beyond width"] += board.disparities > board.width ? 1 : 0;
    seen["window beyond image"] += board.window > std::min(board.width, board.height) ? 1 : 0;
    seen["a bank twice in a list"] += names_a_bank_twice(board.left_image) ? 1 : 0;
    seen["one bank for all"] += banks_in_use(board) == 1 ? 1 : 0;
    seen["a bank for each buffer"] += banks_in_use(board) == buffers(board) ? 1 : 0;
    seen["no tables"] += !board.left_lut && !board.right_lut ? 1 : 0;
    seen["a table on one side"] += board.left_lut.has_value() != board.right_lut.has_value() ? 1 : 0;
    seen["invalid entries"] += has_invalid_entries(board.left_table) ? 1 : 0;
    seen["all entries valid"] += board.left_table && !has_invalid_entries(board.left_table) ? 1 : 0;
    seen["one slot in a lane"] += board.lane_fifo_slots == 1 ? 1 : 0;
    seen["one result word"] += board.result_fifo_words == 1 ? 1 : 0;
    seen["several frames"] += board.frames > 1 ? 1 : 0;
  }
  for (const auto& [kind, count] : seen) EXPECT_GE(count, static_cast<int>(kSeeds / 100)) << kind;
}

int passes(const RandomBoard& board) {
  return board.units == 0 ? 1 : (board.disparities + board.units - 1) / board.units;
}

TEST(RandomBoard, CoversEveryKnobAloneAndWithOthers) {
  std::map<std::string, int> seen = {
      {"qdr by fixed_priority", 0}, {"qdr by round_robin", 0}, {"qdr by age", 0}};
  for (const int kind : {0, 1, 2, 3}) seen["cost " + std::to_string(kind)] = 0;
  for (const int size : {3, 5, 7}) seen["census " + std::to_string(size)] = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const RandomBoard board = make_random_board(seed, RandomKnobs::all());
    const bool is_column = board.fetch == PlainFetch::kColumn;
    const bool has_qdr = std::any_of(board.banks.begin(), board.banks.end(),
                                     [](const PlainBank& bank) { return bank.kind == PlainBankKind::kQdr; });
    seen["wide"] += board.width > 2048 ? 1 : 0;
    seen["high"] += board.height > 2048 ? 1 : 0;
    seen["as many units as disparities"] += board.units == board.disparities ? 1 : 0;
    seen["two passes"] += passes(board) == 2 ? 1 : 0;
    seen["more than four passes"] += passes(board) > 4 ? 1 : 0;
    seen["passes with line buffers"] += passes(board) > 1 && !is_column ? 1 : 0;
    seen["two rows"] += board.rows == 2 ? 1 : 0;
    seen["more rows than the image"] += board.rows > board.height ? 1 : 0;
    seen["rows that divide the image"] += board.rows > 1 && board.height % board.rows == 0 ? 1 : 0;
    seen["rows that do not"] += board.height > board.rows && board.height % board.rows != 0 ? 1 : 0;
    seen["a queue of as many words as rows"] +=
        board.rows > 1 && board.result_fifo_words == board.rows ? 1 : 0;
    seen["a longer queue"] += board.rows > 1 && board.result_fifo_words > board.rows ? 1 : 0;
    seen["joint tables"] += board.joint_tables ? 1 : 0;
    seen["separate tables in one bank"] +=
        !board.joint_tables && board.left_lut && board.left_lut == board.right_lut ? 1 : 0;
    seen["cache"] += board.word_cache ? 1 : 0;
    seen["cache and line buffers"] += board.word_cache && !is_column ? 1 : 0;
    seen["cache without table"] += board.word_cache && !board.left_lut ? 1 : 0;
    seen["qdr"] += has_qdr ? 1 : 0;
    seen["qdr by " + std::string(name_of(board.arbitration))] += has_qdr ? 1 : 0;
    seen["cost " + number_of(board.cost.kind)]++;
    seen["census " + std::to_string(board.cost.census_size)]++;
    seen["no knob"] +=
        passes(board) == 1 && board.rows == 1 && !board.joint_tables && !board.word_cache ? 1 : 0;
    seen["all knobs"] += passes(board) > 1 && board.rows > 1 && board.joint_tables && board.word_cache &&
                                 has_qdr && board.cost.kind != ReferenceCost::Kind::kSad
                             ? 1
                             : 0;
  }
  for (const auto& [kind, count] : seen) EXPECT_GE(count, static_cast<int>(kSeeds / 100)) << kind;
}

}  // namespace
}  // namespace stereotlm::test

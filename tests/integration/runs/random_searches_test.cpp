#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "platform/config/board_area.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/bounds.h"
#include "sw/explore/optimise/search.h"
#include "sw/runs/simulation/board_model.h"
#include "sw/runs/simulation/simulate_point.h"
#include "tests/support/scratch_folder.h"

// Searches of small random spaces against brute force: every placement by its own enumeration, every board
// simulated, every pair of boards compared.
namespace stereotlm::test {
namespace {

using explore::FrontPoint;
using platform::BoardConfig;

std::uint64_t spaces_of_environment(std::uint64_t otherwise) {
  const char* const text = std::getenv("STEREOTLM_RANDOM_SEARCHES");
  return text != nullptr ? std::stoull(text) : otherwise;
}

constexpr const char* kStalls = "ports.result.stall_cycles";  // known only from a whole run

// The text of a plan of a small space.
class RandomSpace {
 public:
  explicit RandomSpace(std::uint64_t seed) : random_(seed) {
    const std::size_t banks = 2 + below(2);
    places_ = below(5) != 0;
    parts_ = places_ && banks == 2 && below(2) == 0 ? 2 : 1;
    std::string names;
    const std::vector<std::string> kinds = {
        "{kind: zbt_pipelined, words: DEPTH}", "{kind: zbt_flow_through, words: DEPTH}",
        "{kind: sync_burst, turnaround_cycles: 2, words: DEPTH}",
        "{kind: qdr, words: DEPTH, energy: {access_pj: 700}}",
        "{kind: sdram, words: DEPTH, cas_latency: 2, row_words: 16, internal_banks: 2, activate_cycles: 1, "
        "precharge_cycles: 1, refresh_interval_cycles: 64, refresh_cycles: 3}"};
    const std::size_t common = below(kinds.size());
    for (std::size_t i = 0; i < banks; ++i) {
      std::string kind = kinds[below(3) == 0 ? below(kinds.size()) : common];
      kind.replace(kind.find("DEPTH"), 5, i > 0 && below(4) == 0 ? "300" : "4096");
      names += fmt::format("{}b{}: {}", i == 0 ? "" : ", ", i, kind);
    }
    const bool has_tables = below(3) != 0;
    const std::string images = parts_ == 2 || below(2) == 0 ? "b0" : "[b0, b0]";
    const std::string lut = has_tables ? "b0" : "none";
    board = fmt::format(
        "extends: fpl2003\nname: small\nimage: {{width: {}, height: {}}}\n"
        "ssram: {{default: {{kind: zbt_pipelined, words: 4096}}, banks: {{{}}}}}\n"
        "allocation: {{left_image: {}, right_image: {}, disparity: {}, left_lut: {}, right_lut: {}}}\n"
        "matcher: {{window: 3, disparities: {}, filter: {}}}\n",
        4 * (2 + below(4)), 4 + below(5), names, images, images, below(2) == 0 ? "b0" : "[b0, b0]", lut, lut,
        3 + below(6), below(2) == 0 ? "none" : "log7");
    std::vector<std::string> axes = {"matcher.window: [3, 5]",
                                     "matcher.rows: [1, 2]",
                                     "matcher.units: [all, 2]",
                                     "fpga.lanes: [1, 2]",
                                     "matcher.fetch: [column, line_buffer]",
                                     "fpga.pixel_cache: [none, word]",
                                     "fpga.lane_fifo_slots: [2, 16]",
                                     "fpga.result_fifo_words: [1, 8]",
                                     "fpga.clock_mhz: [33.333, 40]",
                                     "fpga.arbitration: [fixed_priority, round_robin, age]",
                                     "matcher.lr_tolerance: ['off', 1]"};
    if (has_tables) axes.emplace_back("fpga.tables: [separate, joint]");
    std::shuffle(axes.begin(), axes.end(), random_);
    axes.resize(1 + below(3));
    for (const std::string& axis : axes) plan += "  " + axis + '\n';
    if (below(3) == 0) plan += "where: [matcher.window + matcher.rows <> 5 OR fpga.lanes = 2]\n";
    if (places_) plan += fmt::format("placements: {{banks: {}, stripes: {}}}\n", 1 + below(banks), parts_);
    std::vector<std::pair<std::string, bool>> goals = {{"frames_per_second.core", true},
                                                       {"area.slices", false},
                                                       {"cycles", false},
                                                       {"energy.memory_mj_per_frame", false},
                                                       {"matcher.window * matcher.disparities", true},
                                                       {"banks_used", false},
                                                       {"pins", false},
                                                       {kStalls, false}};
    std::shuffle(goals.begin(), goals.end(), random_);
    goals.resize(1 + below(3));
    for (const bool is_maximum : {true, false}) {
      std::string list;
      for (const auto& [text, aim] : goals) {
        if (aim == is_maximum) list += (list.empty() ? "" : ", ") + text;
      }
      if (!list.empty()) plan += fmt::format("{}: [{}]\n", is_maximum ? "maximise" : "minimise", list);
    }
    const std::vector<std::string> requirements = {
        "banks_used <= 1", "frames_per_second.core >= 15000", "area.slices < 2500",
        "frames_per_second.core * banks_used > 30000", kStalls + std::string(" <= 100")};
    if (below(2) == 0) plan += fmt::format("require: [\"{}\"]\n", requirements[below(requirements.size())]);
  }

  std::string board;
  std::string plan = "board: board.yaml\nrun: {source: preloaded}\nvary:\n";

 private:
  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }

  std::mt19937_64 random_;
  bool places_;
  int parts_;
};

// Brute force.

// All ordered choices of 1 to `parts` different banks.
void add_choices(std::size_t banks, std::size_t parts, std::vector<std::size_t>& begun,
                 std::vector<std::vector<std::size_t>>& all) {
  if (!begun.empty()) all.push_back(begun);
  if (begun.size() == parts) return;
  for (std::size_t bank = 0; bank < banks; ++bank) {
    if (std::count(begun.begin(), begun.end(), bank) > 0) continue;
    begun.push_back(bank);
    add_choices(banks, parts, begun, all);
    begun.pop_back();
  }
}

platform::BufferBanks named(const BoardConfig& board, const std::vector<std::size_t>& banks) {
  std::vector<std::string> names;
  for (const std::size_t bank : banks) names.push_back(board.banks[bank].name);
  return platform::BufferBanks(names);
}

// The boards of a combination, one for each class of placements that differ by an exchange of equal banks.
std::vector<BoardConfig> boards_of(const explore::Plan& plan, std::uint64_t number) {
  const auto read = plan.read(number);
  BoardConfig board = read.reading.board;
  const int most_banks = plan.wishes().most_banks;
  if (most_banks == 0)
    return platform::problems(board).empty() ? std::vector{board} : std::vector<BoardConfig>();
  std::vector<platform::BufferBanks*> buffers;
  auto& in = board.allocation;
  for (auto* list : {&in.left_image, &in.right_image, &in.disparity}) {
    for (platform::BufferBanks& buffer : *list) buffers.push_back(&buffer);
  }
  if (in.left_lut) buffers.push_back(&*in.left_lut);
  if (in.right_lut && !board.fpga.joint_tables) buffers.push_back(&*in.right_lut);
  std::vector<std::size_t> begun;
  std::vector<std::vector<std::size_t>> choices;
  add_choices(board.banks.size(), static_cast<std::size_t>(plan.wishes().most_parts), begun, choices);
  // All renamings of equal banks.
  std::vector<std::vector<std::size_t>> renamings;
  std::vector<std::size_t> order(board.banks.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  do {
    bool is_of_equals = true;
    for (std::size_t i = 0; i < order.size(); ++i) {
      BoardConfig exchanged = board;
      exchanged.banks[i].name = exchanged.banks[order[i]].name = "same";
      BoardConfig a;
      BoardConfig b;
      a.banks = {exchanged.banks[i]};
      b.banks = {exchanged.banks[order[i]]};
      is_of_equals = is_of_equals && a == b;
    }
    if (is_of_equals) renamings.push_back(order);
  } while (std::next_permutation(order.begin(), order.end()));
  std::set<std::vector<std::vector<std::size_t>>> known;
  std::vector<BoardConfig> boards;
  std::vector<std::size_t> chosen(buffers.size());
  for (bool is_more = true; is_more;) {
    std::vector<std::vector<std::size_t>> placement;
    std::set<std::size_t> used;
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      placement.push_back(choices[chosen[i]]);
      used.insert(placement.back().begin(), placement.back().end());
    }
    if (used.size() <= static_cast<std::size_t>(most_banks)) {
      auto least = placement;
      for (const auto& renaming : renamings) {
        auto renamed = placement;
        for (auto& banks : renamed) {
          for (std::size_t& bank : banks) bank = renaming[bank];
        }
        least = std::min(least, renamed);
      }
      if (known.insert(least).second) {
        for (std::size_t i = 0; i < buffers.size(); ++i) *buffers[i] = named(board, placement[i]);
        if (board.fpga.joint_tables) in.right_lut = in.left_lut;
        if (platform::problems(board).empty()) boards.push_back(board);
      }
    }
    is_more = false;
    for (std::size_t i = 0; i < chosen.size() && !is_more; ++i) {
      is_more = ++chosen[i] < choices.size();
      if (!is_more) chosen[i] = 0;
    }
  }
  return boards;
}

// The value of a name or an expression in the pool of RandomSpace.
double value_of(const std::string& text, const BoardConfig& board, const explore::Figures& figures) {
  const std::vector<bool> used = platform::used_banks(board);
  const auto of_figure = [&](const std::string& name) {
    const auto found = std::find_if(figures.values.begin(), figures.values.end(),
                                    [&name](const auto& value) { return value.path == name; });
    return std::holds_alternative<double>(found->value)
               ? std::get<double>(found->value)
               : static_cast<double>(std::get<std::int64_t>(found->value));
  };
  if (text == "banks_used") return static_cast<double>(std::count(used.begin(), used.end(), true));
  if (text == "pins") return platform::pins_of(board);
  if (text == "matcher.window * matcher.disparities") return board.matcher.window * board.matcher.disparities;
  return of_figure(text);
}

bool meets(const explore::Plan& plan, const BoardConfig& board, const explore::Figures& figures) {
  const double rate = value_of("frames_per_second.core", board, figures);
  const double banks = value_of("banks_used", board, figures);
  for (const explore::Condition& one : plan.wishes().requirements) {
    const bool holds = one.text == "banks_used <= 1"                   ? banks <= 1
                       : one.text == "frames_per_second.core >= 15000" ? rate >= 15000
                       : one.text == "area.slices < 2500" ? value_of("area.slices", board, figures) < 2500
                       : one.text == "frames_per_second.core * banks_used > 30000"
                           ? rate * banks > 30000
                           : value_of(kStalls, board, figures) <= 100;
    if (!holds) return false;
  }
  return true;
}

// [normalised values: larger is better]: the boards that have them.
using Front = std::map<std::vector<double>, std::set<std::string>>;

// The front, by all pairs of values.
Front brute_front(const explore::Plan& plan) {
  Front all;
  for (std::uint64_t number = 0; number < plan.size(); ++number) {
    runs::PointSimulator simulator;
    for (const BoardConfig& board : boards_of(plan, number)) {
      if (!plan.conditions().empty() && board.matcher.window + board.matcher.rows == 5 &&
          board.fpga.lanes != 2)
        continue;
      const explore::Point point = explore::make_point(number, board, plan.read(number).run);
      const explore::Figures figures = simulator(point);
      if (!meets(plan, board, figures)) continue;
      std::vector<double> values;
      for (const auto& goal : plan.wishes().goals) {
        const double value = value_of(goal.figure.text, board, figures);
        values.push_back(goal.is_maximum ? value : -value);
      }
      all[values].insert(fmt::format("{} {}", number, point.yaml));
    }
  }
  Front front;
  for (const auto& [values, boards] : all) {
    const auto beats = [&its = values](const auto& other) {
      bool is_better = false;
      for (std::size_t i = 0; i < its.size(); ++i) {
        if (other.first[i] < its[i]) return false;
        is_better = is_better || other.first[i] > its[i];
      }
      return is_better;
    };
    if (std::none_of(all.begin(), all.end(), beats)) front.emplace(values, boards);
  }
  return front;
}

// How the search of a space differs from brute force; empty if it does not.
std::string difference(std::uint64_t seed, const explore::BoardModel& model) {
  static std::map<std::uint64_t, Front> fronts;
  const RandomSpace space(seed);
  const ScratchFolder folder;
  const std::string board = (folder.path() / "board.yaml").string();
  write_file(board, space.board);
  const explore::Plan plan =
      explore::Plan::load(write_file((folder.path() / "plan.yaml").string(), space.plan), board);
  if (fronts.count(seed) == 0) fronts.emplace(seed, brute_front(plan));
  const Front& expected = fronts.at(seed);
  explore::Search search(plan, plan.wishes(), model, 2);
  if (!search.run([](const explore::SearchState&) { return true; })) return "interrupted";
  std::string text;
  if (search.front().size() != expected.size())
    text += fmt::format("{} front points, expected {}\n", search.front().size(), expected.size());
  for (const FrontPoint& point : search.front()) {
    std::vector<double> values;
    for (std::size_t i = 0; i < point.values.size(); ++i)
      values.push_back(plan.wishes().goals[i].is_maximum ? point.values[i].least : -point.values[i].least);
    const auto found = expected.find(values);
    if (found == expected.end()) {
      text += fmt::format("{}: not on the front\n", fmt::join(values, " "));
      continue;
    }
    if (found->second.size() != point.boards)
      text += fmt::format("{}: {} boards, expected {}\n", fmt::join(values, " "), point.boards,
                          found->second.size());
    if (!std::is_sorted(point.first.begin(), point.first.end())) text += "the first boards are not sorted\n";
  }
  // The certificate covers each combination once, and each placement of an examined one.
  std::uint64_t next = 0;
  std::map<std::string, std::vector<std::size_t>> sizes;  // [space][group]
  std::uint64_t of_certificate = 0;                       // boards of the front
  search.certify({[&](const explore::Search::Part& part) {
                    if (part.first != next) text += "the parts leave a gap\n";
                    next = part.last + 1;
                  },
                  [&](const std::string& name, const explore::Placements& placements) {
                    for (const auto& group : placements.groups())
                      sizes[name].push_back(group.placements.size());
                  },
                  [&](const explore::Search::Examined& one) {
                    if (one.fate != "front") return;
                    for (const std::uint32_t number : one.numbers)
                      of_certificate += one.are_groups && !sizes.empty() ? sizes.at(one.space).at(number) : 1;
                  }});
  std::uint64_t boards = 0;
  for (const FrontPoint& point : search.front()) boards += point.boards;
  if (next != plan.size()) text += "the parts do not cover the space\n";
  if (of_certificate != boards)
    text += fmt::format("{} boards of the certificate, {} found\n", of_certificate, boards);
  return text;
}

TEST(RandomSearches, FindTheFrontOfBruteForce) {
  const std::uint64_t spaces = spaces_of_environment(12);
  const explore::BoardModel model = runs::board_model(nullptr);
  const char* const first = std::getenv("STEREOTLM_FIRST_SEED");
  for (std::uint64_t seed = first != nullptr ? std::stoull(first) : 1; seed <= spaces; ++seed) {
    const RandomSpace space(seed);
    ASSERT_EQ(difference(seed, model), "") << "seed " << seed << '\n' << space.board << space.plan;
  }
}

// Counts the spaces in which a wrong model is seen.
int seen(const explore::BoardModel& wrong) {
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    try {
      count += difference(seed, wrong).empty() ? 0 : 1;
    } catch (const std::exception&) {
      ++count;
    }
  }
  return count;
}

TEST(RandomSearches, SeeAWrongBound) {
  explore::BoardModel wrong = runs::board_model(nullptr);
  wrong.waitless_cycles = [right = wrong.waitless_cycles](const BoardConfig& board) {
    return 2 * right(board);
  };
  EXPECT_GT(seen(wrong), 0);
  wrong = runs::board_model(nullptr);
  wrong.contended_cycles = [right = wrong.contended_cycles](const BoardConfig& board) {
    return 2 * right(board);
  };
  EXPECT_GT(seen(wrong), 0);
}

}  // namespace
}  // namespace stereotlm::test

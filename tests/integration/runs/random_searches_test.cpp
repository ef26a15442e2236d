#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "platform/config/board_area.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/bounds.h"
#include "platform/figures/proven_rate.h"
#include "platform/loop/core_loop.h"
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

std::uint64_t first_seed() {
  const char* const text = std::getenv("STEREOTLM_FIRST_SEED");
  return text != nullptr ? std::stoull(text) : 1;
}

constexpr const char* kStalls = "ports.result.stall_cycles";  // known only from a whole run
constexpr const char* kForArea = "frames_per_second.core / area.slices";

// The text of a plan of a small space.
class RandomSpace {
 public:
  explicit RandomSpace(std::uint64_t seed) : random_(seed) {
    const std::size_t banks = 2 + below(2);
    places_ = below(5) != 0;
    parts_ = places_ && banks == 2 && below(2) == 0 ? 2 : 1;
    std::string names;
    // Most banks are of one kind; some of these differ from it in one key.
    struct Kind {
      const char* keys;
      const char* key;
      std::pair<const char*, const char*> values;
    };
    const std::vector<Kind> kinds = {
        {"kind: zbt_pipelined", "energy.access_pj", {"400", "900"}},
        {"kind: zbt_flow_through", "energy.standby_mw", {"100", "300"}},
        {"kind: sync_burst", "turnaround_cycles", {"2", "5"}},
        {"kind: qdr", "energy.access_pj", {"700", "300"}},
        {"kind: sdram, cas_latency: 2, row_words: 16, internal_banks: 2, activate_cycles: 1, "
         "refresh_interval_cycles: 64, refresh_cycles: 3",
         "precharge_cycles",
         {"1", "6"}}};
    const Kind& common = kinds[below(kinds.size())];
    for (std::size_t i = 0; i < banks; ++i) {
      const Kind& kind = i > 0 && below(4) == 0 ? kinds[below(kinds.size())] : common;
      const char* const value = i > 0 && below(3) == 0 ? kind.values.second : kind.values.first;
      const std::string key = kind.key;
      const std::size_t dot = key.find('.');
      names += fmt::format("{}b{}: {{{}, {}, words: {}}}", i == 0 ? "" : ", ", i, kind.keys,
                           dot == std::string::npos
                               ? fmt::format("{}: {}", key, value)
                               : fmt::format("energy: {{{}: {}}}", key.substr(dot + 1), value),
                           i > 0 && below(4) == 0 ? 300 : 4096);
    }
    const bool has_tables = below(3) != 0;
    // So that brute force has some thousand boards at most, there are not many buffers in many banks.
    const bool has_pictures = parts_ == 1 && (banks == 2 || !has_tables) && below(2) == 0;
    const std::string images = has_pictures ? "[b0, b0]" : "b0";
    const std::string lut = has_tables ? "b0" : "none";
    board = fmt::format(
        "extends: fpl2003\nname: small\nimage: {{width: {}, height: {}}}\n"
        "ssram: {{default: {{kind: zbt_pipelined, words: 4096}}, banks: {{{}}}}}\n"
        "allocation: {{left_image: {}, right_image: {}, disparity: {}, left_lut: {}, right_lut: {}}}\n"
        "fpga: {{arbitration: {}, pipeline_latency_cycles: {}}}\n"
        "matcher: {{window: 3, disparities: {}, filter: {}}}\n",
        4 * (2 + below(4)), 4 + below(5), names, images, images,
        parts_ == 2 || below(2) == 0 ? "b0" : "[b0, b0]", lut, lut,
        below(4) == 0 ? "round_robin" : "fixed_priority", below(2) == 0 ? 0 : 16, 3 + below(6),
        below(2) == 0 ? "none" : "log7");
    plan = fmt::format("board: board.yaml\nrun: {{source: preloaded{}}}\nvary:\n",
                       below(3) == 0 ? ", frames: 3" : "");
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
                                     "fpga.result_delay_cycles: [0, 5]",
                                     "matcher.lr_tolerance: ['off', 1]"};
    if (has_tables) axes.emplace_back("fpga.tables: [separate, joint]");
    std::shuffle(axes.begin(), axes.end(), random_);
    axes.resize(1 + below(3));
    if (below(3) == 0)
      axes.back() =
          fmt::format("ssram.banks.b0.{}: [{}, {}]", common.key, common.values.first, common.values.second);
    for (const std::string& axis : axes) plan += "  " + axis + '\n';
    if (below(3) == 0) plan += "where: [matcher.window + matcher.rows <> 5 OR fpga.lanes = 2]\n";
    if (places_) {
      const std::size_t most = below(3) == 0 ? 1 + below(banks) : banks;
      plan += fmt::format("placements: {{banks: {}, stripes: {}}}\n", most, parts_);
    }
    std::vector<std::pair<std::string, bool>> goals = {{"frames_per_second.core", true},
                                                       {"area.slices", false},
                                                       {"cycles", false},
                                                       {"energy.memory_mj_per_frame", false},
                                                       {"matcher.window * matcher.disparities", true},
                                                       {"banks_used", false},
                                                       {"pins", false},
                                                       {kForArea, true},
                                                       {kStalls, false}};
    std::shuffle(goals.begin(), goals.end(), random_);
    goals.resize(1 + below(4));
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
  std::string plan;

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
  if (text == kForArea) return of_figure("frames_per_second.core") / of_figure("area.slices");
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

struct BruteForce {
  Front front;
  std::uint64_t boards = 0;  // of the space
};

// The front, by all pairs of values.
BruteForce brute_force(const explore::Plan& plan) {
  Front all;
  BruteForce found;
  for (std::uint64_t number = 0; number < plan.size(); ++number) {
    runs::PointSimulator simulator;
    for (const BoardConfig& board : boards_of(plan, number)) {
      if (!plan.conditions().empty() && board.matcher.window + board.matcher.rows == 5 &&
          board.fpga.lanes != 2)
        continue;
      ++found.boards;
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
  for (const auto& [values, boards] : all) {
    const auto beats = [&its = values](const auto& other) {
      bool is_better = false;
      for (std::size_t i = 0; i < its.size(); ++i) {
        if (other.first[i] < its[i]) return false;
        is_better = is_better || other.first[i] > its[i];
      }
      return is_better;
    };
    if (std::none_of(all.begin(), all.end(), beats)) found.front.emplace(values, boards);
  }
  return found;
}

// What is wrong with the fate of these placements, in the first and the last of them; empty if nothing is.
std::string problem_of(explore::Search& search, const explore::Search::Examined& fate,
                       const std::vector<std::uint32_t>& placements) {
  std::set<std::pair<int, double>> uses;
  for (const std::uint32_t placement : {placements.front(), placements.back()}) {
    const explore::Search::Board one = search.board({fate.combination, placement});
    const explore::Figures figures =
        runs::PointSimulator()(explore::make_point(fate.combination, *one.board, one.run));
    uses.emplace(platform::pins_of(*one.board), value_of("banks_used", *one.board, figures));
    const double cycles = value_of("cycles", *one.board, figures) +
                          value_of("frames", *one.board, figures) * one.board->fpga.pipeline_latency_cycles;
    std::vector<double> named;
    for (const std::string& name : search.result_names())
      named.push_back(value_of(name, *one.board, figures));
    if (!fate.results.empty() && fate.results != named && fate.results != std::vector<double>{cycles})
      return "other results";
    if (fate.least_cycles && static_cast<double>(*fate.least_cycles) > cycles)
      return "a bound above the cycles";
  }
  return uses.size() > 1 ? "other banks in use" : "";
}

// How the search of a space differs from brute force; empty if it does not.
std::string difference(std::uint64_t seed, const explore::BoardModel& model) {
  static std::map<std::uint64_t, BruteForce> fronts;
  const RandomSpace space(seed);
  const ScratchFolder folder;
  const std::string board = (folder.path() / "board.yaml").string();
  write_file(board, space.board);
  const explore::Plan plan =
      explore::Plan::load(write_file((folder.path() / "plan.yaml").string(), space.plan), board);
  if (fronts.count(seed) == 0) fronts.emplace(seed, brute_force(plan));
  const Front& expected = fronts.at(seed).front;
  explore::Search search(plan, plan.wishes(), model, 2);
  if (!search.run([](const explore::SearchState&) { return true; })) return "interrupted";
  std::string text;
  if (search.state().boards != fronts.at(seed).boards)
    text += fmt::format("{} boards, expected {}\n", search.state().boards, fronts.at(seed).boards);
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
  std::map<std::string, std::vector<std::vector<std::uint32_t>>> groups;  // [space]: their placements
  std::uint64_t of_certificate = 0;                                       // boards of the front
  search.certify({[&](const explore::Search::Part& part) {
                    if (part.first != next) text += "the parts leave a gap\n";
                    next = part.last + 1;
                  },
                  [&](const std::string& name, const explore::Placements& placements) {
                    for (const auto& group : placements.groups()) groups[name].push_back(group.placements);
                  },
                  [&](const explore::Search::Examined& one) {
                    std::vector<std::uint32_t> all = one.numbers;
                    if (one.are_groups && !groups.empty()) {
                      all.clear();
                      for (const std::uint32_t number : one.numbers) {
                        const auto& group = groups.at(one.space).at(number);
                        all.insert(all.end(), group.begin(), group.end());
                      }
                    }
                    if (one.fate == "front") of_certificate += all.size();
                    text += problem_of(search, one, all);
                  }});
  std::uint64_t boards = 0;
  for (const FrontPoint& point : search.front()) boards += point.boards;
  if (next != plan.size()) text += "the parts do not cover the space\n";
  if (of_certificate != boards)
    text += fmt::format("{} boards of the certificate, {} found\n", of_certificate, boards);
  return text;
}

TEST(RandomSearches, FindTheFrontOfBruteForce) {
  const std::uint64_t spaces = spaces_of_environment(24);
  const explore::BoardModel model = runs::board_model(nullptr);
  for (std::uint64_t seed = first_seed(); seed <= spaces; ++seed) {
    const RandomSpace space(seed);
    if (const char* const folder = std::getenv("STEREOTLM_SPACES")) {  // for check_search_test.py
      const std::filesystem::path own = std::filesystem::path(folder) / std::to_string(seed);
      write_file(own / "board.yaml", space.board);
      write_file(own / "plan.yaml", space.plan);
    }
    ASSERT_EQ(difference(seed, model), "") << "seed " << seed << '\n' << space.board << space.plan;
  }
}

// Counts the spaces in which a wrong model is seen.
int seen(const explore::BoardModel& wrong) {
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
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

constexpr const char* kByTwenties = "round(frames_per_second.steady / 20)";
constexpr const char* kQuick = "frames_per_second.steady >= 500";

// Of whole computers. A plan whose cameras are about as quick as the core, so that some boards lose pixels.
std::pair<std::string, std::string> computer_space(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto below = [&random](std::uint64_t end) { return random() % end; };
  const std::vector<std::string> kinds = {"{kind: zbt_pipelined}", "{kind: zbt_flow_through}",
                                          "{kind: sync_burst, turnaround_cycles: 2}"};
  const std::string images = below(2) == 0 ? "a" : "[a, b]";
  const std::string board = fmt::format(
      "extends: fpl2003\nname: small\nimage: {{width: {}, height: {}}}\ncameras: {{frame_rate_hz: {}}}\n"
      "capture: {{fifo_words: 16, fifo_trigger_words: 4}}\nbridge: {{posted_words: 16}}\n"
      "fpga: {{clock_mhz: 4}}\nmatcher: {{filter: none, window: 3, disparities: 4}}\n"
      "ssram: {{default: {{words: 4096}}, banks: {{a: {}, b: {}, c: {}}}}}\n"
      "allocation: {{left_image: {}, right_image: {}, disparity: b, left_lut: none, right_lut: none}}\n",
      4 * (8 + below(8)), 8 + below(8), 400 + 100 * below(7), kinds[0], kinds[below(3)], kinds[below(3)],
      images, images);
  std::vector<std::string> axes = {"fpga.clock_mhz: [4, 5]",
                                   "matcher.rows: [1, 2]",
                                   "matcher.units: [all, 1]",
                                   "fpga.lane_fifo_slots: [3, 8]",
                                   "capture.fifo_words: [8, 64]",
                                   "matcher.fetch: [column, line_buffer]",
                                   "bridge.posted_words: [4, 64]",
                                   "cameras.frame_rate_hz: [600, 950]",
                                   "fpga.arbitration: [fixed_priority, round_robin]"};
  std::shuffle(axes.begin(), axes.end(), random);
  const std::uint64_t frames = seed % 2 == 0 ? 0 : 64 + below(20);  // with a short run before
  std::string plan = fmt::format("board: board.yaml\nrun: {{source: camera{}}}\nvary:\n",
                                 frames == 0 ? "" : fmt::format(", frames: {}", frames));
  for (std::size_t i = 0; i < 2; ++i) plan += "  " + axes[i] + '\n';
  plan += fmt::format("placements: {{banks: 3}}\nmaximise: [\"{}\"]\n",
                      below(2) == 0 ? kByTwenties : "frames_per_second.steady");
  if (below(3) == 0) plan += fmt::format("require: {}\n", kQuick);
  if (below(2) == 0) plan += "minimise: [banks_used]\n";
  return {board, plan};
}

// What is known of the rate of a board in the long run; nullopt: it loses pixels.
std::optional<explore::Range> steady_of(const explore::Point& point, const explore::Figures& figures) {
  if (value_of("lost_pixels", *point.board, figures) > 0) return std::nullopt;
  const double rate = value_of("frames_per_second.steady", *point.board, figures);
  const double uncertainty = value_of("frames_per_second.steady_uncertainty", *point.board, figures);
  const fpga::AccessPatterns patterns = platform::access_patterns(*point.board, nullptr);
  const platform::FrameAccesses accesses = platform::frame_accesses(*point.board, patterns);
  const auto cycles =
      platform::core_frame_cycles(*point.board, patterns, platform::allocation_period_frames(*point.board));
  const auto proven =
      platform::proven_rate(*point.board, accesses, cycles, platform::steady_bound(*point.board, accesses));
  const double least =
      std::max(proven->least, value_of("frames_per_second.exact_least", *point.board, figures));
  const double of_run = value_of("frames_per_second.exact_most", *point.board, figures);
  const double most = std::max(least, std::min(proven->most, of_run));
  return explore::narrowed({least, most}, rate, uncertainty);
}

TEST(RandomSearches, OfComputersFindTheFrontOfBruteForce) {
  using Values = std::vector<std::pair<double, double>>;  // [goal]: worst and best; larger is better
  const std::uint64_t spaces = spaces_of_environment(3);
  for (std::uint64_t seed = first_seed(); seed <= spaces; ++seed) {
    const auto [board_text, plan_text] = computer_space(seed);
    const ScratchFolder folder;
    const std::string board_file = write_file((folder.path() / "board.yaml").string(), board_text);
    const explore::Plan plan =
        explore::Plan::load(write_file((folder.path() / "plan.yaml").string(), plan_text), board_file);
    std::map<Values, std::uint64_t> all;
    runs::PointSimulator simulator;
    for (std::uint64_t number = 0; number < plan.size(); ++number) {
      for (const BoardConfig& board : boards_of(plan, number)) {
        const explore::Point point = explore::make_point(number, board, plan.read(number).run);
        auto steady = steady_of(point, simulator(point));
        if (!steady) continue;
        const std::uint64_t turn = platform::allocation_period_frames(board);
        const std::uint64_t few = turn + (30 + turn - 1) / turn * turn;
        if (2 * few <= point.run.frames) {  // what a run of few frames leaves open too
          const explore::Point shorter = explore::make_point(number, board, {true, few, ""});
          const auto other = steady_of(shorter, simulator(shorter));
          steady->most = std::min(steady->most, other->most);
          steady->least = std::min(std::max(steady->least, other->least), steady->most);
          if (other->is_exact()) steady = other;  // no longer run is needed
        }
        if (!plan.wishes().requirements.empty() && steady->least < 500) continue;
        Values values = {{steady->least, steady->most}};
        if (plan.wishes().goals[0].figure.text == kByTwenties)
          values = {{std::round(steady->least / 20), std::round(steady->most / 20)}};
        if (plan.wishes().goals.size() > 1) {
          const double banks = -value_of("banks_used", board, {});
          values.emplace_back(banks, banks);
        }
        ++all[values];
      }
    }
    const auto beats = [](const Values& one, const Values& other) {
      bool is_better = false;
      for (std::size_t i = 0; i < one.size(); ++i) {
        if (one[i].first < other[i].second) return false;
        is_better = is_better || one[i].first > other[i].second;
      }
      return is_better;
    };
    std::map<Values, std::uint64_t> expected;
    for (const auto& one : all) {
      if (std::none_of(all.begin(), all.end(),
                       [&](const auto& other) { return beats(other.first, one.first); }))
        expected.insert(one);
    }
    const explore::BoardModel model = runs::board_model(nullptr);
    explore::Search search(plan, plan.wishes(), model, 2);
    ASSERT_TRUE(search.run([](const explore::SearchState&) { return true; }));
    std::map<Values, std::uint64_t> found;
    for (const FrontPoint& point : search.front()) {
      Values values = {{point.values[0].least, point.values[0].most}};
      if (point.values.size() > 1) values.emplace_back(-point.values[1].least, -point.values[1].least);
      found[values] += point.boards;
    }
    EXPECT_EQ(found, expected) << "seed " << seed << '\n' << board_text << plan_text;
    double certain = 0;  // the best that a board has for sure
    for (const auto& one : expected) certain = std::max(certain, one.first[0].first);
    if (!expected.empty()) {
      EXPECT_EQ(search.state().best, certain);
    }
  }
}

}  // namespace
}  // namespace stereotlm::test

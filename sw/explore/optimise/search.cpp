#include "sw/explore/optimise/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "platform/config/board_reader.h"
#include "platform/config/buffer_layout.h"
#include "sw/explore/optimise/workers.h"

namespace stereotlm::explore {
namespace {

using platform::BoardConfig;

constexpr std::size_t kPieces = 128;            // for each process, of a round
constexpr std::size_t kPixels = 2 * 640 * 480;  // the same: of the pictures of its whole computers
constexpr std::size_t kMostLooked = 4096;       // nodes that a round looks at

// What follows in the message of a piece.
enum class Tag : char { kResult, kSecondResult, kFront, kNodes };

}  // namespace

Search::Search(const Plan& plan, const SearchWishes& wishes, const BoardModel& model, unsigned processes)
    : wishes_(wishes), processes_(processes), space_(plan, wishes_, model, results_), front_(wishes.goals) {
  if (plan.size() > kMostCombinations)
    throw std::length_error(
        fmt::format("{} combinations of values: at most {}", plan.size(), kMostCombinations));
  std::map<std::string, BoardConfig> first;
  space_.add_board(0, first);  // throws at once if there are too many placements
  verdicts_.resize(plan.size());
  placements_.resize(plan.size());
  bests_.resize(plan.size() * space_.goals());
}

// The rate is what both runs leave open. So a board that its short run rules out is ruled out by its own
// run too, and the front does not depend on which boards had a run of their own.
Search::Found Search::find(Combination& its, const Placements::Group& group, std::uint64_t placement,
                           const GetResult& get) {
  std::optional<SearchSpace::Worth> of_short;
  if (space_.short_frames(its, placement) > 0) {
    const std::string key = space_.result_keys(its, group, placement, true).front();
    const auto result = get(key, 0, true);
    of_short = space_.worth(its, group, placement, {result}, true);
    if (!of_short) return {"unmet", {}, {}};
    if (front_.beats(front_.bests_of(of_short->goals).data())) return {"bound", of_short->goals, {}};
    if (of_short->is_known) return {"front", of_short->goals, {}};
  }
  Found found;
  for (const std::string& key : space_.result_keys(its, group, placement)) {
    const auto result = get(key, found.results.size(), false);
    if (result.empty()) return {"", of_short->goals, {}};
    found.results.push_back(result);
  }
  const Range steady = of_short ? of_short->steady : Range();
  const auto worth = space_.worth(its, group, placement, found.results, false, steady);
  found.fate = "unmet";
  if (!worth) return found;
  found.values = worth->goals;
  found.fate = front_.beats(front_.bests_of(found.values).data()) ? "dominated" : "front";
  return found;
}

// Boards that differ in nothing that changes the disparities are computed once.
bool Search::compute_accuracy(const std::function<bool()>& keep_going) {
  std::map<std::string, BoardConfig> boards;  // by the keys of their results
  for (std::uint64_t number = 0; number < verdicts_.size(); ++number) {
    if (number % kCombinationsOfPiece == 0 && !keep_going()) return false;
    space_.add_board(number, boards);
  }
  std::vector<std::pair<std::string, BoardConfig>> left;
  for (auto& one : boards) {
    if (results_.count(one.first) == 0) left.push_back(one);
  }
  const auto work = [&](std::size_t piece) {
    Message bytes;
    bytes.put_numbers(space_.accuracy(left[piece].second));
    return bytes.text();
  };
  const auto take = [&](std::size_t piece, const std::string& message) {
    const auto values = Message(message).get_numbers<double>();
    results_.emplace(left[piece].first, values);
    new_results_.emplace(left[piece].first, values);
  };
  return do_in_processes(left.size(), processes_, work, take, keep_going);
}

// Finds the verdict and the bounds of each combination.
bool Search::assess(const std::function<bool()>& keep_going) {
  const std::size_t goals = space_.goals();
  const std::size_t pieces = (verdicts_.size() + kCombinationsOfPiece - 1) / kCombinationsOfPiece;
  const auto work = [&](std::size_t piece) {
    Message bytes;
    const std::size_t end = std::min(verdicts_.size(), (piece + 1) * kCombinationsOfPiece);
    for (std::size_t number = piece * kCombinationsOfPiece; number < end; ++number) {
      Combination& its = space_.combination(number);
      Verdict verdict = its.verdict;
      SearchSpace::Estimate estimate;
      if (verdict == Verdict::kUnknown) {
        estimate = space_.estimate(its);
        if (!estimate.may_meet) verdict = Verdict::kUnmet;
      }
      bytes.put(verdict);
      bytes.put(verdict == Verdict::kImpossible ? std::uint32_t{0}
                                                : static_cast<std::uint32_t>(its.placements->size()));
      for (std::size_t goal = 0; goal < goals; ++goal) bytes.put(estimate.best[goal]);
    }
    return bytes.text();
  };
  const auto take = [&](std::size_t piece, const std::string& message) {
    Message bytes(message);
    for (std::size_t number = piece * kCombinationsOfPiece; !bytes.at_end(); ++number) {
      verdicts_[number] = bytes.get<Verdict>();
      placements_[number] = bytes.get<std::uint32_t>();
      Node node;
      node.combination = number;
      for (std::size_t goal = 0; goal < goals; ++goal)
        node.best[goal] = bests_[number * goals + goal] = bytes.get<double>();
      node.boards = placements_[number];
      if (verdicts_[number] != Verdict::kExcluded) state_.boards += node.boards;
      if (verdicts_[number] != Verdict::kUnknown) continue;
      nodes_.push(node);
      state_.open += node.boards;
    }
  };
  return do_in_processes(pieces, processes_, work, take, keep_going);
}

// Takes the nodes of a round: the best by their bounds, without those that another of them beats.
std::vector<Search::Node> Search::choose() {
  std::vector<Node> chosen;
  std::vector<Node> later;
  std::size_t pixels = 0;  // of the frames of whole computers
  const auto is_worse = [goals = space_.goals()](const Node& a, const Node& b) {
    bool is_better = false;
    for (std::size_t goal = 0; goal < goals; ++goal) {
      if (b.best[goal] < a.best[goal]) return false;
      is_better = is_better || b.best[goal] > a.best[goal];
    }
    return is_better;
  };
  for (std::size_t looked = 0; looked < kMostLooked && !nodes_.empty(); ++looked) {
    if (chosen.size() == kPieces * processes_ || pixels >= kPixels * processes_) break;
    const Node node = nodes_.top();
    nodes_.pop();
    if (front_.beats(node.best.data())) {
      state_.open -= node.boards;
      continue;
    }
    const bool waits =
        std::any_of(chosen.begin(), chosen.end(), [&](const Node& other) { return is_worse(node, other); });
    (waits ? later : chosen).push_back(node);
    if (waits || node.placement == Node::kAll) continue;
    const Combination& its = space_.combination(node.combination);
    if (its.run.camera) pixels += static_cast<std::size_t>(its.board.image.width * its.board.image.height);
  }
  for (const Node& node : later) nodes_.push(node);
  return chosen;
}

// Finds the values of a placement, for all of `placements`, and says the results of its simulations. Says a
// node instead if its own run can wait for those of boards that can be better.
void Search::examine(Combination& its, const Placements::Group& group, const Node& node,
                     const std::vector<std::uint32_t>& placements, Message& message) {
  const std::uint32_t placement = placements.front();
  bool had_short_run = false;
  const auto get = [&](const std::string& key, std::size_t which, bool is_short) -> std::vector<double> {
    const auto known = results_.find(key);
    if (known != results_.end()) return known->second;
    if (had_short_run && !front_.points().empty()) return {};  // else there would be no best so far for long
    had_short_run = is_short;
    const auto result = space_.simulate(its, group, placement, which, is_short);
    results_.emplace(key, result);
    const bool is_second = !is_short && space_.short_frames(its, placement) > 0;
    message.put(is_second ? Tag::kSecondResult : Tag::kResult);
    message.put_text(key);
    message.put_numbers(result);
    return result;
  };
  const Found found = find(its, group, placement, get);
  if (found.fate == "front") {
    front_.add(found.values, its.number, placements);
    message.put(Tag::kFront);
    for (const Range& value : found.values) message.put(value);
    message.put_numbers(placements);
  } else if (found.fate.empty()) {
    Node again = node;
    const std::vector<double> bests = front_.bests_of(found.values);
    for (std::size_t goal = 0; goal < bests.size(); ++goal)
      again.best[goal] = std::min(node.best[goal], bests[goal]);
    again.put(placements, message);
  }
}

// In another process: what a node comes to, as a message.
std::string Search::work_on(const Node& node) {
  Message message;
  Combination& its = space_.combination(node.combination);
  const std::vector<Placements::Group>& groups = its.placements->groups();
  if (node.placement != Node::kAll) {
    examine(its, groups[node.group], node, {node.placement}, message);
    return message.text();
  }
  std::vector<Node> nodes;
  const bool is_alone = space_.is_alone(its) && !its.is_by_ways;
  for (std::uint32_t i = 0; i < groups.size(); ++i) {
    const std::vector<std::uint32_t>& all = groups[i].placements;
    for (std::size_t first = 0; first < (is_alone ? all.size() : 1); ++first) {
      Node one = node;
      one.group = i;
      if (is_alone) one.placement = all[first];
      const SearchSpace::Estimate estimate = space_.estimate(its, groups[i], all[first]);
      one.best = estimate.best;
      if (estimate.may_meet && !front_.beats(one.best.data())) nodes.push_back(one);
    }
  }
  std::sort(nodes.rbegin(), nodes.rend());
  for (const Node& one : nodes) {
    const Placements::Group& group = groups[one.group];
    if (front_.beats(one.best.data())) continue;
    if (its.is_by_ways) {
      examine(its, group, one, group.placements, message);
    } else {
      one.put(is_alone ? std::vector{one.placement} : group.placements, message);
    }
  }
  return message.text();
}

void Search::Node::put(const std::vector<std::uint32_t>& placements, Message& message) const {
  message.put(Tag::kNodes);
  message.put(group);
  message.put(best);
  message.put_numbers(placements);
}

// Takes over what a node came to.
void Search::take(const Node& node, Message message) {
  state_.open -= node.boards;
  while (!message.at_end()) {
    const Tag tag = message.get<Tag>();
    if (tag == Tag::kResult || tag == Tag::kSecondResult) {
      const std::string key = message.get_text();
      const auto result = message.get_numbers<double>();
      if (results_.emplace(key, result).second && tag == Tag::kResult) ++state_.simulated;
      new_results_.emplace(key, result);
    } else if (tag == Tag::kFront) {
      std::vector<Range> values(space_.goals());
      for (Range& value : values) value = message.get<Range>();
      front_.add(values, node.combination, message.get_numbers<std::uint32_t>());
    } else {
      Node one = node;
      one.group = message.get<std::uint32_t>();
      one.best = message.get<GoalValues>();
      one.boards = 1;
      for (const std::uint32_t placement : message.get_numbers<std::uint32_t>()) {
        one.placement = placement;
        nodes_.push(one);
        ++state_.open;
      }
    }
  }
}

// What is best by its bounds is examined, in all processes.
bool Search::do_round(const std::function<bool()>& keep_going) {
  const std::vector<Node> chosen = choose();
  std::vector<bool> is_done(chosen.size());
  const bool is_whole = do_in_processes(
      chosen.size(), processes_, [&](std::size_t piece) { return work_on(chosen[piece]); },
      [&](std::size_t piece, const std::string& message) {
        is_done[piece] = true;
        take(chosen[piece], Message(message));
      },
      keep_going);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!is_done[i]) nodes_.push(chosen[i]);
  }
  return is_whole;
}

SearchState Search::state() const {
  SearchState state = state_;
  const bool is_maximum = space_.is_maximum(0);
  state.has_best = !front().empty();
  double best = -std::numeric_limits<double>::infinity();
  double bound = nodes_.empty() ? best : nodes_.top().best[0];
  for (const FrontPoint& point : front()) {
    const Range& value = point.values.front();
    best = std::max(best, is_maximum ? value.least : -value.most);
    bound = std::max(bound, is_maximum ? value.most : -value.least);
  }
  state.best = is_maximum ? best : -best;
  state.bound = is_maximum ? bound : -bound;
  return state;
}

bool Search::run(const std::function<bool(const SearchState& state)>& keep_going) {
  const auto goes_on = [&] { return keep_going(state()); };
  if (space_.needs_accuracy() && !compute_accuracy(goes_on)) return false;
  if (!assess(goes_on)) return false;
  state_.is_counted = true;
  while (!nodes_.empty()) {
    if (!do_round(goes_on)) return false;
  }
  return true;
}

Search::Impossible Search::impossible() const {
  const auto first = std::find(verdicts_.begin(), verdicts_.end(), Verdict::kImpossible);
  return {static_cast<std::uint64_t>(std::count(first, verdicts_.end(), Verdict::kImpossible)),
          static_cast<std::uint64_t>(first - verdicts_.begin())};
}

Search::Board Search::board(const BoardNumber& number) {
  Combination& its = space_.combination(number.combination);
  if (its.verdict == Verdict::kImpossible) return {std::nullopt, its.run, its.reason};
  return {its.placements->placed(its.board, number.placement), its.run, ""};
}

std::map<std::string, double> Search::results_of(const BoardNumber& number) {
  Combination& its = space_.combination(number.combination);
  const std::vector<Placements::Group>& groups = its.placements->groups();
  const auto group = std::find_if(groups.begin(), groups.end(), [&](const Placements::Group& one) {
    return std::binary_search(one.placements.begin(), one.placements.end(), number.placement);
  });
  std::vector<std::vector<double>> results;
  for (const std::string& key : space_.result_keys(its, *group, number.placement)) {
    const auto known = results_.find(key);
    results.push_back(known != results_.end()
                          ? known->second
                          : space_.simulate(its, *group, number.placement, results.size()));
  }
  return space_.named(its, results, its.placements->placed(its.board, number.placement));
}

Search::Judgement Search::judge(const platform::BoardDraft& draft, const PointRun& run, bool places) {
  platform::BoardDraft::Reading reading = draft.read_with_problems();
  places = places && wishes_.most_banks > 0;
  std::vector<std::string> rules;
  for (const platform::Diagnostic& problem : reading.problems) {
    if (!places || !is_of_placement(problem)) rules.push_back(problem.text);
  }
  const std::vector<bool> used = platform::used_banks(reading.board);
  const auto banks = std::count(used.begin(), used.end(), true);
  if (!places && wishes_.most_banks > 0 && banks > wishes_.most_banks)
    rules.push_back(fmt::format("it uses {} banks, and may use {}", banks, wishes_.most_banks));
  constexpr std::uint64_t kNoNumber = UINT64_MAX;
  Combination& its = space_.take(kNoNumber, std::move(reading.board), run, rules, places);
  Judgement found;
  found.refused = its.verdict == Verdict::kExcluded ? "left out by where" : its.reason;
  if (!found.refused.empty()) return found;
  // The best by the goals one after the other, of those that meet the requirements.
  std::optional<GoalValues> most;
  const auto take = [&](const GoalValues& best, const std::vector<Range>& values, bool is_bound) {
    if (most && best <= *most) return;
    most = best;
    found.values = values;
    found.is_bound = is_bound;
    found.dominated_by = front_.beaten_by(best.data());
  };
  for (const Placements::Group& group : its.placements->groups()) {
    for (const std::uint32_t placement : group.placements) {
      const SearchSpace::Estimate estimate = space_.estimate(its, group, placement);
      if (!estimate.may_meet) {
        found.unmet = space_.requirement(estimate.unmet);
      } else if (front_.beats(estimate.best.data())) {
        std::vector<Range> bounds;
        for (std::size_t goal = 0; goal < space_.goals(); ++goal)
          bounds.push_back(Range::of(space_.is_maximum(goal) ? estimate.best[goal] : -estimate.best[goal]));
        take(estimate.best, bounds, true);
      } else {
        const Found its_own =
            find(its, group, placement, [&](const std::string& /*key*/, std::size_t which, bool is_short) {
              return space_.simulate(its, group, placement, which, is_short);
            });
        if (its_own.fate == "unmet") {
          found.unmet = space_.unmet() + ", as its simulation shows";
          continue;
        }
        GoalValues best{};
        const std::vector<double> bests = front_.bests_of(its_own.values);
        std::copy(bests.begin(), bests.end(), best.begin());
        take(best, its_own.values, false);
        if (its_own.fate == "front") {
          found.unmet.clear();
          return found;
        }
      }
      if (its.is_by_ways) break;
    }
  }
  if (most) found.unmet.clear();
  return found;
}

}  // namespace stereotlm::explore

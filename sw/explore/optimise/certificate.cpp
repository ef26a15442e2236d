#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "sw/explore/optimise/message.h"
#include "sw/explore/optimise/search.h"
#include "sw/explore/optimise/workers.h"

namespace stereotlm::explore {

std::vector<Search::Examined> Search::examined(Combination& its) {
  std::vector<Examined> found;
  std::map<std::tuple<std::string, std::uint32_t, std::vector<double>>, std::size_t>
      known;  // by fate, use, results
  const std::string space = short_hash(wishes_.most_banks > 0 ? Placements::key(its.board) : "own");
  const auto examine = [&](const Placements::Group& group, std::uint32_t placement, std::uint32_t number) {
    Examined one = {its.number, space, its.is_by_ways, {number}, "bound", std::nullopt, {}};
    if (!its.run.camera) one.least_cycles = space_.least_cycles(its, group);
    const SearchSpace::Estimate estimate = space_.estimate(its, group, placement);
    if (!estimate.may_meet) {
      one.fate = "unmet";
    } else if (!front_.beats(estimate.best.data())) {
      const Found its_own = find(its, group, placement,
                                 [&](const std::string& key, std::size_t, bool) { return results_.at(key); });
      one.fate = its_own.fate;
      if (!its_own.results.empty()) one.results = space_.totals(its, its_own.results);
    }
    const auto [at, is_new] = known.emplace(std::tuple(one.fate, group.use, one.results), found.size());
    if (is_new) return found.push_back(std::move(one));
    Examined& other = found[at->second];
    other.numbers.push_back(number);
    if (other.least_cycles) other.least_cycles = std::min(other.least_cycles, one.least_cycles);
  };
  const std::vector<Placements::Group>& groups = its.placements->groups();
  for (std::uint32_t i = 0; i < groups.size(); ++i) {
    if (its.is_by_ways) {
      examine(groups[i], groups[i].placements.front(), i);
    } else {
      for (const std::uint32_t placement : groups[i].placements) examine(groups[i], placement, placement);
    }
  }
  for (Examined& one : found) std::sort(one.numbers.begin(), one.numbers.end());
  return found;
}

void Search::certify(const Certificate& certificate) {
  const std::size_t goals = space_.goals();
  // The reasons, and the groups, are found in all processes.
  std::vector<std::uint64_t> asked;
  for (std::uint64_t number = 0; number < verdicts_.size(); ++number) {
    Verdict& verdict = verdicts_[number];
    if (verdict == Verdict::kUnknown)
      verdict = front_.beats(&bests_[number * goals]) ? Verdict::kRuledOut : Verdict::kExamined;
    if (verdict == Verdict::kExamined || verdict == Verdict::kImpossible) asked.push_back(number);
  }
  const auto work = [&](std::size_t piece) {
    Message bytes;
    const std::size_t end = std::min(asked.size(), (piece + 1) * kCombinationsOfPiece);
    for (std::size_t i = piece * kCombinationsOfPiece; i < end; ++i) {
      Combination& its = space_.combination(asked[i]);
      bytes.put_text(its.reason);
      const std::vector<Examined> all =
          its.verdict == Verdict::kImpossible ? std::vector<Examined>() : examined(its);
      bytes.put(all.size());
      for (const Examined& one : all) {
        bytes.put_text(one.space);
        bytes.put(one.are_groups);
        bytes.put_numbers(one.numbers);
        bytes.put_text(one.fate);
        bytes.put(one.least_cycles);
        bytes.put_numbers(one.results);
      }
    }
    return bytes.text();
  };
  std::map<std::size_t, std::string> waiting;  // for the pieces before them
  std::size_t next_piece = 0;
  std::uint64_t next = 0;  // combination
  std::set<std::string> spaces;
  std::optional<Part> open;
  const auto add = [&](Verdict verdict, const std::string& reason) {
    if (open && open->verdict == verdict && open->reason == reason) {
      open->last = next;
    } else {
      if (open) certificate.part(*open);
      open = Part{next, next, verdict, reason};
    }
    ++next;
  };
  const auto take = [&](std::size_t piece, const std::string& message) {
    waiting.emplace(piece, message);
    for (; !waiting.empty() && waiting.begin()->first == next_piece; waiting.erase(waiting.begin())) {
      Message bytes(waiting.begin()->second);
      for (std::size_t i = next_piece * kCombinationsOfPiece; !bytes.at_end(); ++i) {
        while (next < asked[i]) add(verdicts_[next], "");
        add(verdicts_[asked[i]], bytes.get_text());
        for (auto left = bytes.get<std::size_t>(); left > 0; --left) {
          Examined one;
          one.combination = asked[i];
          one.space = bytes.get_text();
          one.are_groups = bytes.get<bool>();
          one.numbers = bytes.get_numbers<std::uint32_t>();
          one.fate = bytes.get_text();
          one.least_cycles = bytes.get<std::optional<std::uint64_t>>();
          one.results = bytes.get_numbers<double>();
          if (spaces.insert(one.space).second && wishes_.most_banks > 0)
            certificate.space(one.space, *space_.combination(asked[i]).placements);
          certificate.examined(one);
        }
      }
      ++next_piece;
    }
  };
  const std::size_t pieces = (asked.size() + kCombinationsOfPiece - 1) / kCombinationsOfPiece;
  do_in_processes(pieces, processes_, work, take, [] { return true; });
  while (next < verdicts_.size()) add(verdicts_[next], "");
  if (open) certificate.part(*open);
}

}  // namespace stereotlm::explore

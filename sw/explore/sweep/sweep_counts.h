#pragma once

#include <cstdint>
#include <string>

namespace stereotlm::explore {

// How far a sweep, or a shard of one, is.
struct SweepCounts {
  std::uint64_t total = 0;     // points, before conditions
  std::uint64_t excluded = 0;  // by conditions
  std::uint64_t known = 0;     // there already: of an earlier sweep, or equal to another point
  std::uint64_t ok = 0;        // these three: new
  std::uint64_t impossible = 0;
  std::uint64_t failed = 0;
  std::uint64_t given_up = 0;  // nothing of them is kept

  std::uint64_t done() const { return excluded + known + ok + impossible + failed + given_up; }
  void add(const SweepCounts& other);
};

// A line for each: "ok 12".
std::string counts_text(const SweepCounts& counts);
// What counts_text() has written; a line that is missing counts 0.
SweepCounts read_counts(const std::string& text);

}  // namespace stereotlm::explore

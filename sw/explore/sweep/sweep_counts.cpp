#include "sw/explore/sweep/sweep_counts.h"

#include <fmt/format.h>

#include <array>
#include <sstream>
#include <utility>

namespace stereotlm::explore {
namespace {

constexpr std::array<std::pair<const char*, std::uint64_t SweepCounts::*>, 7> kCounts = {{
    {"total", &SweepCounts::total},
    {"excluded", &SweepCounts::excluded},
    {"known", &SweepCounts::known},
    {"ok", &SweepCounts::ok},
    {"impossible", &SweepCounts::impossible},
    {"failed", &SweepCounts::failed},
    {"given_up", &SweepCounts::given_up},
}};

}  // namespace

void SweepCounts::add(const SweepCounts& other) {
  for (const auto& [name, count] : kCounts) this->*count += other.*count;
}

std::string counts_text(const SweepCounts& counts) {
  std::string text;
  for (const auto& [name, count] : kCounts) text += fmt::format("{} {}\n", name, counts.*count);
  return text;
}

SweepCounts read_counts(const std::string& text) {
  SweepCounts counts;
  std::istringstream stream(text);
  std::string read;
  for (std::uint64_t number = 0; stream >> read >> number;) {
    for (const auto& [name, count] : kCounts) {
      if (read == name) counts.*count = number;
    }
  }
  return counts;
}

}  // namespace stereotlm::explore

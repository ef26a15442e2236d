#include "sw/runs/sources/pair_files.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <optional>
#include <system_error>

namespace stereotlm::runs {
namespace {

namespace fs = std::filesystem;

using Names = std::vector<std::string>;

// The parts of a name: text and digits in turn, text first.
Names parts_of(const std::string& name) {
  Names parts = {""};
  for (const char each : name) {
    const bool is_digit = std::isdigit(static_cast<unsigned char>(each)) != 0;
    if (is_digit != (parts.size() % 2 == 0)) parts.emplace_back();
    parts.back() += each;
  }
  return parts;
}

// The natural order: digits are compared as numbers.
bool comes_before(const std::string& a, const std::string& b) {
  const Names parts_a = parts_of(a);
  const Names parts_b = parts_of(b);
  const auto [own, other] = std::mismatch(parts_a.begin(), parts_a.end(), parts_b.begin(), parts_b.end());
  if (own == parts_a.end() || other == parts_b.end()) return parts_a.size() < parts_b.size();
  if ((own - parts_a.begin()) % 2 == 1) {
    const auto digits = [](const std::string& text) {
      return text.substr(std::min(text.find_first_not_of('0'), text.size()));
    };
    const std::string first = digits(*own);
    const std::string second = digits(*other);
    if (first.size() != second.size()) return first.size() < second.size();
    if (first != second) return first < second;
  }
  return *own < *other;
}

// The difference of the one number in which two names differ; nullopt if they differ in more.
std::optional<double> step_between(const std::string& a, const std::string& b) {
  const Names parts_a = parts_of(a);
  const Names parts_b = parts_of(b);
  if (parts_a.size() != parts_b.size()) return std::nullopt;
  const auto [own, other] = std::mismatch(parts_a.begin(), parts_a.end(), parts_b.begin());
  const bool is_number = (own - parts_a.begin()) % 2 == 1;
  if (!is_number || !std::equal(own + 1, parts_a.end(), other + 1)) return std::nullopt;
  return std::stod(*other) - std::stod(*own);
}

// A note about the first place where a number is missing. Numbers may run in steps: 0, 5, 10.
std::optional<std::string> gap_note(const std::string& option, const Names& files) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < files.size(); ++i) {
    const auto step = step_between(files[i - 1], files[i]);
    if (!step) return std::nullopt;
    steps.push_back(*step);
  }
  const double usual = steps.size() < 2 ? 1 : *std::min_element(steps.begin(), steps.end());
  const auto is_gap = [usual](double step) { return step >= 2 * usual; };
  const auto gaps = std::count_if(steps.begin(), steps.end(), is_gap);
  if (gaps == 0) return std::nullopt;
  const auto at = std::find_if(steps.begin(), steps.end(), is_gap) - steps.begin();
  return fmt::format("{}: '{}' follows '{}': numbers between them are missing{}", option,
                     files[static_cast<std::size_t>(at + 1)], files[static_cast<std::size_t>(at)],
                     gaps == 1 ? "" : fmt::format("; there are {} such gaps", gaps));
}

// A note about the first pair whose names do not end in the same number: if each side lacks a different
// picture, all pairs between these two are wrong.
std::optional<std::string> pairing_note(const PairFiles& pairs) {
  const auto number_of = [](const std::string& file) {
    const std::string stem = fs::path(file).stem();
    return stem.substr(stem.find_last_not_of("0123456789") + 1);
  };
  for (std::size_t i = 0; i < pairs.left.size(); ++i) {
    if (number_of(pairs.left[i]) == number_of(pairs.right[i])) continue;
    return fmt::format(
        "pictures are paired in the order of their names, '{}' with '{}': do they belong together?",
        pairs.left[i], pairs.right[i]);
  }
  return std::nullopt;
}

// The pattern with an ending in any case: *.[pP][nN][gG] of *.png.
std::string with_any_case(const std::string& pattern) {
  const std::string ending = fs::path(pattern).extension();
  if (ending.find_first_of("*?[\\") != std::string::npos) return pattern;
  std::string result = pattern.substr(0, pattern.size() - ending.size());
  for (const char each : ending) {
    const auto code = static_cast<unsigned char>(each);
    if (std::isalpha(code) == 0) {
      result += each;
    } else {
      result += {'[', static_cast<char>(std::tolower(code)), static_cast<char>(std::toupper(code)), ']'};
    }
  }
  return result;
}

// Sorted by bytes. Throws std::runtime_error if a folder cannot be read.
Names matches_of(const std::string& pattern) {
  glob_t found = {};
  const int status = glob(pattern.c_str(), 0, nullptr, &found);
  Names files(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  globfree(&found);
  if (status != 0 && status != GLOB_NOMATCH)
    throw std::runtime_error("a folder of this pattern cannot be read");
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

Names files_of(const std::string& option, const Names& patterns, Names& notes, process::Problems& problems) {
  Names files;
  for (const std::string& pattern : patterns) {
    std::error_code unknown;  // such as a folder that cannot be read: the file's reader says why
    if (pattern.find_first_of("*?[") == std::string::npos || fs::exists(pattern, unknown) || unknown) {
      files.push_back(pattern);
      continue;
    }
    const std::string named = fmt::format("{} '{}': ", option, pattern);
    problems.attempt(named, [&] {
      const Names found = matches_of(pattern);
      const Names all = matches_of(with_any_case(pattern));
      Names others;
      std::set_difference(all.begin(), all.end(), found.begin(), found.end(), std::back_inserter(others));
      std::string left_out;
      if (!others.empty())
        left_out =
            fmt::format("'{}'{} left out: the case of the ending differs", others.front(),
                        others.size() == 1 ? " is" : fmt::format(" and {} more are", others.size() - 1));
      if (found.empty()) throw std::runtime_error("no such file" + (others.empty() ? "" : ": " + left_out));
      if (!others.empty()) notes.push_back(named + left_out);
      files.insert(files.end(), found.begin(), found.end());
    });
  }
  std::sort(files.begin(), files.end(), comes_before);
  if (auto note = gap_note(option, files)) notes.push_back(*note);
  return files;
}

PairFiles find_pairs(const Names& left, const Names& right, process::Problems& problems) {
  PairFiles pairs;
  pairs.left = files_of("--left", left, pairs.notes, problems);
  pairs.right = files_of("--right", right, pairs.notes, problems);
  if (pairs.left.empty() || pairs.right.empty()) return {};
  if (pairs.left.size() != pairs.right.size()) {
    problems.add(fmt::format(
        "--left, --right: {} left pictures ('{}' .. '{}') and {} right ones ('{}' .. '{}'): must be as many",
        pairs.left.size(), pairs.left.front(), pairs.left.back(), pairs.right.size(), pairs.right.front(),
        pairs.right.back()));
    return {};
  }
  if (auto note = pairing_note(pairs)) pairs.notes.push_back(*note);
  return pairs;
}

}  // namespace stereotlm::runs

#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace stereotlm::test {

// A value change dump, read as IEEE 1364 describes it, with words as GTKWave adds them.
class VcdFile {
 public:
  explicit VcdFile(const std::string& text) {
    std::istringstream words(text);
    std::string word;
    while (words >> word && word != "$enddefinitions") define(words, word);
    words >> word;
    std::uint64_t time = 0;
    while (words >> word) {
      if (word == "$dumpvars" || word == "$end") continue;
      if (word[0] != '#') {
        change(words, word, time);
        continue;
      }
      const std::uint64_t next = std::stoull(word.substr(1));
      if (!times_.empty() && next <= time) throw std::runtime_error("time " + word);
      times_.push_back(time = next);
    }
  }

  // The value of a signal from a time on: a word, binary digits, or "" before its first value.
  std::string at(const std::string& signal, std::uint64_t time_ps) const {
    const std::map<std::uint64_t, std::string>& values = changes_.at(codes_.at(signal));
    auto next = values.upper_bound(time_ps);
    return next == values.begin() ? "" : std::prev(next)->second;
  }
  std::uint64_t number(const std::string& signal, std::uint64_t time_ps) const {
    return std::stoull(at(signal, time_ps), nullptr, 2);
  }
  const std::map<std::uint64_t, std::string>& changes(const std::string& signal) const {
    return changes_.at(codes_.at(signal));
  }
  // [scope.name]: code
  const std::map<std::string, std::string>& signals() const { return codes_; }
  const std::vector<std::uint64_t>& times() const { return times_; }

 private:
  void define(std::istringstream& words, const std::string& keyword) {
    std::vector<std::string> parts;
    for (std::string word; words >> word && word != "$end";) parts.push_back(word);
    if (keyword == "$scope") scopes_.push_back((scopes_.empty() ? "" : scopes_.back()) + parts.at(1) + ".");
    if (keyword == "$upscope") scopes_.pop_back();
    if (keyword != "$var") return;
    codes_[scopes_.back() + parts.at(3)] = parts.at(2);
    changes_[parts.at(2)];
  }
  void change(std::istringstream& words, const std::string& word, std::uint64_t time) {
    std::string value = word.substr(0, 1);
    std::string code = word.substr(1);
    if (word[0] == 's' || word[0] == 'b') {
      value = word[0] == 'b' ? shortest(word.substr(1)) : word.substr(1);
      words >> code;
    }
    std::map<std::uint64_t, std::string>& values = changes_.at(code);
    if (!values.empty() && values.rbegin()->second == value) throw std::runtime_error("no change: " + word);
    if (!values.emplace(time, value).second) throw std::runtime_error("two changes at one time: " + word);
  }

  // Digits that repeat the first one of 0 or z may be left out.
  static std::string shortest(const std::string& digits) {
    const char first = digits[0] == 'z' ? 'z' : '0';
    return digits.substr(std::min(digits.find_first_not_of(first), digits.size() - 1));
  }

  std::vector<std::string> scopes_;  // that are open, each with those around it: "left_lut.0."
  std::map<std::string, std::string> codes_;
  std::map<std::string, std::map<std::uint64_t, std::string>> changes_;  // [code][time]
  std::vector<std::uint64_t> times_;
};

}  // namespace stereotlm::test

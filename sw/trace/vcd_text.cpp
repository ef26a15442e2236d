#include "sw/trace/vcd_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <string>
#include <string_view>

namespace stereotlm::trace {
namespace {

// The short name of a signal in the file.
std::string code_of(std::size_t signal) {
  constexpr std::size_t kCodes = 94;  // printable characters without the space
  std::string code;
  for (;; signal = signal / kCodes - 1) {
    code += static_cast<char>('!' + signal % kCodes);
    if (signal < kCodes) return code;
  }
}

// The text of each byte in binary.
const std::array<std::array<char, 8>, 256>& bits_of_bytes() {
  static const auto texts = [] {
    std::array<std::array<char, 8>, 256> made{};
    for (std::size_t byte = 0; byte < made.size(); ++byte) {
      for (std::size_t bit = 0; bit < 8; ++bit) made[byte][bit] = (byte >> (7 - bit) & 1U) != 0 ? '1' : '0';
    }
    return made;
  }();
  return texts;
}

// Writes the text of one file.
class VcdText {
 public:
  VcdText(files::AsideFile& file, const VcdSignals& signals) : file_(file), signals_(signals) {
    for (const VcdSignal& signal : signals.all()) {
      codes_.push_back(make_code(codes_.size()));
      values_.push_back(signal.idle);
    }
    next_values_ = values_;
    is_touched_.resize(values_.size());
    is_active_.resize(values_.size());
  }

  void header() {
    std::string text = kVcdMark;
    const std::string* scope = nullptr;
    for (std::size_t signal = 0; signal < codes_.size(); ++signal) {
      const VcdSignal& its = signals_.all()[signal];
      if (scope == nullptr || *scope != its.scope) {
        if (scope != nullptr) text += "$upscope $end\n";
        text += "$scope module " + its.scope + " $end\n";
        scope = &its.scope;
      }
      const std::string code = code_of(signal);
      if (its.bits == 0)
        fmt::format_to(std::back_inserter(text), "$var string 1 {} {} $end\n", code, its.name);
      else if (its.bits == 1)
        fmt::format_to(std::back_inserter(text), "$var wire 1 {} {} $end\n", code, its.name);
      else
        fmt::format_to(std::back_inserter(text), "$var wire {} {} {} [{}:0] $end\n", its.bits, code, its.name,
                       its.bits - 1);
    }
    put(text + "$upscope $end\n$enddefinitions $end\n");
  }

  void set(std::uint32_t signal, std::uint32_t value) {
    next_values_[signal] = value;
    if (is_touched_[signal] != 0) return;
    is_touched_[signal] = 1;
    touched_.push_back(signal);
  }
  void all_at(std::uint64_t time_ps) {
    forget_touched();
    values_ = next_values_;
    time(time_ps);
    put("$dumpvars\n");
    for (std::uint32_t signal = 0; signal < values_.size(); ++signal) value(signal);
    put("$end\n");
  }
  void changes_at(std::uint64_t time_ps) {
    bool has_time = false;
    for (const std::uint32_t signal : touched_) {
      if (values_[signal] == next_values_[signal]) continue;
      if (!has_time) time(time_ps);
      has_time = true;
      values_[signal] = next_values_[signal];
      value(signal);
    }
    forget_touched();
  }
  void end_at(std::uint64_t time_ps) {
    if (time_ps != last_ps_) time(time_ps);
  }
  std::uint64_t last_ps() const { return last_ps_; }
  void flush() {
    file_.write({text_.data(), size_});
    size_ = 0;
  }
  std::set<std::string> active_scopes() const {
    std::set<std::string> scopes;
    for (std::size_t signal = 0; signal < is_active_.size(); ++signal) {
      if (is_active_[signal] != 0) scopes.insert(signals_.all()[signal].scope);
    }
    return scopes;
  }

 private:
  static constexpr std::size_t kTextBytes = std::size_t{1} << 19U;
  static constexpr std::size_t kCodeBytes = 8;
  // What stands behind a value: a space, the code of the signal, the end of the line.
  struct Code {
    std::array<char, kCodeBytes> text{};
    std::size_t size = 0;

    std::string_view name_and_end() const { return {text.data() + 1, size - 1}; }
  };

  static Code make_code(std::size_t signal) {
    const std::string text = ' ' + code_of(signal) + '\n';
    Code code;
    code.size = text.copy(code.text.data(), kCodeBytes);
    return code;
  }

  void forget_touched() {
    for (const std::uint32_t signal : touched_) is_touched_[signal] = 0;
    touched_.clear();
  }
  void put(std::string_view text) {
    if (text_.size() - size_ < text.size()) flush();
    if (text_.size() < text.size()) return file_.write(text);
    std::memcpy(text_.data() + size_, text.data(), text.size());
    size_ += text.size();
  }
  void put(char character) { put({&character, 1}); }
  // Puts a text of at most `kMost` characters, which stands at the beginning of as many bytes. Copying all of
  // them takes less time than copying the right number.
  template <std::size_t kMost>
  void put_short(const char* text, std::size_t size) {
    if (text_.size() - size_ < kMost) flush();
    std::memcpy(text_.data() + size_, text, kMost);
    size_ += size;
  }
  void time(std::uint64_t time_ps) {
    last_ps_ = time_ps;
    const fmt::format_int digits(time_ps);
    put('#');
    put({digits.data(), digits.size()});
    put('\n');
  }
  void value(std::uint32_t signal) {
    const unsigned bits = signals_.all()[signal].bits;
    const std::uint32_t value = values_[signal];
    is_active_[signal] |= static_cast<char>(value != signals_.all()[signal].idle);
    if (bits == 0) {
      put('s');
      put(signals_.text(value));
    } else if (bits == 1) {
      put(value != 0 ? '1' : '0');
      return put(codes_[signal].name_and_end());
    } else if (value >= VcdSignals::kUnknown) {
      put(value == VcdSignals::kNoNumber ? "bz" : "bx");
    } else {
      binary(value);
    }
    const Code& code = codes_[signal];
    put_short<kCodeBytes>(code.text.data(), code.size);
  }
  // Without leading zeros.
  void binary(std::uint32_t value) {
    std::array<char, 2 * 33> text{};
    for (std::size_t byte = 0; byte < 4; ++byte)
      std::memcpy(text.data() + 1 + 8 * byte, bits_of_bytes_[value >> (24 - 8 * byte) & 0xFFU].data(), 8);
    const auto zeros = static_cast<std::size_t>(__builtin_clz(value | 1U));
    text[zeros] = 'b';
    put_short<33>(text.data() + zeros, 33 - zeros);
  }

  files::AsideFile& file_;
  const VcdSignals& signals_;
  const std::array<std::array<char, 8>, 256>& bits_of_bytes_ = bits_of_bytes();
  std::vector<Code> codes_;  // [signal]
  std::vector<std::uint32_t> values_;
  std::vector<std::uint32_t> next_values_;
  std::vector<char> is_touched_;
  std::vector<char> is_active_;  // [signal]: has had another value than its idle one
  std::vector<std::uint32_t> touched_;
  std::vector<char> text_ = std::vector<char>(kTextBytes);
  std::size_t size_ = 0;  // bytes of text_ in use
  std::uint64_t last_ps_ = 0;
};

}  // namespace

VcdSpan write_vcd(files::AsideFile& file, const VcdSignals& signals,
                  const std::vector<ChangeStream*>& streams, const TimeSpan& window) {
  VcdText text(file, signals);
  text.header();
  for (ChangeStream* const stream : streams) stream->rewind();
  const auto take_up_to = [&](std::uint64_t time_ps) {
    for (ChangeStream* const stream : streams) {
      for (; !stream->at_end() && stream->change().time_ps <= time_ps; stream->advance())
        text.set(stream->change().signal, stream->change().value);
    }
  };
  take_up_to(window.begin_ps);
  text.all_at(window.begin_ps);
  while (true) {
    std::uint64_t time_ps = UINT64_MAX;
    for (const ChangeStream* const stream : streams) {
      if (!stream->at_end()) time_ps = std::min(time_ps, stream->change().time_ps);
    }
    if (time_ps == UINT64_MAX || time_ps > window.end_ps) break;
    take_up_to(time_ps);
    text.changes_at(time_ps);
  }
  if (window.end_ps != UINT64_MAX) text.end_at(window.end_ps);
  text.flush();
  return {window.begin_ps, text.last_ps(), window.wait_ps, text.active_scopes()};
}

}  // namespace stereotlm::trace

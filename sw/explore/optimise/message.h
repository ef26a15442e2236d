#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

namespace stereotlm::explore {

// A message between processes.
class Message {
 public:
  Message() = default;
  explicit Message(const std::string& text) : text_(text) {}

  template <typename Number>
  void put(Number number) {
    text_.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  void put_text(const std::string& text) {
    put(text.size());
    text_ += text;
  }
  template <typename Number>
  Number get() {
    Number number;
    std::memcpy(&number, text_.data() + at_, sizeof number);
    at_ += sizeof number;
    return number;
  }
  std::string get_text() {
    const auto size = get<std::size_t>();
    at_ += size;
    return text_.substr(at_ - size, size);
  }
  template <typename Number>
  void put_numbers(const std::vector<Number>& numbers) {
    put(numbers.size());
    for (const Number number : numbers) put(number);
  }
  template <typename Number>
  std::vector<Number> get_numbers() {
    std::vector<Number> numbers(get<std::size_t>());
    for (Number& number : numbers) number = get<Number>();
    return numbers;
  }
  bool at_end() const { return at_ == text_.size(); }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::size_t at_ = 0;
};

}  // namespace stereotlm::explore

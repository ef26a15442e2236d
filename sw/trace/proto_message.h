#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace stereotlm::trace {

// A message of Protocol Buffers in its wire format: fields, each with its number, in the order of the calls.
class ProtoMessage {
 public:
  void clear() { bytes_.clear(); }
  bool empty() const { return bytes_.empty(); }
  const std::string& bytes() const { return bytes_; }

  void integer(std::uint32_t field, std::uint64_t value) {
    varint(field << 3U);
    varint(value);
  }
  void fixed(std::uint32_t field, std::uint64_t value) {
    varint(field << 3U | 1U);
    for (unsigned byte = 0; byte < 8; ++byte) bytes_ += static_cast<char>(value >> (8U * byte));
  }
  void real(std::uint32_t field, double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    fixed(field, bits);
  }
  void text(std::uint32_t field, std::string_view text) {
    varint(field << 3U | 2U);
    varint(text.size());
    bytes_ += text;
  }
  void message(std::uint32_t field, const ProtoMessage& message) { text(field, message.bytes_); }

 private:
  void varint(std::uint64_t value) {
    constexpr std::uint64_t kMore = 0x80;
    for (; value >= kMore; value >>= 7U) bytes_ += static_cast<char>(value | kMore);
    bytes_ += static_cast<char>(value);
  }

  std::string bytes_;
};

}  // namespace stereotlm::trace

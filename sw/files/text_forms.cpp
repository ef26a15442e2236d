#include "sw/files/text_forms.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace stereotlm::files {
namespace {

// The SHA-256 of the pieces that `next` returns, until an empty one.
template <typename Next>
std::string sha256_of(const Next& next) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  bool is_done = context != nullptr && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  for (std::string_view piece = next(); is_done && !piece.empty(); piece = next())
    is_done = EVP_DigestUpdate(context.get(), piece.data(), piece.size()) == 1;
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  if (!is_done || EVP_DigestFinal_ex(context.get(), digest, &size) != 1)
    throw std::runtime_error("SHA-256: the OpenSSL library refuses to compute it");
  return fmt::format("{:02x}", fmt::join(digest, digest + size, ""));
}

using Json = nlohmann::ordered_json;

std::string scalar_text(const Json& value, bool replaces) {
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (!std::isfinite(number))
      throw std::invalid_argument(fmt::format("{}: JSON numbers are finite", number));
    return fmt::format("{}", number);
  }
  try {
    return value.dump(-1, ' ', false,
                      replaces ? Json::error_handler_t::replace : Json::error_handler_t::strict);
  } catch (const Json::type_error&) {
    throw std::invalid_argument(fmt::format("'{}': JSON strings are UTF-8", value.get<std::string>()));
  }
}

void append(std::string& text, const Json& value, std::size_t depth, bool replaces) {
  if (!value.is_structured()) {
    text += scalar_text(value, replaces);
    return;
  }
  const bool one_line =
      value.empty() || (depth > 0 && std::none_of(value.begin(), value.end(),
                                                  [](const Json& member) { return member.is_structured(); }));
  const std::string indent = one_line ? "" : "\n" + std::string(2 * (depth + 1), ' ');
  const char* separator = "";
  text += value.is_object() ? '{' : '[';
  for (const auto& [key, member] : value.items()) {
    text += separator + indent;
    if (value.is_object()) text += scalar_text(key, replaces) + ": ";
    append(text, member, depth + 1, replaces);
    separator = one_line ? ", " : ",";
  }
  if (!one_line) text += "\n" + std::string(2 * depth, ' ');
  text += value.is_object() ? '}' : ']';
}

}  // namespace

std::string sha256_hex(const void* bytes, std::size_t count) {
  std::string_view rest(static_cast<const char*>(bytes), count);
  return sha256_of([&rest] { return std::exchange(rest, {}); });
}

std::string sha256_file(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  char buffer[1 << 16];
  const auto refuse = [&path] {
    throw std::runtime_error(fmt::format("'{}': cannot be read: {}", path, std::strerror(errno)));
  };
  if (!file) refuse();
  return sha256_of([&] {
    const std::size_t count = std::fread(buffer, 1, sizeof buffer, file.get());
    if (std::ferror(file.get()) != 0) refuse();
    return std::string_view(buffer, count);
  });
}

std::string base64(const void* bytes, std::size_t size) {
  std::string text(4 * ((size + 2) / 3) + 1, '\0');  // EVP_EncodeBlock() also writes a terminating zero
  const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                     static_cast<const unsigned char*>(bytes), static_cast<int>(size));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

double without_minus_zero(double number, int decimals) {
  return std::abs(number) < 0.5 * std::pow(10, -decimals) ? 0 : number;
}

std::string shell_word(const std::string& word) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text = "'";
  for (const char each : word) text += each == '\'' ? std::string("'\\''") : std::string(1, each);
  return text + '\'';
}

std::string shell_command(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + shell_word(word);
  return text;
}

std::string ranges_text(const std::vector<std::uint64_t>& numbers, const std::string& separator) {
  std::string text;
  for (std::size_t first = 0; first < numbers.size();) {
    std::size_t last = first;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += (first > 0 ? separator : "") + std::to_string(numbers[first]);
    if (last > first) text += fmt::format("-{}", numbers[last]);
    first = last + 1;
  }
  return text;
}

std::string json_text(const nlohmann::ordered_json& document, bool replaces) {
  std::string text;
  append(text, document, 0, replaces);
  return text + "\n";
}

Json parse_json(const std::string& text) {
  constexpr int kMostDepth = 100;  // copies and texts of a document need stack for each level
  const auto check = [](int depth, Json::parse_event_t /*event*/, const Json& /*value*/) {
    if (depth > kMostDepth) throw JsonError(1, "nested too deeply");
    return true;
  };
  try {
    return Json::parse(text, check);
  } catch (const Json::parse_error& error) {
    const std::string_view before = std::string_view(text).substr(0, error.byte == 0 ? 0 : error.byte - 1);
    const auto line = static_cast<std::size_t>(1 + std::count(before.begin(), before.end(), '\n'));
    throw JsonError(line, fmt::format("not JSON from column {} on", before.size() - before.rfind('\n')));
  } catch (const Json::out_of_range& /*error*/) {
    throw JsonError(1, "a number is too large");
  }
}

}  // namespace stereotlm::files

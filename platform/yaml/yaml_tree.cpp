#include "platform/yaml/yaml_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <set>
#include <system_error>
#include <utility>

namespace stereotlm::platform {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Reads a number that is not in quotes, and begins and ends with a digit, after a minus if there is one.
// Nullopt for anything else. A number beyond the range of `Number` gives `beyond`.
template <typename Number, typename... Format>
std::optional<Number> number_of(const YamlNode& node, Number beyond, Format... format) {
  const std::string& text = node.text;
  const std::size_t first = !text.empty() && text.front() == '-' ? 1 : 0;
  if (!node.is_scalar() || node.quoted || first == text.size() || !is_digit(text[first]) ||
      !is_digit(text.back()))
    return std::nullopt;
  Number value{};
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value, format...);
  if (result.ptr != end) return std::nullopt;
  return result.ec == std::errc::result_out_of_range ? beyond : value;
}

// The first entry with that key, or nullptr.
template <typename Entries>
auto* find_in(Entries& entries, const std::string& key) {
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return entry.key.is(key); });
  return found == entries.end() ? nullptr : &*found;
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

// Whether YAML 1.1 or 1.2 reads the text, in small letters, as a number: 7, +7, 0x1f, 0o17, 1_000, 1., .5,
// 1e3, .inf, .nan.
bool looks_like_number(std::string_view rest) {
  if (!rest.empty() && (rest.front() == '-' || rest.front() == '+')) rest.remove_prefix(1);
  if (rest == ".inf" || rest == ".nan") return true;
  const std::string_view prefix = rest.substr(0, 2);
  if (prefix == "0x" || prefix == "0o" || prefix == "0b") {
    return rest.size() > 2 && rest.find_first_not_of("0123456789abcdef_", 2) == std::string_view::npos;
  }
  const std::size_t exponent = rest.find('e');
  if (exponent != std::string_view::npos) {
    std::string_view power = rest.substr(exponent + 1);
    if (!power.empty() && (power.front() == '-' || power.front() == '+')) power.remove_prefix(1);
    if (power.empty() || !std::all_of(power.begin(), power.end(), is_digit)) return false;
    rest = rest.substr(0, exponent);
  }
  const bool has_digit = std::any_of(rest.begin(), rest.end(), is_digit);
  return has_digit && rest.front() != '_' && std::count(rest.begin(), rest.end(), '.') <= 1 &&
         rest.find_first_not_of("0123456789_.") == std::string_view::npos;
}

// A text that a reader of YAML could take for a number, a truth value or null, or could not read, needs
// quotes.
bool needs_quotes(const std::string& text) {
  static const std::set<std::string_view> kReserved = {"y",  "n",   "yes",  "no",   "true",
                                                       "on", "off", "null", "none", "false"};
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const bool is_plain =
      !text.empty() && is_letter(text[0]) && std::all_of(text.begin(), text.end(), [&](char c) {
        return is_letter(c) || is_digit(c) || c == '_' || c == '-';
      });
  return !is_plain || kReserved.count(lower(text)) > 0;
}

// A scalar or null: as it was written (`as_yaml` false), or so that a reader of YAML reads it back.
std::string scalar_text(const YamlNode& node, bool as_yaml) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.+-";
  if (!node.is_scalar()) {
    if (as_yaml) return "~";
    return !node.text.empty() ? node.text : node.misuse.empty() ? "(nothing)" : "(anchor or alias)";
  }
  const bool is_plain = !as_yaml || (!node.text.empty() && node.text != "-" &&
                                     node.text.find_first_not_of(kPlain) == std::string::npos);
  return node.quoted || !is_plain ? quoted_text(node.text) : node.text;
}

// Appends the value in flow style to `out`. May leave out text beyond `enough` bytes.
void append_flow(const YamlNode& node, bool as_yaml, std::size_t enough, std::string& out) {
  if (out.size() > enough) return;
  if (!node.is_list() && !node.is_map()) {
    out += scalar_text(node, as_yaml);
    return;
  }
  const char* separator = "";
  out += node.is_list() ? '[' : '{';
  for (std::size_t i = 0; i < node.items.size() && out.size() <= enough; ++i) {
    out += std::exchange(separator, ", ");
    append_flow(node.items[i], as_yaml, enough, out);
  }
  for (std::size_t i = 0; i < node.entries.size() && out.size() <= enough; ++i) {
    out += std::exchange(separator, ", ");
    append_flow(node.entries[i].key, as_yaml, enough, out);
    out += ": ";
    append_flow(node.entries[i].value, as_yaml, enough, out);
  }
  out += node.is_list() ? ']' : '}';
}

void append_block(const YamlNode& map, const std::string& indent, std::string& out) {
  for (const auto& [key, value] : map.entries) {
    out += indent + flow_text(key) + ':';
    const bool is_other = value.style == YamlNode::Style::kOther;
    if (value.is_map() && !value.entries.empty() && !is_other) {
      out += '\n';
      append_block(value, indent + "  ", out);
    } else if (value.is_list() && is_other) {
      out += '\n';
      for (const YamlNode& item : value.items) out += indent + "  - " + flow_text(item) + '\n';
    } else {
      out += ' ' + flow_text(value) + '\n';
    }
  }
}

}  // namespace

YamlNode YamlNode::map(const Place& place) {
  YamlNode node;
  node.kind = Kind::kMap;
  node.place = place;
  return node;
}

YamlNode YamlNode::list(std::vector<YamlNode> items) {
  YamlNode node;
  node.kind = Kind::kList;
  node.items = std::move(items);
  return node;
}

YamlNode YamlNode::plain(std::string text, const Place& place) {
  YamlNode node;
  node.kind = Kind::kScalar;
  node.place = place;
  node.text = std::move(text);
  return node;
}

YamlNode YamlNode::word(const std::string& text) {
  YamlNode node = plain(text);
  node.quoted = needs_quotes(text);
  return node;
}

const YamlNode::Entry* YamlNode::find(const std::string& key) const { return find_in(entries, key); }
YamlNode::Entry* YamlNode::find(const std::string& key) { return find_in(entries, key); }

YamlNode& YamlNode::add(YamlNode key, YamlNode value) {
  entries.push_back({std::move(key), std::move(value)});
  return entries.back().value;
}

std::optional<std::int64_t> integer_of(const YamlNode& node) {
  using Limits = std::numeric_limits<std::int64_t>;
  return number_of(node, node.text.rfind('-', 0) == 0 ? Limits::min() : Limits::max());
}

std::optional<double> decimal_of(const YamlNode& node) {
  // The number is too large for double, or so small that it rounds to 0.
  const bool is_large = node.text.find_first_not_of("-0") < node.text.find('.');
  return number_of(node, is_large ? std::numeric_limits<double>::infinity() : 0.0, std::chars_format::fixed);
}

std::string decimal_text(double value) {
  std::array<char, 400> text{};  // the longest number has about 330 characters
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  return {text.data(), result.ptr};
}

bool is_text(const YamlNode& node) {
  const std::string word = lower(node.text);
  return node.is_scalar() && (node.quoted || (!looks_like_number(word) && word != "true" && word != "false"));
}

std::string short_text(const YamlNode& node) {
  constexpr std::size_t kLimit = 60;
  std::string out;
  append_flow(node, false, kLimit + 20, out);
  std::replace_if(
      out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, ' ');
  if (out.size() <= kLimit) return out;
  std::size_t end = kLimit - 3;
  while (end > 0 && continues_character(out[end])) --end;
  return out.substr(0, end) + "...";
}

std::string short_text(const std::string& text) { return short_text(YamlNode::plain(text)); }

std::string flow_text(const YamlNode& node) {
  std::string out;
  append_flow(node, true, out.max_size(), out);
  return out;
}

std::string yaml_text(const YamlNode& map) {
  std::string out;
  append_block(map, "", out);
  return out;
}

std::string quoted_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      out += fmt::format("\\x{:02X}", static_cast<unsigned char>(c));
    } else {
      out += c;
    }
  }
  return out + '"';
}

}  // namespace stereotlm::platform

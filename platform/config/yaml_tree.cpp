#include "platform/config/yaml_tree.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>
#include <utility>

namespace stereotlm::platform {
namespace {

bool continues_character(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }

// Length in bytes of the UTF-8 character that begins at `at`; 0 if there is none.
std::size_t character_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(at);
  const std::size_t length = first < 0x80 ? 1 : first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  if (length == 0 || first > 0xF4 || at + length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if (!continues_character(text[at + i])) return 0;
  }
  if (length >= 3) {  // overlong forms, surrogates, beyond U+10FFFF
    const unsigned second = byte(at + 1);
    if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
        (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F)) {
      return 0;
    }
  }
  return length;
}

void check_characters(const std::string& text, int source) {
  Place place{source, 1, 1};
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = character_length(text, at);
    const auto byte = static_cast<unsigned char>(text[at]);
    if (length == 0) throw YamlError(place, fmt::format("byte 0x{:02X}: the text is not UTF-8", byte));
    if ((byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') || byte == 0x7F) {
      throw YamlError(place, fmt::format("control character 0x{:02X}: not allowed in YAML", byte));
    }
    at += length;
    ++place.column;
    if (byte == '\n') {
      ++place.line;
      place.column = 1;
    }
  }
}

// Converts yaml-cpp's marks to places. A mark counts lines and columns from 0, and columns in bytes. The cost
// does not depend on the length of a line.
class Places {
 public:
  Places(const std::string& text, int source) : source_(source), continuing_(text.size() + 1) {
    for (std::size_t i = 0; i < text.size(); ++i)
      continuing_[i + 1] = continuing_[i] + (continues_character(text[i]) ? 1 : 0);
  }

  Place of(const YAML::Mark& mark) const {
    if (mark.is_null()) return {source_, 1, 1};
    const std::size_t end = std::min(static_cast<std::size_t>(std::max(mark.pos, 0)), continuing_.size() - 1);
    const std::size_t column = std::min(static_cast<std::size_t>(std::max(mark.column, 0)), end);
    return {source_, mark.line + 1, mark.column + 1 - (continuing_[end] - continuing_[end - column])};
  }

 private:
  int source_;
  std::vector<int> continuing_;  // for each byte: the number of earlier bytes that continue a character
};

// Whether the quoted scalar that begins at `at` has a closing quote; true if none begins there.
bool is_closed(const std::string& text, std::size_t at) {
  const char quote = at < text.size() ? text[at] : ' ';
  if (quote != '"' && quote != '\'') return true;
  for (++at; at < text.size(); ++at) {
    if (text[at] == '\\' && quote == '"') {
      ++at;
    } else if (text[at] == quote) {
      if (quote == '"' || at + 1 >= text.size() || text[at + 1] != quote) return true;
      ++at;  // two single quotes stand for one
    }
  }
  return false;
}

// Builds the tree from the events of yaml-cpp's parser.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const std::string& text, const Places& places) : text_(text), places_(places) {}

  bool has_document() const { return documents_ > 0; }
  YamlNode take_root() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) throw YamlError(places_.of(mark), "one YAML document only");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    YamlNode node = make(YamlNode::Kind::kNull, mark, "", anchor);
    const std::string_view rest = std::string_view(text_).substr(
        std::min(static_cast<std::size_t>(std::max(mark.pos, 0)), text_.size()));
    for (const std::string_view word : {"~", "null", "Null", "NULL"}) {
      if (rest.substr(0, word.size()) == word) node.text = word;
    }
    complete(std::move(node));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    complete(make(YamlNode::Kind::kNull, mark, "", anchor));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    YamlNode node = make(YamlNode::Kind::kScalar, mark, tag, anchor);
    node.text = value;
    node.quoted = tag == "!";
    // yaml-cpp accepts the end of the text after a line break as a closing quote.
    if (node.quoted && !is_closed(text_, static_cast<std::size_t>(std::max(mark.pos, 0)))) {
      throw YamlError(node.place, "not YAML: the closing quote is missing");
    }
    complete(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(make(YamlNode::Kind::kList, mark, tag, anchor));
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(make(YamlNode::Kind::kMap, mark, tag, anchor));
  }
  void OnMapEnd() override { close(); }

 private:
  // A board or a plan needs fewer than ten levels. yaml-cpp has a limit too, but gives no place for it.
  static constexpr std::size_t kMostLevels = 100;

  struct Open {
    YamlNode node;
    YamlNode key;  // key of the entry whose value comes next
    bool has_key;
  };

  YamlNode make(YamlNode::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    YamlNode node;
    node.kind = kind;
    node.place = places_.of(mark);
    if (anchor != 0) node.misuse = "anchors and aliases are not allowed in a board";
    if (!tag.empty() && tag != "?" && tag != "!") node.misuse = "tags are not allowed in a board";
    return node;
  }
  void open(YamlNode node) {
    if (open_.size() == kMostLevels)
      throw YamlError(node.place, fmt::format("nested too deeply: at most {} levels", kMostLevels));
    open_.push_back({std::move(node), {}, false});
  }
  void close() {
    YamlNode node = std::move(open_.back().node);
    open_.pop_back();
    complete(std::move(node));
  }
  void complete(YamlNode node) {
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = open_.back();
    if (parent.node.is_list()) {
      parent.node.items.push_back(std::move(node));
    } else if (!parent.has_key) {
      parent.key = std::move(node);
      parent.has_key = true;
    } else {
      // A missing value has no place of its own; it gets the place of its key.
      if (node.kind == YamlNode::Kind::kNull && node.text.empty() && node.misuse.empty()) {
        node.place = parent.key.place;
      }
      parent.node.entries.push_back({std::move(parent.key), std::move(node)});
      parent.has_key = false;
    }
  }

  const std::string& text_;
  const Places& places_;
  int documents_ = 0;
  YamlNode root_;
  std::vector<Open> open_;
};

// The text that follows "expected" for a message of yaml-cpp; empty if the message needs none.
std::string_view expectation(std::string_view message) {
  namespace Message = YAML::ErrorMsg;
  static const std::array<std::array<std::string_view, 2>, 7> kExpectations = {{
      {Message::END_OF_MAP, "a key that is indented as the one before it"},
      {Message::END_OF_MAP_FLOW, "a comma or the } of a map that began with {"},
      {Message::END_OF_SEQ_FLOW, "a comma or the ] of a list that began with ["},
      {Message::FLOW_END, "brackets in matching pairs"},
      {Message::MAP_VALUE,
       "one key: value on each line; a text that holds a colon and a space stands in quotes"},
      {Message::TAB_IN_INDENTATION, "spaces for indentation, not tabs"},
      {Message::UNKNOWN_TOKEN, "a value; one that begins with this character stands in quotes"},
  }};
  for (const auto& [known, expected] : kExpectations) {
    if (message == known) return expected;
  }
  return "";
}

// The message for an error of yaml-cpp. The first `size` characters of `text` are the user's; this reader has
// added the rest.
std::string syntax_rule(const std::string& text, std::size_t size, const YAML::Exception& error) {
  const std::size_t at = std::min(static_cast<std::size_t>(std::max(error.mark.pos, 0)), size);
  const std::size_t line = text.substr(0, at).rfind('\n') + 1;
  const std::size_t indentation = text.find_first_not_of(" \t", line);
  const bool has_tab = text.substr(line, indentation - line).find('\t') != std::string::npos;
  const std::string_view expected = expectation(has_tab ? YAML::ErrorMsg::TAB_IN_INDENTATION : error.msg);
  if (expected.empty()) return "not YAML: " + error.msg;
  YamlNode rest;
  rest.kind = YamlNode::Kind::kScalar;
  rest.text = text.substr(at, std::min(text.find('\n', at), size) - at);
  const bool is_end = text.find_first_not_of(" \t\r\n", at) >= size;
  return fmt::format("not YAML: found {}, expected {}", is_end ? "the end" : quoted_text(short_text(rest)),
                     expected);
}

// The first `size` characters of `text` are the user's; this reader has added the rest.
YamlNode parse_document(const std::string& text, std::size_t size, int source) {
  check_characters(text, source);
  const Places places(text, source);
  TreeBuilder builder(text, places);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    throw YamlError(places.of(error.mark), syntax_rule(text, size, error));
  }
  if (!builder.has_document()) throw YamlError({source, 1, 1}, "empty: a board is a map of keys and values");
  return builder.take_root();
}

// Appends the value in flow style to `out`. May leave out text beyond `enough` bytes.
void append_text(const YamlNode& node, std::size_t enough, std::string& out) {
  if (out.size() > enough) return;
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      out += !node.text.empty() ? node.text : node.misuse.empty() ? "(nothing)" : "(anchor or alias)";
      break;
    case YamlNode::Kind::kScalar:
      out += node.quoted ? quoted_text(node.text) : node.text;
      break;
    case YamlNode::Kind::kList:
      out += '[';
      for (std::size_t i = 0; i < node.items.size() && out.size() <= enough; ++i) {
        if (i > 0) out += ", ";
        append_text(node.items[i], enough, out);
      }
      out += ']';
      break;
    case YamlNode::Kind::kMap:
      out += '{';
      for (std::size_t i = 0; i < node.entries.size() && out.size() <= enough; ++i) {
        if (i > 0) out += ", ";
        append_text(node.entries[i].key, enough, out);
        out += ": ";
        append_text(node.entries[i].value, enough, out);
      }
      out += '}';
      break;
  }
}

// A scalar in flow style: as it was written, or in quotes if it has characters with a meaning in YAML.
std::string flow_scalar(const YamlNode& node) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.+-";
  if (node.kind == YamlNode::Kind::kNull) return "~";
  const bool is_plain = !node.quoted && !node.text.empty() && node.text != "-" &&
                        node.text.find_first_not_of(kPlain) == std::string::npos;
  return is_plain ? node.text : quoted_text(node.text);
}

void append_flow(const YamlNode& node, std::string& out) {
  const char* separator = "";
  if (node.is_list()) {
    out += '[';
    for (const YamlNode& item : node.items) {
      out += std::exchange(separator, ", ");
      append_flow(item, out);
    }
    out += ']';
  } else if (node.is_map()) {
    out += '{';
    for (const YamlNode::Entry& entry : node.entries) {
      out += std::exchange(separator, ", ");
      append_flow(entry.key, out);
      out += ": ";
      append_flow(entry.value, out);
    }
    out += '}';
  } else {
    out += flow_scalar(node);
  }
}

void append_block(const YamlNode& map, const std::string& indent, std::string& out) {
  for (const YamlNode::Entry& entry : map.entries) {
    out += indent;
    append_flow(entry.key, out);
    out += ':';
    if (entry.value.is_map() && !entry.value.entries.empty()) {
      out += '\n';
      append_block(entry.value, indent + "  ", out);
    } else {
      out += ' ';
      append_flow(entry.value, out);
      out += '\n';
    }
  }
}

}  // namespace

const YamlNode::Entry* YamlNode::find(const std::string& key) const {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) {
    return entry.key.is_scalar() && entry.key.text == key;
  });
  return found == entries.end() ? nullptr : &*found;
}

YamlNode::Entry* YamlNode::find(const std::string& key) {
  return const_cast<Entry*>(std::as_const(*this).find(key));
}

YamlNode parse_yaml(const std::string& text, int source) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (std::string_view(text).substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    return parse_document(text.substr(kByteOrderMark.size()), text.size() - kByteOrderMark.size(), source);
  }
  return parse_document(text, text.size(), source);
}

// Parses the text as the only item of a flow list, because block style is not allowed there. The line break
// before the ] ends a comment in the text.
YamlNode parse_flow_value(const std::string& text, int source) {
  YamlNode list = parse_document("[" + text + "\n]", 1 + text.size(), source);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool is_one_value = list.is_list() && list.items.size() == 1 && first != std::string::npos &&
                            (!list.items[0].is_map() || text[first] == '{');
  if (!is_one_value) throw YamlError({source, 1, 1}, "one YAML flow value, such as 3, [a, b] or {a: 1}");
  return std::move(list.items[0]);
}

bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = character_length(text, at);
    if (length == 0) return false;
    at += length;
  }
  return true;
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

std::string flow_text(const YamlNode& node) {
  std::string out;
  append_text(node, out.max_size(), out);
  return out;
}

std::string yaml_text(const YamlNode& map) {
  std::string out;
  append_block(map, "", out);
  return out;
}

std::string short_text(const YamlNode& node) {
  constexpr std::size_t kLimit = 60;
  std::string out;
  append_text(node, kLimit + 20, out);
  std::replace_if(
      out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, ' ');
  if (out.size() <= kLimit) return out;
  std::size_t end = kLimit - 3;
  while (end > 0 && continues_character(out[end])) --end;
  return out.substr(0, end) + "...";
}

}  // namespace stereotlm::platform

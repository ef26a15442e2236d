#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include "platform/yaml/yaml_tree.h"

namespace stereotlm::platform {
namespace {

// The length in bytes of the first character of the text, which is not empty; 0 if it is not UTF-8.
std::size_t character_length(std::string_view text) {
  const auto first = static_cast<unsigned char>(text.front());
  const std::size_t length = first < 0x80 ? 1 : first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  if (length < 2) return length;
  if (length > text.size() || first > 0xF4) return 0;
  if (!std::all_of(text.begin() + 1, text.begin() + static_cast<std::ptrdiff_t>(length), continues_character))
    return 0;
  // These first bytes could also begin a code that is too long, a surrogate, or one beyond 0x10FFFF.
  const auto second = static_cast<unsigned char>(text[1]);
  const bool is_valid = (first != 0xE0 || second >= 0xA0) && (first != 0xED || second < 0xA0) &&
                        (first != 0xF0 || second >= 0x90) && (first != 0xF4 || second < 0x90);
  return is_valid ? length : 0;
}

// yaml-cpp stops at some control characters, and accepts others.
void check_characters(std::string_view text, int source) {
  Place place{source, 1, 1};
  while (!text.empty()) {
    const auto byte = static_cast<unsigned char>(text.front());
    const std::size_t length = character_length(text);
    if (length == 0) throw YamlError(place, fmt::format("byte 0x{:02X}: the text is not UTF-8", byte));
    if ((byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') || byte == 0x7F) {
      throw YamlError(place, fmt::format("control character 0x{:02X}: not allowed in YAML", byte));
    }
    text.remove_prefix(length);
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
  const std::string rest = text.substr(at, std::min(text.find('\n', at), size) - at);
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

}  // namespace

YamlNode parse_yaml(const std::string& text, int source) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  const std::size_t begin = text.rfind(kByteOrderMark, 0) == 0 ? kByteOrderMark.size() : 0;
  return parse_document(text.substr(begin), text.size() - begin, source);
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

}  // namespace stereotlm::platform

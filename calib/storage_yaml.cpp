#include "calib/storage_yaml.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace stereotlm::calib {
namespace {

constexpr const char* kBegin = "%YAML:1.0";
constexpr const char* kRule = "must be OpenCV FileStorage YAML";

using Kind = StorageValue::Kind;

[[noreturn]] void refuse(int line, const std::string& found, const std::string& rule) {
  throw std::runtime_error(fmt::format("line {}: {}: {}", line, found, rule));
}

int line_of(const YAML::Mark& mark) { return mark.is_null() ? 1 : mark.line + 1; }

// Builds values from the events of yaml-cpp's parser.
class Builder : public YAML::EventHandler {
 public:
  StorageValue take_root() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) refuse(line_of(mark), "a second document", "must be the only one");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    complete(make(Kind::kScalar, mark, anchor));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override { make(Kind::kScalar, mark, anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    StorageValue value = make(Kind::kScalar, mark, anchor);
    value.quoted = tag == "!";
    value.text = text;
    complete(std::move(value));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    open(make(Kind::kList, mark, anchor));
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    open(make(Kind::kMap, mark, anchor));
  }
  void OnMapEnd() override {
    check_keys(open_.back());
    close();
  }

 private:
  static StorageValue make(Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != YAML::NullAnchor) refuse(line_of(mark), "an anchor or alias", kRule);
    StorageValue value;
    value.kind = kind;
    value.line = line_of(mark);
    return value;
  }

  void open(StorageValue value) {
    if (open_.size() == kMostStorageDepth) {
      refuse(value.line, "nested too deeply",
             fmt::format("{} maps and lists in each other at most", kMostStorageDepth));
    }
    open_.push_back(std::move(value));
  }

  void close() {
    StorageValue value = std::move(open_.back());
    open_.pop_back();
    complete(std::move(value));
  }

  void complete(StorageValue value) {
    if (open_.empty()) {
      root_ = std::move(value);
      return;
    }
    StorageValue& parent = open_.back();
    if (parent.kind == Kind::kMap && parent.keys.size() == parent.items.size()) {
      if (value.kind != Kind::kScalar) refuse(value.line, "a key that is a map or list", kRule);
      parent.keys.push_back(std::move(value.text));
    } else {
      parent.items.push_back(std::move(value));
    }
  }

  static void check_keys(const StorageValue& map) {
    std::vector<std::size_t> order(map.keys.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&map](std::size_t a, std::size_t b) { return map.keys[a] < map.keys[b]; });
    const auto twice = std::adjacent_find(order.begin(), order.end(), [&map](std::size_t a, std::size_t b) {
      return map.keys[a] == map.keys[b];
    });
    if (twice != order.end()) refuse(map.items[*(twice + 1)].line, map.keys[*twice], "must be there once");
  }

  int documents_ = 0;
  StorageValue root_;
  std::vector<StorageValue> open_;  // open maps and lists, the outermost first
};

// Refuses control characters: yaml-cpp stops at some of them and accepts others.
void check_characters(const std::string& text) {
  int line = 1;
  for (const char character : text) {
    const auto byte = static_cast<unsigned char>(character);
    if (byte < ' ' && byte != '\t' && byte != '\n' && byte != '\r')
      refuse(line, fmt::format("control character 0x{:02X}", byte), kRule);
    if (byte == '\n') ++line;
  }
}

}  // namespace

const StorageValue* StorageValue::find(const std::string& key) const {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &items[static_cast<std::size_t>(found - keys.begin())];
}

StorageValue parse_storage(const std::string& text) {
  if (text.rfind(kBegin, 0) != 0)
    refuse(1, "no OpenCV FileStorage", fmt::format("must begin with {}", kBegin));
  if (text.size() > kMostStorageBytes) {
    throw std::runtime_error(fmt::format("{} bytes: must be {} at most", text.size(), kMostStorageBytes));
  }
  check_characters(text);
  std::string yaml = text;
  yaml[0] = '#';  // the first line is no directive of YAML: makes it a comment
  Builder builder;
  try {
    std::istringstream stream(yaml);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    refuse(line_of(error.mark), error.msg, kRule);
  }
  StorageValue root = builder.take_root();
  if (root.kind != Kind::kMap) refuse(root.line, "no map of keys and values", kRule);
  return root;
}

}  // namespace stereotlm::calib

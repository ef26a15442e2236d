#include "platform/yaml/yaml_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "platform/config/board_reader.h"

namespace stereotlm::platform {
namespace {

// "item,item,..": so many items that a quadratic cost would exceed the time limit of a test.
std::string many(const std::string& item) {
  constexpr int kCount = 250'000;
  std::string text;
  for (int i = 0; i < kCount; ++i) text += item + ',';
  return text;
}

TEST(YamlTree, IsReadFromALongLineInLinearTime) {
  const std::string text = many(
      "\"ein ganz langer \xC3\xBC"
      "bertext\"");
  const YamlNode board = parse_yaml("x: [" + text + "1]\n", Place::kBoard);
  const YamlNode set = parse_flow_value("[" + text + "1]", Place::kFirstSet);
  for (const YamlNode* list : {&board.entries.at(0).value, &set}) {
    ASSERT_EQ(list->items.size(), 250'001U);
    EXPECT_EQ(list->items[0].text,
              "ein ganz langer \xC3\xBC"
              "bertext");
  }
  EXPECT_EQ(board.entries[0].value.items.back().place.column, 5 + 250'000 * 27) << "in characters";
}

TEST(YamlTree, IsReadWithManyBanksInLinearTime) {
  std::string text;
  for (int i = 0; i < 250'000; ++i)
    text += "a_bank_with_a_long_name_of_its_own_" + std::to_string(i) + ": {},";
  std::vector<Finding> findings;
  read_board(parse_yaml("ssram: {banks: {" + text + "}}", Place::kBoard), findings);
  const auto is_of_banks = [](const Finding& finding) { return finding.missing.empty(); };
  ASSERT_EQ(std::count_if(findings.begin(), findings.end(), is_of_banks), 1);
  const auto of_banks = std::find_if(findings.begin(), findings.end(), is_of_banks);
  EXPECT_NE(of_banks->text.find("250000 banks; a map of 1..64 banks"), std::string::npos);
}

void expect_same(const YamlNode& a, const YamlNode& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.is_scalar() ? a.text : "", b.is_scalar() ? b.text : "");
  ASSERT_EQ(a.items.size(), b.items.size());
  ASSERT_EQ(a.entries.size(), b.entries.size());
  for (std::size_t i = 0; i < a.items.size(); ++i) expect_same(a.items[i], b.items[i]);
  for (std::size_t i = 0; i < a.entries.size(); ++i) {
    expect_same(a.entries[i].key, b.entries[i].key);
    expect_same(a.entries[i].value, b.entries[i].value);
  }
}

TEST(YamlTree, IsReadBackFromItsText) {
  const YamlNode tree = parse_yaml(R"(a: {b: {c: -5, d: [1, 'x, y', ""]}, e: []}
plain: has [brackets], quotes " and # more
block: |
  one
  two	tab \ backslash
none: ~
nothing:
dash: "-"
empty: {}
rows:
- [1.5, -2]
- {z: no}
"a b: c": größe
)",
                                   Place::kBoard);
  const YamlNode again = parse_yaml(yaml_text(tree), Place::kBoard);
  expect_same(tree, again);
  EXPECT_FALSE(again.find("a")->value.find("b")->value.find("c")->value.quoted) << "a number";
}

struct PlacedText {
  std::string text;
  int column;  // of the first level that is too deep
};

TEST(YamlTree, NamesThePlaceWhereItIsNestedTooDeeply) {
  const auto nested = [](const std::string& open, const std::string& close) {
    std::string text;
    for (int i = 0; i < 1000; ++i) text += open;
    text += '1';
    for (int i = 0; i < 1000; ++i) text += close;
    return text;
  };
  for (const auto& [text, column] : {PlacedText{nested("[", "]"), 101}, PlacedText{nested("{a: ", "}"), 401},
                                     PlacedText{nested("- ", ""), 201}}) {
    try {
      parse_yaml(text, Place::kBoard);
      FAIL() << text.substr(0, 10);
    } catch (const YamlError& error) {
      EXPECT_STREQ(error.what(), "nested too deeply: at most 100 levels");
      EXPECT_EQ(error.place.line, 1);
      EXPECT_EQ(error.place.column, column) << text.substr(0, 10);
    }
  }
}

}  // namespace
}  // namespace stereotlm::platform

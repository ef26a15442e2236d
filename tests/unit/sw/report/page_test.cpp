#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "sw/files/base64.h"
#include "sw/report/html_page.h"
#include "sw/report/page_data/packed_column.h"
#include "tests/unit/sw/report/unpacked.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;

// The text between the tags of the data.
std::string data_in(const std::string& page) {
  const std::string begin = "id=\"data\">";
  const std::size_t from = page.find(begin) + begin.size();
  return page.substr(from, page.find("</script>", from) - from);
}

TEST(HtmlPage, HoldsTheDataUnchanged) {
  const Json data = {{"kind", "run"}, {"numbers", {0.1, 1e300, -3, 18446744073709551615U}}, {"text", "a\nb"}};
  EXPECT_EQ(Json::parse(data_in(html_page(data))), data);
}

TEST(HtmlPage, NoTextEndsOrBeginsAnElement) {
  for (const char* const text : {"</script><script>x()</script>", "<!--<script>", "\"'&$`]]>", "<"}) {
    const Json data = {{"name", text}, {text, 1}};
    const std::string written = data_in(html_page(data));
    EXPECT_THAT(written, Not(HasSubstr("<")));
    EXPECT_EQ(Json::parse(written), data);
  }
}

TEST(HtmlPage, BytesThatAreNotUtf8AreReplaced) {
  EXPECT_EQ(Json::parse(data_in(html_page({{"folder",
                                            "a\xff"
                                            "b"}})))["folder"],
            "a\xef\xbf\xbd"
            "b");
}

TEST(HtmlPage, IsOneFile) {
  const std::string page = html_page(Json::object());
  EXPECT_THAT(page, Not(HasSubstr("_OF_THE_REPORT")));
  EXPECT_THAT(page, Not(HasSubstr("\nimport ")));
  EXPECT_THAT(page, Not(HasSubstr("\nexport ")));
  EXPECT_THAT(page, Not(HasSubstr("innerHTML")));
  EXPECT_LT(page.size(), 200'000U);
}

TEST(Base64, IsThatOfRfc4648) {
  const auto of = [](const std::string& text) { return files::base64(text.data(), text.size()); };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

void expect_round_trip(const std::vector<PackedColumn::Value>& values, const char* form) {
  PackedColumn column;
  std::vector<Json> expected;
  for (const PackedColumn::Value& value : values) {
    column.add(value);
    expected.push_back(json_of(value));
  }
  const Json packed = Json::parse(column.json().dump());
  EXPECT_TRUE(packed.contains(form)) << packed.dump();
  EXPECT_EQ(unpacked(packed, values.size()), expected);
}

TEST(PackedColumn, AConstantIsOneValue) {
  expect_round_trip({std::int64_t{7}, std::int64_t{7}}, "constant");
  expect_round_trip({std::string("</script>")}, "constant");
  expect_round_trip({std::monostate(), std::monostate()}, "constant");
}

TEST(PackedColumn, KeepsValuesOfAllTypes) {
  expect_round_trip({std::monostate(), std::int64_t{1}, 1.5, std::string("1"), std::int64_t{1}}, "codes");
}

TEST(PackedColumn, TakesAnotherLetterFrom65And4097Values) {
  for (const auto& [values, letters] :
       {std::pair(64, 1), std::pair(65, 2), std::pair(4096, 2), std::pair(4097, 3)}) {
    PackedColumn column;
    std::vector<PackedColumn::Value> all;
    for (std::int64_t value = 0; value < values; ++value) {
      all.emplace_back(value * value);
      column.add(all.back());
    }
    EXPECT_EQ(column.json()["codes"].get<std::string>().size(), static_cast<std::size_t>(letters * values));
    expect_round_trip(all, "codes");
  }
}

TEST(PackedColumn, ManyDifferentRealNumbersAreTheirBytes) {
  std::mt19937_64 draw(1);
  std::vector<PackedColumn::Value> values;
  for (int row = 0; row < 1000; ++row)
    values.emplace_back(std::ldexp(static_cast<double>(draw() >> 11), static_cast<int>(draw() % 200) - 150));
  expect_round_trip(values, "float64");
}

}  // namespace
}  // namespace stereotlm::report

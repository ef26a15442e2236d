#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "sw/files/text_forms.h"

namespace stereotlm::files {
namespace {

using Json = nlohmann::ordered_json;

TEST(JsonText, WritesTheShortestNumberThatReadsBackEqual) {
  EXPECT_EQ(json_text(0.1), "0.1\n");
  EXPECT_EQ(json_text(40.0), "40\n");
  EXPECT_EQ(json_text(18.6), "18.6\n");
  EXPECT_EQ(json_text(2.0 / 3), "0.6666666666666666\n");
  EXPECT_EQ(json_text(std::numeric_limits<std::uint64_t>::max()), "18446744073709551615\n");
  for (const double number :
       {5e-324, 1.7976931348623157e308, 1e16, 1e21, 123456.789, 1e-7, std::nextafter(1.0, 2.0)}) {
    EXPECT_EQ(Json::parse(json_text(number)).get<double>(), number);
  }
}

TEST(JsonText, KeepsAContainerWithoutContainersOnOneLine) {
  const Json document = {
      {"b", 1}, {"a", {1, 2}}, {"rows", {{{"x", 1}, {"y", nullptr}}, {{"x", 2}, {"y", "z"}}}}};
  EXPECT_EQ(json_text(document),
            "{\n  \"b\": 1,\n  \"a\": [1, 2],\n  \"rows\": [\n    {\"x\": 1, \"y\": null},\n"
            "    {\"x\": 2, \"y\": \"z\"}\n  ]\n}\n");
  EXPECT_EQ(json_text({{"none", Json::array()}}), "{\n  \"none\": []\n}\n");
}

TEST(JsonText, EscapesStrings) {
  EXPECT_EQ(json_text("a\"b\\c\n\xC3\xA4"), "\"a\\\"b\\\\c\\n\xC3\xA4\"\n");
  EXPECT_EQ(json_text({{"a\"b", 1}}), "{\n  \"a\\\"b\": 1\n}\n");
}

TEST(JsonText, RefusesValuesThatJsonDoesNotHave) {
  EXPECT_THROW(json_text(std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  EXPECT_THROW(json_text(std::numeric_limits<double>::infinity()), std::invalid_argument);
  EXPECT_THROW(json_text("\xFF"), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::files

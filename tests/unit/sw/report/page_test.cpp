#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>

#include "sw/report/html_page.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;

TEST(HtmlPage, BytesThatAreNotUtf8AreReplaced) {
  EXPECT_EQ(html_page({{"folder", "a\xff_b"}}), html_page({{"folder", "a\xef\xbf\xbd_b"}}));
}

TEST(HtmlPage, IsOneFile) {
  const std::string page = html_page(Json::object());
  EXPECT_THAT(page, HasSubstr("color-scheme: light;\n"));
  EXPECT_THAT(page, HasSubstr("DecompressionStream"));
  EXPECT_THAT(page, Not(HasSubstr("\nimport ")));
  EXPECT_THAT(page, Not(HasSubstr("\nexport ")));
  EXPECT_THAT(page, Not(HasSubstr("innerHTML")));
  EXPECT_LT(page.size(), 210'000U);
}

}  // namespace
}  // namespace stereotlm::report

#include <gmock/gmock.h>
#include <zlib.h>

#include <nlohmann/json.hpp>
#include <string>

#include "sw/files/text_forms.h"
#include "sw/report/html_page.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(HtmlPage, HoldsTheDataCompressed) {
  const std::string text =
      "{\"kind\":\"run\",\"numbers\":[0.1,1e+300,-3,18446744073709551615],\"text\":\"</script>\"}";
  uLongf size = compressBound(text.size());
  std::string bytes(size, '\0');
  ASSERT_EQ(compress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                     reinterpret_cast<const Bytef*>(text.data()), text.size()),
            Z_OK);
  const std::string page = html_page(Json::parse(text));
  EXPECT_THAT(page, HasSubstr("id=\"data\">" + files::base64(bytes.data(), size) + "</script>"));
  EXPECT_THAT(page, StartsWith(page_mark()));
}

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
  EXPECT_LT(page.size(), 200'000U);
}

TEST(Base64, IsThatOfRfc4648) {
  const auto of = [](const std::string& text) { return files::base64(text.data(), text.size()); };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace stereotlm::report

#include "sw/report/html_page.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>

extern "C" {
// Of page/page_text.S.
extern const char stereotlm_page_style[];
extern const char stereotlm_page_style_end[];
extern const char stereotlm_page_script[];
extern const char stereotlm_page_script_end[];
}

namespace stereotlm::report {
namespace {

std::string_view between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

// In JSON `<` occurs in strings only, where it may be escaped. Without it no text ends the script element.
std::string without_tags(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char letter : json) {
    if (letter == '<') {
      text += "\\u003c";
    } else {
      text += letter;
    }
  }
  return text;
}

}  // namespace

std::string page_mark() {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"generator\" content=\"stereotlm report\">\n";
}

std::string html_page(const nlohmann::ordered_json& data) {
  constexpr std::string_view kPage = R"({}<meta name="viewport" content="width=device-width, initial-scale=1">
<title>stereotlm report</title>
<link rel="icon" href="data:,">
<style>
{}</style>
</head>
<body>
<main id="page"><noscript>This page needs JavaScript.</noscript></main>
<script type="application/json" id="data">{}</script>
<script type="module">
{}</script>
</body>
</html>
)";
  return fmt::format(kPage, page_mark(), between(stereotlm_page_style, stereotlm_page_style_end),
                     without_tags(data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)),
                     between(stereotlm_page_script, stereotlm_page_script_end));
}

}  // namespace stereotlm::report

#include "sw/report/html_page.h"

#include <fmt/format.h>
#include <zlib.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "sw/files/text_forms.h"

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

// The bytes compressed by zlib, in base64.
std::string compressed(const std::string& text) {
  uLongf size = compressBound(text.size());
  std::vector<Bytef> bytes(size);
  if (compress(bytes.data(), &size, reinterpret_cast<const Bytef*>(text.data()), text.size()) != Z_OK)
    throw std::runtime_error("the data of the page cannot be compressed");
  return files::base64(bytes.data(), size);
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
<main id="page"><noscript><pre>{}</pre></noscript></main>
<script type="text/plain" id="data">{}</script>
<script type="module">
{}</script>
</body>
</html>
)";
  const auto json_of = [](const nlohmann::ordered_json& value) {
    return value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  };
  std::string plain;
  const std::string text = json_of(data.value("text", ""));
  for (const char letter : nlohmann::json::parse(text).get<std::string>())
    plain += letter == '<' ? "&lt;" : letter == '&' ? "&amp;" : std::string(1, letter);
  return fmt::format(kPage, page_mark(), between(stereotlm_page_style, stereotlm_page_style_end), plain,
                     compressed(json_of(data)), between(stereotlm_page_script, stereotlm_page_script_end));
}

}  // namespace stereotlm::report

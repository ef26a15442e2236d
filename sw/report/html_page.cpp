#include "sw/report/html_page.h"

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "sw/report/page/page_text.h"

namespace stereotlm::report {
namespace {

// Where the page takes its data.
constexpr std::string_view kPlace = "DATA_OF_THE_REPORT";

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

std::string html_page(const nlohmann::ordered_json& data) {
  const std::string_view page = page_text();
  const std::size_t place = page.find(kPlace);
  if (place == std::string_view::npos) throw std::logic_error("the page has no place for its data");
  std::string text(page.substr(0, place));
  text += without_tags(data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  return text.append(page.substr(place + kPlace.size()));
}

std::string page_mark() {
  constexpr std::string_view kGenerator = "content=\"stereotlm report\">\n";
  const std::string_view page = page_text();
  return std::string(page.substr(0, page.find(kGenerator) + kGenerator.size()));
}

}  // namespace stereotlm::report

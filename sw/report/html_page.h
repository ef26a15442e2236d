#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace stereotlm::report {

// A page that shows the data (sw/report/page/README.md) in a browser. It is one file and needs no network.
// Without JavaScript it shows `text` of the data. Text is shown as text, whatever it holds; bytes that are
// not UTF-8 become replacement characters.
std::string html_page(const nlohmann::ordered_json& data);

// How every page begins, up to the name of its generator. No other page begins so.
std::string page_mark();

}  // namespace stereotlm::report

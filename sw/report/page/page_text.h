#pragma once

#include <string_view>

namespace stereotlm::report {

// The page without its data: page.html with the style sheet and the scripts of this folder in it.
std::string_view page_text();

}  // namespace stereotlm::report

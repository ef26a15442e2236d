#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>

#include "sw/media/decode.h"

namespace stereotlm::media {
namespace {

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

// Reads words from the header of a file.
class Words {
 public:
  explicit Words(std::string_view bytes) : rest_(bytes) {}

  // The next word, without comments before it. Takes the one byte of white space behind it.
  std::string_view next() {
    while (!rest_.empty() && (is_space(rest_[0]) || rest_[0] == '#')) {
      const bool is_comment = rest_[0] == '#';
      rest_.remove_prefix(is_comment ? std::min(rest_.find_first_of("\r\n"), rest_.size()) : 1);
    }
    const auto end = std::find_if(rest_.begin(), rest_.end(), is_space);
    if (end == rest_.end()) refuse_damaged();
    const std::string_view word = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(word.size() + 1);
    return word;
  }
  // The next word as a number, at most 1,000,000,000.
  std::uint64_t number() {
    constexpr std::uint64_t kMost = 1'000'000'000;
    std::uint64_t number = 0;
    for (const char digit : next()) {
      if (digit < '0' || digit > '9') refuse_damaged();
      number = std::min(kMost, number * 10 + static_cast<std::uint64_t>(digit - '0'));
    }
    return number;
  }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

struct PnmHeader {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::uint64_t channels = 0;
  std::uint64_t maximum = 0;
};

PnmHeader pam_header(Words& words) {
  PnmHeader header;
  for (std::string_view field = words.next(); field != "ENDHDR"; field = words.next()) {
    if (field == "WIDTH") {
      header.width = words.number();
    } else if (field == "HEIGHT") {
      header.height = words.number();
    } else if (field == "DEPTH") {
      header.channels = words.number();
    } else if (field == "MAXVAL") {
      header.maximum = words.number();
    } else {
      words.next();  // the kind of pixels, which DEPTH says too
    }
  }
  return header;
}

}  // namespace

Picture decode_pnm(std::string_view bytes) {
  const char kind = bytes[1];
  if (kind == '1' || kind == '4') refuse_picture("1-bit black and white", kPixelRule);
  if (kind == 'f' || kind == 'F') refuse_picture(kind == 'f' ? "float grey" : "float colour", kPixelRule);
  Words words(bytes.substr(2));
  PnmHeader header;
  if (kind == '7') {
    header = pam_header(words);
  } else {
    header.width = words.number();
    header.height = words.number();
    header.maximum = words.number();
    header.channels = kind == '2' || kind == '5' ? 1 : 3;
  }
  if (header.channels != 1 && header.channels != 3)
    refuse_picture(fmt::format("a PAM of depth {}", header.channels), kPixelRule);
  Picture picture = new_picture(header.width, header.height, static_cast<int>(header.channels));
  if (header.maximum != 255) {
    refuse_picture(fmt::format("a maximum level of {}", header.maximum), "a PGM, PPM or PAM must state 255");
  }
  if (kind == '2' || kind == '3') {
    for (std::uint8_t& sample : picture.samples)
      sample = static_cast<std::uint8_t>(std::min<std::uint64_t>(255, words.number()));
  } else {
    if (words.rest().size() < picture.samples.size()) refuse_damaged();
    std::copy_n(words.rest().begin(), picture.samples.size(), picture.samples.begin());
  }
  // The file has red first.
  for (std::size_t at = 0; picture.channels == 3 && at < picture.samples.size(); at += 3)
    std::swap(picture.samples[at], picture.samples[at + 2]);
  return picture;
}

}  // namespace stereotlm::media

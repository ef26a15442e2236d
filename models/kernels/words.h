#pragma once

#include <cstddef>
#include <cstdint>

namespace stereotlm::kernels {

// Image and disparity buffers hold four pixels to a 32-bit word, the lowest column in the lowest byte
// (contract 1.5).
inline constexpr int kPixelsPerWord = 4;
inline constexpr std::uint8_t kInvalidDisparity = 255;  // of a pixel without a disparity

// Returns one of the four pixels of a word.
constexpr std::uint8_t pixel_of_word(std::uint32_t word, std::size_t pixel_index) {
  return static_cast<std::uint8_t>(word >> (8U * static_cast<unsigned>(pixel_index % kPixelsPerWord)));
}

// Packs kPixelsPerWord pixels into a word.
constexpr std::uint32_t word_of_pixels(const std::uint8_t* pixels) {
  return static_cast<std::uint32_t>(pixels[0]) | static_cast<std::uint32_t>(pixels[1]) << 8U |
         static_cast<std::uint32_t>(pixels[2]) << 16U | static_cast<std::uint32_t>(pixels[3]) << 24U;
}

// Packs the pixels of `words` consecutive words.
inline void words_of_pixels(const std::uint8_t* pixels, int words, std::uint32_t* to) {
  for (int word = 0; word < words; ++word, pixels += kPixelsPerWord) to[word] = word_of_pixels(pixels);
}

// Returns the word with this pixel replaced.
constexpr std::uint32_t insert_pixel(std::uint32_t word, std::size_t pixel_index, std::uint8_t pixel) {
  const unsigned shift = 8U * static_cast<unsigned>(pixel_index % kPixelsPerWord);
  return (word & ~(0xFFU << shift)) | static_cast<std::uint32_t>(pixel) << shift;
}

}  // namespace stereotlm::kernels

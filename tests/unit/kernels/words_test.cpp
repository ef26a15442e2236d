#include "models/kernels/words.h"

#include <gtest/gtest.h>

#include "tests/support/reference_arithmetic.h"

namespace stereotlm::kernels {
namespace {

TEST(Words, HoldPixelsAsTheReferenceDoes) {
  const std::vector<std::uint8_t> pixels = {0, 1, 254, 255, 128, 7, 0, 99};
  std::vector<std::uint32_t> words(2, 0xDEADBEEFU);
  for (std::size_t index = 0; index < pixels.size(); ++index)
    words[index / 4] = insert_pixel(words[index / 4], index, pixels[index]);
  EXPECT_EQ(words, test::reference_words(pixels));
  EXPECT_EQ(word_of_pixels(pixels.data()), words[0]);
  EXPECT_EQ(word_of_pixels(pixels.data() + 4), words[1]);
  for (std::size_t index = 0; index < pixels.size(); ++index)
    EXPECT_EQ(pixel_of_word(words[index / 4], index), pixels[index]);
}

}  // namespace
}  // namespace stereotlm::kernels

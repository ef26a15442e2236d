#include "calib/grid_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stereotlm::calib {
namespace {

constexpr double kLeastMarginMm = 10;
constexpr double kPrintHeightMm = 10;  // strip at the bottom: above the small print, below it white
constexpr double kPrintWidthMm = 198;  // from the beginning of the ruler to the end of the small print
constexpr double kFontSizeMm = 2.8;
constexpr int kRulerMm = 100;

struct Size {
  double width, height;  // mm
};

Size page_for(const Size& board, double square_mm) {
  constexpr Size kPages[] = {{297, 210}, {210, 297}, {420, 297}, {297, 420}};
  constexpr double kNarrowest = 210;
  const double wide_margin = std::max(kLeastMarginMm, square_mm / 2);
  const auto with_margin = [&board](double margin) {
    return Size{board.width + 2 * margin, board.height + 2 * margin + kPrintHeightMm};
  };
  for (const double margin : {wide_margin, kLeastMarginMm}) {
    const Size needed = with_margin(margin);
    for (const Size& page : kPages) {
      if (needed.width <= page.width && needed.height <= page.height) return page;
    }
  }
  const Size needed = with_margin(wide_margin);
  return {std::max(kNarrowest, needed.width), needed.height};
}

// A length in millimetres without the rounding errors in its last digits.
double rounded(double mm) { return std::round(mm * 1e6) / 1e6; }

}  // namespace

std::string grid_sheet_svg(const GridShape& shape) {
  const double square = shape.square_mm;
  const Size board = {(shape.columns + 1) * square, (shape.rows + 1) * square};
  const Size page = page_for(board, square);
  const double board_left = (page.width - board.width) / 2;
  const double board_top = (page.height - kPrintHeightMm - board.height) / 2;
  std::string squares;
  for (int row = 0; row <= shape.rows; ++row) {
    for (int column = row % 2; column <= shape.columns; column += 2) {
      squares += fmt::format("M{0} {1}h{2}v{2}h-{2}z", rounded(board_left + column * square),
                             rounded(board_top + row * square), square);
    }
  }
  const double left = rounded((page.width - kPrintWidthMm) / 2);
  const double bottom = rounded(page.height - kPrintHeightMm / 2);
  std::string ruler = fmt::format("M{} {}h{}", left, bottom, kRulerMm);
  for (int mm = 0; mm <= kRulerMm; mm += 10)
    ruler += fmt::format("M{} {}v-{}", left + mm, bottom, mm % 50 == 0 ? kFontSizeMm : kFontSizeMm / 2);
  return fmt::format(
      R"(<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" width="{0}mm" height="{1}mm" viewBox="0 0 {0} {1}">
<style>@page {{ size: {0}mm {1}mm; margin: 0 }} text {{ font: {2}px sans-serif }}</style>
<rect width="{0}" height="{1}" fill="white"/>
<path d="{3}"/>
<path d="{4}" stroke="black" stroke-width="0.2"/>
<text x="{5}" y="{6}">{7} mm</text>
<text x="{8}" y="{6}" text-anchor="end">{9}x{10} inner corners, squares of {11:.6g} mm: print at 100 %</text>
</svg>
)",
      rounded(page.width), rounded(page.height), kFontSizeMm, squares, ruler, left + kRulerMm + 1, bottom,
      kRulerMm, left + kPrintWidthMm, shape.columns, shape.rows, square);
}

}  // namespace stereotlm::calib

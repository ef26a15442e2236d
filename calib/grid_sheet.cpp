#include "calib/grid_sheet.h"

#include <cairo-pdf.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace stereotlm::calib {
namespace {

constexpr double kPointsPerMm = 72 / 25.4;
constexpr double kLargestPageMm = 14400 / kPointsPerMm;
constexpr double kLeastMarginMm = 10;
constexpr double kPrintHeightMm = 10;  // strip at the bottom: above the small print, below it white
constexpr double kFontSizeMm = 2.8;
constexpr int kRulerMm = 100;
constexpr double kLineMm = 0.2;

// A4 and A3, landscape and portrait.
constexpr std::array<std::pair<double, double>, 4> kPages = {
    {{297, 210}, {210, 297}, {420, 297}, {297, 420}}};
constexpr double kNarrowestPageMm = 210;

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

double board_width(const GridShape& shape) { return (shape.columns + 1) * shape.square_mm; }
double board_height(const GridShape& shape) { return (shape.rows + 1) * shape.square_mm; }

// Places the board in the middle of the page above the small print.
GridSheet with_board(const GridShape& shape, double width_mm, double height_mm) {
  return {width_mm, height_mm, (width_mm - board_width(shape)) / 2,
          (height_mm - kPrintHeightMm - board_height(shape)) / 2};
}

// A square, or a line from one end to the other.
struct Box {
  double left, top, right, bottom;  // mm
};

struct Text {
  std::string words;
  double x, bottom;  // mm
  bool ends_at_x;    // true: it ends at x; false: it begins there
};

// The contents of the page, all in black.
struct Drawing {
  GridSheet sheet;
  std::vector<Box> squares;
  std::vector<Box> lines;
  std::vector<Text> texts;
};

std::string small_print(const GridShape& shape) {
  return fmt::format("{}x{} inner corners, squares of {:.6g} mm: print at 100 %", shape.columns, shape.rows,
                     shape.square_mm);
}

// Adds a ruler with a tick every 10 mm, upwards from its bottom.
Drawing drawing_of(const GridShape& shape) {
  constexpr double kPrintWidthMm = 198;  // from the beginning of the ruler to the end of the text
  Drawing drawing{grid_sheet(shape), {}, {}, {}};
  const GridSheet& sheet = drawing.sheet;
  for (int row = 0; row <= shape.rows; ++row) {
    for (int column = row % 2; column <= shape.columns; column += 2) {
      drawing.squares.push_back({sheet.board_left_mm + column * shape.square_mm,
                                 sheet.board_top_mm + row * shape.square_mm,
                                 sheet.board_left_mm + (column + 1) * shape.square_mm,
                                 sheet.board_top_mm + (row + 1) * shape.square_mm});
    }
  }
  const double left = (sheet.width_mm - kPrintWidthMm) / 2;
  const double bottom = sheet.height_mm - kPrintHeightMm / 2;
  drawing.lines = {{left, bottom, left + kRulerMm, bottom}};
  for (int mm = 0; mm <= kRulerMm; mm += 10) {
    const double height = mm % 50 == 0 ? kFontSizeMm : kFontSizeMm / 2;
    drawing.lines.push_back({left + mm, bottom + kLineMm / 2, left + mm, bottom - height});
  }
  drawing.texts = {{fmt::format("{} mm", kRulerMm), left + kRulerMm + 1, bottom, false},
                   {small_print(shape), left + kPrintWidthMm, bottom, true}};
  return drawing;
}

void draw(cairo_t* context, const Drawing& drawing) {
  cairo_set_source_rgb(context, 1, 1, 1);
  cairo_paint(context);
  cairo_set_source_rgb(context, 0, 0, 0);
  for (const Box& square : drawing.squares) {
    cairo_rectangle(context, square.left, square.top, square.right - square.left, square.bottom - square.top);
  }
  cairo_fill(context);
  for (const Box& line : drawing.lines) {
    cairo_move_to(context, line.left, line.top);
    cairo_line_to(context, line.right, line.bottom);
  }
  cairo_set_line_width(context, kLineMm);
  cairo_stroke(context);
  // Cairo's own letters are the same on every machine, and need no search for fonts.
  cairo_select_font_face(context, "@cairo:", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, kFontSizeMm);
  for (const Text& text : drawing.texts) {
    cairo_text_extents_t extents;
    cairo_text_extents(context, text.words.c_str(), &extents);
    cairo_move_to(context, text.ends_at_x ? text.x - extents.x_advance : text.x, text.bottom);
    cairo_show_text(context, text.words.c_str());
  }
}

cairo_status_t append(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

// Removes rounding errors in the last digits, for the SVG.
double rounded(double mm) {
  constexpr double kParts = 1e6;
  return std::round(mm * kParts) / kParts;
}

}  // namespace

GridSheet grid_sheet(const GridShape& shape) {
  if (const auto found = problems(shape); !found.empty()) {
    throw std::invalid_argument(fmt::format("{}", fmt::join(found, "\n")));
  }
  const double wide_margin_mm = std::max(kLeastMarginMm, shape.square_mm / 2);
  for (const double margin_mm : {wide_margin_mm, kLeastMarginMm}) {
    const double width_mm = board_width(shape) + 2 * margin_mm;
    const double height_mm = board_height(shape) + 2 * margin_mm + kPrintHeightMm;
    for (const auto& [page_width_mm, page_height_mm] : kPages) {
      if (width_mm <= page_width_mm && height_mm <= page_height_mm) {
        return with_board(shape, page_width_mm, page_height_mm);
      }
    }
  }
  const double width_mm = std::max(kNarrowestPageMm, board_width(shape) + 2 * wide_margin_mm);
  const double height_mm = board_height(shape) + 2 * wide_margin_mm + kPrintHeightMm;
  if (std::max(width_mm, height_mm) > kLargestPageMm) {
    throw std::invalid_argument(
        fmt::format("square_mm = {}: the page must be at most {:.0f} mm wide and high, not {} x {}",
                    shape.square_mm, kLargestPageMm, width_mm, height_mm));
  }
  return with_board(shape, width_mm, height_mm);
}

std::string grid_sheet_pdf(const GridShape& shape) {
  const Drawing drawing = drawing_of(shape);
  std::string bytes;
  const Surface surface(
      cairo_pdf_surface_create_for_stream(append, &bytes, drawing.sheet.width_mm * kPointsPerMm,
                                          drawing.sheet.height_mm * kPointsPerMm),
      cairo_surface_destroy);
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, small_print(shape).c_str());
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  const Context context(cairo_create(surface.get()), cairo_destroy);
  cairo_scale(context.get(), kPointsPerMm, kPointsPerMm);
  draw(context.get(), drawing);
  cairo_surface_finish(surface.get());
  for (const cairo_status_t status : {cairo_status(context.get()), cairo_surface_status(surface.get())}) {
    if (status != CAIRO_STATUS_SUCCESS)
      throw std::runtime_error(
          fmt::format("the sheet could not be drawn: {}", cairo_status_to_string(status)));
  }
  return bytes;
}

// Does not use Cairo, which rounds positions to 1/256 of a unit. Cairo also numbers the drawings of a
// process, so that the same shape would not give the same bytes.
std::string grid_sheet_svg(const GridShape& shape) {
  const Drawing drawing = drawing_of(shape);
  const double width = rounded(drawing.sheet.width_mm);
  const double height = rounded(drawing.sheet.height_mm);
  std::string svg = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}mm\" height=\"{1}mm\" viewBox=\"0 0 {0} {1}\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      width, height);
  for (const Box& square : drawing.squares) {
    const double left = rounded(square.left);
    const double top = rounded(square.top);
    svg += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", left, top,
                       rounded(square.right - left), rounded(square.bottom - top));
  }
  for (const Box& line : drawing.lines) {
    svg += fmt::format(
        "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"black\" stroke-width=\"{}\"/>\n",
        rounded(line.left), rounded(line.top), rounded(line.right), rounded(line.bottom), kLineMm);
  }
  for (const Text& text : drawing.texts) {
    svg += fmt::format(
        "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"{}\" text-anchor=\"{}\">{}</text>\n",
        rounded(text.x), rounded(text.bottom), kFontSizeMm, text.ends_at_x ? "end" : "start", text.words);
  }
  return svg + "</svg>\n";
}

}  // namespace stereotlm::calib

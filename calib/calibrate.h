#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/calibration.h"
#include "calib/rig_fit.h"
#include "calib/tables.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

// A pair of pictures, and the names of their files. The names are equal if one file holds both pictures.
struct PicturePair {
  std::string left_name;
  std::string right_name;
  kernels::GrayImage left;
  kernels::GrayImage right;
};

struct CalibrationRequest {
  GridShape grid;
  std::vector<PicturePair> pictures;    // all of one size
  int disparities = 80;                 // number of candidates of the board
  std::optional<int> disparity_offset;  // nullopt: chosen by disparity_offset_for()
  // Called after the search of each pair: how many pictures were searched, and "'right02.jpg': found".
  std::function<void(std::size_t pictures, const std::string& last)> progress;
};

// A pair in which the grid was found.
struct CalibratedPair {
  std::size_t picture = 0;  // index in the request
  GridPair corners;
  std::vector<bool> used;  // [corner]: whether the rig was fitted to it
};

struct CalibrationResult {
  Calibration calibration;  // without the checksums of the tables
  TablePair tables;
  std::vector<CalibratedPair> pairs;
  std::vector<LeftOutCorner> left_out;  // LeftOutCorner::pair is an index in `pairs`
  Lens lens = Lens::kFull;              // without k3 if the grid was not seen where k3 has an effect
  std::vector<std::string> skipped;     // one message per picture without grid: "'left04.jpg': no grid of .."
};

// Makes tables from pictures of a grid: finds the corners, fits the rig and leaves out corners that do not
// fit, rectifies, chooses the disparity offset, and measures the quality. Throws std::invalid_argument, with
// a message that names the cure, if too few pairs show a grid, if they do not determine the lenses, if the
// cameras are swapped or not side by side, or if the grid needs more disparities; std::runtime_error if no
// rig fits.
CalibrationResult calibrate(const CalibrationRequest& request);

// The result of matched_rows().
struct MatchedRows {
  std::size_t points = 0;  // distinctive points of the left picture that were searched for
  std::size_t in_row = 0;  // of these, found in the same row, or the one above or below
  RowError error;          // of the points that were found
};

// Measures how well the rows of two rectified pictures agree. The most distinctive points of the left picture
// are searched for in the right one, 0..disparities-1 columns to the left and up to 8 rows above or below.
// Only reliable matches count. A point of a pattern that repeats does not count: it looks like another place
// of the left picture, or fits two places of the right one. If the tables belong to the cameras, the mean
// error is below one pixel. The function takes about 50 ms at 640x480 with 320 disparities. Throws
// std::invalid_argument if the pictures differ in size.
MatchedRows matched_rows(const kernels::GrayImage& left, const kernels::GrayImage& right, int disparities);

}  // namespace stereotlm::calib

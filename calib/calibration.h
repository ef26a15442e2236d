#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calib/certainty.h"
#include "calib/rig.h"

namespace stereotlm::calib {

// The positions of a pair's corners in its rectified pictures.
GridPair rectified(const Rig& rig, const Rectification& rectification, const GridPair& pair);

// Distances between the rows of the same corner in two rectified pictures, which should be 0.
struct RowError {
  double mean_px = 0;  // mean of the absolute values
  double max_px = 0;
  std::size_t corners = 0;
};

// Their signs do not matter. All is 0 if there are none.
RowError row_error(const std::vector<double>& distances);

// Disparities x_left - x_right that the rig has to cover.
struct DisparityRange {
  double min = 0;
  double max = 0;

  // The number of candidates that cover the range: the whole numbers from floor(min) to ceil(max).
  int needed() const;
};

// The offset that `--disparity-offset auto` chooses: m = floor(range.min) if that is negative. Else it is
// max(0, m - (disparities - range.needed()) / 2), which centres `range` among the candidates. Throws
// std::invalid_argument if range.needed() > disparities; the message names the options of `calibrate`.
int disparity_offset_for(const DisparityRange& range, int disparities);

// The errors of pairs under a rig fitted without them (cross-validation). Each pair is left out once.
struct HeldOut {
  double rms_px = 0;   // reprojection, over the pictures of both cameras
  RowError row_error;  // of rectified corners
};

// How well the calibration explains the corners, in pixels.
struct Quality {
  double left_rms_px = 0;  // reprojection
  double right_rms_px = 0;
  double stereo_rms_px = 0;  // over the pictures of both cameras
  RowError row_error;        // of rectified corners
  // Of corners found again in the rectified pictures, whose pixels come from rounded positions.
  RowError found_again;
  std::optional<HeldOut> held_out;  // nullopt if there are too few pairs
  DisparityRange disparities;       // of the grid, without the offset
};

// A pair of pictures in which the grid was found.
struct Source {
  std::string left;  // files
  std::string right;
  std::size_t corners_used = 0;
};

// The contents of a calibration file.
struct Calibration {
  std::vector<std::string> imported;  // files; if there are any, there is no grid, no quality and no source
  GridShape grid;
  Rig rig;
  Rectification rectification;
  int disparities = 0;  // number of candidates of the board for which it was made
  int disparity_offset = 0;
  Quality quality;
  std::optional<Certainty> certainty;  // nullopt of an imported calibration
  std::vector<Source> sources;
  std::string left_lut_sha256;  // of the table files
  std::string right_lut_sha256;
};

// The most bytes of a calibration file. Each pair of pictures adds 60 bytes and two paths.
inline constexpr std::size_t kMostCalibrationBytes = 1'000'000;

// Reads a text of calibration_yaml(); every number is the same to the last bit. Throws std::runtime_error,
// which names the line, the key, the value and the rule, if the text is of another kind or too long, a key is
// missing, a matrix has another size, a number is not finite, R, R1 or R2 is no rotation, or Q does not
// follow from P1 and P2.
Calibration parse_calibration(const std::string& text);

// The text of a calibration file: OpenCV FileStorage YAML with the keys of OpenCV's stereo_calib sample (M1
// D1 M2 D2 R T R1 R2 P1 P2 Q; lengths in mm), image_width, image_height, disparity_offset, the checksums of
// the tables, the sources and the quality. Throws std::runtime_error if it would be longer than
// parse_calibration() accepts.
std::string calibration_yaml(const Calibration& calibration);

}  // namespace stereotlm::calib

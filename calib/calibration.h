#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calib/rig.h"
#include "calib/rig_fit.h"

namespace stereotlm::calib {

// The positions of a pair's corners in its rectified pictures.
GridPair rectified(const Rig& rig, const Rectification& rectification, const GridPair& pair);

// Distances between the rows of the same corner in two rectified pictures, which should be 0.
struct RowError {
  double mean_px = 0;  // mean of the absolute values
  double max_px = 0;
  std::size_t corners = 0;
};

// Of these distances, whose signs do not matter.
RowError row_error(const std::vector<double>& distances);

// Disparities x_left - x_right that the rig has to cover.
struct DisparityRange {
  double min = 0;
  double max = 0;

  // The number of candidates that cover the range: the whole numbers from floor(min) to ceil(max).
  int needed() const;
};

// The offset that `--disparity-offset auto` chooses. It centres `range` among the candidates, but is not
// below 0 unless `range` is. Throws std::invalid_argument if `range` needs more than `disparities`
// candidates; the message names the options of `calibrate`.
int disparity_offset_for(const DisparityRange& range, int disparities);

// The errors of pairs under a rig that was fitted without them (cross-validation). Each pair is left out
// once.
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
  // Of corners that are searched again in the rectified pictures. The tables round the sources of their
  // pixels.
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
  GridShape grid;
  Rig rig;
  Rectification rectification;
  int disparities = 0;  // number of candidates of the board for which it was made
  int disparity_offset = 0;
  Quality quality;
  std::vector<Source> sources;
  std::string left_lut_sha256;  // of the table files
  std::string right_lut_sha256;
};

// The most bytes of a calibration file. Each pair of pictures adds 60 bytes and two paths.
inline constexpr std::size_t kMostCalibrationBytes = 1'000'000;

// Reads a text that calibration_yaml() wrote; every number is the same to the last bit. Throws
// std::runtime_error, which names the line, the key, the value and the rule, for a text of another kind, a
// missing key, a matrix of another size, a number that is not finite, an R that is no rotation, or a Q that
// does not follow from P1 and P2.
Calibration parse_calibration(const std::string& text);

// The text of a calibration file: OpenCV FileStorage YAML with the keys of OpenCV's stereo_calib sample (M1
// D1 M2 D2 R T R1 R2 P1 P2 Q; lengths in mm), image_width, image_height, disparity_offset, the checksums of
// the tables, the sources and the quality. Throws std::runtime_error if it would be longer than
// parse_calibration() accepts.
std::string calibration_yaml(const Calibration& calibration);

}  // namespace stereotlm::calib

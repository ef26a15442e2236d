#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/rig.h"

// Random rigs, and the corners that their cameras see of a grid, for tests of the calibration. There are no
// pictures. A seed gives the same rig on every platform.
namespace stereotlm::test {

struct RandomRig {
  calib::Rig rig;  // the truth
  calib::GridShape grid;
  std::vector<Eigen::Isometry3d> poses;  // [position]: from the grid to the left camera
  std::vector<calib::GridPair> pairs;    // [position]: as the detector finds them, with noise
};

// 35 to 130 degrees of view in a row, 320x240 to 1280x960 pixels, cameras 40 to 400 mm apart and turned by up
// to 8 degrees about each axis, 6 to 20 positions of a grid of 5x4 to 11x8 corners. The lenses are barrel
// shaped, and one to one beyond the picture. Both cameras see the whole grid at each position, tilted by 15
// to 40 degrees. They share half of the view or more. A board of 254 candidates can hold the disparities.
// noise_px: standard deviation of each coordinate of each corner.
RandomRig random_rig(std::uint64_t seed, double noise_px);

enum class Fault : std::uint8_t {
  kNone,
  kMoved,             // the grid moves between the two exposures of each pair
  kMovedLittle,       // the same, by 0.5 mm and 0.1 degrees at 550 mm, however few pixels that is
  kSomeMoved,         // it moves in one pair of six
  kLate,              // the left picture of a position has the right one of 1 to 3 positions later or earlier
  kReversed,          // the right pictures are in reverse order
  kOneLostInEach,     // a picture is missing on each side, and the pairs between the two gaps are wrong
  kOneMiscounted,     // in one right picture the detector counts the corners from the next row or column
  kUpsideDown,        // the right camera
  kOppositeQuarters,  // the left picture turned by 90 degrees counter-clockwise, the right one clockwise
  kMirrored,          // the right pictures
  kExchanged,         // left and right
  kRolled,            // the right camera is rolled by a quarter turn
  kVertical,          // one camera stands above the other
  kTurnedFar,         // the cameras look at the grid from far apart
  kFrontal,           // the grid is never tilted, and always at one distance
  kHardlyTilted,      // by 5 degrees at most, always at about one distance
};

struct FaultyRig : RandomRig {
  int width = 0;  // of the pictures, which a quarter turn exchanges
  int height = 0;
  std::vector<std::size_t> bad_pairs;  // those that are wrong among good ones
  int shift = 0;                       // kLate: left position i has right position i + shift
  double moved_px = 0;                 // root mean square shift of the right corners in the pairs that moved
};

// kMoved and kSomeMoved move the grid so far that moved_px is at least 5 * noise_px and 0.5.
FaultyRig faulty_rig(std::uint64_t seed, double noise_px, Fault fault);

// A rig of known lenses: 640x480 pixels, focal length 520, centre (320, 240), k1 -0.2, k2 0.05, the right
// camera 80 mm to the right and not turned, 12 positions of 9x6 corners of 25 mm, and noise of 0.05 pixels.
// The grid moves by 4 mm and 0.8 degrees if at all, by half as much for kMovedLittle.
FaultyRig made_rig(std::uint64_t seed, Fault fault);

}  // namespace stereotlm::test

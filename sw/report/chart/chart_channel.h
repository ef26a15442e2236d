#pragma once

#include <vector>

namespace stereotlm::report {

// An edge in the channel between the banks, on its left, and the ports, on its right. It runs from its bank to
// `track_x`, there up or down, and on to its port.
struct ChannelEdge {
  double bank_y = 0;
  double port_y = 0;
  double width = 0;
  double track_x = 0;  // result of route_channel()
};

// The edges of one port.
struct ChannelNet {
  std::vector<ChannelEdge> edges;
  double play = 0;      // the port's ends may be moved by so much, up or down
  bool spread = false;  // the edges run side by side, else on top of each other
};

// Chooses the tracks, from `left_x` on, so that few edges cross and edges of different ports never run on top
// of each other. Moves the ends at the ports where that helps. Returns the right end of the last track.
double route_channel(std::vector<ChannelNet>& nets, double left_x);

}  // namespace stereotlm::report

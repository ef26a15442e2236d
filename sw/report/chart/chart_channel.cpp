#include "sw/report/chart/chart_channel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

namespace stereotlm::report {
namespace {

constexpr double kBetweenTracks = 10;
constexpr double kBetweenEdges = 1;  // that run side by side
constexpr double kClearance = 6;     // between edges of different ports, where there is room
constexpr double kLeastClearance = 1;
constexpr double kPlayStep = 1.5;
constexpr long kNearCost = 5;  // in crossings
constexpr long kOverlapCost = 1000;

bool is_between(double y, const ChannelEdge& edge) {
  return y > std::min(edge.bank_y, edge.port_y) && y < std::max(edge.bank_y, edge.port_y);
}

bool is_straight(const ChannelEdge& edge) { return edge.bank_y == edge.port_y; }

// Whether the horizontal pieces of the edges, at these heights, would be nearer to each other than that.
bool touch(double y, double width, double other_y, double other_width, double clearance = kClearance) {
  return std::abs(y - other_y) < (width + other_width) / 2 + clearance;
}

// Crossings of two nets if `left` has its tracks to the left of those of `right`. The pieces of `left` to its
// port pass the tracks of `right`, the pieces of `right` to its banks those of `left`.
long cost(const ChannelNet& left, const ChannelNet& right) {
  long sum = 0;
  for (const ChannelEdge& a : left.edges) {
    for (const ChannelEdge& b : right.edges) {
      sum += (is_between(b.bank_y, a) ? 1 : 0) + (is_between(a.port_y, b) ? 1 : 0);
      if (touch(a.port_y, a.width, b.bank_y, b.width)) sum += kNearCost;
      if (touch(a.port_y, a.width, b.bank_y, b.width, kLeastClearance)) sum += kOverlapCost;
    }
  }
  return sum;
}

// Edges of other ports that end at a bank at the height of an end at this net's port, when it is moved by
// `shift`.
int touched(const std::vector<ChannelNet>& nets, const ChannelNet& net, double shift) {
  int count = 0;
  for (const ChannelNet& other : nets) {
    if (&other == &net) continue;
    for (const ChannelEdge& edge : net.edges) {
      for (const ChannelEdge& foreign : other.edges)
        count += touch(edge.port_y + shift, edge.width, foreign.bank_y, foreign.width) ? 1 : 0;
    }
  }
  return count;
}

void move_ends(const std::vector<ChannelNet>& nets, ChannelNet& net) {
  if (net.edges.size() == 1) {
    ChannelEdge& only = net.edges.front();
    const double shift = only.bank_y - only.port_y;
    if (std::abs(shift) <= net.play && touched(nets, net, shift) == 0) {
      only.port_y = only.bank_y;
      return;
    }
  }
  double best = 0;
  int least = touched(nets, net, 0);
  for (double shift = kPlayStep; shift <= net.play && least > 0; shift += kPlayStep) {
    for (const double signed_shift : {shift, -shift}) {
      const int count = touched(nets, net, signed_shift);
      if (count >= least) continue;
      least = count;
      best = signed_shift;
    }
  }
  for (ChannelEdge& edge : net.edges) edge.port_y += best;
}

// The order of the tracks from left to right, and its cost.
struct TrackOrder {
  std::vector<std::size_t> nets;
  long cost = std::numeric_limits<long>::max();
};

TrackOrder best_order(const std::vector<ChannelNet>& nets) {
  std::vector<std::size_t> order(nets.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::vector<long>> costs(nets.size(), std::vector<long>(nets.size()));
  for (std::size_t a = 0; a < nets.size(); ++a) {
    for (std::size_t b = 0; b < nets.size(); ++b) costs[a][b] = cost(nets[a], nets[b]);
  }
  TrackOrder best;
  do {
    long sum = 0;
    for (std::size_t a = 0; a < order.size(); ++a) {
      for (std::size_t b = a + 1; b < order.size(); ++b) sum += costs[order[a]][order[b]];
    }
    if (sum < best.cost) best = {order, sum};
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

// Edges of two ports that each end at the height of the other's bank overlap in every order: moves the ends of
// one port after the other to where the best order costs least. `centred`: the nets before they were moved.
TrackOrder without_overlap(std::vector<ChannelNet>& nets, const std::vector<ChannelNet>& centred,
                           TrackOrder order) {
  for (std::size_t n = 0; n < nets.size(); ++n) {
    ChannelNet best = nets[n];
    for (double shift = -centred[n].play; shift <= centred[n].play; shift += kPlayStep) {
      nets[n] = centred[n];
      for (ChannelEdge& edge : nets[n].edges) edge.port_y += shift;
      TrackOrder found = best_order(nets);
      if (found.cost >= order.cost) continue;
      order = std::move(found);
      best = nets[n];
    }
    nets[n] = best;
  }
  return order;
}

// Places the edges that go up, or those that go down, side by side: the one with the farthest bank has the
// rightmost track, so that they do not cross each other. Returns their width.
double place(std::vector<ChannelEdge*> edges, const ChannelNet& net, double left_x) {
  std::sort(edges.begin(), edges.end(), [](const ChannelEdge* a, const ChannelEdge* b) {
    return std::abs(a->bank_y - a->port_y) < std::abs(b->bank_y - b->port_y);
  });
  double width = 0;
  for (ChannelEdge* edge : edges) {
    if (!net.spread) width = 0;
    edge->track_x = left_x + width + edge->width / 2;
    width += edge->width + kBetweenEdges;
  }
  return width;
}

}  // namespace

double route_channel(std::vector<ChannelNet>& nets, double left_x) {
  const std::vector<ChannelNet> centred = nets;
  for (ChannelNet& net : nets) move_ends(nets, net);
  TrackOrder order = best_order(nets);
  if (order.cost >= kOverlapCost) order = without_overlap(nets, centred, std::move(order));
  for (const std::size_t number : order.nets) {
    ChannelNet& net = nets[number];
    std::vector<ChannelEdge*> up;
    std::vector<ChannelEdge*> down;
    for (ChannelEdge& edge : net.edges) {
      edge.track_x = left_x;
      if (!is_straight(edge)) (edge.bank_y < edge.port_y ? up : down).push_back(&edge);
    }
    const double width = std::max(place(up, net, left_x), place(down, net, left_x));
    if (width > 0) left_x += width + kBetweenTracks;
  }
  return left_x;
}

}  // namespace stereotlm::report

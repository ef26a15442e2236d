#include "sw/report/chart/chart_channel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace stereotlm::report {
namespace {

constexpr double kBetweenTracks = 10;
constexpr double kBetweenEdges = 1;  // that run side by side
constexpr double kClearance = 6;     // between edges of different ports, where there is room
constexpr double kPlayStep = 1.5;
constexpr long kBendCost = 2;  // in crossings: of an edge that does not run straight
constexpr long kNearCost = 5;

bool is_between(double y, const ChannelEdge& edge) {
  return y > std::min(edge.bank_y, edge.port_y) && y < std::max(edge.bank_y, edge.port_y);
}

bool is_straight(const ChannelEdge& edge) { return edge.bank_y == edge.port_y; }

// Whether the horizontal pieces of the edges, at these heights, would be too near to each other.
bool touch(double y, double width, double other_y, double other_width) {
  return std::abs(y - other_y) < (width + other_width) / 2 + kClearance;
}

// Crossings of two nets if `left` has its tracks to the left of those of `right`. The pieces of `left` to its
// port pass the tracks of `right`, the pieces of `right` to its banks those of `left`.
long cost(const ChannelNet& left, const ChannelNet& right) {
  long sum = 0;
  for (const ChannelEdge& a : left.edges) {
    for (const ChannelEdge& b : right.edges) {
      sum += (is_between(b.bank_y, a) ? 1 : 0) + (is_between(a.port_y, b) ? 1 : 0);
      if (touch(a.port_y, a.width, b.bank_y, b.width)) sum += kNearCost;
    }
  }
  return sum;
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
  long bends = 0;
  for (const ChannelNet& net : nets)
    bends += kBendCost * std::count_if(net.edges.begin(), net.edges.end(), std::not_fn(is_straight));
  TrackOrder best;
  do {
    long sum = bends;
    for (std::size_t a = 0; a < order.size(); ++a) {
      for (std::size_t b = a + 1; b < order.size(); ++b) sum += costs[order[a]][order[b]];
    }
    if (sum < best.cost) best = {order, sum};
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

// Moves the ends of one port after the other to where the best order of the tracks costs least: by steps of
// its play, or so that an edge runs straight.
TrackOrder move_ends(std::vector<ChannelNet>& nets) {
  TrackOrder order = best_order(nets);
  for (ChannelNet& net : nets) {
    const ChannelNet centred = net;
    std::vector<double> shifts;
    for (double shift = kPlayStep; shift <= net.play; shift += kPlayStep)
      shifts.insert(shifts.end(), {shift, -shift});
    for (const ChannelEdge& edge : net.edges) {
      if (std::abs(edge.bank_y - edge.port_y) <= net.play) shifts.push_back(edge.bank_y - edge.port_y);
    }
    ChannelNet best = net;
    for (const double shift : shifts) {
      for (std::size_t i = 0; i < net.edges.size(); ++i)
        net.edges[i].port_y = centred.edges[i].port_y + shift;
      TrackOrder found = best_order(nets);
      if (found.cost >= order.cost) continue;
      order = std::move(found);
      best = net;
    }
    net = best;
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
  for (const std::size_t number : move_ends(nets).nets) {
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

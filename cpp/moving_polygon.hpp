// How the vertices and edges of a clipped polygon move; see docs/theory/coupling-tangent.md.
#pragma once
#include "moving_edges.hpp"

namespace abut {

// Of a polygon's edge, p + t (q - p) + t (1 - t) bulge.
struct MovingSide {
  Rows2 p, q, bulge; // without a bulge: none
};

// Follows `Outline`, edge by edge, with rows for its ends and bulges.
class MovingOutline {
public:
  // Edges of `polygon` that lie on an edge of the contactor's piece `mine` count as that edge, whichever they were cut
  // by: the facet's own rim must move with the facet.
  MovingOutline(MovingEdges &edges, const Polygon &polygon, int mine, const Piece &own)
      : edges_(edges), polygon_(polygon) {
    for (int i = 0; i < polygon.size; ++i)
      edge_[i] = edge_of(i, mine, own);
    for (int i = 0; i < polygon.size; ++i)
      vertex_[i] = vertex(i);
    for (int i = 0; i < polygon.size; ++i)
      add_sides(i);
  }

  int size = 0;
  std::array<MovingSide, 3 * MAX_CLIP> side;
  const Rows2 &corner(int i) const { return vertex_[i]; }

private:
  static constexpr double SAME_LINE = 1e-9; // of the edge's length
  static constexpr double PARALLEL = 1e-9;

  Point2 at(int i) const { return polygon_.v[i % polygon_.size].p; }

  static bool on(const Curve &curve, Point2 p) {
    const double t = curve.parameter(p);
    const Point2 off = curve.at(t) - p, chord = curve.b - curve.a;
    return dot2(off, off) <= SAME_LINE * SAME_LINE * dot2(chord, chord);
  }

  MovingEdge edge_of(int i, int mine, const Piece &own) {
    const Vertex &v = polygon_.v[i];
    if (v.side == mine)
      return edges_.edge(v.side, v.edge);
    const MovingEdge theirs = edges_.edge(v.side, v.edge);
    const Point2 p = at(i), q = at(i + 1);
    Point2 middle = 0.5 * (p + q);
    if (v.side >= 0)
      middle = theirs.curve.at(theirs.curve.parameter(middle));
    for (int k = 0; k < own.size; ++k)
      if (on(own.curve[k], p) && on(own.curve[k], q) && on(own.curve[k], middle))
        return edges_.edge(mine, k);
    return theirs;
  }

  // Crossing of the edges before and after it.
  Rows2 vertex(int i) {
    MovingEdge in = edge_[(i + polygon_.size - 1) % polygon_.size], out = edge_[i];
    if (in.a && out.a && in.side == out.side && (in.edge + 1) % edges_.corners(in.side) == out.edge)
      return edges_.corner(in.side, out.edge);
    const Point2 p = at(i);
    // Where polishing found no crossing of the curves, that of the chords stays.
    if (!on(in.curve, p))
      in = in.chord();
    if (!on(out.curve, p))
      out = out.chord();
    const double s = in.a ? in.parameter(p) : 0, t = out.a ? out.parameter(p) : 0;
    const Point2 along = in.a ? in.curve.slope(s) : p - at(i + polygon_.size - 1);
    const Point2 away = out.a ? out.curve.slope(t) : at(i + 1) - p;
    const double det = cross2(along, away);
    const Rows2 row = edges_.take();
    const std::size_t n = edges_.size();
    if (std::abs(det) <= PARALLEL * std::sqrt(dot2(along, along) * dot2(away, away))) {
      in.a ? in.add(n, s, 1, row) : out.add(n, t, 1, row);
      return row;
    }
    // Across each edge the vertex moves as the edge does: theory (T5).
    double *first = edges_.take().x, *second = edges_.take().x;
    in.add_along(n, s, {-along.y, along.x}, 1 / det, first);
    out.add_along(n, t, {-away.y, away.x}, 1 / det, second);
    add_row(n, away.x, first, row.x), add_row(n, -along.x, second, row.x);
    add_row(n, away.y, first, row.y), add_row(n, -along.y, second, row.y);
    return row;
  }

  void add_sides(int i) {
    const Rows2 p = vertex_[i], q = vertex_[(i + 1) % polygon_.size];
    const MovingEdge &edge = edge_[i];
    const Vertex &v = polygon_.v[i];
    const MovingEdge drawn = edges_.edge(v.side, v.edge); // the one that `Outline` takes
    if (!edge.bulge && (v.side < 0 || drawn.curve.straight)) {
      side[size++] = {p, q, {}};
      return;
    }
    const MovingEdge &taken = v.side < 0 || drawn.curve.straight ? edge : drawn;
    const Curve &curve = taken.curve;
    const double t0 = taken.parameter(at(i)), t1 = taken.parameter(at(i + 1)), span = t1 - t0;
    double *first = parameter_rate(edge, curve, t0, at(i), p), *last = parameter_rate(edge, curve, t1, at(i + 1), q);
    const Rows2 bulge = edges_.take();
    const std::size_t n = edges_.size();
    if (edge.bulge)
      add_row(n, span * span, edge.bulge.x, bulge.x), add_row(n, span * span, edge.bulge.y, bulge.y);
    for (const auto &[rate, sign] : {std::pair{last, 1.0}, std::pair{first, -1.0}}) {
      add_row(n, sign * 2 * span * curve.bulge.x, rate, bulge.x);
      add_row(n, sign * 2 * span * curve.bulge.y, rate, bulge.y);
    }
    const double off = 1e-24 * dot2(curve.b - curve.a, curve.b - curve.a);
    const bool curved = v.side >= 0 && !drawn.curve.straight;
    const bool before = curved && distance(curve.at(t0), at(i)) > off;
    const bool after = curved && distance(curve.at(t1), at(i + 1)) > off;
    const Rows2 begin = before ? place(edge, curve, t0, first) : p, end = after ? place(edge, curve, t1, last) : q;
    if (before)
      side[size++] = {p, begin, {}};
    side[size++] = {begin, end, bulge};
    if (after)
      side[size++] = {end, q, {}};
  }

  static double distance(Point2 a, Point2 b) { return dot2(a - b, a - b); }

  // Of the parameter t of the curve's point nearest to p: (c(t) - p) . c'(t) = 0.
  double *parameter_rate(const MovingEdge &edge, const Curve &curve, double t, Point2 p, const Rows2 &moving) {
    double *row = edges_.take().x;
    const std::size_t n = edges_.size();
    const Point2 slope = curve.slope(t), off = curve.at(t) - p;
    const double by_t = dot2(slope, slope) - 2 * dot2(off, curve.bulge);
    if (by_t == 0) // an edge without length
      return row;
    add_row(n, slope.x / by_t, moving.x, row), add_row(n, slope.y / by_t, moving.y, row);
    edge.add_along(n, t, slope, -1 / by_t, row);
    if (!edge.a)
      return row;
    add_row(n, off.x / by_t, edge.a.x, row), add_row(n, off.y / by_t, edge.a.y, row);
    add_row(n, -off.x / by_t, edge.b.x, row), add_row(n, -off.y / by_t, edge.b.y, row);
    if (edge.bulge) {
      add_row(n, -(1 - 2 * t) * off.x / by_t, edge.bulge.x, row);
      add_row(n, -(1 - 2 * t) * off.y / by_t, edge.bulge.y, row);
    }
    return row;
  }

  Rows2 place(const MovingEdge &edge, const Curve &curve, double t, const double *rate) {
    const Rows2 row = edges_.take();
    const Point2 slope = curve.slope(t);
    edge.add(edges_.size(), t, 1, row);
    add_row(edges_.size(), slope.x, rate, row.x), add_row(edges_.size(), slope.y, rate, row.y);
    return row;
  }

  MovingEdges &edges_;
  const Polygon &polygon_;
  std::array<MovingEdge, MAX_CLIP> edge_;
  std::array<Rows2, MAX_CLIP> vertex_;
};

} // namespace abut

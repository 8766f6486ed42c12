// What of a segment lies behind another one: theory (S12).
#pragma once
#include "clip.hpp"
#include "segments.hpp"

namespace abut {

constexpr double TOUCHING = 1e-12; // of the contactor facet: common parts below are none
constexpr double EDGE_ON = 0.1;    // cosine of normals: facets that the contactor sees nearly edge-on do not face it
constexpr int MANY_CORNERS = 12;   // polygons with more are halved before they are cut again

// What a segment is for: contact, or only to hide others: those of the same pair seen the other way round hide all that
// is behind, the far side of the contactor's own body what is seen through it.
enum class Role : std::uint8_t { counts, hides, through };

// An interval of a contactor line, or a polygon in a contactor facet's mean plane, that sees one target facet.
struct Segment {
  int target;
  Role role = Role::counts;
  double begin = 0, end = 0; // 2D
  Polygon polygon, finished; // 3D: uncut by others, its vertices on the chords, and where the curves cross
  int mine = 0, theirs = 0;  // 3D: the two pieces
  double xi[2], eta[2];      // where the integration begins to look
  double x[3], n[3], gap;    // in the middle: place and normal on the contactor, and how far away the target is
  std::vector<int> behind;   // segments that lie nearer
};

// Facets that share a node do not hide each other.
inline bool adjacent(const std::int32_t *a, const std::int32_t *b) {
  for (int i = 0; i < MAX_FACET_NODES && a[i] >= 0; ++i)
    for (int j = 0; j < MAX_FACET_NODES && b[j] >= 0; ++j)
      if (a[i] == b[j])
        return true;
  return false;
}

// Writes down which segments lie behind which: of two with a common part, whichever is farther off in its middle.
// `common(a, b, p)` gives the middle p of the common part of two segments, false where there is none; `gap(a, p)` that
// of segment a there.
template <class P, class Common, class Gap>
void find_hidden(std::vector<Segment> &segments, const std::int32_t *nodes, Common common, Gap gap) {
  for (std::size_t i = 0; i < segments.size(); ++i)
    for (std::size_t j = i + 1; j < segments.size(); ++j) {
      Segment &a = segments[i], &b = segments[j];
      P p;
      if (a.target == b.target || !common(a, b, p) ||
          adjacent(nodes + MAX_FACET_NODES * a.target, nodes + MAX_FACET_NODES * b.target))
        continue;
      const double gap_a = gap(a, p), gap_b = gap(b, p);
      const bool second = std::abs(gap_b) < std::abs(gap_a);
      if ((second ? b : a).role == Role::through && std::signbit(gap_a) != std::signbit(gap_b))
        continue;
      if (second)
        a.behind.push_back(int(j));
      else
        b.behind.push_back(int(i));
    }
}

// The parts of an interval outside of others.
inline std::vector<std::array<double, 2>> outside_of(std::array<double, 2> whole,
                                                     const std::vector<std::array<double, 2>> &others) {
  std::vector<std::array<double, 2>> left{whole}, next;
  for (const auto &other : others) {
    next.clear();
    for (const auto &part : left) {
      if (other[0] - part[0] > TOUCHING)
        next.push_back({part[0], std::min(part[1], other[0])});
      if (part[1] - other[1] > TOUCHING)
        next.push_back({std::max(part[0], other[1]), part[1]});
    }
    left.swap(next);
  }
  return left;
}

// Where an edge along a piece's chord goes on beyond the chord's ends, it becomes a straight cut.
inline Polygon only_on_chord(const Polygon &polygon, int side, int edge, Point2 a, Point2 b) {
  Polygon next;
  const double length = dot2(b - a, b - a);
  for (int i = 0; i < polygon.size; ++i) {
    const Vertex &v = polygon.v[i];
    if (v.side != side || v.edge != edge) {
      next.push(v);
      continue;
    }
    const Point2 p = v.p, q = polygon.v[(i + 1) % polygon.size].p;
    const double from = dot2(p - a, b - a) / length, to = dot2(q - a, b - a) / length;
    const double first = to > from ? 0 : 1, last = 1 - first, way = to > from ? 1 : -1;
    // In the direction of travel: before the chord, on it, beyond it.
    const bool before = way * (first - from) > TOUCHING, beyond = way * (to - last) > TOUCHING;
    const bool on = std::min(way * to, way * last) - std::max(way * from, way * first) > TOUCHING;
    if (!on) {
      next.push({p, along_chord(side), edge});
      continue;
    }
    if (before)
      next.push({p, along_chord(side), edge});
    next.push({before ? (first == 0 ? a : b) : p, side, edge});
    if (beyond)
      next.push({last == 1 ? b : a, along_chord(side), edge});
  }
  return next;
}

inline void halve(const Polygon &polygon, std::vector<Polygon> &out) {
  Polygon half[2];
  const int middle = polygon.size / 2;
  for (int i = 0; i <= middle; ++i)
    half[0].push(polygon.v[i]);
  for (int i = middle; i <= polygon.size; ++i)
    half[1].push(polygon.v[i % polygon.size]);
  for (Polygon &own : half) {
    own.v[own.size - 1].side = STRAIGHT;
    out.push_back(own);
  }
}

// The convex parts of a convex polygon outside of a piece, number `side`.
inline void outside_of(const Polygon &polygon, const Piece &piece, int side, double least, std::vector<Polygon> &out) {
  if (polygon.size > MANY_CORNERS) {
    std::vector<Polygon> halves;
    halve(polygon, halves);
    for (const Polygon &half : halves)
      outside_of(half, piece, side, least, out);
    return;
  }
  auto area = [](const Polygon &p) {
    Point2 corner[MAX_CLIP];
    for (int i = 0; i < p.size; ++i)
      corner[i] = p.v[i].p;
    return p.size < 3 ? 0.0 : signed_area(corner, p.size);
  };
  Polygon rest = polygon;
  for (int j = 0; j < piece.size && area(rest) > least; ++j) {
    const Point2 a = piece.p[j], b = piece.p[(j + 1) % piece.size];
    const bool straight = piece.curve[j].straight;
    Polygon part = clip_line(rest, b, a, side, j);
    rest = clip_line(rest, a, b, side, j);
    if (!straight)
      part = only_on_chord(part, side, j, a, b), rest = only_on_chord(rest, side, j, a, b);
    if (area(part) > least)
      out.push_back(part);
  }
}

} // namespace abut

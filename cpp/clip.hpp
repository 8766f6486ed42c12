// Plane polygons with straight or parabolic edges: clipping, and integration over the result.
#pragma once
#include <array>
#include <cmath>
#include <vector>

namespace abut {

struct Point2 {
  double x, y;
};
inline Point2 operator+(Point2 a, Point2 b) { return {a.x + b.x, a.y + b.y}; }
inline Point2 operator-(Point2 a, Point2 b) { return {a.x - b.x, a.y - b.y}; }
inline Point2 operator*(double s, Point2 a) { return {s * a.x, s * a.y}; }
inline double cross2(Point2 a, Point2 b) { return a.x * b.y - a.y * b.x; }
inline double dot2(Point2 a, Point2 b) { return a.x * b.x + a.y * b.y; }

// The curve a + t (b - a) + t (1 - t) bulge, t in [0, 1]; straight when the bulge is zero: theory (S6).
struct Curve {
  Point2 a, b, bulge;
  bool straight;
  Point2 at(double t) const { return a + t * (b - a) + (t * (1 - t)) * bulge; }
  Point2 slope(double t) const { return (b - a) + (1 - 2 * t) * bulge; }
  // Parameter of the curve's point nearest to p.
  double parameter(Point2 p) const {
    const Point2 chord = b - a;
    double t = dot2(p - a, chord) / dot2(chord, chord);
    for (int i = 0; i < 4 && !straight; ++i) {
      const Point2 s = slope(t);
      const double step = dot2(at(t) - p, s) / dot2(s, s);
      t -= step;
      if (std::abs(step) < 1e-16)
        break;
    }
    return t;
  }
};

constexpr int MAX_CLIP = 24; // vertices of a clipped polygon: a quadrilateral cut by four lines has at most eight
constexpr int STRAIGHT = -1; // side of an edge that belongs to no piece: a straight cut
// Side of a straight cut along the chord of an edge of piece `side`, and back.
constexpr int along_chord(int side) { return -2 - side; }

// A vertex and the edge that leaves it: `side` the piece that the edge belongs to, `edge` its number there.
struct Vertex {
  Point2 p;
  int side, edge;
};

struct Polygon {
  int size = 0;
  std::array<Vertex, MAX_CLIP> v;
  void push(const Vertex &w) {
    if (size < MAX_CLIP)
      v[size++] = w;
  }
  Point2 middle() const {
    Point2 mean{0, 0};
    for (int i = 0; i < size; ++i)
      mean = mean + (1.0 / size) * v[i].p;
    return mean;
  }
};

inline double signed_area(const Point2 *p, int n) {
  double sum = 0;
  for (int i = 1; i + 1 < n; ++i)
    sum += cross2(p[i] - p[0], p[i + 1] - p[0]);
  return 0.5 * sum;
}

inline bool convex(const Point2 *p, int n) {
  for (int i = 0; i < n; ++i)
    if (cross2(p[(i + 1) % n] - p[i], p[(i + 2) % n] - p[(i + 1) % n]) < 0)
      return false;
  return true;
}

constexpr double ON_LINE = 1e-12; // of an edge's length, some roundings: what is nearer to its line lies on it

// Part of a convex polygon on the left of the line from a to b; the edge along it is `edge` of `side`
// (Sutherland-Hodgman, with the origin of each edge kept). An edge of the polygon on the line stays that edge: rounding
// must not decide which of two curves with a common chord bounds the part.
inline Polygon clip_line(const Polygon &polygon, Point2 a, Point2 b, int side, int edge) {
  const Point2 along = b - a;
  const double least = ON_LINE * dot2(along, along);
  auto side_of = [&](Point2 p) {
    const double d = cross2(along, p - a);
    return std::abs(d) <= least ? 0.0 : d;
  };
  Polygon next;
  for (int i = 0; i < polygon.size; ++i) {
    const Vertex &p = polygon.v[i], &q = polygon.v[(i + 1) % polygon.size];
    const double dp = side_of(p.p), dq = side_of(q.p);
    if (dp >= 0)
      next.push(p);
    if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) {
      const Point2 at = p.p + (dp / (dp - dq)) * (q.p - p.p);
      next.push(dp > 0 ? Vertex{at, side, edge} : Vertex{at, p.side, p.edge});
    } else if (dp == 0 && dq < 0) {
      next.v[next.size - 1].side = side, next.v[next.size - 1].edge = edge;
    }
  }
  return next;
}

// Part of `subject` on the left of every edge of the counter-clockwise convex polygon `clip`, which is piece `side`.
inline Polygon clip_convex(const Polygon &subject, const Point2 *clip, int count, int side) {
  Polygon current = subject;
  for (int j = 0; j < count && current.size > 2; ++j)
    current = clip_line(current, clip[j], clip[(j + 1) % count], side, j);
  return current;
}

// Moves a vertex where two curves cross to their true intersection, theory (S8), starting from that of the chords.
// Where Newton finds none nearby the chords' stays: both neighbours of either curve then see the same vertex, whichever
// curve comes first.
inline void polish(const Curve &c, const Curve &d, Point2 &p) {
  double s = c.parameter(p), t = d.parameter(p);
  for (int i = 0; i < 12; ++i) {
    const Point2 f = c.at(s) - d.at(t), cs = c.slope(s), dt = d.slope(t);
    const double det = -cross2(cs, dt);
    if (std::abs(det) < 1e-12 * std::sqrt(dot2(cs, cs) * dot2(dt, dt)))
      return; // nearly parallel
    const double ds = (-f.x * -dt.y + f.y * -dt.x) / det;
    const double step = (cs.x * -f.y + cs.y * f.x) / det;
    s += ds, t += step;
    if (!(s > -0.5 && s < 1.5 && t > -0.5 && t < 1.5))
      return;
    if (std::abs(ds) + std::abs(step) < 1e-9) { // quadratic convergence: the next step would be rounding
      p = c.at(s);
      return;
    }
  }
}

// One-dimensional rules on [0, 1]: `t` along an edge, `r` from the apex with the weight r included.
struct Rule {
  int n;
  const double *t, *wt, *r, *wr;
};

// An edge of a polygon: p + t (q - p) + t (1 - t) bulge.
struct Edge {
  Point2 p, q, bulge;
  Point2 at(double t) const { return p + t * (q - p) + (t * (1 - t)) * bulge; }
  Point2 slope(double t) const { return (q - p) + (1 - 2 * t) * bulge; }
};

// The edges of a polygon: theory (S9). A vertex that is not on its curve (see `polish`) is linked to it by a straight
// edge: only a closed boundary has an area that does not depend on the apex, and neighbours share links.
struct Outline {
  int size = 0;
  bool straight = true;
  std::array<Edge, 3 * MAX_CLIP> edge;

  template <class CurveOf> Outline(const Polygon &polygon, CurveOf curve_of) {
    for (int i = 0; i < polygon.size; ++i) {
      const Point2 p = polygon.v[i].p, q = polygon.v[i + 1 < polygon.size ? i + 1 : 0].p;
      const Curve *curve = curve_of(polygon.v[i]);
      if (!curve || curve->straight) {
        edge[size++] = {p, q, {0, 0}};
        continue;
      }
      straight = false;
      const double t0 = curve->parameter(p), t1 = curve->parameter(q);
      const Point2 first = curve->at(t0), last = curve->at(t1);
      const double off = 1e-24 * dot2(curve->b - curve->a, curve->b - curve->a);
      const bool before = dot2(first - p, first - p) > off, after = dot2(q - last, q - last) > off;
      if (before)
        edge[size++] = {p, first, {0, 0}};
      edge[size++] = {before ? first : p, after ? last : q, ((t1 - t0) * (t1 - t0)) * curve->bulge};
      if (after)
        edge[size++] = {last, q, {0, 0}};
    }
  }
};

// Calls visit(point, weight) for a rule on every triangle between an apex and an edge: theory (S9), (Q1). Polygons with
// curved edges take the mean of their vertices, or, with `fan`, as straight ones their first vertex: half as many
// triangles, but maps of higher degree, as the bulges of both edges there are blended into the first triangle and the
// last.
template <class CurveOf, class Visit>
void integrate_polygon(const Polygon &polygon, CurveOf curve_of, const Rule &rule, bool fan, Visit visit) {
  const Outline outline(polygon, curve_of);
  Point2 apex = polygon.v[0].p;
  const Point2 none{0, 0};
  const bool around = !fan && !outline.straight;
  if (around)
    apex = polygon.middle();
  for (int i = around ? 0 : 1; i + (around ? 0 : 1) < outline.size; ++i) {
    const Edge &edge = outline.edge[i];
    const Point2 first = !around && i == 1 ? outline.edge[0].bulge : none;
    const Point2 last = !around && i + 2 == outline.size ? outline.edge[i + 1].bulge : none;
    for (int k = 0; k < rule.n; ++k) {
      const double t = rule.t[k];
      const Point2 on = edge.at(t) - apex, along = edge.slope(t), bulge = (1 - t) * first + t * last;
      for (int m = 0; m < rule.n; ++m) {
        const double r = rule.r[m];
        const double jacobian = cross2(on + (1 - 2 * r) * bulge, along + (1 - r) * (last - first));
        visit(apex + r * (on + (1 - r) * bulge), jacobian * rule.wt[k] * rule.wr[m]);
      }
    }
  }
}

} // namespace abut

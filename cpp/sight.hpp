// Where a contactor's sight of a target ends: theory (S17) to (S19).
#pragma once
#include "hidden.hpp"
#include "project.hpp"

namespace abut {

// Whether the normals of a facet in space, which lead from xi to a gap, do not meet before, theory (S17): beyond where
// they do a target is seen upside down, more than once. (In 2D its interval runs backwards then, and is none.)
inline bool before_focus(const Facet &c, const double *xi, double gap) {
  double x[3], m[3], dx[2][3], dm[2][3], e[2][3], flat[2][2], turn[2][2];
  c.position.at(xi, x, dx), c.direction.at(xi, m, dm);
  const double size = std::sqrt(dot(m, m, 3)), way = dot(dx[0], m, 3) / (size * size);
  for (int a = 0; a < 3; ++a)
    e[0][a] = dx[0][a] - way * m[a];
  normalize(m, 3), normalize(e[0], 3), cross(m, e[0], e[1]);
  for (int k = 0; k < 2; ++k) // slopes square to the normal, which turns by dm / size
    for (int a = 0; a < 2; ++a)
      flat[k][a] = dot(dx[k], e[a], 3), turn[k][a] = gap * dot(dm[k], e[a], 3) / size;
  const double area = flat[0][0] * flat[1][1] - flat[0][1] * flat[1][0];
  const double mixed =
      turn[0][0] * flat[1][1] - turn[0][1] * flat[1][0] + flat[0][0] * turn[1][1] - flat[0][1] * turn[1][0];
  const double there = area + mixed + turn[0][0] * turn[1][1] - turn[0][1] * turn[1][0];
  return area * there > 0 && area * (2 * area + mixed) > 0; // neither curvature has come to its centre
}

// The line along which a plane cuts a facet, between its corners: from a to b in the plane's frame. `heights` of the
// corners over the plane, `flat` the corners in it.
inline bool cut_by_plane(const double *heights, const Point2 *flat, int corners, Point2 &a, Point2 &b) {
  int found = 0;
  for (int i = 0; i < corners; ++i) {
    const int next = (i + 1) % corners;
    if ((heights[i] < 0) == (heights[next] < 0))
      continue;
    const Point2 at = flat[i] + heights[i] / (heights[i] - heights[next]) * (flat[next] - flat[i]);
    (found++ ? b : a) = at;
  }
  return found >= 2;
}

// The point of the line from a to b that is nearest to p.
inline Point2 nearest_on(Point2 a, Point2 b, Point2 p) {
  const Point2 way = b - a, to = p - a;
  const double length = dot2(way, way);
  return a + (length > 0 ? std::clamp(dot2(to, way) / length, 0.0, 1.0) : 0.0) * way;
}

// Normal of a facet in its middle, out of its body.
inline void middle_normal(const Facet &t, double *n) {
  double xi[2], x[3], slope[2][3];
  t.centre(xi), t.position.at(xi, x, slope);
  if (t.dim == 2)
    n[0] = slope[0][1], n[1] = -slope[0][0];
  else
    cross(slope[0], slope[1], n);
  normalize(n, t.dim);
}

// A piece of the contactor: the plane (in 2D the line) that touches it in its middle, and its corners there.
struct Touching {
  int dim, corners = 0;
  double x[3], n[3], e1[3], e2[3]; // in 2D without e2
  Point2 p[MAX_CLIP];

  Touching(int d, const double *at, const double *normal) : dim(d) {
    std::copy(at, at + d, x), std::copy(normal, normal + d, n);
    if (d == 3)
      frame(n, e1, e2);
    else
      e1[0] = -n[1], e1[1] = n[0];
  }
  Point2 flat(const double *v) const {
    const double d[3] = {v[0] - x[0], v[1] - x[1], dim == 3 ? v[2] - x[2] : 0};
    return {dot(d, e1, dim), dim == 3 ? dot(d, e2, 3) : 0};
  }
  double height(const double *v) const {
    const double d[3] = {v[0] - x[0], v[1] - x[1], dim == 3 ? v[2] - x[2] : 0};
    return dot(d, n, dim);
  }
  void add(const double *v) {
    if (corners < MAX_CLIP)
      p[corners++] = flat(v);
  }

  // Whether a facet of the target, which lies `depth` behind the piece, shows that it is seen through the target's
  // body: theory (S18).
  bool shows_through(const Facet &t, const double *its, double depth) const {
    const double facing = dot(its, n, dim);
    if (facing < -EDGE_ON)
      return false;
    const int many = CORNERS[t.kind];
    double heights[4];
    Point2 corner[4];
    for (int i = 0; i < many; ++i)
      heights[i] = height(t.x[i]), corner[i] = flat(t.x[i]);
    return (facing > 0 && comes_in_by(corner, heights, many, depth)) || leaves_by(corner, heights, many, its, depth);
  }

private:
  // Whether the line from the middle to what is seen comes into the target's body by a facet, so begins outside of it.
  bool comes_in_by(const Point2 *corner, const double *heights, int many, double depth) const {
    if (dim == 2) {
      if ((corner[0].x < 0) == (corner[1].x < 0))
        return false;
      const double share = corner[0].x / (corner[0].x - corner[1].x);
      const double at = heights[0] + share * (heights[1] - heights[0]);
      return at < 0 && at > -depth;
    }
    for (int i = 1; i + 1 < many; ++i) {
      const Point2 a = corner[0], b = corner[i], c = corner[i + 1];
      const double whole = cross2(b - a, c - a), second = cross2(c, a) / whole, third = cross2(a, b) / whole;
      const double first = 1 - second - third, at = first * heights[0] + second * heights[i] + third * heights[i + 1];
      if (first >= 0 && second >= 0 && third >= 0 && at < 0 && at > -depth)
        return true;
    }
    return false;
  }

  // Whether all of the piece is nearer than `depth`, along its plane, to where that leaves the target's body by a
  // facet.
  bool leaves_by(const Point2 *corner, const double *heights, int many, const double *its, double depth) const {
    Point2 a, b;
    if (!cut_by_plane(heights, corner, many, a, b))
      return false;
    const Point2 out = nearest_on(a, b, {0, 0}), along{dot(its, e1, dim), dim == 3 ? dot(its, e2, 3) : 0};
    if (!(dot2(along, out) > 0)) // there it comes in
      return false;
    for (int i = 0; i < corners; ++i) {
      const Point2 way = nearest_on(a, b, p[i]) - p[i];
      if (!(std::hypot(way.x, way.y) < depth))
        return false;
    }
    return true;
  }
};

} // namespace abut

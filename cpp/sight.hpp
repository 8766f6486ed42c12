// Where a contactor's sight of a target ends: theory (S17), (S18).
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

inline double distance2(const double *x, const double *y, int dim) {
  double sum = 0;
  for (int a = 0; a < dim; ++a)
    sum += (x[a] - y[a]) * (x[a] - y[a]);
  return sum;
}

// Square of the distance from x to the line from a to b.
inline double distance2_to_line(const double *x, const double *a, const double *b, int dim) {
  double along = 0, length = 0, foot[3];
  for (int k = 0; k < dim; ++k)
    along += (x[k] - a[k]) * (b[k] - a[k]), length += (b[k] - a[k]) * (b[k] - a[k]);
  const double share = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0;
  for (int k = 0; k < dim; ++k)
    foot[k] = a[k] + share * (b[k] - a[k]);
  return distance2(x, foot, dim);
}

// The same to a triangle.
inline double distance2_to_triangle(const double *x, const double *a, const double *b, const double *c) {
  const double *corner[3] = {a, b, c};
  double u[3], v[3], n[3], to[3];
  for (int k = 0; k < 3; ++k)
    u[k] = b[k] - a[k], v[k] = c[k] - a[k], to[k] = x[k] - a[k];
  cross(u, v, n);
  bool over = dot(n, n, 3) > 0;
  double least = HUGE_VAL;
  for (int i = 0; i < 3; ++i) {
    const double *from = corner[i], *until = corner[(i + 1) % 3];
    double edge[3], way[3], out[3];
    for (int k = 0; k < 3; ++k)
      edge[k] = until[k] - from[k], way[k] = x[k] - from[k];
    cross(n, edge, out);
    over = over && dot(out, way, 3) >= 0;
    least = std::min(least, distance2_to_line(x, from, until, 3));
  }
  const double height = dot(to, n, 3);
  return over ? height * height / dot(n, n, 3) : least;
}

// The same to a facet, between its corners.
inline double distance2_to_facet(const double *x, const Facet &t) {
  if (t.dim == 2)
    return distance2_to_line(x, t.x[0], t.x[1], 2);
  const double first = distance2_to_triangle(x, t.x[0], t.x[1], t.x[2]);
  return t.triangle() ? first : std::min(first, distance2_to_triangle(x, t.x[0], t.x[2], t.x[3]));
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

// Whether a point x of the contactor with normal n, at a depth in the target, is seen through it: a side of the target
// that it sees edge-on or from behind is nearer than a fifth of that, and is where it has come in.
inline bool comes_in_by(const Facet &side, const double *x, const double *n, double depth) {
  constexpr double nearer = 0.2,
                   level = 0.7; // of the depth; cosine of normals from which on sides are opposite each other
  double its[3];
  middle_normal(side, its);
  const double facing = dot(its, n, side.dim);
  return facing >= -EDGE_ON && facing <= level && distance2_to_facet(x, side) < nearer * nearer * depth * depth;
}

} // namespace abut

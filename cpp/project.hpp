// One facet in space and its projections: position and tangents, inverse map along a direction.
#pragma once
#include "polynomial.hpp"
#include <algorithm>
#include <cmath>

namespace abut {

template <class T> T dot(const T *a, const T *b, int dim) {
  T sum = a[0] * b[0] + a[1] * b[1];
  return dim == 3 ? sum + a[2] * b[2] : sum;
}
template <class T> void cross(const T *a, const T *b, T *c) {
  c[0] = a[1] * b[2] - a[2] * b[1], c[1] = a[2] * b[0] - a[0] * b[2], c[2] = a[0] * b[1] - a[1] * b[0];
}
template <class T> void normalize(T *a, int dim) {
  const T length = std::sqrt(dot(a, a, dim));
  for (int i = 0; i < dim; ++i)
    a[i] /= length;
}
// Two unit vectors that complete the unit vector n to a right-handed frame (t1, t2, n).
template <class T> void frame(const T *n, T *t1, T *t2) {
  int least = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(n[i]) < std::abs(n[least]))
      least = i;
  T axis[3] = {0, 0, 0};
  axis[least] = 1;
  cross(axis, n, t1);
  normalize(t1, 3);
  cross(n, t1, t2);
}

// Coordinates of one facet; `normals` (contactor only) are unit nodal normals, outward. In 2D third components are 0.
struct Facet {
  int kind, dim, nodes;
  double x[MAX_FACET_NODES][3], normals[MAX_FACET_NODES][3];
  Polynomial<3> position, direction; // of x and normals
  bool affine = false;               // the map from the reference domain is affine: one Newton step inverts it
  double bend = 0;                   // a Newton step of size s leaves an error below bend s^2: see `bend_of`
  const double *bulge = nullptr;     // at the nodes of the `QUADRATIC` type, or none: theory (S14)

  void values(const double *xi, double *n) const { facet_values(kind, xi, n); }

  // The continuous normal of theory (S1).
  void normal(const double *xi, double *n) const {
    direction.at(xi, n);
    normalize(n, dim);
  }

  // How far the smooth surface lies outside of the facet.
  double bulge_at(const double *xi) const {
    if (!bulge)
      return 0;
    double n[MAX_FACET_NODES], sum = 0;
    facet_values(QUADRATIC[kind], xi, n);
    for (int i = CORNERS[kind]; i < NODES[QUADRATIC[kind]]; ++i)
      sum += bulge[i] * n[i];
    return sum;
  }

  bool triangle() const { return kind == TRI3 || kind == TRI6; }
  // Reference coordinates of the middle.
  void centre(double *xi) const { xi[0] = xi[1] = triangle() ? 1.0 / 3 : 0; }
  // A near point of the reference domain, `slack` wider: componentwise, in triangles' area coordinates, so that the
  // answer does not depend on which corner comes first. True where the point lay outside.
  bool clamp(double *xi, double slack = 0) const {
    if (triangle()) {
      double l[3] = {1 - xi[0] - xi[1] + slack, xi[0] + slack, xi[1] + slack};
      if (l[0] >= 0 && l[1] >= 0 && l[2] >= 0)
        return false;
      double sum = 0;
      for (double &value : l)
        value = std::max(value, 0.0), sum += value;
      for (int a = 0; a < 2; ++a)
        xi[a] = l[a + 1] * (1 + 3 * slack) / sum - slack;
      return true;
    }
    bool outside = false;
    for (int a = 0; a < dim - 1; ++a) {
      const double inside = std::min(std::max(xi[a], -1 - slack), 1 + slack);
      outside = outside || inside != xi[a];
      xi[a] = inside;
    }
    return outside;
  }
};

// Points of which everything interpolated over a facet is a mean with weights that are not negative: the Bezier points
// of its polynomial.
struct Hull {
  int size;
  double x[MAX_FACET_NODES][3];

  Hull() = default;
  Hull(const Facet &f, const double (*values)[3])
      : size(quadratic(f.kind) && !f.triangle() && f.dim == 3 ? 9 : f.nodes) {
    const int corners = CORNERS[f.kind];
    for (int a = 0; a < 3; ++a) {
      double sum = 0, middles = 0;
      for (int i = 0; i < corners; ++i)
        x[i][a] = values[i][a], sum += values[i][a];
      for (int i = corners; i < std::min(f.nodes, 2 * corners); ++i) {
        const int end = f.dim == 2 ? 1 : (i + 1) % corners;
        x[i][a] = 2 * values[i][a] - 0.5 * (values[i - corners][a] + values[end][a]), middles += values[i][a];
      }
      if (size == 9)
        x[8][a] = f.nodes == 9 ? 4 * values[8][a] - middles + 0.25 * sum : middles - 0.75 * sum;
    }
  }
};

// A point of a facet with its place and its slopes, from which the search for the next one starts.
template <int W> struct Spot {
  double xi[2], x[W], slope[2][W];
  bool known = false; // whether x and slope are those at xi
  void begin(const double *at) { xi[0] = at[0], xi[1] = at[1], known = false; }
};

constexpr double SAME_PLACE = 1e-12; // of the reference domain: Newton is done

// Newton's method on a facet from `at`; step(x, slope, s) is one step s from a point. Returns false where it does not
// converge within a domain wider by 1.
template <int W, class Step> bool newton(const Facet &facet, const Polynomial<W> &map, Spot<W> &at, Step step) {
  for (int iteration = 0; iteration < 25; ++iteration) {
    const bool old = at.known; // slopes of a point near by
    at.known = false;
    if (!old)
      map.at(at.xi, at.x, at.slope);
    double s[2];
    if (!step(at.x, at.slope, s))
      return false;
    const double before[2] = {at.xi[0], at.xi[1]};
    at.xi[0] -= s[0], at.xi[1] -= s[1];
    if (facet.clamp(at.xi, 1)) {
      if (facet.affine || std::abs(at.xi[0] - before[0]) + std::abs(at.xi[1] - before[1]) < 1e-9)
        return false;
      continue;
    }
    const double size = std::abs(s[0]) + std::abs(s[1]);
    if (facet.affine || size < SAME_PLACE || (!old && facet.bend * size * size < SAME_PLACE)) {
      map.at(at.xi, at.x);
      at.known = true;
      return true;
    }
  }
  return false;
}

// Finds the point of the facet seen from `from` along n (3D), of any length.
inline bool project(const Facet &facet, const double *from, const double *n, Spot<3> &at) {
  return newton(facet, facet.position, at, [&](const double *x, const double (*slope)[3], double *s) {
    const double d[3] = {x[0] - from[0], x[1] - from[1], x[2] - from[2]};
    double p[3], q[3];
    cross(slope[1], n, p), cross(n, slope[0], q);
    const double det = dot(slope[0], p, 3);
    s[0] = dot(d, p, 3) / det, s[1] = dot(d, q, 3) / det;
    return det != 0;
  });
}

// Finds the point of the line seen from `from` perpendicular to `along` (2D).
inline bool project_line(const Facet &facet, const double *from, const double *along, Spot<3> &at) {
  return newton(facet, facet.position, at, [&](const double *x, const double (*slope)[3], double *s) {
    const double d[2] = {x[0] - from[0], x[1] - from[1]}, rate = dot(slope[0], along, 2);
    s[0] = dot(d, along, 2) / rate, s[1] = 0;
    return rate != 0;
  });
}

// Half the largest second derivative over the slopes at the origin, eight times that for directions up to 60 degrees
// off the normal and slopes that change fourfold over the facet.
inline double bend_of(const Facet &f) {
  const auto &c = f.position.c;
  auto size = [&](int m) { return m < f.position.terms ? std::sqrt(dot(c[m], c[m], 3)) : 0.0; };
  const double second = std::max({2 * (size(4) + size(6) + size(8)), 2 * (size(5) + size(7) + size(8)),
                                  size(3) + 2 * size(6) + 2 * size(7) + 4 * size(8)});
  if (f.dim == 2)
    return 4 * second / size(1);
  double area[3];
  cross(c[1], c[2], area);
  return 4 * second * (size(1) + size(2)) / std::sqrt(dot(area, area, 3));
}

// Is the map from the reference domain affine: every node where the first corners put it?
inline bool is_affine(const Facet &f) {
  double origin[3], edge[2][3], size = 0; // x = origin + sum of edges times reference coordinates
  const double scale = f.dim == 2 || !f.triangle() ? 0.5 : 1.0;
  for (int a = 0; a < f.dim; ++a) {
    edge[0][a] = scale * (f.x[1][a] - f.x[0][a]);
    edge[1][a] = f.dim == 2 ? 0.0 : scale * (f.triangle() ? f.x[2][a] - f.x[0][a] : f.x[3][a] - f.x[0][a]);
    origin[a] = f.triangle() ? f.x[0][a] : f.x[0][a] + edge[0][a] + edge[1][a];
    size = std::max({size, std::abs(edge[0][a]), std::abs(edge[1][a])});
  }
  static constexpr double line[3] = {-1, 1, 0};
  static constexpr double triangle[6][2] = {{0, 0}, {1, 0}, {0, 1}, {.5, 0}, {.5, .5}, {0, .5}};
  for (int i = 0; i < f.nodes; ++i)
    for (int a = 0; a < f.dim; ++a) {
      double x = origin[a];
      if (f.dim == 2)
        x += line[i] * edge[0][a];
      else if (f.triangle())
        x += triangle[i][0] * edge[0][a] + triangle[i][1] * edge[1][a];
      else if (i < 8)
        x += detail::QUAD_SIGN[i][0] * edge[0][a] + detail::QUAD_SIGN[i][1] * edge[1][a];
      if (std::abs(x - f.x[i][a]) > 1e-13 * size)
        return false;
    }
  return true;
}

} // namespace abut

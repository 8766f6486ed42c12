// One facet in space and its projections: position and tangents, inverse map along a direction.
#pragma once
#include "cells.hpp"
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

// Coordinates of one facet; `normals` (contactor only) are unit nodal normals, outward.
template <class T> struct Facet {
  int kind, dim, nodes;
  T x[MAX_FACET_NODES][3];
  T normals[MAX_FACET_NODES][3];
  bool affine = false; // the map from the reference domain is affine: one Newton step inverts it

  void values(const T *xi, T *n, T (*d)[3]) const { shape(kind, xi, n, d); }

  // Position and tangents, the continuous normal of theory (S1), shape functions.
  void at(const T *xi, T *point, T (*tangent)[3], T *normal = nullptr, T *shapes = nullptr) const {
    T own[MAX_FACET_NODES], d[MAX_FACET_NODES][3], *n = shapes ? shapes : own;
    shape(kind, xi, n, d);
    for (int a = 0; a < dim; ++a) {
      point[a] = tangent[0][a] = tangent[1][a] = T(0);
      if (normal)
        normal[a] = T(0);
    }
    for (int i = 0; i < nodes; ++i)
      for (int a = 0; a < dim; ++a) {
        point[a] += n[i] * x[i][a];
        tangent[0][a] += d[i][0] * x[i][a];
        if (dim == 3)
          tangent[1][a] += d[i][1] * x[i][a];
        if (normal)
          normal[a] += n[i] * normals[i][a];
      }
    if (normal)
      normalize(normal, dim);
  }

  bool triangle() const { return kind == TRI3 || kind == TRI6; }
  // Reference coordinates of the middle.
  void centre(T *xi) const { xi[0] = xi[1] = triangle() ? T(1) / T(3) : T(0); }
  // A near point of the reference domain, `slack` wider: componentwise, in triangles' area coordinates, so that the
  // answer does not depend on which corner comes first.
  void clamp(T *xi, T slack = T(0)) const {
    if (triangle()) {
      T l[3] = {T(1) - xi[0] - xi[1] + slack, xi[0] + slack, xi[1] + slack};
      if (l[0] >= T(0) && l[1] >= T(0) && l[2] >= T(0))
        return;
      T sum = T(0);
      for (T &value : l)
        value = std::max(value, T(0)), sum += value;
      for (int a = 0; a < 2; ++a)
        xi[a] = l[a + 1] * (T(1) + T(3) * slack) / sum - slack;
    } else {
      for (int a = 0; a < dim - 1; ++a)
        xi[a] = std::min(std::max(xi[a], T(-1) - slack), T(1) + slack);
    }
  }
};

// Finds xi with (x(xi) - from) perpendicular to both t1 and t2 (3D) or to t1 (2D): the point of the facet seen from
// `from` along the remaining direction. Starts at the given xi; returns false where Newton does not converge.
template <class T> bool project(const Facet<T> &facet, const T *from, const T *t1, const T *t2, T *xi) {
  const T slack = T(1);
  for (int iteration = 0; iteration < 25; ++iteration) {
    T point[3], tangent[2][3];
    facet.at(xi, point, tangent);
    for (int a = 0; a < facet.dim; ++a)
      point[a] -= from[a];
    T step[2] = {T(0), T(0)};
    if (facet.dim == 2) {
      const T slope = dot(tangent[0], t1, 2);
      if (slope == T(0))
        return false;
      step[0] = dot(point, t1, 2) / slope;
    } else {
      const T a = dot(tangent[0], t1, 3), b = dot(tangent[1], t1, 3), c = dot(tangent[0], t2, 3),
              d = dot(tangent[1], t2, 3), p = dot(point, t1, 3), q = dot(point, t2, 3);
      const T det = a * d - b * c;
      if (det == T(0))
        return false;
      step[0] = (d * p - b * q) / det, step[1] = (a * q - c * p) / det;
    }
    const T before[2] = {xi[0], xi[1]};
    xi[0] -= step[0];
    if (facet.dim == 3)
      xi[1] -= step[1];
    facet.clamp(xi, slack);
    if (facet.affine)
      return before[0] - step[0] == xi[0] && (facet.dim == 2 || before[1] - step[1] == xi[1]);
    const T moved = std::abs(xi[0] - before[0]) + (facet.dim == 3 ? std::abs(xi[1] - before[1]) : T(0));
    if (moved < T(1e-9)) {
      // Quadratic convergence: one more step of this size would be at rounding level.
      return std::abs(step[0]) + std::abs(step[1]) < T(1e-6);
    }
  }
  return false;
}

// Is the map from the reference domain affine: every node where the first corners put it?
inline bool is_affine(const Facet<double> &f) {
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

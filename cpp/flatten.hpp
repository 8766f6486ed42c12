// Flattening facets into a plane: the pieces that are clipped against each other.
#pragma once
#include "segments.hpp"

namespace abut {

// The mean plane of a facet; coordinates in it along e1, e2: theory (S4).
struct Plane {
  double origin[3], e1[3], e2[3], n[3];
  Point2 flat(const double *x) const {
    const double d[3] = {x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]};
    return {dot(d, e1, 3), dot(d, e2, 3)};
  }
  double height(const double *x) const {
    const double d[3] = {x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]};
    return dot(d, n, 3);
  }
  void lift(Point2 p, double *x) const {
    for (int a = 0; a < 3; ++a)
      x[a] = origin[a] + p.x * e1[a] + p.y * e2[a];
  }
};

inline Plane mean_plane(const Facet &f) {
  Plane plane;
  const int corners = f.triangle() ? 3 : 4;
  double area[3] = {0, 0, 0};
  for (int a = 0; a < 3; ++a) {
    plane.origin[a] = 0;
    for (int i = 0; i < corners; ++i)
      plane.origin[a] += f.x[i][a] / corners;
  }
  double p[3], q[3], c[3]; // half the cross product of the diagonals, or of two edges
  for (int a = 0; a < 3; ++a) {
    p[a] = f.x[2][a] - f.x[0][a];
    q[a] = corners == 4 ? f.x[3][a] - f.x[1][a] : f.x[2][a] - f.x[1][a];
  }
  if (corners == 3)
    for (int a = 0; a < 3; ++a)
      p[a] = f.x[1][a] - f.x[0][a];
  cross(p, q, c);
  for (int a = 0; a < 3; ++a)
    area[a] += c[a];
  normalize(area, 3);
  for (int a = 0; a < 3; ++a)
    plane.n[a] = area[a];
  frame(plane.n, plane.e1, plane.e2);
  return plane;
}

// An edge through the images of its ends and its middle: theory (S6).
inline Curve make_curve(Point2 a, Point2 b, const Point2 *middle) {
  Curve curve{a, b, {0, 0}, true};
  if (!middle)
    return curve;
  const Point2 chord = b - a;
  curve.bulge = 4.0 * (*middle - 0.5 * (a + b));
  curve.straight = std::abs(cross2(chord, curve.bulge)) <= 4e-13 * dot2(chord, chord); // also without length
  if (curve.straight)
    curve.bulge = {0, 0};
  return curve;
}

// A quadrilateral that is not convex: cut along the diagonal from its reflex corner.
inline void halve(const Piece &piece, std::vector<Piece> &out) {
  int reflex = 0;
  for (int i = 0; i < 4; ++i)
    if (cross2(piece.p[i] - piece.p[(i + 3) % 4], piece.p[(i + 1) % 4] - piece.p[i]) < 0)
      reflex = i;
  for (int half = 0; half < 2; ++half) {
    const int from[3] = {reflex, (reflex + (half == 0 ? 1 : 2)) % 4, (reflex + (half == 0 ? 2 : 3)) % 4};
    const int cut = half == 0 ? 2 : 0; // the edge along the diagonal
    Piece part;
    part.size = 3, part.facet = piece.facet;
    for (int i = 0; i < 3; ++i)
      part.p[i] = piece.p[from[i]], part.corner[i] = piece.corner[from[i]];
    for (int i = 0; i < 3; ++i) {
      part.curve[i] = i == cut ? make_curve(part.p[i], part.p[(i + 1) % 3], nullptr) : piece.curve[from[i]];
      part.middle[i] = piece.middle[from[i]], part.bend[i] = i != cut && piece.bend[from[i]];
      part.bulge[i] = piece.bulge[from[i]];
    }
    if (signed_area(part.p, 3) > 0)
      out.push_back(part);
  }
}

// A facet that is divided m x m and flattened; `reverse` turns the order (a target seen from the contactor).
struct Division {
  const Facet &facet;
  int m;
  bool reverse;
  int number; // of the facet

  // Reference coordinates of the grid's points, which lie at whole i, j.
  void grid(double i, double j, double *xi) const {
    const bool triangle = facet.triangle();
    xi[0] = triangle ? i / m : -1 + 2 * i / m, xi[1] = triangle ? j / m : -1 + 2 * j / m;
  }

  // The piece with these corners on the grid, counter-clockwise; none where it faces back.
  template <class Map> void add(const double (*corner)[2], int size, Map to_plane, std::vector<Piece> &out) const {
    const bool curved = quadratic(facet.kind);
    Piece piece;
    piece.size = size, piece.facet = number;
    Point2 middle[4];
    auto put = [&](double i, double j, int node, Piece::Place &place) {
      grid(i, j, place.xi);
      place.node = m == 1 ? node : -1;
      return to_plane(place.xi, place.node);
    };
    for (int i = 0; i < size; ++i) {
      const int k = reverse ? size - 1 - i : i, next = reverse ? (k + size - 1) % size : (k + 1) % size;
      piece.p[i] = put(corner[k][0], corner[k][1], k, piece.corner[i]);
      piece.bend[i] = curved;
      if (curved)
        middle[i] = put(0.5 * (corner[k][0] + corner[next][0]), 0.5 * (corner[k][1] + corner[next][1]),
                        size + (reverse ? next : k), piece.middle[i]);
    }
    if (signed_area(piece.p, size) <= 0)
      return;
    for (int i = 0; i < size; ++i) {
      const Point2 a = piece.p[i], b = piece.p[(i + 1) % size];
      piece.curve[i] = make_curve(a, b, curved ? &middle[i] : nullptr);
      piece.bulge[i] = curved ? 4.0 * (middle[i] - 0.5 * (a + b)) : Point2{0, 0};
    }
    if (size == 3 || convex(piece.p, 4))
      out.push_back(piece);
    else
      halve(piece, out);
  }
};

// The pieces of a divided facet, counter-clockwise; to_plane(xi, node) maps reference coordinates to the plane, which
// are those of a node where m = 1 (-1 for none).
template <class Map> void flatten(const Division &division, Map to_plane, std::vector<Piece> &out) {
  const bool triangle = division.facet.triangle();
  const int m = division.m;
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < (triangle ? m - i : m); ++j) {
      const double a = i, b = j;
      if (!triangle) {
        const double quad[4][2] = {{a, b}, {a + 1, b}, {a + 1, b + 1}, {a, b + 1}};
        division.add(quad, 4, to_plane, out);
        continue;
      }
      const double up[3][2] = {{a, b}, {a + 1, b}, {a, b + 1}};
      division.add(up, 3, to_plane, out);
      if (i + j < m - 1) {
        const double down[3][2] = {{a + 1, b}, {a + 1, b + 1}, {a, b + 1}};
        division.add(down, 3, to_plane, out);
      }
    }
}

} // namespace abut

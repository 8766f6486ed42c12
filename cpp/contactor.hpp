// A contactor facet laid into its mean plane.
#pragma once
#include "flatten.hpp"

namespace abut {

// The contactor facet in its mean plane, and the way its continuous normal carries points of space into that plane.
struct Contactor3 {
  Facet<double> facet;
  Plane plane;
  bool flat; // all nodal normals along the plane's normal: projection is plain
  std::vector<Piece> pieces;

  Contactor3(const Facet<double> &f, int m) : facet(f), plane(mean_plane(f)) {
    flat = true;
    for (int i = 0; i < f.nodes; ++i) {
      double d[3];
      for (int a = 0; a < 3; ++a)
        d[a] = f.normals[i][a] - plane.n[a];
      flat = flat && dot(d, d, 3) < 1e-26;
    }
    flatten(
        f, m, false,
        [&](const double *xi, Point2 &p) {
          double x[3], tangent[2][3];
          facet.at(xi, x, tangent);
          p = plane.flat(x);
          return true;
        },
        pieces);
  }

  // Reference coordinates of the facet's point over p: theory (S10).
  bool locate(Point2 p, double *xi) const {
    double x[3];
    plane.lift(p, x);
    return project(facet, x, plane.e1, plane.e2, xi);
  }

  // Foot in the plane of the contactor point whose normal line meets v; outside the facet the normal of the nearest
  // point of the facet is used. See theory (S5).
  Point2 carry(const double *v) const {
    const Point2 start = plane.flat(v);
    if (flat)
      return start;
    Point2 p = start;
    double xi[2];
    facet.centre(xi);
    for (int i = 0; i < 12; ++i) {
      locate(p, xi);
      facet.clamp(xi);
      double x[3], tangent[2][3], n[3];
      facet.at(xi, x, tangent, n);
      const double along = dot(n, plane.n, 3);
      if (along < 0.1)
        return p;
      // Height of v above the facet's tangent plane region: the contactor point itself may stand off the mean plane.
      const double t = (plane.height(v) - plane.height(x)) / along;
      const Point2 next = start - t * Point2{dot(n, plane.e1, 3), dot(n, plane.e2, 3)};
      const Point2 moved = next - p;
      p = next;
      if (dot2(moved, moved) < 1e-30 * (dot2(p, p) + 1e-300))
        break;
    }
    return p;
  }
};

} // namespace abut

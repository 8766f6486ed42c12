// A contactor facet laid into its mean plane.
#pragma once
#include "flatten.hpp"

namespace abut {

// The contactor facet in its mean plane, and the way its continuous normal carries points of space into that plane.
struct Contactor3 {
  Facet facet;
  Plane plane;
  Polynomial<2> map; // from the reference domain into the plane
  bool flat;         // all nodal normals along the plane's normal: projection is plain
  std::vector<Piece> pieces;

  Contactor3(const Facet &f, int m) : facet(f), plane(mean_plane(f)) {
    flat = true;
    for (int i = 0; i < f.nodes; ++i) {
      double d[3];
      for (int a = 0; a < 3; ++a)
        d[a] = f.normals[i][a] - plane.n[a];
      flat = flat && dot(d, d, 3) < 1e-26;
    }
    map.terms = facet.position.terms;
    for (int i = 0; i < map.terms; ++i) {
      const double *c = facet.position.c[i];
      double x[3];
      for (int a = 0; a < 3; ++a)
        x[a] = i == 0 ? c[a] - plane.origin[a] : c[a];
      map.c[i][0] = dot(x, plane.e1, 3), map.c[i][1] = dot(x, plane.e2, 3);
    }
    flatten(
        f, m, false,
        [&](const double *xi, int) {
          double x[3];
          facet.position.at(xi, x);
          return plane.flat(x);
        },
        pieces);
  }

  // Reference coordinates of the facet's point over p: theory (S10).
  bool locate(Point2 p, Spot<2> &at) const {
    return newton(facet, map, at, [&](const double *x, const double (*slope)[2], double *s) {
      const Point2 d{x[0] - p.x, x[1] - p.y}, a{slope[0][0], slope[0][1]}, b{slope[1][0], slope[1][1]};
      const double det = cross2(a, b);
      s[0] = cross2(d, b) / det, s[1] = cross2(a, d) / det;
      return det != 0;
    });
  }

  // Foot in the plane of the contactor point whose normal line meets v; outside the facet the normal of the nearest
  // point of the facet is used. See theory (S5).
  Point2 carry(const double *v) const {
    const Point2 start = plane.flat(v);
    if (flat)
      return start;
    Point2 p = start;
    Spot<2> at;
    facet.centre(at.xi);
    for (int i = 0; i < 12; ++i) {
      locate(p, at);
      if (facet.clamp(at.xi))
        at.known = false;
      double x[3], n[3];
      facet.position.at(at.xi, x), facet.normal(at.xi, n);
      const double along = dot(n, plane.n, 3);
      if (along < 0.1)
        return p;
      // Height of v above the facet's tangent plane region: the contactor point itself may stand off the mean plane.
      const double t = (plane.height(v) - plane.height(x)) / along;
      const Point2 next = start - t * Point2{dot(n, plane.e1, 3), dot(n, plane.e2, 3)};
      const Point2 moved = next - p;
      p = next;
      if (dot2(moved, moved) < 1e-28 * (dot2(p, p) + 1e-300))
        break;
    }
    return p;
  }
};

// The target's points in the plane of one contactor facet after another. Each is a point of several target facets.
class Carried {
public:
  void begin() { ++facet_; }
  template <class Carry> Point2 find(std::int32_t point, Carry carry) {
    if (std::size_t(point) >= facet_of_.size())
      facet_of_.resize(2 * std::size_t(point) + 1, 0), place_.resize(2 * std::size_t(point) + 1);
    if (facet_of_[point] != facet_)
      facet_of_[point] = facet_, place_[point] = carry();
    return place_[point];
  }

private:
  std::uint32_t facet_ = 0; // which one the places hold for
  std::vector<std::uint32_t> facet_of_;
  std::vector<Point2> place_;
};

} // namespace abut

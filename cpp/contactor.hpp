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
    Polynomial<3> from = facet.position;
    for (int a = 0; a < 3; ++a)
      from.c[0][a] -= plane.origin[a];
    to_frame(from, position), to_frame(facet.direction, direction);
    map.terms = position.terms;
    for (int i = 0; i < map.terms; ++i)
      map.c[i][0] = position.c[i][0], map.c[i][1] = position.c[i][1];
    flatten(
        {f, m, false, 0},
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

  // Foot in the plane of the contactor point whose normal line meets v: theory (S5).
  Point2 carry(const double *v) const {
    double xi[2];
    return flat ? plane.flat(v) : foot(v, xi).p;
  }

  // The foot, and the contactor point's reference coordinates xi: outside the facet those of its nearest point, whose
  // normal is used. Not `upright` where the normal leans too much, or where v has no foot; then its plain projection.
  struct Foot {
    Point2 p;
    bool upright;
  };
  Foot foot(const double *v, double *xi) const {
    const Point2 start = plane.flat(v);
    const double height = plane.height(v);
    double x[3], n[3], dx[2][3], dn[2][3], last[2] = {0, 0}, size = 0;
    facet.centre(xi);
    Point2 p = start;
    for (int i = 0; i < 12; ++i) {
      position.at(xi, x, dx), direction.at(xi, n, dn);
      if (leaning(n))
        return {p, false};
      // How much of the way from the facet's point along its normal is missing to v.
      const double t = (height - x[2]) / n[2];
      double s[2][2];
      for (int k = 0; k < 2; ++k)
        for (int a = 0; a < 2; ++a)
          s[k][a] = dx[k][a] + t * dn[k][a] - n[a] / n[2] * (dx[k][2] + t * dn[k][2]);
      const Point2 d{x[0] + t * n[0] - start.x, x[1] + t * n[1] - start.y}, a{s[0][0], s[0][1]}, b{s[1][0], s[1][1]};
      const double det = cross2(a, b), before[2] = {xi[0], xi[1]};
      if (det == 0)
        return {p, true};
      xi[0] -= cross2(d, b) / det, xi[1] -= cross2(a, d) / det;
      const bool cut = facet.clamp(xi);
      const double step[2] = {xi[0] - before[0], xi[1] - before[1]};
      cut ? go_on(xi, step, last) : void(last[0] = last[1] = 0);
      position.at(xi, x), direction.at(xi, n);
      if (leaning(n))
        return {p, false};
      p = start - (height - x[2]) / n[2] * Point2{n[0], n[1]};
      size = std::abs(step[0]) + std::abs(step[1]);
      if (size < (cut ? SETTLED_AT_RIM : SETTLED))
        break;
    }
    return size < LOST ? Foot{p, true} : Foot{start, false};
  }

  Polynomial<3> position, direction; // of the facet and its normals, in the plane's frame

private:
  static constexpr double SETTLED = 1e-7; // of the reference domain: what Newton's next step leaves is rounding
  static constexpr double SETTLED_AT_RIM = 1e-10;
  static constexpr double LOST = 0.1; // still after all steps: v lies further away than the normals meet

  // Steps that are cut off at the rim shrink by a factor only, so the point goes on to where they lead: Aitken.
  void go_on(double *xi, const double *step, double *last) const {
    const double size = last[0] * last[0] + last[1] * last[1];
    const double ratio = size > 0 ? (step[0] * last[0] + step[1] * last[1]) / size : 1;
    const bool leads = ratio < 0.9 && ratio > -5;
    for (int a = 0; a < 2; ++a) {
      xi[a] += leads ? ratio / (1 - ratio) * step[a] : 0;
      last[a] = leads ? 0 : step[a];
    }
    facet.clamp(xi);
  }

  static bool leaning(const double *n) { return !(n[2] > 0.1 * std::sqrt(dot(n, n, 3))); }
  void to_frame(const Polynomial<3> &from, Polynomial<3> &to) const {
    to.terms = from.terms;
    for (int i = 0; i < from.terms; ++i)
      to.c[i][0] = dot(from.c[i], plane.e1, 3), to.c[i][1] = dot(from.c[i], plane.e2, 3),
      to.c[i][2] = dot(from.c[i], plane.n, 3);
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

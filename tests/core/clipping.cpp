// Clipping of convex polygons, crossings of curved edges, and integrals over what is left.
#include "check.hpp"
#include "clip.hpp"

using namespace abut;
using check::holds;
using check::same;

namespace {

constexpr double ROUNDING = 1e-14;
constexpr int SUBJECT = 0, CLIP = 1;

Polygon polygon_of(const std::vector<Point2> &corners, int side = SUBJECT) {
  Polygon polygon;
  for (int i = 0; i < int(corners.size()); ++i)
    polygon.push({corners[i], side, i});
  return polygon;
}

double area(const Polygon &polygon) {
  Point2 p[MAX_CLIP];
  for (int i = 0; i < polygon.size; ++i)
    p[i] = polygon.v[i].p;
  return polygon.size > 2 ? signed_area(p, polygon.size) : 0;
}

double common(const std::vector<Point2> &a, const std::vector<Point2> &b) {
  return area(clip_convex(polygon_of(a), b.data(), int(b.size()), CLIP));
}

std::vector<Point2> square(double x, double y, double size = 1) {
  return {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}};
}

const std::vector<Point2> TRIANGLE{{0.3, 0.2}, {1.4, 0.5}, {0.6, 1.3}};

// Gauss-Legendre with four points on [0, 1], exact to degree 7; from the apex, with r in the weight, to degree 6.
struct Gauss {
  double t[4], w[4], wr[4];
  Gauss() {
    const double x[2] = {0.33998104358485626, 0.86113631159405258},
                 weight[2] = {0.65214515486254614, 0.34785484513745386};
    for (int i = 0; i < 4; ++i) {
      t[i] = 0.5 + (i % 2 ? 0.5 : -0.5) * x[i / 2], w[i] = 0.5 * weight[i / 2];
      wr[i] = w[i] * t[i];
    }
  }
  Rule rule() const { return {4, t, w, t, wr}; }
};

template <class CurveOf, class F> double integral(const Polygon &polygon, CurveOf curve_of, bool fan, F f) {
  const Gauss gauss;
  double sum = 0;
  integrate_polygon(polygon, curve_of, gauss.rule(), fan, [&](Point2 p, double weight) { sum += weight * f(p); });
  return sum;
}

const auto STRAIGHT_EDGES = [](const Vertex &) -> const Curve * { return nullptr; };

} // namespace

TEST(squares_overlap_in_a_rectangle) {
  same(common(square(0, 0), square(0.5, 0.25)), 0.5 * 0.75, ROUNDING, "area");
  same(common(square(0, 0), square(-1, -1, 3)), 1, ROUNDING, "area of one inside the other");
  same(common(square(0, 0, 3), square(1, 1)), 1, ROUNDING, "area of one around the other");
  same(common(square(0, 0), square(2, 0)), 0, 0, "area of two apart");
  same(common(square(0, 0), square(1, 0)), 0, 0, "area of neighbours");
}

TEST(either_polygon_may_clip_the_other) {
  for (double x = -0.9; x < 1.5; x += 0.13)
    for (double y = -0.8; y < 1.5; y += 0.17)
      same(common(TRIANGLE, square(x, y)), common(square(x, y), TRIANGLE), ROUNDING, "common area");
}

TEST(a_line_divides_without_a_gap) {
  const Point2 a{-0.4, 0.1}, b{1.7, 0.9};
  const Polygon whole = polygon_of(square(0, 0));
  const double left = area(clip_line(whole, a, b, CLIP, 0)), right = area(clip_line(whole, b, a, CLIP, 0));
  holds(left > 0 && right > 0, "the line crosses the square");
  same(left + right, 1, ROUNDING, "both parts");
}

TEST(edges_know_where_they_come_from) {
  const auto clip = square(0.5, 0.25), subject = square(0, 0);
  const Polygon left = clip_convex(polygon_of(subject), clip.data(), 4, CLIP);
  holds(left.size == 4, "a rectangle");
  int of_clip = 0;
  for (int i = 0; i < left.size; ++i) {
    const Vertex &v = left.v[i];
    const auto &origin = v.side == CLIP ? clip : subject;
    const Point2 p = origin[v.edge], along = origin[(v.edge + 1) % 4] - p, next = left.v[(i + 1) % left.size].p;
    same(cross2(along, v.p - p), 0, ROUNDING, "a vertex off its edge");
    same(cross2(along, next - p), 0, ROUNDING, "the end of an edge off it");
    of_clip += v.side == CLIP;
  }
  holds(of_clip == 2, "two edges of each");
}

TEST(curves_cross_where_both_are) {
  const Curve parabola{{0, 0}, {1, 0}, {0, 1}, false}, line{{0.3, -1}, {0.3, 1}, {0, 0}, true};
  Point2 p{0.3, 0};
  polish(parabola, line, p);
  same(p.x, 0.3, ROUNDING, "x of the crossing");
  same(p.y, 0.3 * 0.7, ROUNDING, "y of the crossing"); // the curve is y = x (1 - x)
  const Curve other{{0, 0.4}, {1, 0.2}, {0, -1}, false};
  p = {0.2, 0.2};
  polish(parabola, other, p);
  same(p.y, p.x * (1 - p.x), ROUNDING, "on the first");
  same(p.y, 0.4 - 0.2 * p.x - p.x * (1 - p.x), ROUNDING, "on the second");
}

TEST(parallel_curves_leave_the_vertex) {
  const Curve one{{0, 0}, {1, 0}, {0, 0}, true}, other{{0, 0.1}, {1, 0.1}, {0, 0}, true};
  Point2 p{0.4, 0.05};
  polish(one, other, p);
  same(p.x, 0.4, 0, "x"), same(p.y, 0.05, 0, "y");
}

TEST(polynomials_are_integrated_exactly) {
  const Polygon polygon = polygon_of(square(0, 0));
  same(integral(polygon, STRAIGHT_EDGES, false, [](Point2) { return 1.0; }), 1, ROUNDING, "area");
  same(integral(polygon, STRAIGHT_EDGES, false, [](Point2 p) { return p.x * p.x * p.y * p.y; }), 1.0 / 9, ROUNDING,
       "int x^2 y^2");
}

TEST(a_bulging_edge_adds_its_segment) {
  const Polygon polygon = polygon_of(square(0, 0));
  const Curve bottom{{0, 0}, {1, 0}, {0, -0.4}, false}; // outward: y = -0.4 x (1 - x)
  const auto curve_of = [&](const Vertex &v) { return v.edge == 0 ? &bottom : nullptr; };
  for (bool fan : {false, true}) {
    same(integral(polygon, curve_of, fan, [](Point2) { return 1.0; }), 1 + 0.4 / 6, ROUNDING, "area");
    same(integral(polygon, curve_of, fan, [](Point2 p) { return p.y; }), 0.5 - 0.4 * 0.4 / 60, ROUNDING, "int y");
  }
}

TEST(both_edges_at_the_apex_may_bulge) {
  const Polygon polygon = polygon_of(square(0, 0));
  const Curve bottom{{0, 0}, {1, 0}, {0.15, -0.4}, false}, left{{0, 1}, {0, 0}, {-0.3, 0.2}, false};
  const auto curve_of = [&](const Vertex &v) { return v.edge == 0 ? &bottom : v.edge == 3 ? &left : nullptr; };
  const double added =
      -(cross2({1, 0}, bottom.bulge) + cross2({0, -1}, left.bulge)) / 6; // a segment has chord x bulge / 6
  for (bool fan : {false, true})
    same(integral(polygon, curve_of, fan, [](Point2) { return 1.0; }), 1 + added, ROUNDING, "area");
  const auto moment = [](Point2 p) { return p.x * p.y; };
  same(integral(polygon, curve_of, true, moment), integral(polygon, curve_of, false, moment), ROUNDING, "int x y");
}

// Rounding must not decide which of two edges with a common chord, whose curves differ, bounds the part.
TEST(common_chords_stay_the_subject_s) {
  const auto subject = square(0, 0);
  for (double off : {-3e-15, 0.0, 3e-15})
    for (double tilt : {-3e-15, 0.0, 3e-15}) {
      const std::vector<Point2> clip{{0, off + tilt}, {1, off - tilt}, {1, 0.5}, {0, 0.5}};
      const Polygon part = clip_convex(polygon_of(subject), clip.data(), 4, CLIP);
      holds(part.size == 4, "a rectangle");
      holds(part.v[0].side == SUBJECT && part.v[0].edge == 0, "the lower edge is the subject's own");
      int of_clip = 0;
      for (int i = 0; i < part.size; ++i)
        of_clip += part.v[i].side == CLIP;
      holds(of_clip == 1, "the clip cuts once");
    }
}

// Points found on a facet along a direction, and the parts that this is made of.
#include "check.hpp"
#include "project.hpp"

using namespace abut;
using check::holds;
using check::same;

namespace {

constexpr double ROUNDING =
    1e-13; // Newton's method stops at 1e-12 of the reference domain and errs by the square of that

template <class Place> Facet facet_of(Kind kind, int dim, Place place) {
  static constexpr double line[3] = {-1, 1, 0};
  static constexpr double triangle[6][2] = {{0, 0}, {1, 0}, {0, 1}, {.5, 0}, {.5, .5}, {0, .5}};
  Facet facet;
  facet.kind = kind, facet.dim = dim, facet.nodes = NODES[kind];
  for (int i = 0; i < facet.nodes; ++i) {
    double xi[2] = {0, 0};
    if (DIM[kind] == 1)
      xi[0] = line[i];
    else if (facet.triangle())
      xi[0] = triangle[i][0], xi[1] = triangle[i][1];
    else if (i < 8)
      xi[0] = detail::QUAD_SIGN[i][0], xi[1] = detail::QUAD_SIGN[i][1];
    place(xi, facet.x[i]);
  }
  facet.position.interpolate(kind, facet.x);
  facet.affine = is_affine(facet);
  facet.bend = bend_of(facet);
  return facet;
}

Spot<3> middle_of(const Facet &facet) {
  double xi[2];
  facet.centre(xi);
  Spot<3> at;
  at.begin(xi);
  return at;
}

const auto PLANE = [](const double *xi, double *x) { x[0] = xi[0], x[1] = xi[1], x[2] = 0.5 + 0.1 * xi[0]; };
const auto BOWL = [](const double *xi, double *x) {
  x[0] = xi[0], x[1] = xi[1], x[2] = 0.3 * xi[0] * xi[0] - 0.2 * xi[0] * xi[1];
};
constexpr Kind FACETS[] = {TRI3, TRI6, QUAD4, QUAD8, QUAD9};

} // namespace

TEST(a_plane_is_met_where_it_is) {
  const double from[3] = {0.2, 0.3, 4}, along[3] = {0, 0, 2};
  for (Kind kind : FACETS) {
    const Facet facet = facet_of(kind, 3, PLANE);
    holds(facet.affine, "a plane facet with straight edges is affine");
    Spot<3> at = middle_of(facet);
    holds(project(facet, from, along, at), "the plane is found");
    same(at.xi[0], 0.2, ROUNDING, "xi"), same(at.xi[1], 0.3, ROUNDING, "eta"), same(at.x[2], 0.52, ROUNDING, "z");
  }
}

TEST(a_curved_facet_is_met_along_any_direction) {
  const double from[3] = {0.35, 0.2, 2}, along[3] = {0.2, -0.1, -1};
  for (Kind kind : {TRI6, QUAD8, QUAD9}) {
    const Facet facet = facet_of(kind, 3, BOWL);
    holds(!facet.affine, "a bowl is not affine");
    Spot<3> at = middle_of(facet);
    holds(project(facet, from, along, at), "the bowl is found");
    double on[3];
    BOWL(at.xi, on); // quadratic functions follow it exactly
    const double far = (at.x[2] - from[2]) / along[2];
    for (int a = 0; a < 3; ++a)
      same(at.x[a], on[a], ROUNDING, "on the facet"), same(at.x[a], from[a] + far * along[a], ROUNDING, "on the line");
  }
}

TEST(what_lies_far_beside_is_not_met) {
  const double from[3] = {7, 0.1, 3}, along[3] = {0, 0, 1}, within[3] = {0, 1, 0};
  for (Kind kind : FACETS) {
    const Facet facet = facet_of(kind, 3, PLANE);
    Spot<3> at = middle_of(facet);
    holds(!project(facet, from, along, at), "a point beside the facet");
    at = middle_of(facet);
    holds(!project(facet, from, within, at), "a direction in the plane");
  }
}

TEST(lines_are_met_at_right_angles) {
  const double from[2] = {0.3, 5}, along[2] = {1, 0};
  const auto parabola = [](const double *xi, double *x) {
    x[0] = xi[0] + 0.1 * xi[0] * xi[0], x[1] = xi[0] * xi[0], x[2] = 0;
  };
  const auto straight = [](const double *xi, double *x) { x[0] = 1 + xi[0], x[1] = 0.5 * xi[0], x[2] = 0; };
  const Facet line = facet_of(LINE2, 2, straight), curve = facet_of(LINE3, 2, parabola);
  Spot<3> at = middle_of(line);
  holds(project_line(line, from, along, at), "the line is found");
  same(at.xi[0], -0.7, ROUNDING, "xi"), same(at.x[1], -0.35, ROUNDING, "y");
  at = middle_of(curve);
  holds(project_line(curve, from, along, at), "the parabola is found");
  same(at.x[0], 0.3, ROUNDING, "x"), same(at.x[1], at.xi[0] * at.xi[0], ROUNDING, "y");
}

TEST(points_outside_are_moved_to_the_edge) {
  const Facet triangle = facet_of(TRI3, 3, PLANE), quad = facet_of(QUAD4, 3, PLANE);
  double xi[2] = {0.8, 0.8};
  holds(triangle.clamp(xi), "beyond the long edge");
  same(xi[0], 0.5, ROUNDING, "xi"), same(xi[1], 0.5, ROUNDING, "eta");
  double far[2] = {-3, 0.25}, inside[2] = {0.2, 0.3};
  holds(quad.clamp(far), "beyond an edge");
  same(far[0], -1, 0, "xi"), same(far[1], 0.25, 0, "eta");
  holds(!triangle.clamp(inside) && !quad.clamp(inside), "a point inside stays");
}

TEST(frames_are_right_handed) {
  for (double turn = 0; turn < 6; turn += 0.7) {
    double n[3] = {std::cos(turn), std::sin(turn) * 0.6, std::sin(turn) * 0.8}, t1[3], t2[3], c[3];
    frame(n, t1, t2);
    cross(t1, t2, c);
    for (int a = 0; a < 3; ++a)
      same(c[a], n[a], ROUNDING, "t1 x t2");
    same(dot(t1, t1, 3), 1, ROUNDING, "length"), same(dot(t1, n, 3), 0, ROUNDING, "right angle");
  }
}

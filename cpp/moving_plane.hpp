// How the image of a point in a contactor facet's mean plane moves; see docs/theory/coupling-tangent.md.
#pragma once
#include "contactor.hpp"
#include "dual.hpp"
#include "moving_sums.hpp"

namespace abut {

// Rows of the two coordinates of a point of the plane.
struct Rows2 {
  double *x = nullptr, *y = nullptr;
  explicit operator bool() const { return x; }
};

// The plane turns with the corners of its facet. That its origin and its axes move within it changes no integral, so
// they are taken as fixed: only the tilt remains, the change of its normal along e1 and e2.
class MovingPlane {
public:
  explicit MovingPlane(const Contactor3 &c) : c_(c), own_(6 * c.facet.nodes) {
    const Facet &f = c.facet;
    const bool triangle = f.triangle();
    // The normal is that of p x q: see `mean_plane`.
    const int ends[2][2] = {{triangle ? 1 : 2, 0}, {triangle ? 2 : 3, 1}};
    double edge[2][3], area[3];
    for (int k = 0; k < 2; ++k)
      for (int a = 0; a < 3; ++a)
        edge[k][a] = f.x[ends[k][0]][a] - f.x[ends[k][1]][a];
    cross(edge[0], edge[1], area);
    const double size = std::sqrt(dot(area, area, 3)), *axis[2] = {c.plane.e1, c.plane.e2};
    for (int t = 0; t < 2; ++t) {
      double by[2][3];
      cross(edge[1], axis[t], by[0]), cross(axis[t], edge[0], by[1]);
      for (int k = 0; k < 2; ++k)
        for (int a = 0; a < 3; ++a) {
          tilt[t][3 * ends[k][0] + a] += by[k][a] / size;
          tilt[t][3 * ends[k][1] + a] -= by[k][a] / size;
        }
    }
  }

  double tilt[2][3 * MAX_FACET_NODES] = {{0}}; // by the facet's points

  const Contactor3 &contactor() const { return c_; }
  // Columns of the rows below: the facet's points, its normals, and three of the point that is carried.
  int size() const { return own_ + 3; }

  // Image of the facet's own point.
  void flat(const double *xi, const Rows2 &row) const {
    double n[MAX_FACET_NODES], x[3];
    c_.facet.values(xi, n), c_.position.at(xi, x);
    const double *axis[2] = {c_.plane.e1, c_.plane.e2};
    double *rows[2] = {row.x, row.y};
    for (int t = 0; t < 2; ++t) {
      for (int i = 0; i < c_.facet.nodes; ++i)
        for (int a = 0; a < 3; ++a)
          rows[t][3 * i + a] += n[i] * axis[t][a];
      add_row(3 * c_.facet.nodes, -x[2], tilt[t], rows[t]);
    }
  }

  // Image of a point v of space: theory (S5).
  void carried(const double *v, const Rows2 &row) const {
    Look at;
    const Contactor3::Foot foot = c_.foot(v, at.xi);
    const double d[3] = {v[0] - c_.plane.origin[0], v[1] - c_.plane.origin[1], v[2] - c_.plane.origin[2]};
    at.v[0] = dot(d, c_.plane.e1, 3), at.v[1] = dot(d, c_.plane.e2, 3), at.v[2] = dot(d, c_.plane.n, 3);
    c_.position.at(at.xi, at.x, at.dx), c_.direction.at(at.xi, at.m, at.dm);
    Gradient g;
    if (foot.upright)
      differentiate(at, g);
    else
      g.by[0][V] = g.by[1][V + 1] = 1;
    spread(at, g, row);
  }

private:
  // Vectors in the plane's frame that the image depends on: contactor point and normal, slopes of both along q, and v.
  static constexpr int X = 0, M = 3, XQ = 6, MQ = 9, V = 12, ALONG = 15, SEEDS = 16;
  using Number = Dual<SEEDS>;
  struct Look {
    double xi[2], x[3], m[3], v[3], dx[2][3], dm[2][3];
  };
  struct Gradient {
    double by[2][15] = {{0}}, q[2] = {0, 0}; // of the two coordinates; direction of the slopes
  };

  // Where xi is at the rim: the direction q that Newton's steps are cut off in, the direction along the rim that is
  // left, and how q changes along it. False inside, and no direction left at a corner.
  struct Rim {
    double q[2], along[2], turn;
    bool corner;
  };
  bool at_rim(const double *xi, Rim &rim) const {
    constexpr double near = 1e-9;
    if (!c_.facet.triangle()) {
      const bool at[2] = {1 - std::abs(xi[0]) < near, 1 - std::abs(xi[1]) < near};
      const int cut = at[0] ? 0 : 1;
      rim = {{1.0 - cut, 1.0 * cut}, {1.0 * cut, 1.0 - cut}, 0, at[0] && at[1]};
      return at[0] || at[1];
    }
    static constexpr double corner[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    static constexpr double edge[3][2] = {{-1, 1}, {0, 1}, {1, 0}};
    const double l[3] = {1 - xi[0] - xi[1], xi[0], xi[1]};
    int count = 0;
    for (int k = 0; k < 3; ++k)
      if (l[k] < near) {
        ++count;
        rim = {{xi[0] - corner[k][0], xi[1] - corner[k][1]}, {edge[k][0], edge[k][1]}, 1, count > 1};
      }
    return count > 0;
  }

  void differentiate(const Look &at, Gradient &g) const {
    Rim rim;
    if (!at_rim(at.xi, rim))
      return inside(at, g);
    double ddx[2][3], ddm[2][3];
    bend(c_.position, at.xi, rim.along, ddx), bend(c_.direction, at.xi, rim.along, ddm);
    std::copy(rim.q, rim.q + 2, g.q);
    Number x[3], m[3], xq[3], mq[3], v[3];
    for (int a = 0; a < 3; ++a) {
      x[a] = Number::seed(at.x[a], X + a), m[a] = Number::seed(at.m[a], M + a), v[a] = Number::seed(at.v[a], V + a);
      xq[a] = Number::seed(rim.q[0] * at.dx[0][a] + rim.q[1] * at.dx[1][a], XQ + a);
      mq[a] = Number::seed(rim.q[0] * at.dm[0][a] + rim.q[1] * at.dm[1][a], MQ + a);
      for (int k = 0; k < 2; ++k) {
        x[a].d[ALONG] += rim.along[k] * at.dx[k][a], m[a].d[ALONG] += rim.along[k] * at.dm[k][a];
        xq[a].d[ALONG] += rim.q[k] * ddx[k][a] + rim.turn * rim.along[k] * at.dx[k][a];
        mq[a].d[ALONG] += rim.q[k] * ddm[k][a] + rim.turn * rim.along[k] * at.dm[k][a];
      }
    }
    const Number t = (v[2] - x[2]) / m[2], rise = (xq[2] + t * mq[2]) / m[2];
    Number p[2], away[2], slope[2];
    for (int a = 0; a < 2; ++a) {
      p[a] = v[a] - t * m[a];
      away[a] = x[a] - p[a], slope[a] = xq[a] + t * mq[a] - rise * m[a];
    }
    // Newton's step, cut off along q, is zero: it has no part along the rim.
    const Number rest = away[0] * slope[1] - away[1] * slope[0];
    const bool moves = !rim.corner && rest.d[ALONG] != 0;
    for (int a = 0; a < 2; ++a)
      for (int s = 0; s < ALONG; ++s)
        g.by[a][s] = p[a].d[s] - (moves ? p[a].d[ALONG] * rest.d[s] / rest.d[ALONG] : 0);
  }

  // x + t m = v at the foot: p = v - t m, whose slopes along xi are exact.
  static void inside(const Look &at, Gradient &g) {
    const double t = (at.v[2] - at.x[2]) / at.m[2];
    double by_xi[2][2], slope[2][2]; // of p, and of x - p
    for (int a = 0; a < 2; ++a) {
      const double lean = at.m[a] / at.m[2];
      g.by[a][V + a] = 1, g.by[a][V + 2] = -lean;
      g.by[a][X + 2] = lean;
      g.by[a][M + a] = -t, g.by[a][M + 2] = t * lean;
      for (int k = 0; k < 2; ++k) {
        by_xi[a][k] = lean * at.dx[k][2] - t * at.dm[k][a] + t * lean * at.dm[k][2];
        slope[a][k] = at.dx[k][a] - by_xi[a][k];
      }
    }
    const double det = slope[0][0] * slope[1][1] - slope[0][1] * slope[1][0];
    double rest[2][15]; // of x - p
    for (int a = 0; a < 2; ++a)
      for (int s = 0; s < 15; ++s)
        rest[a][s] = (s == X + a) - g.by[a][s];
    for (int s = 0; s < 15; ++s) {
      const double xi[2] = {-(slope[1][1] * rest[0][s] - slope[0][1] * rest[1][s]) / det,
                            -(slope[0][0] * rest[1][s] - slope[1][0] * rest[0][s]) / det};
      for (int a = 0; a < 2; ++a)
        g.by[a][s] += by_xi[a][0] * xi[0] + by_xi[a][1] * xi[1];
    }
  }

  // Change of both slopes along a direction.
  static void bend(const Polynomial<3> &map, const double *xi, const double *along, double (*change)[3]) {
    double second[3][3]; // xx, xy, yy
    map.second(xi, second);
    for (int a = 0; a < 3; ++a) {
      change[0][a] = along[0] * second[0][a] + along[1] * second[1][a];
      change[1][a] = along[0] * second[1][a] + along[1] * second[2][a];
    }
  }

  // From vectors in the frame to points, normals and v.
  void spread(const Look &at, const Gradient &g, const Rows2 &row) const {
    double n[MAX_FACET_NODES], dn[MAX_FACET_NODES][3];
    shape(c_.facet.kind, at.xi, n, dn);
    const int nodes = c_.facet.nodes;
    double *rows[2] = {row.x, row.y};
    for (int t = 0; t < 2; ++t) {
      double global[5][3];
      for (int w = 0; w < 5; ++w)
        for (int a = 0; a < 3; ++a) {
          const double *by = g.by[t] + 3 * w;
          global[w][a] = by[0] * c_.plane.e1[a] + by[1] * c_.plane.e2[a] + by[2] * c_.plane.n[a];
        }
      for (int i = 0; i < nodes; ++i) {
        const double along = g.q[0] * dn[i][0] + g.q[1] * dn[i][1];
        for (int a = 0; a < 3; ++a) {
          rows[t][3 * i + a] += n[i] * global[0][a] + along * global[2][a];
          rows[t][3 * (nodes + i) + a] += n[i] * global[1][a] + along * global[3][a];
        }
      }
      for (int a = 0; a < 3; ++a)
        rows[t][own_ + a] += global[4][a];
      turn(at, g, t, rows[t]);
    }
  }

  // The frame's own part: theory (T4).
  void turn(const Look &at, const Gradient &g, int t, double *row) const {
    double vector[5][3], by[2] = {0, 0};
    for (int a = 0; a < 3; ++a) {
      vector[0][a] = at.x[a], vector[1][a] = at.m[a], vector[4][a] = at.v[a];
      vector[2][a] = g.q[0] * at.dx[0][a] + g.q[1] * at.dx[1][a];
      vector[3][a] = g.q[0] * at.dm[0][a] + g.q[1] * at.dm[1][a];
    }
    for (int w = 0; w < 5; ++w)
      for (int k = 0; k < 2; ++k)
        by[k] += g.by[t][3 * w + 2] * vector[w][k] - g.by[t][3 * w + k] * vector[w][2];
    for (int k = 0; k < 2; ++k)
      add_row(3 * c_.facet.nodes, by[k], tilt[k], row);
  }

  const Contactor3 &c_;
  int own_;
};

} // namespace abut

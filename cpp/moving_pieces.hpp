// Derivatives in 3D: integrates over polygons whose vertices move; see docs/theory/coupling-tangent.md.
#pragma once
#include "moving_polygon.hpp"

namespace abut {

// Integrates what one contactor facet sees of one target facet after another.
class MovingPieces {
public:
  explicit MovingPieces(MovingSums<3> &sums) : sums_(sums) {}

  void begin_target(MovingEdges &edges, const Columns &columns) {
    edges_ = &edges, columns_ = &columns;
    edges.begin_target(columns);
    for (auto *row : {&on_[0], &on_[1], &along_[0], &along_[1], &bulge_[0], &bulge_[1], &turn_[0], &turn_[1], &p_[0],
                      &p_[1], &xi_[0], &xi_[1], &weight_})
      row->assign(columns.size, 0);
  }

  // A polygon of the contactor piece `own.mine` that sees the facet t.
  void integrate(const Over &over, const MovingPlane &plane, const Facet &t, const Segment &own, const Polygon &polygon,
                 const Rule &rule) {
    Sight3 at(over.c, own.xi, own.eta);
    const Outline outline(polygon, [&](const Vertex &v) { return edges_->curve(v); });
    const MovingOutline moving(*edges_, polygon, own.mine, over.piece(own.mine));
    const bool around = over.c.flat && curved(over, polygon); // as in `integrate_polygon`
    Fan fan{polygon.v[0].p, moving.corner(0)};
    if (around)
      fan = middle(polygon, moving);
    for (int i = around ? 0 : 1; i + (around ? 0 : 1) < outline.size; ++i) {
      const bool first = !around && i == 1, last = !around && i + 2 == outline.size;
      fan.edge = outline.edge[i], fan.side = moving.side[i];
      fan.first = first ? outline.edge[0].bulge : Point2{0, 0};
      fan.last = last ? outline.edge[i + 1].bulge : Point2{0, 0};
      fan.first_rows = first ? moving.side[0].bulge : Rows2{};
      fan.last_rows = last ? moving.side[i + 1].bulge : Rows2{};
      integrate(plane, t, fan, rule, at);
    }
  }

private:
  // An apex, an edge, and the bulges of the edges at the apex: theory (S9).
  struct Fan {
    Point2 apex;
    Rows2 apex_rows;
    Edge edge{};
    MovingSide side{};
    Point2 first{}, last{};
    Rows2 first_rows{}, last_rows{};
  };

  static bool curved(const Over &over, const Polygon &polygon) {
    for (int i = 0; i < polygon.size; ++i)
      if (const Curve *curve = over.curve(polygon.v[i]); curve && !curve->straight)
        return true;
    return false;
  }

  Fan middle(const Polygon &polygon, const MovingOutline &moving) {
    Fan fan{polygon.middle(), edges_->take()};
    for (int i = 0; i < polygon.size; ++i)
      add({moving.corner(i).x, fan.apex_rows.x}, 1.0 / polygon.size),
          add({moving.corner(i).y, fan.apex_rows.y}, 1.0 / polygon.size);
    return fan;
  }
  void add(std::pair<const double *, double *> rows, double factor) const {
    add_row(columns_->size, factor, rows.first, rows.second);
  }
  void add(const Rows2 &from, double factor, std::vector<double> *to) const {
    if (!from || factor == 0)
      return;
    add_row(columns_->size, factor, from.x, to[0].data()), add_row(columns_->size, factor, from.y, to[1].data());
  }

  void integrate(const MovingPlane &plane, const Facet &t, const Fan &fan, const Rule &rule, Sight3 &at) {
    for (int k = 0; k < rule.n; ++k) {
      const double s = rule.t[k];
      const Point2 on = fan.edge.at(s) - fan.apex, along = fan.edge.slope(s);
      const Point2 bulge = (1 - s) * fan.first + s * fan.last, turn = fan.last - fan.first;
      find_rows(fan, s);
      for (int m = 0; m < rule.n; ++m) {
        const double r = rule.r[m], w = rule.wt[k] * rule.wr[m];
        const Point2 u = on + (1 - 2 * r) * bulge, v = along + (1 - r) * turn;
        const double weight = cross2(u, v) * w;
        if (weight == 0)
          continue;
        if (at.look(t, fan.apex + r * (on + (1 - r) * bulge)) == HUGE_VAL)
          continue;
        move(fan, r, w, u, v);
        add_point(plane, at, weight);
      }
    }
  }

  // Of what does not depend on r.
  void find_rows(const Fan &fan, double s) {
    for (auto *rows : {on_, along_, bulge_, turn_})
      for (int a = 0; a < 2; ++a)
        std::fill(rows[a].begin(), rows[a].end(), 0.0);
    add(fan.side.p, 1 - s, on_), add(fan.side.q, s, on_), add(fan.side.bulge, s * (1 - s), on_);
    add(fan.apex_rows, -1, on_);
    add(fan.side.p, -1, along_), add(fan.side.q, 1, along_), add(fan.side.bulge, 1 - 2 * s, along_);
    bends_ = fan.first_rows || fan.last_rows;
    if (bends_) {
      add(fan.first_rows, 1 - s, bulge_), add(fan.last_rows, s, bulge_);
      add(fan.first_rows, -1, turn_), add(fan.last_rows, 1, turn_);
    }
  }

  // Of the place in the plane, and of the weight there.
  void move(const Fan &fan, double r, double w, Point2 u, Point2 v) {
    const std::size_t n = columns_->size;
    const double *apex[2] = {fan.apex_rows.x, fan.apex_rows.y};
    for (int a = 0; a < 2; ++a)
      for (std::size_t s = 0; s < n; ++s)
        p_[a][s] = apex[a][s] + r * on_[a][s];
    const double ux = w * u.x, uy = w * u.y, vx = w * v.x, vy = w * v.y;
    for (std::size_t s = 0; s < n; ++s)
      weight_[s] = vy * on_[0][s] - vx * on_[1][s] + ux * along_[1][s] - uy * along_[0][s];
    if (!bends_)
      return;
    add({bulge_[0].data(), p_[0].data()}, r * (1 - r)), add({bulge_[1].data(), p_[1].data()}, r * (1 - r));
    for (std::size_t s = 0; s < n; ++s)
      weight_[s] +=
          (1 - 2 * r) * (vy * bulge_[0][s] - vx * bulge_[1][s]) + (1 - r) * (ux * turn_[1][s] - uy * turn_[0][s]);
  }

  // From the plane to the facet: theory (S10), (S11).
  void add_point(const MovingPlane &plane, const Sight3 &at, double weight) {
    const Contactor3 &c = plane.contactor();
    const std::size_t n = columns_->size;
    const int nodes = c.facet.nodes;
    double shapes[MAX_FACET_NODES], slopes[MAX_FACET_NODES][3];
    shape(c.facet.kind, at.own.xi, shapes, slopes);
    const double *axis[2] = {c.plane.e1, c.plane.e2};
    const double height = c.plane.height(at.x);
    for (int a = 0; a < 2; ++a) {
      for (int i = 0; i < nodes; ++i)
        for (int b = 0; b < 3; ++b)
          p_[a][columns_->point(i) + b] -= shapes[i] * axis[a][b];
      add({plane.tilt[a], p_[a].data()}, height, 3 * nodes);
    }
    double j[2][2]; // of the map into the plane
    for (int a = 0; a < 2; ++a)
      for (int k = 0; k < 2; ++k)
        j[a][k] = dot(at.tangent[k], axis[a], 3);
    const double det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    for (std::size_t s = 0; s < n; ++s) {
      xi_[0][s] = (j[1][1] * p_[0][s] - j[0][1] * p_[1][s]) / det;
      xi_[1][s] = (j[0][0] * p_[1][s] - j[1][0] * p_[0][s]) / det;
    }
    const double stretch = stretch_rows(plane, at, weight, slopes);
    sums_.add({at.own.xi, at.other.xi, weight * stretch, {xi_[0].data(), xi_[1].data()}, weight_.data()});
  }
  void add(std::pair<const double *, double *> rows, double factor, std::size_t n) const {
    add_row(n, factor, rows.first, rows.second);
  }

  // Turns the change of the weight in the plane into that on the facet.
  double stretch_rows(const MovingPlane &plane, const Sight3 &at, double weight, const double (*slopes)[3]) {
    const Contactor3 &c = plane.contactor();
    const std::size_t n = columns_->size;
    double area[3], by_area[3], by_normal[3], by_slope[2][3], second[3][3];
    cross(at.tangent[0], at.tangent[1], area);
    const double size = std::sqrt(dot(area, area, 3)), along = dot(area, c.plane.n, 3), stretch = size / along;
    for (int a = 0; a < 3; ++a) {
      by_area[a] = weight * (area[a] / (size * along) - stretch / along * c.plane.n[a]);
      by_normal[a] = -weight * stretch / along * area[a];
    }
    cross(at.tangent[1], by_area, by_slope[0]), cross(by_area, at.tangent[0], by_slope[1]);
    c.facet.position.second(at.own.xi, second);
    const double by_xi[2] = {dot(by_slope[0], second[0], 3) + dot(by_slope[1], second[1], 3),
                             dot(by_slope[0], second[1], 3) + dot(by_slope[1], second[2], 3)};
    for (std::size_t s = 0; s < n; ++s)
      weight_[s] = stretch * weight_[s] + by_xi[0] * xi_[0][s] + by_xi[1] * xi_[1][s];
    for (int i = 0; i < c.facet.nodes; ++i)
      for (int b = 0; b < 3; ++b)
        weight_[columns_->point(i) + b] += slopes[i][0] * by_slope[0][b] + slopes[i][1] * by_slope[1][b];
    add({plane.tilt[0], weight_.data()}, dot(by_normal, c.plane.e1, 3), 3 * c.facet.nodes);
    add({plane.tilt[1], weight_.data()}, dot(by_normal, c.plane.e2, 3), 3 * c.facet.nodes);
    return stretch;
  }

  MovingSums<3> &sums_;
  MovingEdges *edges_ = nullptr;
  const Columns *columns_ = nullptr;
  bool bends_ = false;
  std::vector<double> on_[2], along_[2], bulge_[2], turn_[2], p_[2], xi_[2], weight_; // rows
};

} // namespace abut

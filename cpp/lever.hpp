// How a contactor facet takes up the couple of a traction across a gap; see docs/theory/large-sliding.md.
#pragma once
#include "moving_columns.hpp"

namespace abut {

// Edges of a contactor facet, combinations of its corners: edge_a = sum_i share[i][a] x_i.
template <int D> class Lever {
public:
  static constexpr int EDGES = D - 1, FORCES = EDGES * D;

  void begin(const Facet &f) {
    static constexpr double line[2] = {-1, 1}, triangle[3][2] = {{-1, -1}, {1, 0}, {0, 1}};
    corners_ = CORNERS[f.kind];
    for (auto &edge : edge_)
      for (double &value : edge)
        value = 0;
    for (int i = 0; i < corners_; ++i)
      for (int e = 0; e < EDGES; ++e) {
        share_[i][e] = D == 2 ? line[i] : f.triangle() ? triangle[i][e] : 0.5 * detail::QUAD_SIGN[i][e];
        for (int a = 0; a < D; ++a)
          edge_[e][a] += share_[i][e] * f.x[i][a];
      }
  }

  // Vectors square to n with dual_e . edge_f = 1 where e is f, else 0.
  void aim(const double *n) {
    if constexpr (D == 2)
      dual_[0][0] = -n[1], dual_[0][1] = n[0];
    else
      cross(edge_[1], n, dual_[0]), cross(n, edge_[0], dual_[1]);
    const double volume = dot(edge_[0], dual_[0], D);
    for (auto &dual : dual_)
      for (double &value : dual)
        value /= volume;
  }

  // moment (dual_e . t) N, the forces on the edges. Edges are constants here: `turn` has their part.
  template <class Number> void find(const Number &moment, const Number *normal, const Number *t, Number *to) const {
    Number along[EDGES], volume;
    if constexpr (D == 2) {
      along[0] = normal[0] * t[1] - normal[1] * t[0];
      volume = edge_[0][1] * normal[0] - edge_[0][0] * normal[1];
    } else {
      double area[3];
      Number turned[3];
      cross(edge_[0], edge_[1], area), cross(normal, t, turned);
      for (int a = 0; a < 3; ++a) {
        volume += area[a] * normal[a];
        along[0] += edge_[1][a] * turned[a], along[1] -= edge_[0][a] * turned[a];
      }
    }
    const Number share = moment / volume;
    for (int e = 0; e < EDGES; ++e)
      for (int a = 0; a < D; ++a)
        to[D * e + a] = share * along[e] * normal[a];
  }

  // Adds to the rows of the forces what they change by the edges: d dual_e = -sum_f (dual_e . d edge_f) dual_f.
  template <class Number> void turn(const Number *force, const Columns &columns, std::vector<double> *rows) const {
    for (int q = 0; q < FORCES; ++q)
      for (int i = 0; i < corners_; ++i) {
        double sum = 0;
        for (int e = 0; e < EDGES; ++e)
          sum += share_[i][e] * force[D * e + q % D].v;
        for (int a = 0; a < D; ++a)
          rows[q][columns.point(i) + a] -= sum * dual_[q / D][a];
      }
  }

  // Adds rows of n columns of the forces on the edges to those of the nodes, D a node.
  void spread(std::size_t n, const double *rows, double *to) const {
    for (int q = 0; q < FORCES; ++q)
      for (int i = 0; i < corners_; ++i)
        add_row(n, share_[i][q / D], rows + q * n, to + (D * i + q % D) * n);
  }

  // Adds what a unit of `moment` makes of tractions along the axes (2D: along the turned normal) to the nodes' entries
  // of the operators, `width` apart.
  void add_operator(double moment, const double *n, std::size_t width, double *to) const {
    for (int i = 0; i < corners_; ++i) {
      double along[D] = {0};
      for (int e = 0; e < EDGES; ++e)
        add_row(D, moment * share_[i][e], dual_[e], along);
      if constexpr (D == 2)
        add_row(D, along[1] * n[0] - along[0] * n[1], n, to + i * width + D);
      else
        for (int a = 0; a < D; ++a)
          add_row(D, along[a], n, to + i * width + D + D * a);
    }
  }

private:
  int corners_ = 0;
  double share_[4][EDGES], edge_[EDGES][D], dual_[EDGES][D];
};

} // namespace abut

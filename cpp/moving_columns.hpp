// The columns of derivatives that a contactor facet and its targets have; see docs/theory/coupling-tangent.md.
#pragma once
#include "project.hpp"
#include <vector>

namespace abut {

// y += a x, rows of n columns.
inline void add_row(std::size_t n, double a, const double *x, double *y) {
  for (std::size_t s = 0; s < n; ++s)
    y[s] += a * x[s];
}

// The columns of a contactor facet and its targets: its points, its nodal normals, and the points of one target facet
// after another, dim columns each.
struct Columns {
  int dim = 0, nodes = 0; // of the contactor facet
  std::vector<int> target, first;
  int size = 0;

  void begin(int dimension, const Facet &c) {
    dim = dimension, nodes = c.nodes, size = 2 * dim * nodes;
    target.clear(), first.clear();
  }
  int point(int i) const { return dim * i; }
  int normal(int i) const { return dim * (nodes + i); }
  // First column of a target facet, which is given a place if it has none.
  int of(int t, int its_nodes) {
    for (std::size_t k = 0; k < target.size(); ++k)
      if (target[k] == t)
        return first[k];
    target.push_back(t), first.push_back(size);
    size += dim * its_nodes;
    return first.back();
  }
};

// An integration point: places on both facets and area, with rows of the changes of xi and of the area.
struct MovingPoint {
  const double *xi, *eta;
  double weight;
  const double *rate[2], *weight_rate;
};

} // namespace abut

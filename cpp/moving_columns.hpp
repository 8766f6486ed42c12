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

// Where int H_k g and int H_k of all facets are added up; facets of one thread are no others'.
struct Moments {
  double *gap, *weight;
};

// An integration point: places on both facets and area, with rows of the changes of xi and of the area.
struct MovingPoint {
  const double *xi, *eta;
  double weight;
  const double *rate[2], *weight_rate;
};

// Adds share times a row and, by the slopes of the share, force times the rows of reference coordinates.
template <int D>
inline void add_share(std::size_t size, double share, const double *row, double force, const double *slope,
                      const double *const *rate, double *to) {
  const double first = force * slope[0], second = D == 3 ? force * slope[1] : 0;
  const double *xi = rate[0], *eta = rate[1];
  if constexpr (D == 2)
    for (std::size_t s = 0; s < size; ++s)
      to[s] += share * row[s] + first * xi[s];
  else
    for (std::size_t s = 0; s < size; ++s)
      to[s] += share * row[s] + first * xi[s] + second * eta[s];
}

} // namespace abut

// Slips at integration points whose places on both surfaces are held, with derivatives; see
// docs/theory/coupling-tangent.md.
#pragma once
#include "tangent.hpp"

namespace abut {

// n points, facet by facet: numbers of both facets, areas, and values of the pressure functions and of both facets'
// shape functions, MAX_FACET_NODES each; nodal normals out of the contactor, MAX_FACET_NODES a facet.
struct SlipView {
  std::size_t n;
  const std::int32_t *facet, *target_facet;
  const double *weight, *pressure, *own, *other, *points, *target_points, *normals;
  const std::int32_t *nodes, *target_nodes;
};

// Rows MAX_FACET_NODES f + k: one component in 2D, three in 3D; theory (G6).
struct SlipLists {
  std::vector<double> value;
  Derivative by;
};

SlipLists slip(const SlipView &view, int dim, std::size_t facets, const Numbering &numbering);

} // namespace abut

// What facets of one body are to each other where its surface may touch itself; see docs/theory/large-sliding.md.
#pragma once
#include "hidden.hpp"

namespace abut {

constexpr double LEVEL = 1e-9; // of a distance: what is less above a facet lies level with it

// Whether a facet is one of the body seen through its own material, by theory (G11): each lies behind the other in the
// undeformed body, no further away than either's depth.
inline bool through_body(const double *a, const double *b) {
  double way[3], length = 0, from = 0, to = 0;
  for (int i = 0; i < 3; ++i) {
    way[i] = b[i] - a[i];
    length += way[i] * way[i], from += way[i] * a[3 + i], to += way[i] * b[3 + i];
  }
  length = std::sqrt(length);
  const double depth = std::max(a[6], b[6]);
  return length <= depth && from < -LEVEL * length && to > LEVEL * length;
}

inline bool may_touch(const SurfaceView &contactor, std::size_t c, const SurfaceView &target, std::size_t t) {
  return !contactor.kin || contactor.kin[KIN * c] != target.kin[KIN * t] ||
         !adjacent(contactor.facet_nodes(c), target.facet_nodes(t));
}

// Whether two facets of a surface are of one body, as far as that is known.
inline bool same_body(const SurfaceView &surface, std::size_t a, std::size_t b) {
  return !surface.kin || surface.kin[KIN * a] == surface.kin[KIN * b];
}

// How deep two facets may lie in each other: what is seen at a greater depth is seen through a body.
inline double deepest(const SurfaceView &contactor, std::size_t c, const SurfaceView &target, std::size_t t) {
  constexpr double most = 0.75; // of the thickness
  return contactor.kin ? most * std::min(contactor.kin[KIN * c + 9], target.kin[KIN * t + 9]) : HUGE_VAL;
}

inline Role role_of(const SurfaceView &contactor, std::size_t c, const SurfaceView &target, std::size_t t) {
  if (!contactor.kin)
    return Role::counts;
  const double *a = contactor.kin + KIN * c, *b = target.kin + KIN * t;
  if (a[0] == b[0] && through_body(a + 2, b + 2))
    return Role::through;
  return a[1] < b[1] ? Role::counts : Role::hides;
}

} // namespace abut

// Surfaces and rules as Python hands them over.
#pragma once
#include "bind.hpp"
#include "segments.hpp"

namespace abut {

inline SurfaceView view(Matrix<double> points, Vector<std::uint8_t> kinds, Matrix<std::int32_t> nodes) {
  if (nodes.shape(0) != kinds.shape(0) || nodes.shape(1) != MAX_FACET_NODES)
    throw nb::value_error("nodes must be (facets, MAX_FACET_NODES)");
  return {int(points.shape(1)), points.data(), kinds.shape(0), kinds.data(), nodes.data()};
}

// How far the smooth surface lies outside of each facet; nothing where the array is empty.
inline void add_bulge(SurfaceView &surface, Matrix<double> bulge) {
  if (!bulge.shape(0))
    return;
  if (bulge.shape(0) != surface.facets || bulge.shape(1) != MAX_FACET_NODES)
    throw nb::value_error("bulge must be (facets, MAX_FACET_NODES)");
  surface.bulge = bulge.data();
}

// What the facets of a surface are to others of their body; nothing where the array is empty.
inline void add_kin(SurfaceView &surface, Matrix<double> kin) {
  if (!kin.shape(0))
    return;
  if (kin.shape(0) != surface.facets || kin.shape(1) != KIN)
    throw nb::value_error("kin must be (facets, KIN)");
  surface.kin = kin.data();
}

inline RuleTable table(Tensor3<double> rules) {
  if (rules.shape(0) != 4)
    throw nb::value_error("rules must be (4, count, width)");
  const std::size_t step = rules.shape(1) * rules.shape(2);
  const double *data = rules.data();
  return {rules.shape(1), rules.shape(2), data, data + step, data + 2 * step, data + 3 * step};
}

} // namespace abut

// What a contactor facet can look at: a bound that spares the facets out of sight the cutting.
#pragma once
#include "flatten.hpp"
#include "tree.hpp"

namespace abut {

// Extent of something in a facet's own frame: along its plane, and above it.
struct Extent {
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  double lowest = HUGE_VAL, highest = -HUGE_VAL;
  void add(const double *flat, int axes, double height) {
    for (int a = 0; a < axes; ++a)
      low[a] = std::min(low[a], flat[a]), high[a] = std::max(high[a], flat[a]);
    lowest = std::min(lowest, height), highest = std::max(highest, height);
  }
};

// By theory (S5), points at height h above the plane of the facet are seen from places at most h times `slope` beside
// them. So a target whose extent, that much wider, misses the facet's own cannot be seen. Reach is measured from the
// facet itself, and how far its normals lean is its own matter too: what is far away on the surface costs nothing.
class Horizon {
public:
  Horizon(const Facet &c, double reach) : dim_(c.dim), reach_(reach) {
    set_frame(c);
    const Hull hull(c, c.x), normals(c, c.normals);
    own_ = extent(hull);
    double size = 0;
    for (int a = 0; a < dim_ - 1; ++a)
      size = std::max(size, own_.high[a] - own_.low[a]);
    margin_ = ROUNDING * size;
    for (int i = 0; i < normals.size; ++i) {
      const double along = dot(normals.x[i], normal_, dim_);
      for (int a = 0; a < dim_ - 1; ++a)
        slope_[a] =
            along < LEANING ? HUGE_VAL : std::max(slope_[a], std::abs(dot(normals.x[i], axis_[a], dim_)) / along);
    }
    for (double &slope : slope_)
      slope += ROUNDING;
  }

  // Anything inside the hull of a target facet.
  bool may_see(const Hull &hull) const { return may_see(extent(hull)); }

  // Anything inside a box along the axes.
  bool may_see(const Box &box) const {
    double middle[3], half[3];
    for (int a = 0; a < dim_; ++a)
      middle[a] = 0.5 * (box.low[a] + box.high[a]), half[a] = 0.5 * (box.high[a] - box.low[a]);
    Extent its;
    add(its, middle);
    auto widen = [&](const double *e, double &low, double &high) {
      double wide = 0;
      for (int a = 0; a < dim_; ++a)
        wide += std::abs(e[a]) * half[a];
      low -= wide, high += wide;
    };
    for (int a = 0; a < dim_ - 1; ++a)
      widen(axis_[a], its.low[a], its.high[a]);
    widen(normal_, its.lowest, its.highest);
    return may_see(its);
  }

private:
  static constexpr double ROUNDING = 1e-9; // of its size
  static constexpr double LEANING = 0.2;   // cosine between normals from which down no bound is given

  void set_frame(const Facet &c) {
    if (dim_ == 3) {
      const Plane plane = mean_plane(c);
      std::copy(plane.origin, plane.origin + 3, origin_), std::copy(plane.n, plane.n + 3, normal_);
      std::copy(plane.e1, plane.e1 + 3, axis_[0]), std::copy(plane.e2, plane.e2 + 3, axis_[1]);
      return;
    }
    for (int a = 0; a < 2; ++a)
      origin_[a] = c.x[0][a], axis_[0][a] = c.x[1][a] - c.x[0][a];
    normalize(axis_[0], 2);
    normal_[0] = axis_[0][1], normal_[1] = -axis_[0][0];
  }

  void add(Extent &extent, const double *x) const {
    double d[3], flat[2];
    for (int a = 0; a < dim_; ++a)
      d[a] = x[a] - origin_[a];
    for (int a = 0; a < dim_ - 1; ++a)
      flat[a] = dot(d, axis_[a], dim_);
    extent.add(flat, dim_ - 1, dot(d, normal_, dim_));
  }

  Extent extent(const Hull &hull) const {
    Extent result;
    for (int i = 0; i < hull.size; ++i)
      add(result, hull.x[i]);
    return result;
  }

  bool may_see(const Extent &its) const {
    const double above = its.highest - own_.lowest, below = own_.highest - its.lowest;
    if (-below > 2 * reach_ || -above > 2 * reach_)
      return false;
    const double height = std::max(above, below);
    for (int a = 0; a < dim_ - 1; ++a) {
      const double wider = height * slope_[a] + margin_;
      if (its.low[a] - wider > own_.high[a] || its.high[a] + wider < own_.low[a])
        return false;
    }
    return true;
  }

  int dim_;
  double reach_, origin_[3], axis_[2][3], normal_[3], slope_[2] = {0, 0}, margin_;
  Extent own_;
};

} // namespace abut

// Facets beside a sharp edge of the target that presses: docs/theory/segments.md, Candidates.
#pragma once
#include "segments.hpp"
#include <algorithm>
#include <array>
#include <vector>

namespace abut {

constexpr double CREASE = 0.76604; // cosine of 40 degrees: facets that meet at a larger angle have an edge between
constexpr double MORE_EDGE_ON = 1.0 / 3; // of the cosine of the facet across an edge: a facet with less is a wall there

// The facets of a target, and what each of them meets at its edges (3D) or ends (2D).
class Neighbours {
public:
  // normals: of the facets, out of the body, in their middles
  Neighbours(const SurfaceView &surface, std::vector<std::array<double, 3>> normals)
      : dim_(surface.dim), normals_(std::move(normals)), middle_(surface.facets), begin_(surface.facets + 1, 0) {
    struct Edge {
      std::array<std::int32_t, 2> nodes;
      std::int32_t facet;
    };
    std::vector<Edge> edges;
    for (std::size_t t = 0; t < surface.facets; ++t) {
      const std::int32_t *nodes = surface.facet_nodes(t);
      const int n = CORNERS[surface.kinds[t]];
      for (int i = 0; i < n; ++i) {
        const std::int32_t a = nodes[i], b = dim_ == 3 ? nodes[(i + 1) % n] : a;
        edges.push_back({{std::min(a, b), std::max(a, b)}, std::int32_t(t)});
        for (int x = 0; x < dim_; ++x)
          middle_[t][x] += surface.points[std::size_t(a) * dim_ + x] / n;
      }
    }
    std::sort(edges.begin(), edges.end(),
              [](const Edge &a, const Edge &b) { return a.nodes != b.nodes ? a.nodes < b.nodes : a.facet < b.facet; });
    std::vector<std::array<std::int32_t, 2>> pairs; // facet and number of the edge
    for (std::size_t a = 0; a < edges.size(); ++a)
      for (std::size_t b = a + 1; b < edges.size() && edges[b].nodes == edges[a].nodes; ++b) {
        const std::int32_t edge = std::int32_t(at_.size());
        at_.push_back({});
        for (int x = 0; x < dim_; ++x)
          for (const std::int32_t node : edges[a].nodes)
            at_.back()[x] += 0.5 * surface.points[std::size_t(node) * dim_ + x];
        ends_.push_back({edges[a].facet, edges[b].facet});
        pairs.push_back({edges[a].facet, edge}), pairs.push_back({edges[b].facet, edge});
      }
    std::sort(pairs.begin(), pairs.end());
    for (const auto &[facet, edge] : pairs)
      ++begin_[std::size_t(facet) + 1], edge_.push_back(edge);
    for (std::size_t t = 0; t < surface.facets; ++t)
      begin_[t + 1] += begin_[t];
  }

  const double *normal(int t) const { return normals_[t].data(); }

  // Whether facet t, seen from x along n as far away as `gap`, is a wall beside an edge that is nearer: on the way back
  // to the contactor, over edge after edge, there is one across which a facet faces the contactor much more. No edge
  // counts that lies deeper in the contactor than what is seen is far away.
  bool wall(int t, const double *x, const double *n, double gap) const {
    const double own = -dot(normal(t), n, dim_);
    if (own >= MORE_EDGE_ON)
      return false;
    const double deepest = dot(x, n, dim_) - std::abs(gap);
    double low = dot(middle_[t].data(), n, dim_);
    for (int at = t;;) {
      int next = -1;
      double lowest = low;
      for (int i = begin_[at]; i < begin_[at + 1]; ++i) {
        const double height = dot(at_[edge_[i]].data(), n, dim_);
        const int other = ends_[edge_[i]][0] == at ? ends_[edge_[i]][1] : ends_[edge_[i]][0];
        if (!(height < low && height >= deepest))
          continue;
        if (dot(normal(at), normal(other), dim_) >= CREASE) {
          if (height < lowest)
            lowest = height, next = other;
        } else if (own < -MORE_EDGE_ON * dot(normal(other), n, dim_))
          return true;
      }
      if (next < 0)
        return false;
      at = next, low = lowest;
    }
  }

private:
  int dim_;
  std::vector<std::array<double, 3>> normals_, middle_, at_; // of facets twice; middle of an edge
  std::vector<std::array<std::int32_t, 2>> ends_;            // of an edge: two facets
  std::vector<std::int32_t> begin_, edge_;                   // of a facet: its edges
};

} // namespace abut

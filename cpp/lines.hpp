// Segments in 2D: intervals of a contactor line; see docs/theory/segments.md.
#pragma once
#include "accumulator.hpp"
#include "hidden.hpp"
#include "project.hpp"
#include "sight.hpp"
#include <numbers>

namespace abut {

// Where the contactor sees the point v along its continuous normal, clamped to the facet: the root of
// (v - x(xi)) x n(xi), which neighbouring facets share at their common node; theory (S3).
inline double sees(const Facet &c, const double *v) {
  auto ahead = [&](double xi) { // > 0 where v lies ahead of xi
    const double place[2] = {xi, 0};
    double x[3], n[3];
    c.position.at(place, x), c.normal(place, n);
    return -((v[0] - x[0]) * n[1] - (v[1] - x[1]) * n[0]);
  };
  double low = -1, high = 1, at_low = ahead(low), at_high = ahead(high);
  if (at_low <= 0)
    return -1;
  if (at_high >= 0)
    return 1;
  double xi = low + (high - low) * at_low / (at_low - at_high);
  for (int i = 0; i < 60; ++i) { // regula falsi safeguarded by bisection
    const double value = ahead(xi);
    if (value > 0)
      low = xi, at_low = value;
    else
      high = xi, at_high = value;
    if (value == 0 || high - low < 1e-15)
      break;
    double next = low + (high - low) * at_low / (at_low - at_high);
    if (i % 3 == 2)
      next = 0.5 * (low + high);
    if (std::abs(next - xi) < 1e-16)
      break;
    xi = next;
  }
  return xi;
}

// What a contactor line sees of a target facet from one of its points.
struct Sight2 {
  const Facet &c;
  Spot<3> other;
  double x[3], tangent[2][3], n[3], gap = 0; // between the smooth surfaces
  double nc[MAX_FACET_NODES], nt[MAX_FACET_NODES];

  explicit Sight2(const Facet &own, double eta = 0) : c(own) { begin(eta); }
  void begin(double eta) {
    const double at[2] = {eta, 0};
    other.begin(at);
  }
  bool look(const Facet &t, double xi) { // the point seen from x: theory (S2)
    const double place[2] = {xi, 0};
    c.position.at(place, x, tangent), c.normal(place, n);
    const double along[2] = {-n[1], n[0]};
    if (!project_line(t, x, along, other))
      return false;
    gap = (other.x[0] - x[0]) * n[0] + (other.x[1] - x[1]) * n[1] - c.bulge_at(place) - t.bulge_at(other.xi);
    c.values(place, nc), t.values(other.xi, nt);
    return true;
  }
};

inline void cut_line(const Facet &c, const Facet &t, int number, Reach reach, std::vector<Segment> &out) {
  Segment own;
  own.target = number;
  own.begin = sees(c, t.x[1]), own.end = sees(c, t.x[0]); // the target runs the other way
  if (own.end - own.begin < 1e-14)
    return;
  // The middle decides whether the two face each other within reach.
  Sight2 at(c);
  if (!at.look(t, 0.5 * (own.begin + own.end)) || !reach.has(at.gap))
    return;
  double y[3], slope[2][3];
  t.position.at(at.other.xi, y, slope);
  const double *along = slope[0], size = std::sqrt(dot(along, along, 2));
  if (along[1] * at.n[0] - along[0] * at.n[1] >= -EDGE_ON * size)
    return;
  own.eta[0] = at.other.xi[0], own.gap = at.gap;
  std::copy(at.x, at.x + 2, own.x), std::copy(at.n, at.n + 2, own.n);
  out.push_back(own);
}

inline void find_hidden(const Facet &c, const std::vector<Facet> &targets, const std::int32_t *nodes,
                        std::vector<Segment> &segments) {
  find_hidden<double>(
      segments, nodes,
      [](const Segment &a, const Segment &b, double &middle) {
        const double begin = std::max(a.begin, b.begin), end = std::min(a.end, b.end);
        middle = 0.5 * (begin + end);
        return end - begin > TOUCHING;
      },
      [&](const Segment &own, double middle) {
        Sight2 at(c, own.eta[0]);
        return at.look(targets[own.target], middle) ? at.gap : HUGE_VAL;
      });
}

inline void integrate_line(const Facet &c, const Facet &t, double begin, double end, double start, const Rule &rule,
                           bool axisymmetric, Accumulator &sums) {
  bool counted = false;
  Sight2 at(c, start);
  if (sums.wants_sights()) {
    for (const double xi : {0.5 * (begin + end), begin, end})
      if (at.look(t, xi)) {
        const double normal[2] = {-at.n[0], -at.n[1]};
        sums.see(at.nc, at.nt, at.gap, normal);
      }
    at.begin(start); // the integration begins at the same place with gap_samples and without
  }
  for (int q = 0; q < rule.n; ++q) {
    const double xi = begin + rule.t[q] * (end - begin);
    if (!at.look(t, xi))
      return;
    double length = std::sqrt(dot(at.tangent[0], at.tangent[0], 2));
    if (axisymmetric)
      length *= 2 * std::numbers::pi * at.x[0];
    const double normal[2] = {-at.n[0], -at.n[1]};
    if (!counted)
      sums.count_segment(), counted = true;
    sums.add(c.kind, &xi, at.nc, at.nt, rule.wt[q] * (end - begin) * length, at.gap, normal);
  }
}

inline void integrate_line(const Facet &c, const Facet &t, const Segment &own, const std::vector<Segment> &segments,
                           const Rule &rule, bool axisymmetric, Accumulator &sums) {
  std::vector<std::array<double, 2>> others;
  for (int nearer : own.behind)
    others.push_back({segments[nearer].begin, segments[nearer].end});
  for (const auto &part : outside_of({own.begin, own.end}, others))
    integrate_line(c, t, part[0], part[1], own.eta[0], rule, axisymmetric, sums);
}

} // namespace abut

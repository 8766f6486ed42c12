// Derivatives in 2D: the ends of intervals move with the target's nodes; see docs/theory/coupling-tangent.md.
#pragma once
#include "cutting.hpp"
#include "moving_sums.hpp"

namespace abut {

// Nearer than this to an end of the contactor facet, what it sees counts as the end itself, on both facets that meet
// there: of the reference domain.
constexpr double AT_END = 1e-10;

// Change of the place xi where the contactor sees the point v, whose columns begin at `first`: theory (S3).
inline void end_rate(const Facet &c, double xi, const double *v, int first, const Columns &columns, double *row) {
  std::fill(row, row + columns.size, 0.0);
  if (1 - std::abs(xi) < AT_END)
    return;
  double x[3], m[3], slope[2][3], turn[2][3], n[MAX_FACET_NODES];
  const double place[2] = {xi, 0};
  c.position.at(place, x, slope), c.direction.at(place, m, turn), c.values(place, n);
  const double away[2] = {v[0] - x[0], v[1] - x[1]};
  const double by_xi =
      -(slope[0][0] * m[1] - slope[0][1] * m[0]) + away[0] * turn[0][1] - away[1] * turn[0][0]; // exact slope
  const double by_v[2] = {m[1], -m[0]}, by_m[2] = {-away[1], away[0]};
  for (int a = 0; a < 2; ++a) {
    row[first + a] -= by_v[a] / by_xi;
    for (int i = 0; i < c.nodes; ++i) {
      row[columns.point(i) + a] += n[i] * by_v[a] / by_xi;
      row[columns.normal(i) + a] -= n[i] * by_m[a] / by_xi;
    }
  }
}

// Integrates what one contactor facet sees of one target facet.
class MovingLine {
public:
  MovingLine(const Facet &c, const std::vector<Facet> &targets, const std::vector<Segment> &segments, bool axisymmetric,
             MovingSums<2> &sums)
      : c_(c), targets_(targets), segments_(segments), axisymmetric_(axisymmetric), sums_(sums) {}

  void integrate(const Segment &own, const Rule &rule, const Columns &columns) {
    for (auto *row : {&begin_, &end_, &xi_, &weight_})
      row->resize(columns.size);
    std::vector<std::array<double, 2>> others;
    for (int nearer : own.behind)
      others.push_back({segments_[nearer].begin, segments_[nearer].end});
    for (const auto &part : outside_of({own.begin, own.end}, others)) {
      rate_of(part[0], own, columns, begin_.data()), rate_of(part[1], own, columns, end_.data());
      integrate(own, part, rule, columns);
    }
  }

private:
  // Which segment a part ends with.
  void rate_of(double xi, const Segment &own, const Columns &columns, double *row) const {
    auto try_one = [&](const Segment &segment) {
      if (xi != segment.begin && xi != segment.end)
        return false;
      const int node = xi == segment.begin ? 1 : 0; // the target runs the other way
      const Facet &t = targets_[segment.target];
      std::size_t k = 0;
      while (columns.target[k] != segment.target)
        ++k;
      end_rate(c_, xi, t.x[node], columns.first[k] + 2 * node, columns, row);
      return true;
    };
    if (try_one(own))
      return;
    for (int nearer : own.behind)
      if (try_one(segments_[nearer]))
        return;
  }

  void integrate(const Segment &own, const std::array<double, 2> &part, const Rule &rule, const Columns &columns) {
    const Facet &t = targets_[own.target];
    Sight2 at(c_, own.eta[0]);
    const double size = part[1] - part[0];
    for (int q = 0; q < rule.n; ++q) {
      const double xi[2] = {part[0] + rule.t[q] * size, 0};
      if (!at.look(t, xi[0]))
        return;
      for (int s = 0; s < columns.size; ++s)
        xi_[s] = (1 - rule.t[q]) * begin_[s] + rule.t[q] * end_[s];
      const double weight = find_weight(xi, at, rule.wt[q], size, columns);
      sums_.add({xi, at.other.xi, weight, {xi_.data(), nullptr}, weight_.data()});
    }
  }

  // Length, times 2 pi r round an axis, and its change.
  double find_weight(const double *xi, const Sight2 &at, double wt, double size, const Columns &columns) {
    double n[MAX_FACET_NODES], dn[MAX_FACET_NODES][3];
    shape(c_.kind, xi, n, dn);
    const double *slope = at.tangent[0], length = std::sqrt(dot(slope, slope, 2));
    double bend = 0;
    for (int a = 0; a < 2 && c_.position.terms > 4; ++a)
      bend += 2 * slope[a] * c_.position.c[4][a];
    const double around = axisymmetric_ ? 2 * std::numbers::pi * at.x[0] : 1;
    const double turning = axisymmetric_ ? 2 * std::numbers::pi : 0;
    const double by_size = wt * length * around;
    const double by_xi = wt * size * (bend / length * around + length * turning * slope[0]);
    for (int s = 0; s < columns.size; ++s)
      weight_[s] = by_size * (end_[s] - begin_[s]) + by_xi * xi_[s];
    for (int i = 0; i < c_.nodes; ++i) {
      for (int a = 0; a < 2; ++a)
        weight_[columns.point(i) + a] += wt * size * around * slope[a] / length * dn[i][0];
      weight_[columns.point(i)] += wt * size * length * turning * n[i];
    }
    return by_size * size;
  }

  const Facet &c_;
  const std::vector<Facet> &targets_;
  const std::vector<Segment> &segments_;
  bool axisymmetric_;
  MovingSums<2> &sums_;
  std::vector<double> begin_, end_, xi_, weight_;
};

} // namespace abut

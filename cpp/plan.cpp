// How many integration points and subdivisions each facet needs, from its own moments.
#include "contactor.hpp"
#include "parallel.hpp"

namespace abut {

constexpr std::size_t FEW_FACETS = 200; // not worth a thread
constexpr double STRICT = 1e-12;        // tolerance for affine facets: theory (Q4)
constexpr double COARSE = 1e-10;        // tolerances from here up: fewer points do for the moments to be met
constexpr int COARSE_POINTS = 6;
// Gauss points for N_i N_j on affine facets of each type: curved ones do not do with fewer.
constexpr std::array<int, QUAD9 + 1> AFFINE_POINTS{2, 3, 2, 3, 3, 4, 5};

namespace {

// Largest error of int N_i N_j over the facet with this rule on its own polygons, relative to the area: theory (Q4).
double moment_error(const Facet &f, const Contactor3 &own, const Rule &rule, bool fan,
                    const double (*exact)[MAX_FACET_NODES], double area) {
  double sum[MAX_FACET_NODES][MAX_FACET_NODES] = {{0}};
  Spot<2> at;
  f.centre(at.xi);
  for (const Piece &piece : own.pieces) {
    Polygon polygon;
    for (int i = 0; i < piece.size; ++i)
      polygon.push({piece.p[i], 0, i});
    const auto curve_of = [&](const Vertex &v) { return &piece.curve[v.edge]; };
    integrate_polygon(polygon, curve_of, rule, fan, [&](Point2 p, double weight) {
      if (!own.locate(p, at))
        return;
      double x[3], tangent[2][3], n[MAX_FACET_NODES], normal[3];
      f.position.at(at.xi, x, tangent);
      f.values(at.xi, n);
      cross(tangent[0], tangent[1], normal);
      weight *= std::sqrt(dot(normal, normal, 3)) / dot(normal, own.plane.n, 3);
      for (int i = 0; i < f.nodes; ++i)
        for (int j = 0; j <= i; ++j)
          sum[i][j] += weight * n[i] * n[j];
    });
  }
  double error = 0;
  for (int i = 0; i < f.nodes; ++i)
    for (int j = 0; j <= i; ++j)
      error = std::max(error, std::abs(sum[i][j] - exact[i][j]));
  return error / area;
}

// The same in 2D, integrating over the chord so that the inverse map is exercised.
double moment_error_line(const Facet &f, const Rule &rule, const double (*exact)[MAX_FACET_NODES], double length,
                         bool axisymmetric) {
  double sum[MAX_FACET_NODES][MAX_FACET_NODES] = {{0}}, chord[2] = {f.x[1][0] - f.x[0][0], f.x[1][1] - f.x[0][1]};
  normalize(chord, 2);
  Spot<3> at;
  f.centre(at.xi);
  for (int q = 0; q < rule.n; ++q) {
    double from[2], x[3], tangent[2][3], n[MAX_FACET_NODES];
    for (int a = 0; a < 2; ++a)
      from[a] = f.x[0][a] + rule.t[q] * (f.x[1][a] - f.x[0][a]);
    if (!project_line(f, from, chord, at))
      return HUGE_VAL;
    f.position.at(at.xi, x, tangent);
    f.values(at.xi, n);
    double speed = std::sqrt(dot(tangent[0], tangent[0], 2)) / dot(tangent[0], chord, 2);
    if (axisymmetric)
      speed *= x[0];
    const double span = (f.x[1][0] - f.x[0][0]) * chord[0] + (f.x[1][1] - f.x[0][1]) * chord[1];
    for (int i = 0; i < f.nodes; ++i)
      for (int j = 0; j <= i; ++j)
        sum[i][j] += rule.wt[q] * span * speed * n[i] * n[j];
  }
  double error = 0;
  for (int i = 0; i < f.nodes; ++i)
    for (int j = 0; j <= i; ++j)
      error = std::max(error, std::abs(sum[i][j] - exact[i][j]));
  return error / length;
}

// theory (S7)
int subdivisions_needed(const Facet &f) {
  if (!quadratic(f.kind) || f.dim == 2 || f.affine)
    return 1;
  const Plane plane = mean_plane(f);
  const int corners = f.triangle() ? 3 : 4;
  double sagitta = 0;
  for (int i = 0; i < corners; ++i) {
    const Point2 a = plane.flat(f.x[i]), b = plane.flat(f.x[(i + 1) % corners]), m = plane.flat(f.x[corners + i]);
    sagitta = std::max(sagitta, std::abs(cross2(b - a, m - a)) / dot2(b - a, b - a));
  }
  // The error of a segment whose topology the chords get wrong goes with the square of the sagitta.
  return std::min(12, std::max(1, int(std::ceil(std::sqrt(sagitta / 0.03) - 1e-9))));
}

// int N_i N_j over the facet by a rule of many points; returns the area.
double exact_moments(const Facet &facet, const Rule &fine, bool axisymmetric, double (*exact)[MAX_FACET_NODES]) {
  const bool triangle = facet.triangle(), line = facet.dim == 2;
  double area = 0;
  for (int p = 0; p < fine.n; ++p)
    for (int q = 0; q < (line ? 1 : fine.n); ++q) {
      double xi[2], weight, x[3], tangent[2][3], n[MAX_FACET_NODES], normal[3];
      if (line)
        xi[0] = 2 * fine.t[p] - 1, xi[1] = 0, weight = 2 * fine.wt[p];
      else if (triangle)
        xi[0] = fine.r[q] * (1 - fine.t[p]), xi[1] = fine.r[q] * fine.t[p], weight = fine.wt[p] * fine.wr[q];
      else
        xi[0] = 2 * fine.t[p] - 1, xi[1] = 2 * fine.t[q] - 1, weight = 4 * fine.wt[p] * fine.wt[q];
      facet.position.at(xi, x, tangent);
      facet.values(xi, n);
      if (line) {
        weight *= std::sqrt(dot(tangent[0], tangent[0], 2)) * (axisymmetric ? x[0] : 1.0);
      } else {
        cross(tangent[0], tangent[1], normal);
        weight *= std::sqrt(dot(normal, normal, 3));
      }
      area += weight;
      for (int i = 0; i < facet.nodes; ++i)
        for (int j = 0; j <= i; ++j)
          exact[i][j] += weight * n[i] * n[j];
    }
  return area;
}

// The fewest points whose own moments meet the tolerance.
int points_needed(Facet facet, int subdivisions, const RuleTable &rules, const RuleTable &exact_rules, double tolerance,
                  bool axisymmetric) {
  double exact[MAX_FACET_NODES][MAX_FACET_NODES] = {{0}};
  const bool coarse = tolerance >= COARSE;
  const int most = coarse ? COARSE_POINTS : int(exact_rules.count);
  const double area = exact_moments(facet, exact_rules.rule(most), axisymmetric, exact);
  const int last = int(rules.count);
  int n = coarse ? std::min(last, std::max(AFFINE_POINTS[facet.kind], 3)) : 1;
  if (facet.dim == 2) {
    while (n < last && !(moment_error_line(facet, rules.rule(n), exact, area, axisymmetric) < tolerance))
      ++n;
    return n;
  }
  for (int i = 0; i < facet.nodes; ++i)
    for (int a = 0; a < 3; ++a)
      facet.normals[i][a] = 0;
  const Contactor3 own(facet, subdivisions);
  while (n < last && !(moment_error(facet, own, rules.rule(n), coarse, exact, area) < tolerance))
    ++n;
  return n;
}

} // namespace

void plan(const SurfaceView &surface, const RuleTable &rules, const RuleTable &exact_rules, const double *tolerance,
          bool axisymmetric, std::vector<std::int32_t> &points, std::vector<std::int32_t> &subdivisions) {
  std::array<int, KIND_COUNT> affine_points{}; // affine facets of one type all need the same
  // One number of subdivisions for all facets with curves: were a common edge one chord here and two there, segments
  // cut by the chords would overlap or leave out what lies between.
  int most = 1;
  for (std::size_t f = 0; f < surface.facets; ++f)
    most = std::max(most, subdivisions_needed(surface.facet(f)));
  points.assign(surface.facets, 0);
  subdivisions.assign(surface.facets, 1);
  std::vector<std::size_t> others;
  for (std::size_t f = 0; f < surface.facets; ++f) {
    const Facet facet = surface.facet(f);
    if (quadratic(facet.kind))
      subdivisions[f] = most;
    if (!facet.affine || axisymmetric) {
      others.push_back(f);
      continue;
    }
    int &known = affine_points[facet.kind];
    if (!known)
      known = points_needed(facet, subdivisions[f], rules, exact_rules, STRICT, axisymmetric);
    points[f] = known;
  }
  const std::size_t parts = others.size() < FEW_FACETS ? 1 : thread_count();
  run_parts(parts, [&](std::size_t part) {
    for (std::size_t i = part; i < others.size(); i += parts)
      points[others[i]] = points_needed(surface.facet(others[i]), subdivisions[others[i]], rules, exact_rules,
                                        tolerance[others[i]], axisymmetric);
  });
}

} // namespace abut

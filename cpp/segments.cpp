// The 2D and 3D loops over contactor facets; see docs/theory/segments.md for the construction.
#include "segments.hpp"
#include "accumulator.hpp"
#include "contactor.hpp"
#include "parallel.hpp"
#include "sight.hpp"
#include "tree.hpp"
#include <numbers>

namespace abut {

Facet<double> SurfaceView::facet(std::size_t f) const {
  Facet<double> out;
  out.kind = kinds[f], out.dim = dim, out.nodes = NODES[out.kind];
  for (int i = 0; i < out.nodes; ++i)
    for (int a = 0; a < dim; ++a) {
      out.x[i][a] = points[std::size_t(nodes[9 * f + i]) * dim + a];
      if (normals)
        out.normals[i][a] = normals[(9 * f + i) * dim + a];
    }
  out.affine = is_affine(out);
  return out;
}

namespace {

constexpr std::size_t FEW_FACETS = 500; // not worth a thread

Box box_of(const Facet<double> &f) {
  Box box;
  for (int i = 0; i < f.nodes; ++i)
    box.add(f.x[i], f.dim);
  if (quadratic(f.kind))
    box.inflate(0.15 * box.diagonal(f.dim), f.dim);
  return box;
}

// ---- 2D ------------------------------------------------------------------------------------------------------------

// Where the contactor sees the point v along its continuous normal, clamped to the facet: the root of
// (v - x(xi)) x n(xi), which neighbouring facets share at their common node; theory (S3).
double sees(const Facet<double> &c, const double *v) {
  auto ahead = [&](double xi) { // > 0 where v lies ahead of xi
    double x[3], tangent[2][3], n[3];
    c.at(&xi, x, tangent, n);
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

void couple_line(const Facet<double> &c, const Facet<double> &t, const Rule &rule, double reach, bool axisymmetric,
                 Accumulator &sums) {
  const double begin = sees(c, t.x[1]), end = sees(c, t.x[0]); // the target runs the other way
  if (end - begin < 1e-14)
    return;
  bool counted = false;
  double eta[2] = {0, 0}, x[3], tangent[2][3], n[3], y[3], target_tangent[2][3], gap = 0;
  double nc[MAX_FACET_NODES], nt[MAX_FACET_NODES], d[MAX_FACET_NODES][3];
  auto look = [&](double xi) { // the point seen from x: theory (S2)
    c.at(&xi, x, tangent, n);
    const double along[2] = {-n[1], n[0]};
    if (!project(t, x, along, along, eta))
      return false;
    t.at(eta, y, target_tangent);
    gap = (y[0] - x[0]) * n[0] + (y[1] - x[1]) * n[1];
    c.values(&xi, nc, d), t.values(eta, nt, d);
    return true;
  };
  auto see = [&] {
    const double normal[2] = {-n[0], -n[1]};
    sums.see(nc, nt, gap, normal);
  };
  // The middle decides whether the two face each other within reach.
  const double middle = 0.5 * (begin + end);
  if (!look(middle) || std::abs(gap) > reach || target_tangent[0][1] * n[0] - target_tangent[0][0] * n[1] >= 0)
    return;
  if (sums.wants_sights()) {
    const double start = eta[0]; // the integration begins at the same place with sights and without
    see();
    for (const double xi : {begin, end})
      if (look(xi))
        see();
    eta[0] = start;
  }
  for (int q = 0; q < rule.n; ++q) {
    const double xi = begin + rule.t[q] * (end - begin);
    if (!look(xi))
      return;
    double length = std::sqrt(dot(tangent[0], tangent[0], 2));
    if (axisymmetric)
      length *= 2 * std::numbers::pi * x[0];
    const double normal[2] = {-n[0], -n[1]};
    if (!counted)
      sums.count_segment(), counted = true;
    sums.add(c.kind, &xi, nc, nt, rule.wt[q] * (end - begin) * length, gap, normal);
  }
}

// ---- 3D ------------------------------------------------------------------------------------------------------------

void couple_pieces(const Contactor3 &c, const Facet<double> &t, const Piece &mine, const Piece &theirs,
                   const Rule &rule, double reach, Accumulator &sums) {
  Polygon subject;
  double scale = 0;
  for (int i = 0; i < mine.size; ++i) {
    subject.push({mine.p[i], 0, i});
    scale += std::abs(cross2(mine.p[i] - mine.p[0], mine.p[(i + 1) % mine.size] - mine.p[0]));
  }
  Polygon polygon = clip_convex(subject, theirs.p, theirs.size);
  if (polygon.size < 3)
    return;
  Point2 corner[MAX_CLIP], middle{0, 0};
  const std::array<Curve, 4> curves[2] = {mine.curve, theirs.curve};
  for (int i = 0; i < polygon.size; ++i) {
    Vertex &v = polygon.v[i];
    const Vertex &before = polygon.v[(i + polygon.size - 1) % polygon.size];
    const Curve &in = curves[before.side][before.edge], &out = curves[v.side][v.edge];
    if (before.side != v.side && !(in.straight && out.straight))
      polish(in, out, v.p);
    corner[i] = v.p;
    middle = middle + (1.0 / polygon.size) * v.p;
  }
  if (std::abs(signed_area(corner, polygon.size)) < 1e-15 * scale)
    return;

  double xi[2], eta[2];
  c.facet.centre(xi), t.centre(eta);
  // Looks from the contactor at p along its normal; returns the gap, or infinity where nothing is seen: theory (S2).
  double x[3], tangent[2][3], n[3], y[3], target_tangent[2][3], turned[2][3], nc[MAX_FACET_NODES], nt[MAX_FACET_NODES];
  auto look = [&](Point2 p) {
    if (!c.locate(p, xi))
      return HUGE_VAL;
    const double *t1 = c.plane.e1, *t2 = c.plane.e2;
    if (c.flat) {
      c.facet.at(xi, x, tangent, nullptr, nc);
      std::copy(c.plane.n, c.plane.n + 3, n);
    } else {
      c.facet.at(xi, x, tangent, n, nc);
      frame(n, turned[0], turned[1]);
      t1 = turned[0], t2 = turned[1];
    }
    if (!project(t, x, t1, t2, eta))
      return HUGE_VAL;
    t.at(eta, y, target_tangent, nullptr, nt);
    return (y[0] - x[0]) * n[0] + (y[1] - x[1]) * n[1] + (y[2] - x[2]) * n[2];
  };
  if (!(std::abs(look(middle)) <= reach))
    return;
  double facing[3];
  cross(target_tangent[0], target_tangent[1], facing);
  if (dot(facing, n, 3) >= 0)
    return;
  sums.count_segment();
  if (sums.wants_sights()) {
    auto see = [&](Point2 p) {
      const double gap = look(p), normal[3] = {-n[0], -n[1], -n[2]};
      if (gap != HUGE_VAL)
        sums.see(nc, nt, gap, normal);
    };
    const double start[4] = {xi[0], xi[1], eta[0], eta[1]}; // integrals are the same with sights and without
    see(middle);
    for (int i = 0; i < polygon.size; ++i)
      see(corner[i]);
    std::copy(start, start + 2, xi), std::copy(start + 2, start + 4, eta);
  }
  integrate_polygon(polygon, curves, rule, [&](Point2 p, double weight) {
    if (weight == 0)
      return;
    const double gap = look(p);
    if (gap == HUGE_VAL)
      return;
    double area[3]; // the area on the facet over that in the plane: theory (S11)
    cross(tangent[0], tangent[1], area);
    const double stretch = std::sqrt(dot(area, area, 3)) / dot(area, c.plane.n, 3), normal[3] = {-n[0], -n[1], -n[2]};
    sums.add(c.facet.kind, xi, nc, nt, weight * stretch, gap, normal);
  });
}

void couple_facet(const Contactor3 &c, const Facet<double> &t, int subdivide, const Rule &rule, double reach,
                  std::vector<Piece> &pieces, Accumulator &sums) {
  pieces.clear();
  flatten(
      t, subdivide, true,
      [&](const double *eta, Point2 &p) {
        double y[3], tangent[2][3];
        t.at(eta, y, tangent);
        p = c.carry(y);
        return true;
      },
      pieces);
  for (const Piece &mine : c.pieces)
    for (const Piece &theirs : pieces) {
      Box a, b;
      for (int i = 0; i < mine.size; ++i)
        a.add(&mine.p[i].x, 2);
      for (int i = 0; i < theirs.size; ++i)
        b.add(&theirs.p[i].x, 2);
      if (a.meets(b, 2))
        couple_pieces(c, t, mine, theirs, rule, reach, sums);
    }
}

} // namespace

Coupling couple(const SurfaceView &contactor, const SurfaceView &target, const RuleTable &rules,
                const std::int32_t *points_c, const std::int32_t *points_t, const std::int32_t *subdivide_c,
                const std::int32_t *subdivide_t, const Options &options) {
  const int dim = contactor.dim;
  Coupling out;
  out.gap.assign(9 * contactor.facets, 0), out.weight.assign(9 * contactor.facets, 0);
  out.mass.assign(81 * contactor.facets, 0), out.covered.assign(contactor.facets, 0);
  out.segments.assign(contactor.facets, 0);

  std::vector<Facet<double>> targets(target.facets);
  std::vector<Box> boxes(target.facets);
  for (std::size_t t = 0; t < target.facets; ++t)
    targets[t] = target.facet(t), boxes[t] = box_of(targets[t]);
  const Tree tree(boxes, dim);

  const std::size_t parts = contactor.facets < FEW_FACETS ? 1 : thread_count();
  std::vector<Lists> lists(parts);
  run_parts(parts, [&](std::size_t part) {
    Accumulator sums(out, lists[part], options, dim);
    std::vector<int> found;
    std::vector<Piece> pieces;
    for (std::size_t f = contactor.facets * part / parts; f < contactor.facets * (part + 1) / parts; ++f) {
      const Facet<double> c = contactor.facet(f);
      Box swept = box_of(c);
      for (int i = 0; i < c.nodes; ++i) {
        double far[3];
        for (int side = -1; side <= 1; side += 2) {
          for (int a = 0; a < dim; ++a)
            far[a] = c.x[i][a] + side * options.reach * c.normals[i][a];
          swept.add(far, dim);
        }
      }
      swept.inflate(1e-9 * swept.diagonal(dim), dim);
      const Sight sight(c, options.reach);
      tree.query(swept, found, [&](const Box &box) { return sight.may_see(box); });
      std::erase_if(found, [&](int t) { return !sight.may_see(targets[t]); });
      if (found.empty())
        continue;
      sums.begin(f, c);
      if (dim == 2) {
        for (int t : found) {
          sums.begin_target(t, targets[t].nodes);
          couple_line(c, targets[t], rules.rule(std::max(points_c[f], points_t[t])), options.reach,
                      options.axisymmetric, sums);
          sums.end_target(target.nodes + 9 * t);
        }
      } else {
        const Contactor3 own(c, subdivide_c[f]);
        for (int t : found) {
          sums.begin_target(t, targets[t].nodes);
          couple_facet(own, targets[t], subdivide_t[t], rules.rule(std::max(points_c[f], points_t[t])), options.reach,
                       pieces, sums);
          sums.end_target(target.nodes + 9 * t);
        }
      }
      sums.end(contactor.nodes + 9 * f);
    }
  });
  for (Lists &part : lists) {
    append(out.lists.contactor, part.contactor), append(out.lists.target, part.target);
    append(out.lists.points, part.points), append(out.lists.sights, part.sights);
  }
  return out;
}

} // namespace abut

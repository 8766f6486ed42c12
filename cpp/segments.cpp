// The 2D and 3D loops over contactor facets; see docs/theory/segments.md for the construction.
#include "segments.hpp"
#include "accumulator.hpp"
#include "cutting.hpp"
#include "parallel.hpp"

namespace abut {

Facet SurfaceView::facet(std::size_t f) const {
  Facet out;
  out.kind = kinds[f], out.dim = dim, out.nodes = NODES[out.kind];
  for (int i = 0; i < out.nodes; ++i)
    for (int a = 0; a < 3; ++a) {
      out.x[i][a] = a < dim ? points[std::size_t(facet_nodes(f)[i]) * dim + a] : 0;
      out.normals[i][a] = a < dim && normals ? normals[(MAX_FACET_NODES * f + i) * dim + a] : 0;
    }
  out.position.interpolate(out.kind, out.x);
  out.direction.interpolate(out.kind, out.normals);
  out.affine = is_affine(out);
  if (out.affine)
    out.position.terms = 3;
  out.bend = bend_of(out);
  out.bulge = bulge ? bulge + MAX_FACET_NODES * f : nullptr;
  return out;
}

namespace {

void integrate_part(const Over &over, const Facet &t, const Segment &own, const Polygon &polygon, const Rule &rule,
                    Accumulator &sums) {
  sums.count_segment();
  Sight3 at(over.c, own.xi, own.eta);
  if (sums.wants_sights()) {
    auto see = [&](Point2 p) {
      const double gap = at.look(t, p), normal[3] = {-at.n[0], -at.n[1], -at.n[2]};
      if (gap == HUGE_VAL)
        return;
      at.find_shapes(t);
      sums.see(at.nc, at.nt, gap, normal);
    };
    see(polygon.middle());
    for (int i = 0; i < polygon.size; ++i)
      see(polygon.v[i].p);
    at.begin(own.xi, own.eta); // integrals are the same with gap_samples and without
  }
  integrate_polygon(
      polygon, [&](const Vertex &v) { return over.curve(v); }, rule, !over.c.flat,
      [&](Point2 p, double weight) {
        if (weight == 0)
          return;
        const double gap = at.look(t, p);
        if (gap == HUGE_VAL)
          return;
        double area[3]; // the area on the facet over that in the plane: theory (S11)
        cross(at.tangent[0], at.tangent[1], area);
        const double stretch = std::sqrt(dot(area, area, 3)) / dot(area, over.c.plane.n, 3);
        const double normal[3] = {-at.n[0], -at.n[1], -at.n[2]};
        at.find_shapes(t);
        sums.add(over.c.facet.kind, at.own.xi, at.nc, at.nt, weight * stretch, gap, normal);
      });
}

// Cuts contactor facets and integrates, one after another; one for each thread.
class Integrator {
public:
  Integrator(const Interface &both, Coupling &out, Lists &lists)
      : both_(both), cutter_(both), sums_(out, lists, both.options, both.contactor.surface.dim) {}

  void run(std::size_t f) {
    cutter_.cut(
        f,
        [&](const Facet &c, const std::vector<Segment> &segments) {
          sum(f, c, segments, [&](const Facet &t, const Segment &own, const Rule &rule) {
            integrate_line(c, t, own, segments, rule, both_.options.axisymmetric, sums_);
          });
        },
        [&](const Over &over, const std::vector<Segment> &segments) {
          sum(f, over.c.facet, segments, [&](const Facet &t, const Segment &own, const Rule &rule) {
            each_part(over, own, segments,
                      [&](const Polygon &part) { integrate_part(over, t, own, part, rule, sums_); });
          });
        });
  }

private:
  template <class Integrate>
  void sum(std::size_t f, const Facet &c, const std::vector<Segment> &segments, Integrate integrate) {
    sums_.begin(f, c);
    Rule rule{};
    by_target(
        segments,
        [&](int t) {
          sums_.begin_target(t, both_.targets[t].nodes);
          rule = rule_of(both_, f, t);
        },
        [&](const Segment &own) { integrate(both_.targets[own.target], own, rule); },
        [&](int t) { sums_.end_target(both_.target.surface.facet_nodes(t)); });
    sums_.end(both_.contactor.surface.facet_nodes(f));
  }

  const Interface &both_;
  Cutter cutter_;
  Accumulator sums_;
};

} // namespace

Coupling couple(const Planned &contactor, const Planned &target, const RuleTable &rules, const Options &options) {
  const std::size_t facets = contactor.surface.facets;
  Coupling out;
  out.gap.assign(MAX_FACET_NODES * facets, 0), out.weight.assign(MAX_FACET_NODES * facets, 0);
  out.mass.assign(MAX_FACET_NODES * MAX_FACET_NODES * facets, 0), out.covered.assign(facets, 0);
  out.segments.assign(facets, 0);
  const Interface both = interface(contactor, target, rules, options);
  const std::size_t parts = facets < FEW_FACETS ? 1 : thread_count();
  std::vector<Lists> lists(parts);
  run_parts(parts, [&](std::size_t part) {
    Integrator integrator(both, out, lists[part]);
    for (std::size_t f = facets * part / parts; f < facets * (part + 1) / parts; ++f)
      integrator.run(f);
  });
  for (Lists &part : lists) {
    append(out.lists.contactor, part.contactor), append(out.lists.target, part.target);
    append(out.lists.points, part.points), append(out.lists.gap_samples, part.gap_samples);
  }
  return out;
}

} // namespace abut

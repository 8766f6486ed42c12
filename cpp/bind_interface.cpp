// Segments and coupling for Python; arguments are checked there.
#include "bind_surfaces.hpp"
#include <nanobind/stl/vector.h>

namespace abut {

static nb::tuple plan_facets(Matrix<double> points, Vector<std::uint8_t> kinds, Matrix<std::int32_t> nodes,
                             Tensor3<double> rules, Tensor3<double> exact, Vector<double> tolerance,
                             bool axisymmetric) {
  const SurfaceView surface = view(points, kinds, nodes);
  const RuleTable rule_table = table(rules), exact_table = table(exact);
  if (tolerance.shape(0) != surface.facets)
    throw nb::value_error("tolerance must be (facets,)");
  std::vector<std::int32_t> count, subdivisions;
  {
    nb::gil_scoped_release release;
    plan(surface, rule_table, exact_table, tolerance.data(), axisymmetric, count, subdivisions);
  }
  return nb::make_tuple(to_numpy(std::move(count)), to_numpy(std::move(subdivisions)));
}

static nb::dict couple_surfaces(Matrix<double> points_c, Vector<std::uint8_t> kinds_c, Matrix<std::int32_t> nodes_c,
                                Tensor3<double> normals, Matrix<double> points_t, Vector<std::uint8_t> kinds_t,
                                Matrix<std::int32_t> nodes_t, Tensor3<double> rules, Vector<std::int32_t> order_c,
                                Vector<std::int32_t> order_t, Vector<std::int32_t> subdivide_c,
                                Vector<std::int32_t> subdivide_t, int degree, bool vectorial, bool keep_points,
                                bool gap_samples, bool axisymmetric, double reach, double largest_gap, double rounding,
                                bool hidden, Matrix<double> kin_c, Matrix<double> kin_t, Matrix<double> bulge_c,
                                Matrix<double> bulge_t) {
  SurfaceView contactor = view(points_c, kinds_c, nodes_c);
  SurfaceView target = view(points_t, kinds_t, nodes_t);
  add_kin(contactor, kin_c), add_kin(target, kin_t);
  add_bulge(contactor, bulge_c), add_bulge(target, bulge_t);
  contactor.normals = normals.data();
  const RuleTable rule_table = table(rules);
  const std::size_t dim = contactor.dim, facets = contactor.facets, width = vectorial ? dim : 1;
  Coupling c;
  {
    nb::gil_scoped_release release;
    c = couple({contactor, order_c.data(), subdivide_c.data()}, {target, order_t.data(), subdivide_t.data()},
               rule_table,
               {degree, vectorial, keep_points, gap_samples, axisymmetric, reach, largest_gap, rounding, hidden});
  }
  nb::dict out;
  auto entries = [&](const char *name, Entries &e) {
    const std::size_t n = e.row.size();
    out[name] = nb::make_tuple(to_numpy(std::move(e.row)), to_numpy(std::move(e.column)),
                               to_numpy(std::move(e.value), {n, width}));
  };
  entries("contactor", c.lists.contactor);
  entries("target", c.lists.target);
  out["gap"] = to_numpy(std::move(c.gap), {facets, MAX_FACET_NODES});
  out["weight"] = to_numpy(std::move(c.weight), {facets, MAX_FACET_NODES});
  out["mass"] = to_numpy(std::move(c.mass), {facets, MAX_FACET_NODES, MAX_FACET_NODES});
  out["covered"] = to_numpy(std::move(c.covered));
  out["segments"] = to_numpy(std::move(c.segments));
  if (keep_points) {
    const std::size_t n = c.lists.points.weight.size();
    out["point_weight"] = to_numpy(std::move(c.lists.points.weight));
    out["point_gap"] = to_numpy(std::move(c.lists.points.gap));
    out["point_normal"] = to_numpy(std::move(c.lists.points.normal), {n, dim});
    out["point_pressure"] = to_numpy(std::move(c.lists.points.pressure), {n, MAX_FACET_NODES});
    out["point_contactor"] = to_numpy(std::move(c.lists.points.contactor), {n, MAX_FACET_NODES});
    out["point_target"] = to_numpy(std::move(c.lists.points.target), {n, MAX_FACET_NODES});
    out["point_contactor_facet"] = to_numpy(std::move(c.lists.points.contactor_facet));
    out["point_target_facet"] = to_numpy(std::move(c.lists.points.target_facet));
  }
  if (gap_samples) {
    GapSamples &s = c.lists.gap_samples;
    const std::size_t n = s.gap.size();
    out["gap_sample_gap"] = to_numpy(std::move(s.gap));
    out["gap_sample_normal"] = to_numpy(std::move(s.normal), {n, dim});
    out["gap_sample_contactor"] = to_numpy(std::move(s.contactor), {n, MAX_FACET_NODES});
    out["gap_sample_target"] = to_numpy(std::move(s.target), {n, MAX_FACET_NODES});
    out["gap_sample_contactor_facet"] = to_numpy(std::move(s.contactor_facet));
    out["gap_sample_target_facet"] = to_numpy(std::move(s.target_facet));
  }
  return out;
}

void bind_interface(nb::module_ &m) {
  m.def("plan_facets", &plan_facets, nb::arg("points").noconvert(), nb::arg("kinds").noconvert(),
        nb::arg("nodes").noconvert(), nb::arg("rules").noconvert(), nb::arg("exact").noconvert(),
        nb::arg("tolerance").noconvert(), nb::arg("axisymmetric"),
        "Integration points per direction and subdivisions of every facet, so that it meets its own moments.");
  m.def("couple_surfaces", &couple_surfaces, nb::arg("points_c").noconvert(), nb::arg("kinds_c").noconvert(),
        nb::arg("nodes_c").noconvert(), nb::arg("normals").noconvert(), nb::arg("points_t").noconvert(),
        nb::arg("kinds_t").noconvert(), nb::arg("nodes_t").noconvert(), nb::arg("rules").noconvert(),
        nb::arg("order_c").noconvert(), nb::arg("order_t").noconvert(), nb::arg("subdivide_c").noconvert(),
        nb::arg("subdivide_t").noconvert(), nb::arg("degree"), nb::arg("vectorial"), nb::arg("keep_points"),
        nb::arg("gap_samples"), nb::arg("axisymmetric"), nb::arg("reach"), nb::arg("largest_gap"), nb::arg("rounding"),
        nb::arg("hidden"), nb::arg("kin_c").noconvert(), nb::arg("kin_t").noconvert(), nb::arg("bulge_c").noconvert(),
        nb::arg("bulge_t").noconvert(), "Cuts the contactor by the target and integrates; see abut.contact.coupling.");
}

} // namespace abut

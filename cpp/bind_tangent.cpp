// Derivatives of the coupling for Python; arguments are checked there.
#include "bind_surfaces.hpp"
#include "slip.hpp"
#include "tangent.hpp"

namespace abut {

static nb::tuple to_python(const Blocks &blocks, std::size_t rows, std::size_t height, std::size_t width) {
  CompressedBlocks c = compress(blocks, rows, height * width);
  const std::size_t n = c.column.size();
  return nb::make_tuple(to_numpy(std::move(c.value), {n, height, width}), to_numpy(std::move(c.column)),
                        to_numpy(std::move(c.start)));
}

static nb::dict couple_tangent(Matrix<double> points_c, Vector<std::uint8_t> kinds_c, Matrix<std::int32_t> nodes_c,
                               Tensor3<double> normals, Matrix<double> points_t, Vector<std::uint8_t> kinds_t,
                               Matrix<std::int32_t> nodes_t, Tensor3<double> rules, Vector<std::int32_t> order_c,
                               Vector<std::int32_t> order_t, Vector<std::int32_t> subdivide_c,
                               Vector<std::int32_t> subdivide_t, int degree, bool axisymmetric, double reach,
                               double largest_gap, double rounding, bool hidden, Matrix<double> kin_c,
                               Matrix<double> kin_t, Matrix<double> bulge_c, Matrix<double> bulge_t,
                               Matrix<double> pressure, Tensor3<double> traction, Matrix<double> turned,
                               Matrix<std::int32_t> normal_numbers, int target_offset, std::size_t n_points,
                               bool tangential) {
  SurfaceView contactor = view(points_c, kinds_c, nodes_c);
  SurfaceView target = view(points_t, kinds_t, nodes_t);
  add_kin(contactor, kin_c), add_kin(target, kin_t);
  add_bulge(contactor, bulge_c), add_bulge(target, bulge_t);
  contactor.normals = normals.data();
  const RuleTable rule_table = table(rules);
  const std::size_t dim = contactor.dim, rows = MAX_FACET_NODES * contactor.facets;
  if (pressure.shape(0) != contactor.facets || pressure.shape(1) != MAX_FACET_NODES)
    throw nb::value_error("pressure must be (facets, MAX_FACET_NODES)");
  if (turned.shape(0) && (turned.shape(0) != contactor.facets || turned.shape(1) != MAX_FACET_NODES))
    throw nb::value_error("turned must be (facets, MAX_FACET_NODES)");
  TangentLists lists;
  const Load load{pressure.data(), traction.shape(0) ? traction.data() : nullptr,
                  turned.shape(0) ? turned.data() : nullptr, tangential};
  {
    nb::gil_scoped_release release;
    lists = tangent({contactor, order_c.data(), subdivide_c.data()}, {target, order_t.data(), subdivide_t.data()},
                    rule_table, {degree, true, false, false, axisymmetric, reach, largest_gap, rounding, hidden}, load,
                    {normal_numbers.data(), target_offset});
  }
  nb::dict out;
  out["moment_by_points"] = to_python(lists.moment.by_points, rows, 2, dim);
  out["moment_by_normals"] = to_python(lists.moment.by_normals, rows, 2, dim);
  out["force_by_points"] = to_python(lists.force.by_points, n_points, dim, dim);
  out["force_by_normals"] = to_python(lists.force.by_normals, n_points, dim, dim);
  out["operators"] = to_python(lists.operators, rows, 1, operator_width(dim, load.rubs));
  out["gap"] = to_numpy(std::move(lists.gap));
  out["weight"] = to_numpy(std::move(lists.weight));
  const std::size_t loads = lists.loaded.size();
  out["loaded"] = to_numpy(std::move(lists.loaded));
  out["load"] = to_numpy(std::move(lists.load), {loads, dim});
  return out;
}

static nb::dict slip_tangent(Matrix<double> points_c, Matrix<std::int32_t> nodes_c, Tensor3<double> normals,
                             Matrix<double> points_t, Matrix<std::int32_t> nodes_t, Vector<std::int32_t> facet,
                             Vector<std::int32_t> target_facet, Vector<double> weight, Matrix<double> pressure,
                             Matrix<double> own, Matrix<double> other, Matrix<std::int32_t> normal_numbers,
                             int target_offset) {
  const std::size_t n = facet.shape(0), dim = points_c.shape(1), facets = nodes_c.shape(0);
  if (target_facet.shape(0) != n || weight.shape(0) != n || pressure.shape(0) != n || own.shape(0) != n ||
      other.shape(0) != n || normals.shape(0) != facets || normal_numbers.shape(0) != facets)
    throw nb::value_error("the points of the slip disagree");
  const SlipView view{n,
                      facet.data(),
                      target_facet.data(),
                      weight.data(),
                      pressure.data(),
                      own.data(),
                      other.data(),
                      points_c.data(),
                      points_t.data(),
                      normals.data(),
                      nodes_c.data(),
                      nodes_t.data()};
  const std::size_t rows = MAX_FACET_NODES * facets, c = dim == 2 ? 1 : 3;
  SlipLists lists;
  {
    nb::gil_scoped_release release;
    lists = slip(view, int(dim), facets, {normal_numbers.data(), target_offset});
  }
  nb::dict out;
  out["value"] = to_numpy(std::move(lists.value), {rows, c});
  out["by_points"] = to_python(lists.by.by_points, rows, c, dim);
  out["by_normals"] = to_python(lists.by.by_normals, rows, c, dim);
  return out;
}

void bind_tangent(nb::module_ &m) {
  m.def("couple_tangent", &couple_tangent, nb::arg("points_c").noconvert(), nb::arg("kinds_c").noconvert(),
        nb::arg("nodes_c").noconvert(), nb::arg("normals").noconvert(), nb::arg("points_t").noconvert(),
        nb::arg("kinds_t").noconvert(), nb::arg("nodes_t").noconvert(), nb::arg("rules").noconvert(),
        nb::arg("order_c").noconvert(), nb::arg("order_t").noconvert(), nb::arg("subdivide_c").noconvert(),
        nb::arg("subdivide_t").noconvert(), nb::arg("degree"), nb::arg("axisymmetric"), nb::arg("reach"),
        nb::arg("largest_gap"), nb::arg("rounding"), nb::arg("hidden"), nb::arg("kin_c").noconvert(),
        nb::arg("kin_t").noconvert(), nb::arg("bulge_c").noconvert(), nb::arg("bulge_t").noconvert(),
        nb::arg("pressure").noconvert(), nb::arg("traction").noconvert(), nb::arg("turned").noconvert(),
        nb::arg("normal_numbers").noconvert(), nb::arg("target_offset"), nb::arg("n_points"), nb::arg("tangential"),
        "The coupling and its derivatives by points and nodal normals; see abut.contact.coupling_tangent.");
  m.def("slip_tangent", &slip_tangent, nb::arg("points_c").noconvert(), nb::arg("nodes_c").noconvert(),
        nb::arg("normals").noconvert(), nb::arg("points_t").noconvert(), nb::arg("nodes_t").noconvert(),
        nb::arg("facet").noconvert(), nb::arg("target_facet").noconvert(), nb::arg("weight").noconvert(),
        nb::arg("pressure").noconvert(), nb::arg("own").noconvert(), nb::arg("other").noconvert(),
        nb::arg("normal_numbers").noconvert(), nb::arg("target_offset"),
        "Slips at places that are held, and their derivatives by points and nodal normals; see "
        "abut.problem.slip_points.");
}

} // namespace abut

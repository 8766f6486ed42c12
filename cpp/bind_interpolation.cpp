// Forces of straight cells under bent displacements, for Python.
#include "bind.hpp"
#include "interpolation.hpp"
#include "parallel.hpp"
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <optional>
#include <tuple>

namespace abut {

using Materials = std::tuple<Vector<std::int32_t>, Tensor3<double>, Tensor3<double>>; // number, compliance, stiffness
using RuleOfCells = std::tuple<Matrix<double>, Matrix<double>, Vector<double>>;       // shapes, derivatives, weights

// Cells on threads, what they add to nodes in their order.
template <int dim, bool axisymmetric>
void add_forces(const Simplices &cells, std::size_t count, std::vector<double> &result) {
  using Force = InterpolationForce<dim, axisymmetric>;
  constexpr std::size_t width = std::size_t(Force::K) * dim;
  Buffer<double> own(count * width);
  const std::size_t parts = count < FEW_CELLS ? 1 : thread_count();
  run_parts(parts, [&](std::size_t part) {
    const Force force(cells);
    for (std::size_t i = count * part / parts; i < count * (part + 1) / parts; ++i)
      force.at(i, own.data() + i * width);
  });
  for (std::size_t i = 0; i < count * Force::K; ++i)
    for (std::size_t a = 0; a < dim; ++a)
      result[std::size_t(cells.nodes[i]) * dim + a] += own[i * dim + a];
}

static nb::ndarray<nb::numpy, double> interpolation_forces(Matrix<double> points, Matrix<std::int32_t> nodes,
                                                           Tensor3<double> stress,
                                                           const std::optional<Matrix<double>> &thermal,
                                                           const Materials &materials, const RuleOfCells &rule,
                                                           bool axisymmetric) {
  const auto &[number, compliance, stiffness] = materials;
  const auto &[shapes, derivatives, weights] = rule;
  const std::size_t dim = points.shape(1), k = dim + 1, count = nodes.shape(0), c = dim == 2 ? 4 : 6;
  if ((dim != 3 && (dim != 2)) || (dim == 3 && axisymmetric) || nodes.shape(1) != k || stress.shape(0) != count ||
      stress.shape(1) != k || stress.shape(2) != 6 || number.shape(0) != count || compliance.shape(1) != 6 ||
      compliance.shape(2) != 6 || stiffness.shape(0) != compliance.shape(0) || stiffness.shape(1) != c ||
      stiffness.shape(2) != c || (thermal && (thermal->shape(0) != count || thermal->shape(1) != k)) ||
      shapes.shape(1) != k || derivatives.shape(0) != k || derivatives.shape(1) != dim ||
      weights.shape(0) != shapes.shape(0))
    throw nb::value_error("cells, stresses and materials disagree");
  const Simplices cells{points.data(), nodes.data(),       stress.data(),    thermal ? thermal->data() : nullptr,
                        number.data(), compliance.data(),  stiffness.data(), weights.shape(0),
                        shapes.data(), derivatives.data(), weights.data()};
  std::vector<double> result(points.shape(0) * dim);
  {
    nb::gil_scoped_release release;
    if (dim == 3)
      add_forces<3, false>(cells, count, result);
    else if (axisymmetric)
      add_forces<2, true>(cells, count, result);
    else
      add_forces<2, false>(cells, count, result);
  }
  return to_numpy(std::move(result), {points.shape(0), dim});
}

void bind_interpolation(nb::module_ &m) {
  m.def("interpolation_forces", &interpolation_forces, nb::arg("points").noconvert(), nb::arg("nodes").noconvert(),
        nb::arg("stress").noconvert(), nb::arg("thermal").none(), nb::arg("materials"), nb::arg("rule"),
        nb::arg("axisymmetric"),
        "Nodal forces (n_points, dim) of stresses of bent displacements less their linear interpolates in triangles or "
        "tetrahedra, nodes (n, dim + 1), from stresses at their nodes (n, dim + 1, 6) and thermal strains there "
        "(n, dim + 1) or None; materials: (number of each cell's, compliances (b, 6, 6), stiffnesses (b, c, c)); rule: "
        "(shapes (q, dim + 1), derivatives (dim + 1, dim), weights (q,) that add up to 1).");
}

} // namespace abut

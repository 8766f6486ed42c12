// Cells for Python: values and derivatives of shape functions at many reference points, and the smallest Jacobian
// determinant of each cell.
#include "bind.hpp"
#include "cells.hpp"
#include "jacobian.hpp"
#include "parallel.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace abut {

static nb::tuple shape_functions(int kind, Matrix<double> points) {
  const std::size_t count = points.shape(0), dim = points.shape(1);
  if (kind < 0 || kind >= KIND_COUNT || dim != std::size_t(DIM[kind]))
    throw nb::value_error("kind and points disagree");
  const std::size_t nodes = NODES[kind];
  std::vector<double> values(count * nodes), derivatives(count * nodes * dim);
  for (std::size_t p = 0; p < count; ++p) {
    double x[3] = {0, 0, 0}, n[MAX_NODES], d[MAX_NODES][3];
    for (std::size_t a = 0; a < dim; ++a)
      x[a] = points(p, a);
    shape<double>(kind, x, n, d);
    for (std::size_t i = 0; i < nodes; ++i) {
      values[p * nodes + i] = n[i];
      for (std::size_t a = 0; a < dim; ++a)
        derivatives[(p * nodes + i) * dim + a] = d[i][a];
    }
  }
  return nb::make_tuple(to_numpy(std::move(values), {count, nodes}),
                        to_numpy(std::move(derivatives), {count, nodes, dim}));
}

template <int dim>
static double smallest_determinant(const double *points, const std::int32_t *own, std::size_t n,
                                   const double *derivatives, std::size_t rule) {
  double x[MAX_NODES * dim], smallest = std::numeric_limits<double>::infinity(), size = 0;
  gather(points, own, n, dim, x);
  for (int a = 0; a < dim; ++a) {
    double low = x[a], high = x[a];
    for (std::size_t i = 1; i < n; ++i)
      low = std::min(low, x[i * dim + a]), high = std::max(high, x[i * dim + a]);
    size = std::max(size, high - low);
  }
  for (std::size_t i = n; i-- > 0;) // a cell of size one: the determinant has no unit and cannot overflow
    for (int a = 0; a < dim; ++a)
      x[i * dim + a] = (x[i * dim + a] - x[a]) / (size > 0 ? size : 1);
  for (std::size_t q = 0; q < rule; ++q) {
    const double det = jacobian<dim>(x, n, derivatives + q * n * dim).det;
    if (std::isnan(det))
      return det;
    smallest = std::min(smallest, det);
  }
  return smallest;
}

static nb::ndarray<nb::numpy, double> smallest_determinants(Matrix<double> points, Matrix<std::int32_t> nodes,
                                                            Tensor3<double> derivatives) {
  const std::size_t dim = points.shape(1), cells = nodes.shape(0), n = nodes.shape(1);
  if (n > MAX_NODES || derivatives.shape(1) != n || derivatives.shape(2) != dim || (dim != 2 && dim != 3))
    throw nb::value_error("points, cells and derivatives disagree");
  Buffer<double> result(cells);
  {
    nb::gil_scoped_release release;
    const auto smallest = dim == 2 ? smallest_determinant<2> : smallest_determinant<3>;
    const std::size_t parts = cells < FEW_CELLS ? 1 : thread_count();
    run_parts(parts, [&](std::size_t part) {
      for (std::size_t c = cells * part / parts; c < cells * (part + 1) / parts; ++c)
        result[c] = smallest(points.data(), nodes.data() + c * n, n, derivatives.data(), derivatives.shape(0));
    });
  }
  return to_numpy(std::move(result));
}

void bind_cells(nb::module_ &m) {
  m.def("shape_functions", &shape_functions, nb::arg("kind"), nb::arg("points").noconvert(),
        "Values (n, nodes) and reference derivatives (n, nodes, dim) of a cell type at points (n, dim).");
  m.def("smallest_determinants", &smallest_determinants, nb::arg("points").noconvert(), nb::arg("nodes").noconvert(),
        nb::arg("derivatives").noconvert(),
        "Smallest Jacobian determinant (cells,) over the points of a rule, of cells scaled to size one; NaN where one "
        "is.");
}

} // namespace abut

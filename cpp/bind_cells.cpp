// Shape functions for Python: values and derivatives at many reference points.
#include "bind.hpp"
#include "cells.hpp"

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

void bind_cells(nb::module_ &m) {
  m.def("shape_functions", &shape_functions, nb::arg("kind"), nb::arg("points").noconvert(),
        "Values (n, nodes) and reference derivatives (n, nodes, dim) of a cell type at points (n, dim).");
}

} // namespace abut

// Stiffness of a cell whose strains do not change with a displacement that is the same at all nodes: that of the last
// node is what keeps the others' sums at zero, and need not be integrated.
#pragma once
#include <algorithm>
#include <cstddef>

namespace abut {

// Completes the blocks (n, n, dim, dim) of the first n - 1 nodes; half: of a symmetric stiffness, nodes i <= k only.
template <int dim> void complete_last_node(std::size_t n, bool half, double *block) {
  constexpr int size = dim * dim;
  const std::size_t last = n - 1;
  const auto at = [=](std::size_t i, std::size_t k) { return block + (i * n + k) * size; };
  for (std::size_t i = 0; i < last; ++i) {
    double *column = at(i, last), *row = at(last, i);
    std::fill_n(column, size, 0.0);
    if (!half)
      std::fill_n(row, size, 0.0);
    for (std::size_t k = 0; k < last; ++k) {
      const double *other = half && k < i ? at(k, i) : at(i, k);
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b)
          column[a * dim + b] -= half && k < i ? other[b * dim + a] : other[a * dim + b];
      if (!half)
        for (int m = 0; m < size; ++m)
          row[m] -= at(k, i)[m];
    }
  }
  double *corner = at(last, last);
  std::fill_n(corner, size, 0.0);
  for (std::size_t k = 0; k < last; ++k)
    for (int m = 0; m < size; ++m)
      corner[m] -= at(k, last)[m];
}

// The same where ``added`` nodes are in: all of them, or all but the last.
template <int dim> void complete_from(std::size_t added, std::size_t n, bool half, double *block) {
  if (added < n)
    complete_last_node<dim>(n, half, block);
}

} // namespace abut

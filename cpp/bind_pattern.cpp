// Sparsity pattern of the stiffness.
#include "bind.hpp"
#include <algorithm>

namespace abut {

// Node adjacency through cells, rows sorted: cell c has the nodes nodes[start[c] .. start[c+1]].
static nb::tuple node_pattern(std::int64_t n_points, Vector<std::int64_t> start, Vector<std::int32_t> nodes) {
  const std::size_t cells = start.shape(0) - 1;
  std::vector<std::int64_t> indptr(n_points + 1, 0);
  std::vector<std::int32_t> indices;
  {
    nb::gil_scoped_release release;
    std::vector<std::int64_t> first(n_points + 1, 0);
    const std::size_t visits = nodes.shape(0);
    for (std::size_t i = 0; i < visits; ++i)
      ++first[nodes(i) + 1];
    for (std::int64_t i = 0; i < n_points; ++i)
      first[i + 1] += first[i];
    std::vector<std::int32_t> cell_of(visits);
    std::vector<std::int64_t> fill(first.begin(), first.end() - 1);
    for (std::size_t c = 0; c < cells; ++c)
      for (std::int64_t i = start(c); i < start(c + 1); ++i)
        cell_of[fill[nodes(i)]++] = std::int32_t(c);
    std::vector<std::int64_t> seen(n_points, -1);
    indices.reserve(visits * 4);
    for (std::int64_t row = 0; row < n_points; ++row) {
      const std::size_t begin = indices.size();
      for (std::int64_t k = first[row]; k < first[row + 1]; ++k)
        for (std::int64_t i = start(cell_of[k]); i < start(cell_of[k] + 1); ++i)
          if (seen[nodes(i)] != row)
            seen[nodes(i)] = row, indices.push_back(nodes(i));
      std::sort(indices.begin() + begin, indices.end());
      indptr[row + 1] = std::int64_t(indices.size());
    }
  }
  return nb::make_tuple(to_numpy(std::move(indptr)), to_numpy(std::move(indices)));
}

// Expands a node pattern to dim x dim blocks.
static nb::tuple block_pattern(Vector<std::int64_t> indptr, Vector<std::int32_t> indices, int dim) {
  const std::int64_t rows = std::int64_t(indptr.shape(0)) - 1;
  std::vector<std::int64_t> start(rows * dim + 1, 0);
  Buffer<std::int32_t> columns(indices.shape(0) * dim * dim);
  std::size_t k = 0;
  for (std::int64_t i = 0; i < rows; ++i)
    for (int a = 0; a < dim; ++a) {
      for (std::int64_t p = indptr(i); p < indptr(i + 1); ++p)
        for (int b = 0; b < dim; ++b)
          columns[k++] = dim * indices(p) + b;
      start[i * dim + a + 1] = std::int64_t(k);
    }
  return nb::make_tuple(to_numpy(std::move(start)), to_numpy(std::move(columns)));
}

void bind_pattern(nb::module_ &m) {
  m.def("node_pattern", &node_pattern, nb::arg("n_points"), nb::arg("start").noconvert(), nb::arg("nodes").noconvert(),
        "CSR (indptr, indices) of which nodes share a cell, rows sorted.");
  m.def("block_pattern", &block_pattern, nb::arg("indptr").noconvert(), nb::arg("indices").noconvert(), nb::arg("dim"),
        "The same pattern with dim x dim blocks.");
}

} // namespace abut

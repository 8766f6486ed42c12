// Element kernels: sparsity pattern of the stiffness, and isotropic stiffness matrices scattered straight into it.
#include "bind.hpp"
#include "jacobian.hpp"
#include "parallel.hpp"
#include <algorithm>
#include <numbers>

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

// For the rows of points first .. last - 1: adds int lambda div v div u + 2 mu eps(v) : eps(u) of cells of one type to
// the values of a block pattern. shapes (q, n), derivatives (q, n, dim), weights (q): the rule on the reference cell;
// lame (cells, 2): lambda, mu of each cell. Axisymmetric: coordinates are (r, z), the hoop strain is u_r / r and the
// integral runs round the axis. mean_dilatation: div u is replaced by its mean over the cell (B-bar), theory (E3).
template <int dim, bool axisymmetric>
static void add_stiffness(const double *points, const std::int32_t *nodes, std::size_t cells, std::size_t n,
                          const double *shapes, const double *derivatives, const double *weights, std::size_t rule,
                          const double *lame, const std::int64_t *indptr, const std::int32_t *indices, double *values,
                          bool mean_dilatation, std::int32_t first, std::int32_t last) {
  std::vector<double> x(n * dim), gradient(n * dim), hoop(n), block(n * n * dim * dim), dilatation(n * dim);
  for (std::size_t c = 0; c < cells; ++c) {
    const std::int32_t *own = nodes + c * n;
    if (std::none_of(own, own + n, [&](std::int32_t i) { return i >= first && i < last; }))
      continue;
    const double mu = lame[2 * c + 1], bulk = lame[2 * c] + 2 * mu / 3; // bulk modulus
    const double lambda = mean_dilatation ? -2 * mu / 3 : lame[2 * c];  // what is left at the points is deviatoric
    double volume = 0;
    gather(points, own, n, dim, x.data());
    std::fill(block.begin(), block.end(), 0.0);
    std::fill(dilatation.begin(), dilatation.end(), 0.0);
    for (std::size_t q = 0; q < rule; ++q) {
      const double *d = derivatives + q * n * dim;
      double w = gradients<dim>(x.data(), n, d, gradient.data()) * weights[q];
      if constexpr (axisymmetric) {
        double r = 0;
        for (std::size_t i = 0; i < n; ++i)
          r += shapes[q * n + i] * x[i * dim];
        for (std::size_t i = 0; i < n; ++i)
          hoop[i] = shapes[q * n + i] / r;
        w *= 2 * std::numbers::pi * r;
      }
      if (mean_dilatation) {
        volume += w;
        for (std::size_t i = 0; i < n; ++i) {
          for (int a = 0; a < dim; ++a)
            dilatation[i * dim + a] += w * gradient[i * dim + a];
          if constexpr (axisymmetric)
            dilatation[i * dim] += w * hoop[i];
        }
      }
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = i; k < n; ++k) {
          const double *g = &gradient[i * dim], *h = &gradient[k * dim];
          double *out = &block[(i * n + k) * dim * dim];
          double scalar = 0;
          for (int a = 0; a < dim; ++a)
            scalar += g[a] * h[a];
          for (int a = 0; a < dim; ++a) {
            for (int b = 0; b < dim; ++b)
              out[a * dim + b] += w * (lambda * g[a] * h[b] + mu * g[b] * h[a]);
            out[a * dim + a] += w * mu * scalar;
          }
          if constexpr (axisymmetric) {
            out[0] += w * (lambda + 2 * mu) * hoop[i] * hoop[k];
            for (int a = 0; a < dim; ++a)
              out[a * dim] += w * lambda * g[a] * hoop[k], out[a] += w * lambda * hoop[i] * h[a];
          }
        }
    }
    if (mean_dilatation)
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = i; k < n; ++k)
          for (int a = 0; a < dim; ++a)
            for (int b = 0; b < dim; ++b)
              block[((i * n + k) * dim + a) * dim + b] +=
                  bulk / volume * dilatation[i * dim + a] * dilatation[k * dim + b];
    for (std::size_t i = 0; i < n; ++i) {
      if (own[i] < first || own[i] >= last)
        continue;
      const std::int64_t row = indptr[own[i]], length = indptr[own[i] + 1] - row;
      const std::int32_t *begin = indices + row, *end = begin + length;
      double *out = values + row * dim * dim;
      for (std::size_t k = 0; k < n; ++k) {
        const std::int64_t position = std::lower_bound(begin, end, own[k]) - begin;
        const double *in = &block[(i <= k ? i * n + k : k * n + i) * dim * dim];
        for (int a = 0; a < dim; ++a)
          for (int b = 0; b < dim; ++b)
            out[a * dim * length + position * dim + b] += i <= k ? in[a * dim + b] : in[b * dim + a];
      }
    }
  }
}

static void assemble_stiffness(Matrix<double> points, Matrix<std::int32_t> nodes, Matrix<double> shapes,
                               Tensor3<double> derivatives, Vector<double> weights, Matrix<double> lame,
                               bool axisymmetric, bool mean_dilatation, Vector<std::int64_t> indptr,
                               Vector<std::int32_t> indices,
                               nb::ndarray<double, nb::numpy, nb::ndim<1>, nb::c_contig, nb::device::cpu> values) {
  const std::size_t dim = points.shape(1), n = nodes.shape(1);
  if (shapes.shape(1) != n || derivatives.shape(1) != n || derivatives.shape(2) != dim ||
      lame.shape(0) != nodes.shape(0) || lame.shape(1) != 2 || (axisymmetric && dim != 2))
    throw nb::value_error("rule, cells and materials disagree");
  nb::gil_scoped_release release;
  const auto add = axisymmetric ? add_stiffness<2, true> : dim == 2 ? add_stiffness<2, false> : add_stiffness<3, false>;
  // Every thread owns a range of rows and computes all cells that reach into it: each row is added up in the order of
  // the cells, whatever the number of threads.
  const std::size_t rows = points.shape(0), parts = nodes.shape(0) < FEW_CELLS ? 1 : thread_count();
  run_parts(parts, [&](std::size_t part) {
    add(points.data(), nodes.data(), nodes.shape(0), n, shapes.data(), derivatives.data(), weights.data(),
        weights.shape(0), lame.data(), indptr.data(), indices.data(), values.data(), mean_dilatation,
        std::int32_t(rows * part / parts), std::int32_t(rows * (part + 1) / parts));
  });
}

void bind_solids(nb::module_ &m) {
  m.def("node_pattern", &node_pattern, nb::arg("n_points"), nb::arg("start").noconvert(), nb::arg("nodes").noconvert(),
        "CSR (indptr, indices) of which nodes share a cell, rows sorted.");
  m.def("block_pattern", &block_pattern, nb::arg("indptr").noconvert(), nb::arg("indices").noconvert(), nb::arg("dim"),
        "The same pattern with dim x dim blocks.");
  m.def("assemble_stiffness", &assemble_stiffness, nb::arg("points").noconvert(), nb::arg("nodes").noconvert(),
        nb::arg("shapes").noconvert(), nb::arg("derivatives").noconvert(), nb::arg("weights").noconvert(),
        nb::arg("lame").noconvert(), nb::arg("axisymmetric"), nb::arg("mean_dilatation"), nb::arg("indptr").noconvert(),
        nb::arg("indices").noconvert(), nb::arg("values").noconvert(),
        "Adds the stiffness of all cells of one type to the values of a block pattern, in place.");
}

} // namespace abut

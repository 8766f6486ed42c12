// Sparse matrices: products of small dense blocks with vectors, on which a multigrid cycle spends its time, and the
// choice of rows and columns.
#include "bind.hpp"
#include "parallel.hpp"
#include <algorithm>

namespace abut {

constexpr std::size_t FEW_ENTRIES = 400'000; // not worth a thread

// Rows of blocks first .. last - 1 of y = A x, with blocks of r x c.
template <class T, int r, int c>
static void rows_fixed(const std::int32_t *indptr, const std::int32_t *indices, const T *blocks, const T *x, T *y,
                       std::size_t first, std::size_t last, int, int) {
  for (std::size_t i = first; i < last; ++i) {
    T sum[r] = {0};
    for (std::int32_t k = indptr[i]; k < indptr[i + 1]; ++k) {
      const T *block = blocks + std::size_t(k) * r * c, *in = x + std::size_t(indices[k]) * c;
      for (int a = 0; a < r; ++a)
        for (int b = 0; b < c; ++b)
          sum[a] += block[a * c + b] * in[b];
    }
    for (int a = 0; a < r; ++a)
      y[i * r + a] = sum[a];
  }
}

template <class T>
static void rows_any(const std::int32_t *indptr, const std::int32_t *indices, const T *blocks, const T *x, T *y,
                     std::size_t first, std::size_t last, int r, int c) {
  for (std::size_t i = first; i < last; ++i) {
    T *sum = y + i * r;
    for (int a = 0; a < r; ++a)
      sum[a] = 0;
    for (std::int32_t k = indptr[i]; k < indptr[i + 1]; ++k) {
      const T *block = blocks + std::size_t(k) * r * c, *in = x + std::size_t(indices[k]) * c;
      for (int a = 0; a < r; ++a)
        for (int b = 0; b < c; ++b)
          sum[a] += block[a * c + b] * in[b];
    }
  }
}

template <class T> static auto rows_of(int r, int c) {
  if (r == 3 && c == 3)
    return rows_fixed<T, 3, 3>;
  if (r == 3 && c == 6)
    return rows_fixed<T, 3, 6>;
  if (r == 6 && c == 3)
    return rows_fixed<T, 6, 3>;
  if (r == 6 && c == 6)
    return rows_fixed<T, 6, 6>;
  if (r == 2 && c == 2)
    return rows_fixed<T, 2, 2>;
  return rows_any<T>;
}

template <class T>
static nb::ndarray<nb::numpy, T> block_product(Vector<std::int32_t> indptr, Vector<std::int32_t> indices,
                                               Tensor3<T> blocks, Vector<T> x) {
  const std::size_t rows = indptr.shape(0) - 1, r = blocks.shape(1), c = blocks.shape(2);
  if (indices.shape(0) != blocks.shape(0) || std::size_t(indptr(rows)) > blocks.shape(0))
    throw nb::value_error("pattern and blocks disagree");
  Buffer<T> y(rows * r);
  {
    nb::gil_scoped_release release;
    const auto multiply = rows_of<T>(int(r), int(c));
    const std::size_t parts = blocks.size() < FEW_ENTRIES ? 1 : thread_count();
    run_parts(parts, [&](std::size_t part) {
      multiply(indptr.data(), indices.data(), blocks.data(), x.data(), y.data(), rows * part / parts,
               rows * (part + 1) / parts, int(r), int(c));
    });
  }
  return to_numpy(std::move(y));
}

// The rows and columns i of a CSR matrix with place[i] >= 0, which ascend from 0 to size - 1, as a matrix of their own.
static nb::tuple principal_submatrix(Vector<std::int32_t> indptr, Vector<std::int32_t> indices, Vector<double> data,
                                     Vector<std::int32_t> place, std::int64_t size) {
  const std::size_t rows = indptr.shape(0) - 1;
  if (place.shape(0) != rows || indices.shape(0) != data.shape(0))
    throw nb::value_error("matrix and places disagree");
  std::size_t most = 0;
  for (std::size_t i = 0; i < rows; ++i)
    most += place(i) >= 0 ? indptr(i + 1) - indptr(i) : 0;
  std::vector<std::int32_t> start(size + 1, 0);
  Buffer<std::int32_t> columns(most);
  Buffer<double> values(most);
  {
    nb::gil_scoped_release release;
    std::size_t to = 0;
    for (std::size_t i = 0; i < rows; ++i)
      if (place(i) >= 0) {
        for (std::int32_t k = indptr(i); k < indptr(i + 1); ++k) {
          const std::int32_t column = place(indices(k));
          columns[to] = column;
          values[to] = data(k);
          to += column >= 0;
        }
        start[place(i) + 1] = std::int32_t(to);
      }
    columns.shorten(to);
    values.shorten(to);
  }
  return nb::make_tuple(to_numpy(std::move(start)), to_numpy(std::move(columns)), to_numpy(std::move(values)));
}

// The rows of a CSR matrix whose places lie in one block row, walked block column by block column.
struct BlockRow {
  const Vector<std::int32_t> &indptr, &indices, &place;
  int dim;
  std::int32_t first, last; // scalar rows

  // Calls visit(column) for every block column, in ascending order, and take(row, k, column) for every entry k in it.
  template <class Visit, class Take> void walk(Visit visit, Take take) const {
    std::int32_t at[8];
    for (std::int32_t i = first; i < last; ++i)
      at[i - first] = indptr(i);
    for (;;) {
      std::int32_t column = -1;
      for (std::int32_t i = first; i < last; ++i)
        if (at[i - first] < indptr(i + 1)) {
          const std::int32_t own = place(indices(at[i - first])) / dim;
          if (column < 0 || own < column)
            column = own;
        }
      if (column < 0)
        return;
      visit(column);
      for (std::int32_t i = first; i < last; ++i)
        for (std::int32_t &k = at[i - first]; k < indptr(i + 1) && place(indices(k)) / dim == column; ++k)
          take(i, k, column);
    }
  }
};

// A CSR matrix with sorted rows as one of dim x dim blocks, times factor: row and column i go to place[i], which
// ascends; the diagonal is one where nothing goes to.
static nb::tuple padded_blocks(Vector<std::int32_t> indptr, Vector<std::int32_t> indices, Vector<double> data,
                               Vector<std::int32_t> place, int dim, std::int64_t block_rows, double factor) {
  const std::size_t rows = indptr.shape(0) - 1;
  if (place.shape(0) != rows || indices.shape(0) != data.shape(0) || dim < 1 || dim > 8)
    throw nb::value_error("matrix and places disagree");
  std::vector<std::int32_t> first(block_rows + 1, 0), start(block_rows + 1, 0);
  for (std::size_t i = 0; i < rows; ++i)
    ++first[place(i) / dim + 1];
  for (std::int64_t b = 0; b < block_rows; ++b)
    first[b + 1] += first[b];
  const std::size_t parts = indices.shape(0) < FEW_ENTRIES ? 1 : thread_count(), area = std::size_t(dim) * dim;
  auto row = [&](std::int64_t b) { return BlockRow{indptr, indices, place, dim, first[b], first[b + 1]}; };
  auto each = [&](auto work) {
    run_parts(parts, [&](std::size_t part) {
      for (std::int64_t b = block_rows * part / parts; b < std::int64_t(block_rows * (part + 1) / parts); ++b)
        work(b);
    });
  };
  each([&](std::int64_t b) {
    row(b).walk([&](std::int32_t) { ++start[b + 1]; }, [](std::int32_t, std::int32_t, std::int32_t) {});
  });
  for (std::int64_t b = 0; b < block_rows; ++b)
    start[b + 1] += start[b];
  Buffer<std::int32_t> columns(start[block_rows]);
  Buffer<double> blocks(start[block_rows] * area);
  each([&](std::int64_t b) {
    std::int64_t at = start[b] - 1;
    row(b).walk(
        [&](std::int32_t column) {
          columns[++at] = column;
          double *block = &blocks[at * area];
          std::fill(block, block + area, 0.0);
          if (column == b) {
            for (int a = 0; a < dim; ++a)
              block[a * dim + a] = 1.0;
            for (std::int32_t i = first[b]; i < first[b + 1]; ++i)
              block[(place(i) % dim) * (dim + 1)] = 0.0;
          }
        },
        [&](std::int32_t i, std::int32_t k, std::int32_t) {
          blocks[at * area + place(i) % dim * dim + place(indices(k)) % dim] += factor * data(k);
        });
  });
  return nb::make_tuple(to_numpy(std::move(start)), to_numpy(std::move(columns)), to_numpy(std::move(blocks)));
}

void bind_sparse(nb::module_ &m) {
  const char *text =
      "Product of a block sparse row matrix, blocks (n, r, c), with a vector; single or double precision.";
  m.def("block_product", &block_product<float>, nb::arg("indptr").noconvert(), nb::arg("indices").noconvert(),
        nb::arg("blocks").noconvert(), nb::arg("x").noconvert(), text);
  m.def("block_product", &block_product<double>, nb::arg("indptr").noconvert(), nb::arg("indices").noconvert(),
        nb::arg("blocks").noconvert(), nb::arg("x").noconvert(), text);
  m.def("principal_submatrix", &principal_submatrix, nb::arg("indptr").noconvert(), nb::arg("indices").noconvert(),
        nb::arg("data").noconvert(), nb::arg("place").noconvert(), nb::arg("size"),
        "CSR (indptr, indices, data) of the rows and columns i with place[i] >= 0, ascending, < size.");
  m.def("padded_blocks", &padded_blocks, nb::arg("indptr").noconvert(), nb::arg("indices").noconvert(),
        nb::arg("data").noconvert(), nb::arg("place").noconvert(), nb::arg("dim"), nb::arg("block_rows"),
        nb::arg("factor"),
        "BSR (indptr, indices, blocks, flat) of factor times a CSR matrix with sorted rows, row and column i at "
        "place[i], "
        "ascending, with ones on the diagonal elsewhere; every block row must have an entry on its diagonal.");
}

} // namespace abut

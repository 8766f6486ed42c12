// Which couplings of a stiffness matrix are strong: those between near points.
#include "bind.hpp"

namespace abut {

namespace {

struct Rows {
  const Vector<std::int32_t> &indptr, &indices;
  const Matrix<double> &points;

  double squared_distance(std::size_t i, std::size_t j) const {
    double sum = 0;
    for (std::size_t a = 0; a < points.shape(1); ++a)
      sum += (points(i, a) - points(j, a)) * (points(i, a) - points(j, a));
    return sum;
  }

  // Squared distance of each row's point to the nearest other one that it is coupled to; zero where there is none.
  std::vector<double> nearest() const {
    std::vector<double> result(indptr.shape(0) - 1, 0);
    for (std::size_t i = 0; i < result.size(); ++i)
      for (std::int32_t k = indptr(i); k < indptr(i + 1); ++k)
        if (const std::size_t j = indices(k); j != i)
          if (const double d = squared_distance(i, j); result[i] == 0 || d < result[i])
            result[i] = d;
    return result;
  }
};

} // namespace

// A matrix of blocks without couplings of points further apart than reach times the distance of either to the nearest
// point it is coupled to; what they had is added to the diagonal block of the row. None where all are near.
static nb::object strong_part(Vector<std::int32_t> indptr, Vector<std::int32_t> indices, Tensor3<double> blocks,
                              Matrix<double> points, double reach) {
  const std::size_t rows = indptr.shape(0) - 1, area = blocks.shape(1) * blocks.shape(2);
  if (indices.shape(0) != blocks.shape(0) || std::size_t(indptr(rows)) != blocks.shape(0) || points.shape(0) != rows)
    throw nb::value_error("pattern, blocks and points disagree");
  std::vector<std::uint8_t> keep(indices.shape(0));
  std::vector<std::int32_t> start(rows + 1, 0);
  {
    nb::gil_scoped_release release;
    const Rows own{indptr, indices, points};
    const std::vector<double> nearest = own.nearest();
    for (std::size_t i = 0; i < rows; ++i) {
      start[i + 1] = start[i];
      for (std::int32_t k = indptr(i); k < indptr(i + 1); ++k) {
        const std::size_t j = indices(k);
        keep[k] = own.squared_distance(i, j) <= reach * reach * std::max(nearest[i], nearest[j]);
        start[i + 1] += keep[k];
      }
    }
  }
  const std::size_t kept = start[rows];
  if (kept == indices.shape(0))
    return nb::none();
  Buffer<std::int32_t> columns(kept);
  Buffer<double> values(kept * area);
  {
    nb::gil_scoped_release release;
    std::vector<double> weak(area);
    std::size_t to = 0;
    for (std::size_t i = 0; i < rows; ++i) {
      double *diagonal = nullptr;
      std::fill(weak.begin(), weak.end(), 0.0);
      for (std::int32_t k = indptr(i); k < indptr(i + 1); ++k) {
        const double *block = blocks.data() + std::size_t(k) * area;
        if (keep[k]) {
          columns[to] = indices(k);
          double *copy = values.data() + area * to++;
          std::copy(block, block + area, copy);
          if (std::size_t(indices(k)) == i)
            diagonal = copy;
        } else
          for (std::size_t a = 0; a < area; ++a)
            weak[a] += block[a];
      }
      for (std::size_t a = 0; diagonal && a < area; ++a)
        diagonal[a] += weak[a];
    }
  }
  return nb::make_tuple(to_numpy(std::move(start)), to_numpy(std::move(columns)), to_numpy(std::move(values)));
}

void bind_strength(nb::module_ &m) {
  m.def("strong_part", &strong_part, nb::arg("indptr").noconvert(), nb::arg("indices").noconvert(),
        nb::arg("blocks").noconvert(), nb::arg("points").noconvert(), nb::arg("reach"),
        "BSR (indptr, indices, blocks, flat) without blocks of points further apart than reach times the distance of "
        "either to the nearest one it is coupled to; these are added to the diagonal. None where there are none.");
}

} // namespace abut

// Which facets only one cell has.
#include "bind.hpp"
#include <algorithm>
#include <array>
#include <stdexcept>

namespace abut {

// Numbers, ascending, of the rows of points (n, 4) that no other row equals but for the order; shorter rows are filled
// up with -1. Sorted only among those with the same largest point: faster than all at once.
static nb::ndarray<nb::numpy, std::int64_t> single_rows(Matrix<std::int32_t> rows, std::int64_t n_points) {
  using Row = std::array<std::int32_t, 4>;
  const std::size_t n = rows.shape(0);
  if (rows.shape(1) != 4)
    throw nb::value_error("rows must have four entries");
  std::vector<std::int64_t> single;
  {
    nb::gil_scoped_release release;
    std::vector<Row> sorted(n);
    std::vector<std::int64_t> start(n_points + 1, 0), order(n);
    for (std::size_t i = 0; i < n; ++i) {
      std::copy(rows.data() + 4 * i, rows.data() + 4 * i + 4, sorted[i].begin());
      std::sort(sorted[i].begin(), sorted[i].end());
      if (sorted[i][3] < 0 || sorted[i][3] >= n_points)
        throw std::out_of_range("a row names no point, or one that does not exist");
      ++start[sorted[i][3] + 1];
    }
    for (std::int64_t p = 0; p < n_points; ++p)
      start[p + 1] += start[p];
    std::vector<std::int64_t> fill(start.begin(), start.end() - 1);
    for (std::size_t i = 0; i < n; ++i)
      order[fill[sorted[i][3]]++] = std::int64_t(i);
    const auto differ = [&](std::int64_t a, std::int64_t b) { return sorted[order[a]] != sorted[order[b]]; };
    for (std::int64_t p = 0; p < n_points; ++p) {
      const std::int64_t first = start[p], last = start[p + 1];
      std::sort(order.begin() + first, order.begin() + last,
                [&](std::int64_t i, std::int64_t j) { return sorted[i] < sorted[j]; });
      for (std::int64_t a = first; a < last; ++a)
        if ((a == first || differ(a, a - 1)) && (a + 1 == last || differ(a, a + 1)))
          single.push_back(order[a]);
    }
    std::sort(single.begin(), single.end());
  }
  return to_numpy(std::move(single));
}

void bind_facets(nb::module_ &m) {
  m.def("single_rows", &single_rows, nb::arg("rows").noconvert(), nb::arg("n_points"),
        "Numbers, ascending, of rows (n, 4) of points, filled up with -1, that no other row equals but for the order.");
}

} // namespace abut

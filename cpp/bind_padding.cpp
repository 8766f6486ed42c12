// Patterns of sparse matrices that are kept while entries come and go.
#include "bind.hpp"
#include <algorithm>
#include <iterator>

namespace abut {

// The values of a CSR matrix with sorted rows in a pattern with sorted rows, zero where it has none, and how
// many have no place in it.
static nb::tuple values_in(Vector<std::int32_t> indptr, Vector<std::int32_t> indices, Vector<std::int32_t> own_indptr,
                           Vector<std::int32_t> own_indices, Vector<double> own) {
  const std::size_t rows = indptr.shape(0) - 1;
  if (own_indptr.shape(0) != rows + 1 || own_indices.shape(0) != own.shape(0))
    throw nb::value_error("matrix and pattern disagree");
  Buffer<double> values(indices.shape(0));
  std::int64_t lost = 0;
  {
    nb::gil_scoped_release release;
    for (std::size_t i = 0; i < rows; ++i) {
      std::int32_t k = own_indptr(i), found = 0;
      const std::int32_t end = own_indptr(i + 1);
      for (std::int32_t j = indptr(i); j < indptr(i + 1); ++j) {
        while (k < end && own_indices(k) < indices(j))
          ++k;
        const bool here = k < end && own_indices(k) == indices(j);
        values[j] = here ? own(k++) : 0;
        found += here;
      }
      lost += end - own_indptr(i) - found;
    }
  }
  return nb::make_tuple(to_numpy(std::move(values)), lost);
}

// All that one of two patterns with sorted rows has, or the diagonal.
static nb::tuple joined_pattern(Vector<std::int32_t> indptr, Vector<std::int32_t> indices,
                                Vector<std::int32_t> other_indptr, Vector<std::int32_t> other_indices) {
  const std::size_t rows = indptr.shape(0) - 1;
  if (other_indptr.shape(0) != rows + 1)
    throw nb::value_error("the patterns have not the same rows");
  std::vector<std::int32_t> start(1, 0), columns;
  {
    nb::gil_scoped_release release;
    columns.reserve(indices.shape(0) + rows);
    std::vector<std::int32_t> row, own;
    for (std::size_t i = 0; i < rows; ++i) {
      row.clear(), own.clear();
      std::set_union(indices.data() + indptr(i), indices.data() + indptr(i + 1), other_indices.data() + other_indptr(i),
                     other_indices.data() + other_indptr(i + 1), std::back_inserter(own));
      const std::int32_t diagonal = std::int32_t(i);
      std::set_union(own.begin(), own.end(), &diagonal, &diagonal + 1, std::back_inserter(row));
      columns.insert(columns.end(), row.begin(), row.end());
      start.push_back(std::int32_t(columns.size()));
    }
  }
  return nb::make_tuple(to_numpy(std::move(start)), to_numpy(std::move(columns)));
}

void bind_padding(nb::module_ &m) {
  m.def("values_in", &values_in, nb::arg("indptr").noconvert(), nb::arg("indices").noconvert(),
        nb::arg("own_indptr").noconvert(), nb::arg("own_indices").noconvert(), nb::arg("own").noconvert(),
        "Values of a CSR matrix in a pattern, and how many have no place in it; rows sorted.");
  m.def("joined_pattern", &joined_pattern, nb::arg("indptr").noconvert(), nb::arg("indices").noconvert(),
        nb::arg("other_indptr").noconvert(), nb::arg("other_indices").noconvert(),
        "CSR pattern (indptr, indices) of two patterns and the diagonal together; rows sorted.");
}

} // namespace abut

// What every binding file needs: array types of the contract with Python (C-contiguous, no silent conversion).
#pragma once
#include <cstdint>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <utility>
#include <vector>

namespace abut {
namespace nb = nanobind;

template <class T> using Vector = nb::ndarray<const T, nb::numpy, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <class T> using Matrix = nb::ndarray<const T, nb::numpy, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
template <class T> using Tensor3 = nb::ndarray<const T, nb::numpy, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

// Hands a vector's memory to NumPy without a copy.
template <class T> nb::ndarray<nb::numpy, T> to_numpy(std::vector<T> &&data, std::vector<std::size_t> shape = {}) {
  auto *owned = new std::vector<T>(std::move(data));
  if (shape.empty())
    shape = {owned->size()};
  nb::capsule owner(owned, [](void *p) noexcept { delete static_cast<std::vector<T> *>(p); });
  return nb::ndarray<nb::numpy, T>(owned->data(), shape.size(), shape.data(), owner);
}

void bind_cells(nb::module_ &m);
void bind_solids(nb::module_ &m);
void bind_interface(nb::module_ &m);
void bind_sparse(nb::module_ &m);
} // namespace abut

// What every binding file needs: array types of the contract with Python (C-contiguous, no silent conversion).
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <new>
#include <utility>
#include <vector>
#ifdef __linux__
#include <sys/mman.h>
#endif

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

// Memory that is not cleared first: whoever asks for it fills it. Large pieces ask for large pages, since a million
// small ones cost seconds to hand out.
template <class T> class Buffer {
public:
  explicit Buffer(std::size_t n) : count(n) {
    std::size_t bytes = std::max<std::size_t>(n * sizeof(T), 1);
#ifdef __linux__
    if (bytes >= LARGE_PAGE) {
      bytes = (bytes + LARGE_PAGE - 1) / LARGE_PAGE * LARGE_PAGE;
      memory.reset(static_cast<T *>(std::aligned_alloc(LARGE_PAGE, bytes)));
      if (memory)
        madvise(memory.get(), bytes, MADV_HUGEPAGE);
    } else
#endif
      memory.reset(static_cast<T *>(std::malloc(bytes)));
    if (!memory)
      throw std::bad_alloc();
  }
  T &operator[](std::size_t i) { return memory.get()[i]; }
  T *data() { return memory.get(); }
  std::size_t size() const { return count; }
  void shorten(std::size_t n) { count = std::min(count, n); } // what is beyond and was never written to costs nothing
  T *release() { return memory.release(); }

private:
  static constexpr std::size_t LARGE_PAGE = std::size_t(2) << 20;
  struct Free {
    void operator()(T *p) const noexcept { std::free(p); }
  };
  std::unique_ptr<T, Free> memory;
  std::size_t count;
};

template <class T> nb::ndarray<nb::numpy, T> to_numpy(Buffer<T> &&buffer) {
  T *owned = buffer.release();
  nb::capsule owner(owned, [](void *p) noexcept { std::free(p); });
  return nb::ndarray<nb::numpy, T>(owned, {buffer.size()}, owner);
}

void bind_cells(nb::module_ &m);
void bind_facets(nb::module_ &m);
void bind_padding(nb::module_ &m);
void bind_pattern(nb::module_ &m);
void bind_integrate(nb::module_ &m);
void bind_interface(nb::module_ &m);
void bind_interpolation(nb::module_ &m);
void bind_laws(nb::module_ &m);
void bind_recovery(nb::module_ &m);
void bind_sparse(nb::module_ &m);
void bind_strength(nb::module_ &m);
void bind_tangent(nb::module_ &m);
} // namespace abut

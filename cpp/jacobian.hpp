// Nodal values of a cell, and their slopes at a point of the reference cell.
#pragma once
#include <cstddef>
#include <cstdint>

namespace abut {

// Rows own[0] .. own[n - 1] of values (any, width) one after the other.
inline void gather(const double *values, const std::int32_t *own, std::size_t n, std::size_t width, double *to) {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t a = 0; a < width; ++a)
      to[i * width + a] = values[std::size_t(own[i]) * width + a];
}

// slope[a][b]: change of component a of nodal values (n, dim) along reference coordinate b, from the reference
// derivatives d (n, dim) of the shape functions.
template <int dim>
void reference_slope(const double *values, std::size_t n, const double *d, double (&slope)[dim][dim]) {
  double sum[dim][dim] = {{0}};
  for (std::size_t i = 0; i < n; ++i)
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        sum[a][b] += values[i * dim + a] * d[i * dim + b];
  for (int a = 0; a < dim; ++a)
    for (int b = 0; b < dim; ++b)
      slope[a][b] = sum[a][b];
}

template <int dim> struct Jacobian {
  double cofactor[dim][dim], det;

  // Change of reference coordinate a along position b.
  void invert(double (&inverse)[dim][dim]) const {
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        inverse[a][b] = cofactor[a][b] / det;
  }
};

// Of slopes of the position along reference coordinates, component a along b at [a][b].
template <int dim> Jacobian<dim> jacobian_of(const double (&j)[dim][dim]) {
  if constexpr (dim == 2)
    return {{{j[1][1], -j[0][1]}, {-j[1][0], j[0][0]}}, j[0][0] * j[1][1] - j[0][1] * j[1][0]};
  else {
    Jacobian<dim> result;
    auto &c = result.cofactor;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
        c[b][a] = j[a1][b1] * j[a2][b2] - j[a1][b2] * j[a2][b1];
      }
    result.det = j[0][0] * c[0][0] + j[0][1] * c[1][0] + j[0][2] * c[2][0];
    return result;
  }
}

// Of a cell with nodes at x (n, dim).
template <int dim> Jacobian<dim> jacobian(const double *x, std::size_t n, const double *d) {
  double j[dim][dim];
  reference_slope<dim>(x, n, d, j);
  return jacobian_of<dim>(j);
}

// Gradients (n, dim) of the shape functions, and the inverse of the Jacobian; returns the determinant.
template <int dim>
double gradients(const double *x, std::size_t n, const double *d, double *gradient, double (&inverse)[dim][dim]) {
  const Jacobian<dim> j = jacobian<dim>(x, n, d);
  j.invert(inverse);
  for (std::size_t i = 0; i < n; ++i)
    for (int a = 0; a < dim; ++a) {
      double sum = 0;
      for (int b = 0; b < dim; ++b)
        sum += d[i * dim + b] * inverse[b][a];
      gradient[i * dim + a] = sum;
    }
  return j.det;
}
template <int dim> double gradients(const double *x, std::size_t n, const double *d, double *gradient) {
  double inverse[dim][dim];
  return gradients<dim>(x, n, d, gradient, inverse);
}

} // namespace abut

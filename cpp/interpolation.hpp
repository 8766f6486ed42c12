// Forces that straight triangles and tetrahedra leave of displacements that bend; theory (Z11).
#pragma once
#include "jacobian.hpp"
#include <cmath>
#include <numbers>

namespace abut {

// Of one kind: nodes (count, dim + 1); stress (count, dim + 1, 6) at them; thermal strain there, or null; number of
// each cell's compliance (any, 6, 6) and stiffness (any, C, C), of strains xx yy zz xy (yz zx), shear doubled; a rule
// with shapes (q, dim + 1), their reference derivatives (dim + 1, dim), the same at all its points, and weights (q),
// which add up to 1.
struct Simplices {
  const double *points;
  const std::int32_t *nodes;
  const double *stress, *thermal;
  const std::int32_t *number;
  const double *compliance, *stiffness;
  std::size_t q;
  const double *shapes, *derivatives, *weights;
};

template <int dim, bool axisymmetric> class InterpolationForce {
public:
  static constexpr int K = dim + 1, C = dim == 2 ? 4 : 6;

  explicit InterpolationForce(const Simplices &cells) : in(cells) {}

  // Of a cell, at its nodes (K, dim).
  void at(std::size_t cell, double *result) const {
    double x[K * dim], slope[K * dim], bend[dim][dim][dim];
    gather(in.points, in.nodes + cell * K, K, dim, x);
    const double volume = std::abs(gradients<dim>(x, K, in.derivatives, slope)) / (dim == 2 ? 2 : 6);
    second_derivatives(cell, slope, bend);
    std::fill(result, result + K * dim, 0.0);
    for (std::size_t p = 0; p < in.q; ++p)
      add(cell, p, x, slope, volume, bend, result);
  }

private:
  static constexpr int AT[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

  // u_a,bc = e_ac,b + e_ab,c - e_bc,a
  void second_derivatives(std::size_t cell, const double *slope, double (&bend)[dim][dim][dim]) const {
    double change[6][dim] = {{0}}; // of the tensor's components
    const double *compliance = in.compliance + in.number[cell] * 36;
    for (int k = 0; k < K; ++k) {
      const double *stress = in.stress + (cell * K + k) * 6;
      for (int a = 0; a < 6; ++a) {
        double strain = 0;
        for (int b = 0; b < 6; ++b)
          strain += compliance[a * 6 + b] * stress[b];
        if (a >= 3)
          strain *= 0.5;
        else if (in.thermal)
          strain += in.thermal[cell * K + k];
        for (int d = 0; d < dim; ++d)
          change[a][d] += strain * slope[k * dim + d];
      }
    }
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        for (int c = 0; c < dim; ++c)
          bend[a][b][c] = change[AT[a][c]][b] + change[AT[a][b]][c] - change[AT[b][c]][a];
  }

  // Of the displacement less its interpolate: - 1/2 sum over edges of d . bend d times the functions of both ends.
  void add(std::size_t cell, std::size_t p, const double *x, const double *slope, double volume,
           const double (&bend)[dim][dim][dim], double *result) const {
    const double *shape = in.shapes + p * K, *stiffness = in.stiffness + in.number[cell] * C * C;
    double turned[dim][dim] = {{0}}, along = 0, radius = 1;
    for (int i = 0; i < K; ++i)
      for (int j = i + 1; j < K; ++j) {
        double edge[dim], left[dim] = {0};
        for (int a = 0; a < dim; ++a)
          edge[a] = x[i * dim + a] - x[j * dim + a];
        for (int a = 0; a < dim; ++a)
          for (int b = 0; b < dim; ++b)
            for (int c = 0; c < dim; ++c)
              left[a] -= 0.5 * edge[b] * bend[a][b][c] * edge[c];
        for (int a = 0; a < dim; ++a)
          for (int d = 0; d < dim; ++d)
            turned[a][d] += left[a] * (shape[i] * slope[j * dim + d] + shape[j] * slope[i * dim + d]);
        along += shape[i] * shape[j] * left[0];
      }
    if (axisymmetric) {
      radius = 0;
      for (int i = 0; i < K; ++i)
        radius += shape[i] * x[i * dim];
    }
    double strain[C] = {0}, stress[C] = {0};
    for (int a = 0; a < dim; ++a)
      strain[a] = turned[a][a];
    if (axisymmetric)
      strain[2] = along / radius;
    for (int a = 0; a + 1 < dim; ++a)
      strain[3 + a] = turned[a][a + 1] + turned[a + 1][a];
    if (dim == 3)
      strain[C - 1] = turned[dim - 1][0] + turned[0][dim - 1];
    for (int a = 0; a < C; ++a)
      for (int b = 0; b < C; ++b)
        stress[a] += stiffness[a * C + b] * strain[b];
    const double area = in.weights[p] * volume * (axisymmetric ? 2 * std::numbers::pi * radius : 1);
    for (int k = 0; k < K; ++k) {
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b)
          result[k * dim + a] += area * stress[AT[a][b]] * slope[k * dim + b];
      if (axisymmetric)
        result[k * dim] += area * stress[2] / radius * shape[k];
    }
  }

  const Simplices &in;
};

} // namespace abut

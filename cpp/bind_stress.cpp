// Stresses of the cells carried to their nodes, and the smallest Jacobian determinant of each cell.
#include "bind.hpp"
#include "cells.hpp"
#include "jacobian.hpp"
#include "parallel.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace abut {

// What the kernel reads: points and displacement (n_points, dim), temperature (n_points); cells of one type with nodes
// (cells, n) and constants (cells, 6) lambda, mu, Poisson's ratio, expansion, uniform temperature, 1 if it deforms;
// stress points with shapes (q, n), derivatives (q, n, dim), weights (q) and extrapolation (n, q) from them to the
// nodes.
struct Stresses {
  const double *points, *displacement, *temperature;
  const std::int32_t *nodes;
  const double *constants, *shapes, *derivatives, *weights, *extrapolation;
  std::size_t cells, n, rule;
  bool plane_stress, mean_dilatation;
};

// For the points first .. last - 1: adds the stresses xx yy zz xy yz zx of the cells to total (n_points, 6) and the
// number of deforming cells to count. Axisymmetric: the hoop strain is u_r / r. mean_dilatation as in the stiffness.
template <int dim, bool axisymmetric>
static void add_stress(const Stresses &in, double *total, double *count, std::int32_t first, std::int32_t last) {
  const std::size_t n = in.n;
  double x[MAX_NODES * dim], u[MAX_NODES * dim], change[MAX_NODES];
  std::vector<double> stress(in.rule * 6), thermal(in.rule), volume(in.rule);
  for (std::size_t c = 0; c < in.cells; ++c) {
    const std::int32_t *own = in.nodes + c * n;
    if (std::none_of(own, own + n, [&](std::int32_t i) { return i >= first && i < last; }))
      continue;
    gather(in.points, own, n, dim, x);
    gather(in.displacement, own, n, dim, u);
    gather(in.temperature, own, n, 1, change);
    const double *constants = in.constants + 6 * c, lambda = constants[0], mu = constants[1];
    for (std::size_t q = 0; q < in.rule; ++q) {
      const double *shape = in.shapes + q * n;
      const auto j = jacobian<dim>(x, n, in.derivatives + q * n * dim);
      double inverse[dim][dim], along[dim][dim], slope[3][3] = {{0}}, det = j.det, warm = constants[4], r = 0,
                                                 outward = 0;
      j.invert(inverse);
      reference_slope<dim>(u, n, in.derivatives + q * n * dim, along);
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b)
          for (int k = 0; k < dim; ++k)
            slope[a][b] += along[a][k] * inverse[k][b];
      for (std::size_t i = 0; i < n; ++i) {
        warm += shape[i] * change[i];
        if constexpr (axisymmetric)
          r += shape[i] * x[i * dim], outward += shape[i] * u[i * dim];
      }
      thermal[q] = constants[3] * warm;
      if constexpr (axisymmetric)
        slope[2][2] = outward / r, det *= r;
      if (in.plane_stress)
        slope[2][2] = thermal[q] - constants[2] / (1 - constants[2]) * (slope[0][0] + slope[1][1] - 2 * thermal[q]);
      volume[q] = det * in.weights[q];
      double *strain = &stress[q * 6];
      for (int a = 0; a < 3; ++a) {
        strain[a] = slope[a][a];
        strain[3 + a] = 0.5 * (slope[a][(a + 1) % 3] + slope[(a + 1) % 3][a]);
      }
    }
    if (in.mean_dilatation) { // the points are those of the stiffness
      double whole = 0, mean = 0;
      for (std::size_t q = 0; q < in.rule; ++q) {
        const double *strain = &stress[q * 6];
        whole += volume[q], mean += (strain[0] + strain[1] + strain[2]) * volume[q];
      }
      mean /= whole;
      for (std::size_t q = 0; q < in.rule; ++q) {
        double *strain = &stress[q * 6];
        const double more = (mean - (strain[0] + strain[1] + strain[2])) / 3;
        for (int a = 0; a < 3; ++a)
          strain[a] += more;
      }
    }
    for (std::size_t q = 0; q < in.rule; ++q) {
      double *own_stress = &stress[q * 6];
      for (int a = 0; a < 3; ++a)
        own_stress[a] -= thermal[q];
      const double spherical = lambda * (own_stress[0] + own_stress[1] + own_stress[2]);
      for (int k = 0; k < 6; ++k)
        own_stress[k] = 2 * mu * own_stress[k] + (k < 3 ? spherical : 0);
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (own[i] < first || own[i] >= last)
        continue;
      double sum[6] = {0};
      for (std::size_t q = 0; q < in.rule; ++q)
        for (int k = 0; k < 6; ++k)
          sum[k] += in.extrapolation[i * in.rule + q] * stress[q * 6 + k];
      for (int k = 0; k < 6; ++k)
        total[std::size_t(own[i]) * 6 + k] += sum[k];
      count[own[i]] += constants[5];
    }
  }
}

static void add_stresses(Matrix<double> points, Matrix<double> displacement, Vector<double> temperature,
                         Matrix<std::int32_t> nodes, Matrix<double> constants, Matrix<double> shapes,
                         Tensor3<double> derivatives, Vector<double> weights, Matrix<double> extrapolation,
                         bool axisymmetric, bool plane_stress, bool mean_dilatation,
                         nb::ndarray<double, nb::numpy, nb::ndim<2>, nb::c_contig, nb::device::cpu> total,
                         nb::ndarray<double, nb::numpy, nb::ndim<1>, nb::c_contig, nb::device::cpu> count) {
  const std::size_t rows = points.shape(0), dim = points.shape(1), n = nodes.shape(1), q = weights.shape(0);
  if (displacement.shape(0) != rows || displacement.shape(1) != dim || temperature.shape(0) != rows ||
      total.shape(0) != rows || total.shape(1) != 6 || count.shape(0) != rows)
    throw nb::value_error("points and their values disagree");
  if (n > MAX_NODES || constants.shape(0) != nodes.shape(0) || constants.shape(1) != 6 || shapes.shape(0) != q ||
      shapes.shape(1) != n || derivatives.shape(0) != q || derivatives.shape(1) != n || derivatives.shape(2) != dim ||
      extrapolation.shape(0) != n || extrapolation.shape(1) != q || ((axisymmetric || plane_stress) && dim != 2))
    throw nb::value_error("rule, cells and materials disagree");
  const Stresses in{points.data(),
                    displacement.data(),
                    temperature.data(),
                    nodes.data(),
                    constants.data(),
                    shapes.data(),
                    derivatives.data(),
                    weights.data(),
                    extrapolation.data(),
                    nodes.shape(0),
                    n,
                    q,
                    plane_stress,
                    mean_dilatation};
  nb::gil_scoped_release release;
  const auto add = axisymmetric ? add_stress<2, true> : dim == 2 ? add_stress<2, false> : add_stress<3, false>;
  // Every thread owns a range of points, as for the stiffness.
  const std::size_t parts = in.cells < FEW_CELLS ? 1 : thread_count();
  run_parts(parts, [&](std::size_t part) {
    add(in, total.data(), count.data(), std::int32_t(rows * part / parts), std::int32_t(rows * (part + 1) / parts));
  });
}

template <int dim>
static double smallest_determinant(const double *points, const std::int32_t *own, std::size_t n,
                                   const double *derivatives, std::size_t rule) {
  double x[MAX_NODES * dim], smallest = std::numeric_limits<double>::infinity(), size = 0;
  gather(points, own, n, dim, x);
  for (int a = 0; a < dim; ++a) {
    double low = x[a], high = x[a];
    for (std::size_t i = 1; i < n; ++i)
      low = std::min(low, x[i * dim + a]), high = std::max(high, x[i * dim + a]);
    size = std::max(size, high - low);
  }
  for (std::size_t i = n; i-- > 0;) // a cell of size one: the determinant has no unit and cannot overflow
    for (int a = 0; a < dim; ++a)
      x[i * dim + a] = (x[i * dim + a] - x[a]) / (size > 0 ? size : 1);
  for (std::size_t q = 0; q < rule; ++q) {
    const double det = jacobian<dim>(x, n, derivatives + q * n * dim).det;
    if (std::isnan(det))
      return det;
    smallest = std::min(smallest, det);
  }
  return smallest;
}

static nb::ndarray<nb::numpy, double> smallest_determinants(Matrix<double> points, Matrix<std::int32_t> nodes,
                                                            Tensor3<double> derivatives) {
  const std::size_t dim = points.shape(1), cells = nodes.shape(0), n = nodes.shape(1);
  if (n > MAX_NODES || derivatives.shape(1) != n || derivatives.shape(2) != dim || (dim != 2 && dim != 3))
    throw nb::value_error("points, cells and derivatives disagree");
  Buffer<double> result(cells);
  {
    nb::gil_scoped_release release;
    const auto smallest = dim == 2 ? smallest_determinant<2> : smallest_determinant<3>;
    const std::size_t parts = cells < FEW_CELLS ? 1 : thread_count();
    run_parts(parts, [&](std::size_t part) {
      for (std::size_t c = cells * part / parts; c < cells * (part + 1) / parts; ++c)
        result[c] = smallest(points.data(), nodes.data() + c * n, n, derivatives.data(), derivatives.shape(0));
    });
  }
  return to_numpy(std::move(result));
}

void bind_stress(nb::module_ &m) {
  m.def("add_stresses", &add_stresses, nb::arg("points").noconvert(), nb::arg("displacement").noconvert(),
        nb::arg("temperature").noconvert(), nb::arg("nodes").noconvert(), nb::arg("constants").noconvert(),
        nb::arg("shapes").noconvert(), nb::arg("derivatives").noconvert(), nb::arg("weights").noconvert(),
        nb::arg("extrapolation").noconvert(), nb::arg("axisymmetric"), nb::arg("plane_stress"),
        nb::arg("mean_dilatation"), nb::arg("total").noconvert(), nb::arg("count").noconvert(),
        "Adds the stresses of all cells of one type, carried to their nodes, to total (n_points, 6), and how many "
        "cells a "
        "point has to count, in place.");
  m.def("smallest_determinants", &smallest_determinants, nb::arg("points").noconvert(), nb::arg("nodes").noconvert(),
        nb::arg("derivatives").noconvert(),
        "Smallest Jacobian determinant (cells,) over the points of a rule, of cells scaled to size one; NaN where one "
        "is.");
}

} // namespace abut

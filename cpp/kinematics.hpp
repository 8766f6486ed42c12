// Kinematics: how the displacements of a cell's nodes strain it, and the nodal forces and stiffness that stresses and
// tangents at its integration points then mean.
#pragma once
#include "cell_functions.hpp"
#include "jacobian.hpp"
#include "last_node.hpp"
#include "materials.hpp"
#include <algorithm>
#include <numbers>
#include <vector>

namespace abut {

// Cells of one type and an integration rule on the reference cell: points (any, dim), nodes (count, n); shapes (rule,
// n), derivatives (rule, n, dim), weights (rule). mean_dilatation: the dilatation is its mean over the cell,
// theory (E3). pressures: of a mixed cell, its own and eliminated, 1 or dim + 1, theory (E6); 0: no mixed cell.
struct Cells {
  const double *points;
  const std::int32_t *nodes;
  std::size_t count, n;
  const double *shapes, *derivatives, *weights;
  std::size_t rule;
  bool mean_dilatation;
  std::size_t pressures;

  // Functions of the dilatation that counts; 0: that at each point.
  std::size_t modes() const { return pressures ? pressures : mean_dilatation; }
};

// Small strains in space or in the plane, where the strains out of the plane are zero (what a material makes of that in
// plane stress is its matter). Axisymmetric: coordinates are (r, z), the hoop strain zz is u_r / r and integrals run
// round the axis.
template <int dim, bool axisymmetric> class SmallStrain {
public:
  static constexpr int DIM = dim;
  static constexpr bool finite = false;

  explicit SmallStrain(const Cells &cells)
      : cells(cells), n(cells.n), gradient(cells.rule * n * dim), hoop(axisymmetric ? cells.rule * n : 0),
        volume(cells.rule), mean(cells.rule * n * dim), response(n * (STRAINS + 1) * dim), mixed(cells.modes() > 0),
        functions(cells.modes(), cells.rule, dim), sums(cells.modes() * n * dim),
        slopes(mixed ? cells.rule * n * dim : 0), places(mixed ? cells.rule * dim : 0),
        seen(cells.pressures ? cells.rule * n : 0), scratch(cells.pressures * n) {}

  // Moves to the cell with nodes at x (n, dim).
  void place(const double *x) {
    for (std::size_t q = 0; q < cells.rule; ++q) {
      const double *shape = cells.shapes + q * n;
      volume[q] = gradients<dim>(x, n, cells.derivatives + q * n * dim, &gradient[q * n * dim]) * cells.weights[q];
      if constexpr (axisymmetric) {
        double r = 0;
        for (std::size_t i = 0; i < n; ++i)
          r += shape[i] * x[i * dim];
        for (std::size_t i = 0; i < n; ++i)
          hoop[q * n + i] = shape[i] / r;
        volume[q] *= 2 * std::numbers::pi * r;
      }
    }
    if (mixed)
      average(x);
  }

  // Strain at point q under displacements u (n, dim) of the nodes.
  void strain(std::size_t q, const double *u, double *strain) const {
    double slope[3][3] = {{0}};
    for (std::size_t i = 0; i < n; ++i) {
      const double *g = &gradient[(q * n + i) * dim];
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b)
          slope[a][b] += u[i * dim + a] * g[b];
      if constexpr (axisymmetric)
        slope[2][2] += u[i * dim] * hoop[q * n + i];
    }
    for (int a = 0; a < 3; ++a) {
      strain[a] = slope[a][a];
      strain[3 + a] = slope[a][(a + 1) % 3] + slope[(a + 1) % 3][a];
    }
    if (!mixed)
      return;
    double more = -(strain[0] + strain[1] + strain[2]);
    for (std::size_t j = 0; j < n * dim; ++j)
      more += mean[q * n * dim + j] * u[j];
    for (int a = 0; a < 3; ++a)
      strain[a] += more / 3;
  }

  // Adds the forces (n, dim) of a stress at point q.
  void add_force(std::size_t q, const double *stress, double *force) const {
    // The mean stress works on the mean dilatation where that takes the place of the dilatation at the point.
    const double averaged = mixed ? (stress[0] + stress[1] + stress[2]) / 3 : 0, w = volume[q];
    double sigma[3][3];
    for (int a = 0; a < 3; ++a) {
      sigma[a][a] = stress[a] - averaged;
      sigma[a][(a + 1) % 3] = sigma[(a + 1) % 3][a] = stress[3 + a];
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double *g = &gradient[(q * n + i) * dim];
      for (int a = 0; a < dim; ++a) {
        double sum = averaged * mean[(q * n + i) * dim + a];
        for (int b = 0; b < dim; ++b)
          sum += sigma[a][b] * g[b];
        force[i * dim + a] += w * sum;
      }
      if constexpr (axisymmetric)
        force[i * dim] += w * sigma[2][2] * hoop[q * n + i];
    }
  }

  void complete_force(double *) const {} // as of finite strains

  // Adds the stiffness (n, n, dim, dim) of any tangent at point q, of the nodes that ``complete`` does not add;
  // symmetric: it is, and only nodes i <= k are added up.
  void add_stiffness(std::size_t q, const double *c, bool symmetric, double *block) {
    const std::size_t nodes = added();
    for (std::size_t k = 0; k < nodes; ++k)
      respond(q, k, c, &response[k * (STRAINS + 1) * dim]);
    for (std::size_t i = 0; i < nodes; ++i) {
      double g[dim], more[dim]; // local, so that they stay in registers
      std::copy_n(&gradient[(q * n + i) * dim], dim, g);
      for (int a = 0; a < dim; ++a)
        more[a] = mixed ? (mean[(q * n + i) * dim + a] - dilatation(q, i, a)) / 3 : 0;
      for (std::size_t k = symmetric ? i : 0; k < nodes; ++k) {
        const double *r = &response[k * (STRAINS + 1) * dim];
        double *out = &block[(i * n + k) * dim * dim];
        for (int d = 0; d < dim; ++d) {
          const double normal = r[STRAINS * dim + d];
          out[d] += g[0] * r[d] + g[1] * r[3 * dim + d] + more[0] * normal;
          out[dim + d] += g[1] * r[dim + d] + g[0] * r[3 * dim + d] + more[1] * normal;
          if constexpr (dim == 3) {
            out[d] += g[2] * r[5 * dim + d];
            out[dim + d] += g[2] * r[4 * dim + d];
            out[2 * dim + d] +=
                g[2] * r[2 * dim + d] + g[1] * r[4 * dim + d] + g[0] * r[5 * dim + d] + more[2] * normal;
          }
          if constexpr (axisymmetric)
            out[d] += hoop[q * n + i] * r[2 * dim + d];
        }
      }
    }
  }

  // Adds what is left once all points are in: nodes whose equal displacement does not strain the cell.
  void complete(bool symmetric, double *block) const {
    if (added() < n)
      complete_last_node<dim>(n, symmetric, block);
  }

  // Stiffness of two constants, of all nodes, for i <= k, without the mean dilatation: lambda div v div u + 2 mu eps(v)
  // : eps(u).
  void add_stiffness(std::size_t q, const Moduli &tangent, double *block) {
    const double w = volume[q], mu = tangent.mu;
    const double lambda = mixed ? -2 * mu / 3 : tangent.lambda; // what is left is deviatoric
    for (std::size_t i = 0; i < n; ++i) {
      double g[dim]; // local, so that it stays in registers
      std::copy_n(&gradient[(q * n + i) * dim], dim, g);
      const double hoop_i = axisymmetric ? hoop[q * n + i] : 0;
      for (std::size_t k = i; k < n; ++k) {
        const double *h = &gradient[(q * n + k) * dim];
        double *out = &block[(i * n + k) * dim * dim], scalar = 0;
        for (int a = 0; a < dim; ++a)
          scalar += g[a] * h[a];
        for (int a = 0; a < dim; ++a) {
          for (int b = 0; b < dim; ++b)
            out[a * dim + b] += w * (lambda * g[a] * h[b] + mu * g[b] * h[a]);
          out[a * dim + a] += w * mu * scalar;
        }
        if constexpr (axisymmetric) {
          const double hoop_k = hoop[q * n + k];
          out[0] += w * (lambda + 2 * mu) * hoop_i * hoop_k;
          for (int a = 0; a < dim; ++a)
            out[a * dim] += w * lambda * g[a] * hoop_k, out[a] += w * lambda * hoop_i * h[a];
        }
      }
    }
  }

  // Adds what the mean dilatation contributes once all points are in.
  void finish(const Moduli &tangent, double *block) const {
    const double bulk = tangent.lambda + 2 * tangent.mu / 3;
    for (std::size_t m = 0; m < functions.count; ++m) {
      const double *sum = &sums[m * n * dim];
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = i; k < n; ++k)
          for (int a = 0; a < dim; ++a)
            for (int b = 0; b < dim; ++b)
              block[((i * n + k) * dim + a) * dim + b] += bulk * sum[i * dim + a] * sum[k * dim + b];
    }
  }

  static constexpr bool by_modes() { return false; } // as of finite strains
  double reference_volume(std::size_t q) const { return volume[q]; }

  // Shape functions (rule, n) by which heat swells the cell: of a mixed one as far as its pressures see it.
  const double *swelling() const { return cells.pressures ? seen.data() : cells.shapes; }

private:
  // Nodes, from the first on, whose stiffness under any tangent is integrated.
  std::size_t added() const { return axisymmetric ? n : n - 1; }

  // r[s][a]: stress s at point q, times its weight, by displacement a of node k under a tangent c; last the sum of the
  // normal ones.
  void respond(std::size_t q, std::size_t k, const double *c, double *r) const {
    const double *g = &gradient[(q * n + k) * dim], w = volume[q];
    double more[dim];
    for (int a = 0; a < dim; ++a)
      more[a] = mixed ? (mean[(q * n + k) * dim + a] - dilatation(q, k, a)) / 3 : 0, r[STRAINS * dim + a] = 0;
    for (int s = 0; s < STRAINS; ++s, c += STRAINS) {
      const double swelling = c[0] + c[1] + c[2];
      double own[dim];
      if constexpr (dim == 3) {
        own[0] = c[0] * g[0] + c[3] * g[1] + c[5] * g[2];
        own[1] = c[1] * g[1] + c[3] * g[0] + c[4] * g[2];
        own[2] = c[2] * g[2] + c[4] * g[1] + c[5] * g[0];
      } else {
        own[0] = c[0] * g[0] + c[3] * g[1];
        own[1] = c[1] * g[1] + c[3] * g[0];
        if constexpr (axisymmetric)
          own[0] += c[2] * hoop[q * n + k];
      }
      for (int a = 0; a < dim; ++a) {
        r[s * dim + a] = w * (own[a] + swelling * more[a]);
        if (s < 3)
          r[STRAINS * dim + a] += r[s * dim + a];
      }
    }
  }

  double dilatation(std::size_t q, std::size_t i, int a) const {
    const double g = gradient[(q * n + i) * dim + a];
    return axisymmetric && a == 0 ? g + hoop[q * n + i] : g;
  }

  // The dilatation by displacements projected on the functions of the cell with nodes at x (n, dim).
  void average(const double *x) {
    std::fill(places.begin(), places.end(), 0.0);
    for (std::size_t q = 0; q < cells.rule; ++q)
      for (std::size_t i = 0; i < n; ++i)
        for (int a = 0; a < dim; ++a) {
          places[q * dim + a] += cells.shapes[q * n + i] * x[i * dim + a];
          slopes[(q * n + i) * dim + a] = dilatation(q, i, a);
        }
    functions.place(places.data(), volume.data());
    functions.project(slopes.data(), volume.data(), n * dim, sums.data(), mean.data());
    if (cells.pressures)
      functions.project(cells.shapes, volume.data(), n, scratch.data(), seen.data());
  }

  const Cells &cells;
  std::size_t n;
  std::vector<double> gradient, hoop, volume, mean,
      response; // mean: dilatation that counts at a point per displacement
  bool mixed;
  CellFunctions functions; // of the dilatation; sums: their factors per displacement
  std::vector<double> sums, slopes, places, seen, scratch;
};

} // namespace abut

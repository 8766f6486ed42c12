// Finite strains of mixed cells, docs/theory/finite-deformation.md (D19) to (D21).
#pragma once
#include "cell_functions.hpp"
#include "finite_strain.hpp"

namespace abut {

// Within a cell the change of volume that counts is that at the points, projected on the functions of its pressure: the
// deformation gradient is scaled, alike in all directions, to have it. Forces are the derivative of an energy where the
// law's stresses are, so that the stiffness is symmetric with its tangent.
template <int dim, bool axisymmetric> class MixedStrain : public FiniteStrain<dim, axisymmetric> {
  using Base = FiniteStrain<dim, axisymmetric>;
  using Base::cells, Base::n, Base::gradient, Base::hoop, Base::volume, Base::points;

public:
  explicit MixedStrain(const Cells &cells)
      : Base(cells), functions(cells.pressures, cells.rule, dim), growth(cells.rule), grown(cells.rule),
        pressure(cells.rule), mean_stress(cells.rule), places(cells.rule * dim), factors(cells.pressures),
        log_change(cells.rule * n * dim), change(cells.rule * n * dim), projected(cells.rule * n * dim),
        sums(cells.pressures * n * dim), seen(cells.rule * n), scratch(cells.pressures * n), bar(n), by_strain(n) {}

  // As in ``FiniteStrain``.
  void place(const double *x) {
    Base::place(x);
    std::fill(places.begin(), places.end(), 0.0);
    for (std::size_t q = 0; q < cells.rule; ++q)
      for (std::size_t i = 0; i < n; ++i)
        for (int a = 0; a < dim; ++a)
          places[q * dim + a] += cells.shapes[q * n + i] * x[i * dim + a];
    functions.place(places.data(), volume.data());
    functions.project(cells.shapes, volume.data(), n, scratch.data(), seen.data());
  }

  bool deform(const double *u, double &determinant) {
    for (std::size_t q = 0; q < cells.rule; ++q) {
      double slope[3][3];
      this->displacement_slope(u, &gradient[q * n * dim], axisymmetric ? &hoop[q * n] : nullptr, slope);
      points[q].set(slope);
      growth[q] = expansion(slope);
      determinant = points[q].det;
      if (!(determinant > 0) || !std::isfinite(determinant))
        return false;
      points[q].invert();
    }
    functions.project(growth.data(), volume.data(), 1, factors.data(), grown.data());
    for (std::size_t q = 0; q < cells.rule; ++q) {
      determinant = 1 + grown[q];
      if (!(determinant > 0))
        return false;
      points[q].scale = std::cbrt(determinant / points[q].det);
    }
    changes();
    return true;
  }

  void strain(std::size_t q, double *strain) const {
    const double more = std::expm1(2.0 / 3 * std::log1p((grown[q] - growth[q]) / points[q].det)); // square - 1
    for (int s = 0; s < STRAINS; ++s)
      strain[s] = points[q].strain[s] * (1 + more) + (s < 3) * more / 2;
  }

  // As in ``FiniteStrain``.
  void bend(const MixedStrain &past, bool all, double *change) {
    Base::bend(past, all, growth.data());
    functions.project(growth.data(), volume.data(), 1, factors.data(), change);
  }

  // Takes the stresses (rule, 6) of all points, whose pressures act over the cell.
  void collect(const double *stress) {
    for (std::size_t q = 0; q < cells.rule; ++q) {
      double c[STRAINS];
      metric(q, c);
      mean_stress[q] = 0;
      for (int s = 0; s < STRAINS; ++s)
        mean_stress[q] += stress[q * STRAINS + s] * c[s] / 3;
      growth[q] = mean_stress[q] / (1 + grown[q]); // no longer needed as it was
    }
    functions.project(growth.data(), volume.data(), 1, factors.data(), pressure.data());
  }

  // Adds the forces of theory (D20).
  void add_force(std::size_t q, const double *stress, double *force) const {
    const double square = points[q].scale * points[q].scale;
    const double swell = pressure[q] * points[q].det - mean_stress[q];
    double b[STRAINS][dim];
    for (std::size_t i = 0; i < n; ++i) {
      derivative(q, i, b);
      for (int a = 0; a < dim; ++a) {
        double sum = swell * log_change[(q * n + i) * dim + a];
        for (int s = 0; s < STRAINS; ++s)
          sum += square * b[s][a] * stress[s];
        force[i * dim + a] += volume[q] * sum;
      }
    }
  }

  bool symmetric() const { return true; }

  // Adds the stiffness of theory (D21), of the nodes that ``complete`` does not add.
  void add_stiffness(std::size_t q, const Dense &tangent, const double *stress, bool half, double *block) {
    const double w = volume[q], square = points[q].scale * points[q].scale, t = 3 * mean_stress[q];
    const double whole = pressure[q] * points[q].det, turn = whole - mean_stress[q];
    for (std::size_t k = 0; k < this->added(); ++k)
      respond(q, k, tangent, stress);
    double sigma[3][3];
    tensor(stress, sigma);
    for (std::size_t i = 0; i < this->added(); ++i) {
      const double *g = &gradient[(q * n + i) * dim], *own = &log_change[(q * n + i) * dim];
      for (std::size_t k = half ? i : 0; k < this->added(); ++k) {
        const double *h = &gradient[(q * n + k) * dim], *other = &log_change[(q * n + k) * dim];
        const Node &x = bar[i], &y = bar[k];
        double *out = &block[(i * n + k) * dim * dim], scalar = 0;
        for (int a = 0; a < dim; ++a)
          for (int b = 0; b < dim; ++b)
            scalar += g[a] * sigma[a][b] * h[b];
        for (int a = 0; a < dim; ++a) {
          for (int b = 0; b < dim; ++b) {
            double sum = 2 * (x.stress[a] * y.scale[b] + x.scale[a] * y.stress[b] + t * x.scale[a] * y.scale[b]) -
                         mean_stress[q] * x.change[a] * y.change[b] + whole * own[a] * other[b] -
                         turn * x.push[b] * y.push[a];
            for (int s = 0; s < STRAINS; ++s)
              sum += x.strain[s][a] * by_strain[k].strain[s][b];
            out[a * dim + b] += w * sum;
          }
          out[a * dim + a] += w * square * scalar;
        }
        if constexpr (axisymmetric)
          out[0] += w * hoop[q * n + i] * hoop[q * n + k] *
                    (square * sigma[2][2] - turn * points[q].inverse[2][2] * points[q].inverse[2][2]);
      }
    }
  }

  void to_cauchy(std::size_t q, double *stress) const {
    const auto &f = points[q].f;
    double sigma[3][3], result[3][3] = {{0}};
    tensor(stress, sigma);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        for (int c = 0; c < 3; ++c)
          for (int d = 0; d < 3; ++d)
            result[a][b] += f[a][c] * sigma[c][d] * f[b][d];
    const double factor = points[q].scale * points[q].scale / (1 + grown[q]);
    for (int a = 0; a < 3; ++a) {
      stress[a] = result[a][a] * factor;
      stress[3 + a] = result[a][(a + 1) % 3] * factor;
    }
  }

  double determinant(std::size_t q) const { return 1 + grown[q]; }
  const double *swelling() const { return seen.data(); }

private:
  // Of a node at a point, by its displacements: strain that counts; stress by the strain at the point, times the square
  // of the factor; logarithm of the factor; relative change of the volume that counts, and of that at the point without
  // the hoop's part.
  struct Node {
    double strain[STRAINS][dim], stress[dim], scale[dim], change[dim], push[dim];
  };
  struct Response {
    double strain[STRAINS][dim];
  };

  // det(1 + slope) - 1, which keeps its digits where it is small.
  static double expansion(const double (&h)[3][3]) {
    return h[0][0] + h[1][1] + h[2][2] + second_invariant(h) + third_invariant(h);
  }

  // The scaled right Cauchy-Green tensor, shear doubled: strain by the logarithm of the factor.
  void metric(std::size_t q, double *c) const {
    const double square = points[q].scale * points[q].scale;
    for (int s = 0; s < STRAINS; ++s)
      c[s] = square * (2 * points[q].strain[s] + (s < 3));
  }

  // Change of the logarithm of the volume at the points, and of the volume that counts, by displacements.
  void changes() {
    for (std::size_t q = 0; q < cells.rule; ++q)
      for (std::size_t i = 0; i < n; ++i) {
        double *own = &log_change[(q * n + i) * dim];
        Base::push(points[q], &gradient[(q * n + i) * dim], axisymmetric ? hoop[q * n + i] : 0, own);
        for (int a = 0; a < dim; ++a)
          change[(q * n + i) * dim + a] = points[q].det * own[a];
      }
    functions.project(change.data(), volume.data(), n * dim, sums.data(), projected.data());
  }

  // b[s][a]: strain s at point q per displacement a of node i.
  void derivative(std::size_t q, std::size_t i, double (&b)[STRAINS][dim]) const {
    const double *g = &gradient[(q * n + i) * dim];
    const auto &f = points[q].f;
    for (int a = 0; a < dim; ++a) {
      for (int s = 0; s < STRAINS; ++s)
        b[s][a] = 0;
      for (int s = 0; s < dim; ++s)
        b[s][a] = f[a][s] * g[s];
      b[3][a] = f[a][0] * g[1] + f[a][1] * g[0];
      if constexpr (dim == 3)
        b[4][a] = f[a][1] * g[2] + f[a][2] * g[1], b[5][a] = f[a][2] * g[0] + f[a][0] * g[2];
    }
    if constexpr (axisymmetric)
      b[2][0] = f[2][2] * hoop[q * n + i];
  }

  void respond(std::size_t q, std::size_t k, const Dense &tangent, const double *stress) {
    Node &node = bar[k];
    const double square = points[q].scale * points[q].scale;
    double b[STRAINS][dim], c[STRAINS];
    derivative(q, k, b);
    metric(q, c);
    Base::push(points[q], &gradient[(q * n + k) * dim], 0, node.push);
    for (int a = 0; a < dim; ++a) {
      const std::size_t j = (q * n + k) * dim + a;
      node.change[a] = projected[j] / (1 + grown[q]);
      node.scale[a] = (node.change[a] - log_change[j]) / 3;
      node.stress[a] = 0;
      for (int s = 0; s < STRAINS; ++s) {
        node.stress[a] += square * stress[s] * b[s][a];
        node.strain[s][a] = square * b[s][a] + c[s] * node.scale[a];
      }
    }
    for (int s = 0; s < STRAINS; ++s)
      for (int a = 0; a < dim; ++a) {
        double sum = 0;
        for (int r = 0; r < STRAINS; ++r)
          sum += tangent.c[s * STRAINS + r] * node.strain[r][a];
        by_strain[k].strain[s][a] = sum;
      }
  }

  CellFunctions functions;
  std::vector<double> growth, grown;         // of the volume at the points; the one that counts
  std::vector<double> pressure, mean_stress; // projected, per unit of the volume that counts; Kirchhoff's at the points
  std::vector<double> places, factors, log_change, change, projected, sums, seen, scratch;
  std::vector<Node> bar;
  std::vector<Response> by_strain;
};

} // namespace abut

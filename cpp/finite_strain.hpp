// Finite strains by the total Lagrangian description, docs/theory/finite-deformation.md.
#pragma once
#include "hyperelastic.hpp"
#include "kinematics.hpp"
#include <cmath>

namespace abut {

// The strain is that of Green and Lagrange, stresses are of the second kind of Piola and Kirchhoff. In space or in the
// plane, where the stretch out of the plane is 1 until ``thicken`` says otherwise. Axisymmetric: coordinates are (r,
// z), the hoop stretch is 1 + u_r / r. mean_dilatation: F-bar, theory (D7), with the dilatation of the cell's centre.
template <int dim, bool axisymmetric> class FiniteStrain {
public:
  static constexpr int DIM = dim;
  static constexpr bool finite = true;

  explicit FiniteStrain(const Cells &cells)
      : cells(cells), n(cells.n), gradient(cells.rule * n * dim), hoop(axisymmetric ? cells.rule * n : 0),
        volume(cells.rule), points(cells.rule), response(n * STRAINS * dim), pushed(n * dim) {
    if (cells.mean_dilatation)
      centre_rule();
  }

  // Moves to the cell with nodes at x (n, dim).
  void place(const double *x) {
    for (std::size_t q = 0; q < cells.rule; ++q) {
      volume[q] = gradients<dim>(x, n, cells.derivatives + q * n * dim, &gradient[q * n * dim]) * cells.weights[q];
      if constexpr (axisymmetric)
        volume[q] *= 2 * std::numbers::pi * hoops(x, cells.shapes + q * n, &hoop[q * n]);
    }
    if (!cells.mean_dilatation)
      return;
    gradients<dim>(x, n, centre_derivatives.data(), centre_gradient.data());
    if constexpr (axisymmetric)
      hoops(x, centre_shapes.data(), centre_hoop.data());
  }

  // Deforms the cell by displacements u (n, dim) of the nodes. False, with the determinant, where that of the
  // deformation gradient is not positive.
  bool deform(const double *u, double &determinant) {
    double slope[3][3];
    Deformed centre;
    if (cells.mean_dilatation) {
      displacement_slope(u, centre_gradient.data(), centre_hoop.data(), slope);
      centre.set(slope);
      determinant = centre.det;
      if (!(centre.det > 0))
        return false;
      centre.invert();
      for (std::size_t i = 0; i < n; ++i)
        push(centre, &centre_gradient[i * dim], axisymmetric ? centre_hoop[i] : 0, &centre_pushed[i * dim]);
    }
    for (std::size_t q = 0; q < cells.rule; ++q) {
      displacement_slope(u, &gradient[q * n * dim], axisymmetric ? &hoop[q * n] : nullptr, slope);
      points[q].set(slope);
      determinant = points[q].det;
      if (!(determinant > 0) || !std::isfinite(determinant))
        return false;
      points[q].scale = cells.mean_dilatation ? std::pow(centre.det / points[q].det, 1.0 / SCALED) : 1;
    }
    return true;
  }

  // Strain at point q of the deformed cell.
  void strain(std::size_t q, double *strain) const {
    const Deformed &at = points[q];
    std::copy_n(at.strain, STRAINS, strain);
    if (!cells.mean_dilatation)
      return;
    const double square = at.scale * at.scale;
    for (int s = 0; s < STRAINS; ++s)
      strain[s] *= square;
    for (int a = 0; a < SCALED; ++a)
      strain[a] += (square - 1) / 2;
  }

  // Takes the stretch out of the plane that leaves no stress there.
  void thicken(std::size_t q, double stretch) {
    points[q].det *= stretch / points[q].f[2][2];
    points[q].f[2][2] = stretch;
  }

  // Adds the forces (n, dim) of a stress at point q.
  void add_force(std::size_t q, const double *stress, double *force) const {
    const double w = volume[q] * power(q);
    double b[STRAINS][dim];
    for (std::size_t i = 0; i < n; ++i) {
      derivative(q, i, b);
      for (int s = 0; s < STRAINS; ++s)
        for (int a = 0; a < dim; ++a)
          force[i * dim + a] += w * b[s][a] * stress[s];
    }
  }

  // Whether the stiffness is where the tangent is.
  bool symmetric() const { return !cells.mean_dilatation; }

  // Adds the stiffness (n, n, dim, dim) at point q, theory (D6), (D8); half: for nodes i <= k only.
  void add_stiffness(std::size_t q, const Dense &tangent, const double *stress, bool half, double *block) {
    respond(q, tangent, stress);
    const double w = volume[q] * power(q);
    double sigma[3][3], b[STRAINS][dim];
    tensor(stress, sigma);
    for (std::size_t k = 0; k < n; ++k)
      for (int a = 0; a < dim; ++a) {
        double sum = 0;
        for (int c = 0; c < dim; ++c)
          sum += sigma[a][c] * gradient[(q * n + k) * dim + c];
        pushed[k * dim + a] = w * sum;
      }
    for (std::size_t i = 0; i < n; ++i) {
      derivative(q, i, b);
      const double *g = &gradient[(q * n + i) * dim];
      for (std::size_t k = half ? i : 0; k < n; ++k) {
        double *out = &block[(i * n + k) * dim * dim], scalar = 0;
        const double *r = &response[k * STRAINS * dim];
        for (int a = 0; a < dim; ++a)
          scalar += g[a] * pushed[k * dim + a];
        for (int s = 0; s < STRAINS; ++s)
          for (int a = 0; a < dim; ++a)
            for (int c = 0; c < dim; ++c)
              out[a * dim + c] += b[s][a] * r[s * dim + c];
        for (int a = 0; a < dim; ++a)
          out[a * dim + a] += scalar;
        if constexpr (axisymmetric)
          out[0] += w * sigma[2][2] * hoop[q * n + i] * hoop[q * n + k];
      }
    }
  }

  // Turns a stress at point q into that of Cauchy.
  void to_cauchy(std::size_t q, double *stress) const {
    const Deformed &at = points[q];
    double sigma[3][3], result[3][3] = {{0}};
    tensor(stress, sigma);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        for (int c = 0; c < 3; ++c)
          for (int d = 0; d < 3; ++d)
            result[a][b] += stretched(at, a, c) * sigma[c][d] * stretched(at, b, d);
    const double det = at.det * std::pow(at.scale, SCALED);
    for (int a = 0; a < 3; ++a) {
      stress[a] = result[a][a] / det;
      stress[3 + a] = result[a][(a + 1) % 3] / det;
    }
  }

  double reference_volume(std::size_t q) const { return volume[q]; }
  double determinant(std::size_t q) const { return points[q].det; }
  const double *swelling() const { return cells.shapes; } // by which heat swells the cell

protected:
  static constexpr int SCALED = dim == 2 && !axisymmetric ? 2 : 3; // directions that F-bar scales

  // The deformation gradient at a point, its determinant and inverse, the strain, and the factor of F-bar.
  struct Deformed {
    double f[3][3], inverse[3][3], det, strain[STRAINS], scale = 1;

    void set(const double (&slope)[3][3]) {
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          f[a][b] = slope[a][b] + (a == b);
      det = f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) - f[0][1] * (f[1][0] * f[2][2] - f[1][2] * f[2][0]) +
            f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]);
      for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3;
        double own = 0, mixed = 0; // of slope^T slope: small strains lose no digits
        for (int c = 0; c < 3; ++c)
          own += slope[c][a] * slope[c][a], mixed += slope[c][a] * slope[c][b];
        strain[a] = slope[a][a] + own / 2;
        strain[3 + a] = slope[a][b] + slope[b][a] + mixed;
      }
    }
    void invert() {
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
          const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
          inverse[b][a] = (f[a1][b1] * f[a2][b2] - f[a1][b2] * f[a2][b1]) / det;
        }
    }
  };

  static void tensor(const double *stress, double (&sigma)[3][3]) {
    for (int a = 0; a < 3; ++a) {
      sigma[a][a] = stress[a];
      sigma[a][(a + 1) % 3] = sigma[(a + 1) % 3][a] = stress[3 + a];
    }
  }

  static double stretched(const Deformed &at, int a, int b) {
    return a < SCALED && b < SCALED ? at.scale * at.f[a][b] : at.f[a][b];
  }

  // det F-bar / det F over the square of the factor: what the stress is multiplied by, theory (D7).
  double power(std::size_t q) const { return SCALED == 2 ? 1 : 1 / points[q].scale; }

  // Hoop strains (n,) by unit radial displacements; returns the radius.
  double hoops(const double *x, const double *shapes, double *hoop) const {
    double r = 0;
    for (std::size_t i = 0; i < n; ++i)
      r += shapes[i] * x[i * dim];
    for (std::size_t i = 0; i < n; ++i)
      hoop[i] = shapes[i] / r;
    return r;
  }

  void displacement_slope(const double *u, const double *g, const double *hoop, double (&slope)[3][3]) const {
    std::fill_n(&slope[0][0], 9, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b)
          slope[a][b] += u[i * dim + a] * g[i * dim + b];
      if constexpr (axisymmetric)
        slope[2][2] += u[i * dim] * hoop[i];
    }
  }

  // Change of ln det F by displacements of a node.
  static void push(const Deformed &at, const double *g, double hoop, double *result) {
    for (int a = 0; a < dim; ++a) {
      result[a] = 0;
      for (int b = 0; b < dim; ++b)
        result[a] += at.inverse[b][a] * g[b];
    }
    if constexpr (axisymmetric)
      result[0] += at.inverse[2][2] * hoop;
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

  // response[k][s][c]: stress s at point q, times its weight, by displacement c of node k.
  void respond(std::size_t q, const Dense &tangent, const double *stress) {
    Deformed &at = points[q];
    const double w = volume[q] * power(q), square = at.scale * at.scale;
    double b[STRAINS][dim], by_scale[STRAINS] = {0};
    if (cells.mean_dilatation) {
      double metric[STRAINS]; // of the right Cauchy-Green tensor
      for (int s = 0; s < STRAINS; ++s)
        metric[s] = s < 3 ? (s < SCALED) * (2 * at.strain[s] + 1) : 2 * at.strain[s];
      for (int s = 0; s < STRAINS; ++s) {
        for (int t = 0; t < STRAINS; ++t)
          by_scale[s] += square * tangent.c[s * STRAINS + t] * metric[t];
        by_scale[s] += (2 - SCALED) * stress[s];
      }
      at.invert();
    }
    for (std::size_t k = 0; k < n; ++k) {
      derivative(q, k, b);
      double own[dim] = {0};
      if (cells.mean_dilatation) {
        push(at, &gradient[(q * n + k) * dim], axisymmetric ? hoop[q * n + k] : 0, own);
        for (int c = 0; c < dim; ++c)
          own[c] = (centre_pushed[k * dim + c] - own[c]) / SCALED;
      }
      for (int s = 0; s < STRAINS; ++s)
        for (int c = 0; c < dim; ++c) {
          double sum = 0;
          for (int t = 0; t < STRAINS; ++t)
            sum += tangent.c[s * STRAINS + t] * b[t][c];
          response[(k * STRAINS + s) * dim + c] = w * (square * sum + by_scale[s] * own[c]);
        }
    }
  }

  // Shape functions at the centre: their mean over the points of a rule that is symmetric, for functions that are
  // linear in each coordinate.
  void centre_rule() {
    centre_shapes.assign(n, 0), centre_derivatives.assign(n * dim, 0), centre_gradient.resize(n * dim);
    centre_hoop.resize(n), centre_pushed.resize(n * dim);
    for (std::size_t q = 0; q < cells.rule; ++q) {
      for (std::size_t i = 0; i < n; ++i)
        centre_shapes[i] += cells.shapes[q * n + i] / double(cells.rule);
      for (std::size_t j = 0; j < n * dim; ++j)
        centre_derivatives[j] += cells.derivatives[q * n * dim + j] / double(cells.rule);
    }
  }

  const Cells &cells;
  std::size_t n;
  std::vector<double> gradient;     // (rule, n, dim) of the undeformed cell
  std::vector<double> hoop, volume; // (rule, n) shape function over radius; (rule) weight times size
  std::vector<Deformed> points;     // (rule)
  std::vector<double> response, pushed;
  std::vector<double> centre_shapes, centre_derivatives, centre_gradient, centre_hoop, centre_pushed;
};

} // namespace abut

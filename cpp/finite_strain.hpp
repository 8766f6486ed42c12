// Finite strains by the total Lagrangian description, docs/theory/finite-deformation.md.
#pragma once
#include "corner_modes.hpp"
#include "first_moduli.hpp"
#include "hyperelastic.hpp"
#include "kinematics.hpp"
#include "last_node.hpp"
#include "reference_moduli.hpp"
#include "wide.hpp"
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
        volume(cells.rule), points(cells.rule), response(n * RESPONSE), modes(modes_of(cells)) {
    if (cells.mean_dilatation)
      centre_rule();
  }

  // Moves to the cell with nodes at x (n, dim).
  void place(const double *x) {
    if (modes)
      modes->set_slopes(x);
    for (std::size_t q = 0; q < cells.rule; ++q) {
      if (modes) {
        const Jacobian<dim> jacobian = jacobian_of<dim>(modes->slope(q));
        jacobian.invert(points[q].reference);
        volume[q] = jacobian.det * cells.weights[q];
        continue;
      }
      const double *derivatives = cells.derivatives + q * n * dim;
      volume[q] = gradients<dim>(x, n, derivatives, &gradient[q * n * dim], points[q].reference) * cells.weights[q];
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
    if (modes)
      modes->set_slopes(u);
    for (std::size_t q = 0; q < cells.rule; ++q) {
      if (modes)
        by_position(modes->slope(q), points[q].reference, slope);
      else
        displacement_slope(u, &gradient[q * n * dim], axisymmetric ? &hoop[q * n] : nullptr, slope);
      points[q].set(slope);
      determinant = points[q].det;
      if (!(determinant > 0) || !std::isfinite(determinant))
        return false;
      points[q].scale = cells.mean_dilatation ? root(centre.det / points[q].det) : 1;
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

  // Change of the volume that counts at the points since ``past``, (rule,): all of it, or without what is linear in
  // displacements.
  void bend(const FiniteStrain &past, bool all, double *change) {
    for (std::size_t q = 0; q < cells.rule; ++q) {
      const Deformed &from = cells.mean_dilatation ? past.centre : past.points[q];
      const Deformed &to = cells.mean_dilatation ? centre : points[q];
      change[q] = all ? to.det - from.det : bent(from, to);
    }
  }

  // Takes the stretch out of the plane that leaves no stress there.
  void thicken(std::size_t q, double stretch) {
    points[q].det *= stretch / points[q].f[2][2];
    points[q].f[2][2] = stretch;
  }

  // Adds the forces (n, dim) of a stress at point q: products of the first stress of Piola and Kirchhoff with the
  // gradients of shape functions; by modes with ``complete_force`` once all points are in.
  void add_force(std::size_t q, const double *stress, double *force) {
    const double w = volume[q] * power(q);
    const auto &f = points[q].f;
    if (modes) {
      double inward[dim][dim];
      to_reference(points[q], w, stress, inward);
      auto &pushing = modes->pushing(q);
      for (int b = 0; b < dim; ++b)
        for (int a = 0; a < dim; ++a) {
          double sum = inward[b][0] * f[a][0];
          for (int p = 1; p < dim; ++p)
            sum += inward[b][p] * f[a][p];
          pushing[b][a] = sum;
        }
      return;
    }
    double first[dim][dim] = {{0}};
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        for (int p = 0; p < dim; ++p)
          first[a][b] += w * f[a][p] * stress[COMPONENT[p][b]];
    for (std::size_t i = 0; i < n; ++i) {
      const double *g = &gradient[(q * n + i) * dim];
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b)
          force[i * dim + a] += first[a][b] * g[b];
      if constexpr (axisymmetric)
        force[i * dim] += w * f[2][2] * stress[2] * hoop[q * n + i];
    }
  }

  void complete_force(double *force) const {
    if (modes)
      modes->add_forces(force);
  }

  // Whether the stiffness is where the tangent is.
  bool symmetric() const { return !cells.mean_dilatation; }

  // Adds the stiffness (n, n, dim, dim) at point q, theory (D6), (D8), of the nodes that ``complete`` does not add;
  // half: for nodes i <= k only.
  void add_stiffness(std::size_t q, const Dense &tangent, const double *stress, bool symmetric, double *block) {
    const bool half = symmetric && this->symmetric();
    if constexpr (!axisymmetric)
      if (modes)
        return symmetric ? set_moduli<true>(q, tangent, stress) : set_moduli<false>(q, tangent, stress);
    respond(q, tangent, stress);
    for (std::size_t i = 0; i < added(); ++i) {
      double g[dim]; // local, so that it stays in registers
      std::copy_n(&gradient[(q * n + i) * dim], dim, g);
      for (std::size_t k = half ? i : 0; k < added(); ++k) {
        // They do not overlap, so that the compiler may take several components at a time.
        double *__restrict out = &block[(i * n + k) * dim * dim];
        const double *__restrict r = &response[k * RESPONSE];
        for (int m = 0; m < dim * dim; ++m)
          out[m] += along<dim * dim>(g, r + m);
        if constexpr (axisymmetric)
          for (int c = 0; c < dim; ++c)
            out[c] += hoop[q * n + i] * r[dim * dim * dim + c];
      }
    }
  }

  // Whether the stiffness is that of modes: tangents may be along axes of their own, and ``complete`` writes the whole.
  bool by_modes() const { return modes.has_value(); }

  // Adds what is left once all points are in: nodes whose equal displacement does not strain the cell.
  void complete(bool symmetric, double *block) {
    const bool half = symmetric && this->symmetric();
    if (modes)
      write_stiffness(*modes, half, cells.mean_dilatation ? centre_pushed.data() : nullptr, block);
    else
      complete_from<dim>(added(), n, half, block);
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
  using Deformed = abut::Deformed<dim>;
  static constexpr int SCALED = dim == 2 && !axisymmetric ? 2 : 3; // directions that F-bar scales

  static double root(double x) { return SCALED == 3 ? std::cbrt(x) : std::sqrt(x); }

  // Nodes, from the first on, whose stiffness is integrated.
  std::size_t added() const { return axisymmetric ? n : n - 1; }

  // Sum over the directions of a gradient, of what lies that many numbers apart.
  template <int apart> static double along(const double (&g)[dim], const double *values) {
    double sum = g[0] * values[0];
    for (int b = 1; b < dim; ++b)
      sum += g[b] * values[b * apart];
    return sum;
  }

  static constexpr int RESPONSE = dim * dim * dim + (axisymmetric ? dim : 0);

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

  // Slopes along positions of those along reference coordinates.
  static void by_position(const double (&along)[dim][dim], const double (&reference)[dim][dim], double (&slope)[3][3]) {
    std::fill_n(&slope[0][0], 9, 0.0);
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        for (int p = 0; p < dim; ++p)
          slope[a][b] += along[a][p] * reference[p][b];
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

  // response[k]: of the first stress at point q, times its weight, by displacements of node k: stress (a, b) by c at
  // [b][a][c], then the hoop stress by c.
  void respond(std::size_t q, const Dense &tangent, const double *stress) {
    Deformed &at = points[q];
    const double w = volume[q] * power(q), square = at.scale * at.scale;
    FirstModuli<dim> moduli;
    linearise<dim, axisymmetric>(at, w * square, tangent.c, moduli);
    for (int d = 0; d < dim; ++d) // what turns with the stress
      for (int b = 0; b < dim; ++b)
        for (int a = 0; a < dim; ++a)
          moduli.plane[d][b][a][a] += w * stress[COMPONENT[b][d]];
    if constexpr (axisymmetric)
      moduli.own += w * stress[2];
    for (std::size_t k = 0; k < added(); ++k) {
      double g[dim];
      std::copy_n(&gradient[(q * n + k) * dim], dim, g);
      double *__restrict r = &response[k * RESPONSE];
      const double *__restrict m = &moduli.plane[0][0][0][0];
      constexpr int size = dim * dim * dim;
      for (int j = 0; j < size; ++j)
        r[j] = along<size>(g, m + j);
      if constexpr (axisymmetric)
        add_hoop(moduli, g, hoop[q * n + k], r);
    }
    if (cells.mean_dilatation)
      add_dilatation(q, tangent, stress);
  }

  static std::optional<CornerModes<dim>> modes_of(const Cells &cells) {
    return axisymmetric || cells.pressures ? std::nullopt : CornerModes<dim>::of(cells);
  }

  // Sets the moduli of point q along reference coordinates.
  template <bool upper> void set_moduli(std::size_t q, const Dense &tangent, const double *stress) {
    Deformed &at = points[q];
    const double w = volume[q] * power(q), factor = w * at.scale * at.scale;
    const ReferenceLines<dim> lines(at.f, at.reference, tangent.axes);
    auto &moduli = modes->moduli(q);
    double inward[dim][dim];
    write_moduli(lines, upper, tangent.c, factor, &moduli[0][0][0][0]);
    to_reference(at, w, stress, inward);
    add_turn<dim, upper>(at, inward, moduli);
    if (!cells.mean_dilatation)
      return;
    if constexpr (upper)
      mirror<dim>(moduli);
    abut::add_dilatation(at, tangent.c, factor, lines, inward, modes->by_centre(q), moduli);
  }

  // Adds to the response what changes with the factor of F-bar, theory (D8).
  void add_dilatation(std::size_t q, const Dense &tangent, const double *stress) {
    Deformed &at = points[q];
    const double w = volume[q] * power(q), square = at.scale * at.scale;
    double metric[STRAINS], by_scale[STRAINS], first[dim][dim] = {{0}}; // metric: the right Cauchy-Green tensor
    for (int s = 0; s < STRAINS; ++s)
      metric[s] = s < 3 ? (s < SCALED) * (2 * at.strain[s] + 1) : 2 * at.strain[s];
    for (int s = 0; s < STRAINS; ++s) {
      by_scale[s] = (2 - SCALED) * stress[s];
      for (int t = 0; t < STRAINS; ++t)
        by_scale[s] += square * tangent.c[s * STRAINS + t] * metric[t];
    }
    for (int b = 0; b < dim; ++b)
      for (int a = 0; a < dim; ++a)
        for (int p = 0; p < dim; ++p)
          first[b][a] += w * at.f[a][p] * by_scale[COMPONENT[p][b]];
    at.invert();
    for (std::size_t k = 0; k < added(); ++k) {
      double own[dim], *r = &response[k * RESPONSE];
      push(at, &gradient[(q * n + k) * dim], axisymmetric ? hoop[q * n + k] : 0, own);
      for (int c = 0; c < dim; ++c)
        own[c] = (centre_pushed[k * dim + c] - own[c]) / SCALED;
      for (int m = 0; m < dim * dim; ++m)
        for (int c = 0; c < dim; ++c)
          r[m * dim + c] += (&first[0][0])[m] * own[c];
      if constexpr (axisymmetric)
        for (int c = 0; c < dim; ++c)
          r[dim * dim * dim + c] += w * at.f[2][2] * by_scale[2] * own[c];
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
  Deformed centre;                  // where F-bar has its dilatation from
  std::vector<double> response;     // (n, RESPONSE)
  std::optional<CornerModes<dim>> modes;
  std::vector<double> centre_shapes, centre_derivatives, centre_gradient, centre_hoop, centre_pushed;
};

} // namespace abut

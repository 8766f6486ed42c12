// Moduli of finite strains along reference coordinates, theory (D26).
#pragma once
#include "corner_modes.hpp"
#include "deformed.hpp"
#include "each.hpp"

namespace abut {

// What the six components of a tangent mean for slopes along reference coordinates: the change of each strain by the
// slope of component a along coordinate b, [s][b dim + a]. In the plane without those out of it.
template <int dim> class ReferenceLines {
public:
  static constexpr int SIZE = dim * dim, COUNT = dim == 3 ? STRAINS : 3;
  static constexpr int IN[STRAINS] = {0, 1, dim == 3 ? 2 : 3, 3, 4, 5}; // the components

  // At a deformation gradient f; reference: reference coordinate by position, of the undeformed cell; axes: along whose
  // columns the tangent is.
  ReferenceLines(const double (&f)[3][3], const double (&reference)[dim][dim], const double (&axes)[3][3]) {
    double line[dim][dim], inward[dim][dim]; // by axis
    for (int i = 0; i < dim; ++i)
      for (int a = 0; a < dim; ++a) {
        line[i][a] = inward[i][a] = 0;
        for (int p = 0; p < dim; ++p)
          line[i][a] += f[a][p] * axes[p][i], inward[i][a] += reference[a][p] * axes[p][i];
      }
    each<0, COUNT>([&](auto m) {
      constexpr int s = IN[m], i = s % 3, j = (s + 1) % 3;
      metric[m] = 0;
      for (int b = 0; b < dim; ++b) {
        for (int a = 0; a < dim; ++a)
          of[m][b * dim + a] =
              s < 3 ? line[i][a] * inward[i][b] : line[i][a] * inward[j][b] + line[j][a] * inward[i][b];
        metric[m] += s < 3 ? line[i][b] * line[i][b] : 2 * line[i][b] * line[j][b];
      }
    });
  }

  // out (dim dim, dim dim): of the tangent c, times a factor. upper: it is symmetric, and coordinates b <= d are
  // enough.
  template <bool upper> void moduli(const double *c, double factor, double *__restrict out) const {
    double wide[COUNT][SIZE];
    each<0, COUNT>([&](auto m) {
      double by[COUNT];
      each<0, COUNT>([&](auto l) { by[l] = factor * c[IN[m] * STRAINS + IN[l]]; });
      sums<0>(by, of, wide[m]);
    });
    each<0, dim>([&](auto b) {
      for (int a = 0; a < dim; ++a) {
        double by[COUNT];
        each<0, COUNT>([&](auto m) { by[m] = of[m][b * dim + a]; });
        sums<(upper ? b * dim : 0)>(by, wide, out + (b * dim + a) * SIZE);
      }
    });
  }

  // (dim dim,): of the tangent by the logarithm of a stretch alike in all directions, times a factor.
  void by_swelling(const double *c, double factor, double *result) const {
    double by[COUNT];
    each<0, COUNT>([&](auto m) {
      double sum = 0;
      each<0, COUNT>([&](auto l) { sum += c[IN[m] * STRAINS + IN[l]] * metric[l]; });
      by[m] = factor * sum;
    });
    sums<0>(by, of, result);
  }

private:
  // Sums of rows, from a column on.
  template <int from> static void sums(const double (&by)[COUNT], const double (&rows)[COUNT][SIZE], double *result) {
    for (int j = from; j < SIZE; ++j) {
      double sum = by[0] * rows[0][j];
      each<1, COUNT>([&](auto m) { sum += by[m] * rows[m][j]; });
      result[j] = sum;
    }
  }

  double of[COUNT][SIZE], metric[COUNT]; // metric: the right Cauchy-Green tensor, shear doubled
};

// A stress times a weight, along reference coordinates on one side.
template <int dim>
void to_reference(const Deformed<dim> &at, double weight, const double *stress, double (&inward)[dim][dim]) {
  for (int b = 0; b < dim; ++b)
    for (int p = 0; p < dim; ++p) {
      double sum = 0;
      for (int r = 0; r < dim; ++r)
        sum += at.reference[b][r] * stress[COMPONENT[r][p]];
      inward[b][p] = weight * sum;
    }
}

// Adds what turns with a stress; upper: for coordinates b <= d.
template <int dim, bool upper>
void add_turn(const Deformed<dim> &at, const double (&inward)[dim][dim], typename CornerModes<dim>::Moduli &moduli) {
  for (int b = 0; b < dim; ++b)
    for (int d = upper ? b : 0; d < dim; ++d) {
      double sum = 0;
      for (int p = 0; p < dim; ++p)
        sum += inward[b][p] * at.reference[d][p];
      for (int a = 0; a < dim; ++a)
        moduli[b][a][d][a] += sum;
    }
}

// Fills in what is below the diagonal of symmetric moduli.
template <int dim> void mirror(typename CornerModes<dim>::Moduli &moduli) {
  for (int b = 1; b < dim; ++b)
    for (int a = 0; a < dim; ++a)
      for (int d = 0; d < b; ++d)
        for (int c = 0; c < dim; ++c)
          moduli[b][a][d][c] = moduli[d][c][b][a];
}

// Adds what changes with the factor of F-bar, theory (D8): where the dilatation at the point does; first: stress by
// that at the centre. factor: of the tangent.
template <int dim>
void add_dilatation(Deformed<dim> &at, const double *c, double factor, const ReferenceLines<dim> &lines,
                    const double (&inward)[dim][dim], typename CornerModes<dim>::Stress &first,
                    typename CornerModes<dim>::Moduli &moduli) {
  constexpr int size = dim * dim, scaled = dim;
  double push[size]; // change of the dilatation by slopes
  lines.by_swelling(c, factor / scaled, &first[0][0]);
  at.invert();
  for (int d = 0; d < dim; ++d)
    for (int e = 0; e < dim; ++e) {
      double sum = 0;
      for (int p = 0; p < dim; ++p) {
        sum += at.reference[d][p] * at.inverse[p][e];
        first[d][e] += (2.0 - scaled) / scaled * inward[d][p] * at.f[e][p];
      }
      push[d * dim + e] = sum;
    }
  double *__restrict out = &moduli[0][0][0][0];
  for (int i = 0; i < size; ++i) {
    const double by = (&first[0][0])[i];
    for (int j = 0; j < size; ++j)
      out[i * size + j] -= by * push[j];
  }
}

} // namespace abut

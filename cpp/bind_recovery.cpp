// Recovery of stresses for Python: fits over patches, their values at points, and the estimated error of each cell.
#include "bind.hpp"
#include "jacobian.hpp"
#include "parallel.hpp"
#include "recovery.hpp"
#include <nanobind/stl/tuple.h>
#include <numbers>
#include <tuple>

namespace abut {

using Integers = Vector<std::int64_t>;
using Numbers = Vector<std::int32_t>;
using Samples =
    std::tuple<Matrix<double>, Matrix<double>, Integers, Tensor3<double>>; // positions, stresses, first, spread
using Numbered = std::tuple<Integers, Integers>;                           // first, numbers
using Cover =
    std::tuple<Matrix<double>, Numbered, Numbered, Numbers, Numbers>; // centres, around, corners, degree, wide
using Images = std::tuple<Numbered, Matrix<std::int32_t>, Matrix<std::int32_t>>; // by patch, on, by
using Mirrors = std::tuple<Matrix<std::int32_t>, Matrix<double>>;                // planes of each patch, their normals
using Equations = std::tuple<Numbered, Matrix<double>, Matrix<double>, Vector<double>>;
using Table = nb::ndarray<nb::numpy, double>;

constexpr std::size_t FEW_PATCHES = 500, FEW_POINTS = 20000; // not worth a thread

static void require(bool agree) {
  if (!agree)
    throw nb::value_error("patches, samples and equations disagree");
}

template <int dim> void fit_all(const Patches &patches, Integers only, double *coefficients, double *metrics) {
  const std::size_t count = only.shape(0), parts = count < FEW_PATCHES ? 1 : thread_count();
  run_parts(parts, [&](std::size_t part) {
    PatchFit<dim> fit(patches);
    constexpr int width = PatchFit<dim>::UNKNOWNS;
    for (std::size_t i = count * part / parts; i < count * (part + 1) / parts; ++i)
      fit.fit(std::size_t(only.data()[i]), coefficients + i * width, metrics + i * dim * dim);
  });
}

static Lists lists(const Numbered &of, std::size_t count, std::size_t most) {
  const auto &[first, numbers] = of;
  require(first.shape(0) == count + 1 && std::size_t(first.data()[count]) == numbers.shape(0));
  for (std::size_t i = 0; i < numbers.shape(0); ++i)
    require(numbers.data()[i] >= 0 && std::size_t(numbers.data()[i]) < most);
  return {first.data(), numbers.data()};
}

static std::tuple<Table, Table> fit_patches(const Samples &samples, const Cover &cover, const Images &images,
                                            const Mirrors &mirrors, const Equations &equations, double heavy,
                                            Integers only) {
  const auto &[x, stress, first, spread] = samples;
  const auto &[centre, around, corners, degree, wide] = cover;
  const auto &[image_of, on, by] = images;
  const auto &[planes, normals] = mirrors;
  const auto &[rows_of, row_x, row_coefficients, row_values] = equations;
  const std::size_t count = centre.shape(0), dim = x.shape(1), c = dim == 2 ? 4 : 6, n_images = by.shape(0);
  require((dim == 2 || dim == 3) && stress.shape(1) == c && stress.shape(0) == x.shape(0) && centre.shape(1) == dim);
  require(degree.shape(0) == count && wide.shape(0) == count && planes.shape(0) == count && planes.shape(1) == 3 &&
          normals.shape(1) == dim && on.shape(0) == count && on.shape(1) == dim && by.shape(1) == dim);
  require(row_x.shape(1) == dim && row_coefficients.shape(1) == c && row_x.shape(0) == row_values.shape(0) &&
          row_coefficients.shape(0) == row_values.shape(0));
  require(spread.shape(0) >= n_images && first.shape(0) == spread.shape(0) + 1);
  const std::size_t n_cells = spread.shape(0) - n_images;
  const Patches patches{x.data(),
                        stress.data(),
                        first.data(),
                        spread.data(),
                        n_cells,
                        n_images,
                        count,
                        centre.data(),
                        lists(around, count, n_cells),
                        lists(image_of, count, n_images),
                        lists(corners, n_cells, count),
                        lists(rows_of, count, row_x.shape(0)),
                        degree.data(),
                        wide.data(),
                        planes.data(),
                        on.data(),
                        by.data(),
                        normals.data(),
                        row_x.data(),
                        row_coefficients.data(),
                        row_values.data(),
                        heavy};
  for (std::size_t i = 0; i < only.shape(0); ++i) {
    const std::int64_t k = only.data()[i];
    require(k >= 0 && std::size_t(k) < count && patches.around.first[k] < patches.around.first[k + 1]);
  }
  const std::size_t terms = (dim + 1) * (dim + 2) / 2;
  std::vector<double> coefficients(only.shape(0) * terms * c), metrics(only.shape(0) * dim * dim);
  {
    nb::gil_scoped_release release;
    if (dim == 2)
      fit_all<2>(patches, only, coefficients.data(), metrics.data());
    else
      fit_all<3>(patches, only, coefficients.data(), metrics.data());
  }
  return {to_numpy(std::move(coefficients), {only.shape(0), terms, c}),
          to_numpy(std::move(metrics), {only.shape(0), dim, dim})};
}

// Each point's value, the weighted sum of the polynomials of some patches there.
template <int dim>
void evaluate_all(const double *x, std::size_t count, const std::int64_t *patches_of, const std::int64_t *patches,
                  const double *weights, const double *centre, const double *coefficients, const double *metrics,
                  double *result) {
  constexpr int C = PatchFit<dim>::C, T = PatchFit<dim>::T;
  const std::size_t parts = count < FEW_POINTS ? 1 : thread_count();
  run_parts(parts, [&](std::size_t part) {
    double xi[dim], p[T];
    for (std::size_t i = count * part / parts; i < count * (part + 1) / parts; ++i) {
      double sum[C] = {0};
      for (std::int64_t k = patches_of[i]; k < patches_of[i + 1]; ++k) {
        const std::int64_t patch = patches[k];
        PatchFit<dim>::own(metrics + patch * dim * dim, x + i * dim, centre + patch * dim, xi);
        PatchFit<dim>::basis(xi, p);
        const double *own = coefficients + patch * T * C;
        for (int t = 0; t < T; ++t)
          for (int c = 0; c < C; ++c)
            sum[c] += weights[k] * p[t] * own[t * C + c];
      }
      std::copy(sum, sum + C, result + i * C);
    }
  });
}

static Table evaluate_patches(Matrix<double> x, Integers patches_of, Integers patches, Vector<double> weights,
                              Matrix<double> centre, Tensor3<double> coefficients, Tensor3<double> metrics) {
  const std::size_t count = x.shape(0), dim = x.shape(1), c = dim == 2 ? 4 : 6;
  require((dim == 2 || dim == 3) && patches_of.shape(0) == count + 1 && patches.shape(0) == weights.shape(0) &&
          centre.shape(1) == dim && coefficients.shape(0) == centre.shape(0) && coefficients.shape(2) == c &&
          coefficients.shape(1) == (dim + 1) * (dim + 2) / 2 && metrics.shape(0) == centre.shape(0) &&
          metrics.shape(1) == dim && metrics.shape(2) == dim);
  std::vector<double> result(count * c);
  const auto evaluate = dim == 2 ? evaluate_all<2> : evaluate_all<3>;
  evaluate(x.data(), count, patches_of.data(), patches.data(), weights.data(), centre.data(), coefficients.data(),
           metrics.data(), result.data());
  return to_numpy(std::move(result), {count, c});
}

// Of cells with corners alone, at each of these the mean of the polynomials of all of them.
template <int dim>
void evaluate_cells(const std::int32_t *corners, std::size_t count, std::size_t k, const double *centre,
                    const double *coefficients, const double *metrics, double *result) {
  constexpr int C = PatchFit<dim>::C, T = PatchFit<dim>::T;
  const std::size_t parts = count * k < FEW_POINTS ? 1 : thread_count();
  run_parts(parts, [&](std::size_t part) {
    double xi[dim], p[T];
    for (std::size_t cell = count * part / parts; cell < count * (part + 1) / parts; ++cell)
      for (std::size_t j = 0; j < k; ++j) {
        const double *x = centre + std::size_t(corners[cell * k + j]) * dim;
        double sum[C] = {0};
        for (std::size_t i = 0; i < k; ++i) {
          const std::size_t patch = std::size_t(corners[cell * k + i]);
          const double *own = coefficients + patch * T * C;
          if (i == j) { // in the middle there is nothing but the first term
            for (int c = 0; c < C; ++c)
              sum[c] += own[c];
            continue;
          }
          PatchFit<dim>::own(metrics + patch * dim * dim, x, centre + patch * dim, xi);
          PatchFit<dim>::basis(xi, p);
          for (int t = 0; t < T; ++t)
            for (int c = 0; c < C; ++c)
              sum[c] += p[t] * own[t * C + c];
        }
        double *to = result + (cell * k + j) * 6;
        for (int c = 0; c < C; ++c)
          to[c] = sum[c] / double(k);
      }
  });
}

static Table corner_stresses(Matrix<std::int32_t> corners, Matrix<double> centre, Tensor3<double> coefficients,
                             Tensor3<double> metrics) {
  const std::size_t count = corners.shape(0), k = corners.shape(1), dim = centre.shape(1), c = dim == 2 ? 4 : 6;
  require((dim == 2 || dim == 3) && coefficients.shape(0) == centre.shape(0) && coefficients.shape(2) == c &&
          coefficients.shape(1) == (dim + 1) * (dim + 2) / 2 && metrics.shape(0) == centre.shape(0) &&
          metrics.shape(1) == dim && metrics.shape(2) == dim);
  for (std::size_t i = 0; i < count * k; ++i)
    require(corners.data()[i] >= 0 && std::size_t(corners.data()[i]) < centre.shape(0));
  std::vector<double> result(count * k * 6);
  const auto evaluate = dim == 2 ? evaluate_cells<2> : evaluate_cells<3>;
  {
    nb::gil_scoped_release release;
    evaluate(corners.data(), count, k, centre.data(), coefficients.data(), metrics.data(), result.data());
  }
  return to_numpy(std::move(result), {count, k, 6});
}

// Of a stress s (6): s S s with the compliance S (6, 6) of stresses whose shear strains are doubled.
static double energy(const double *s, const double *compliance) {
  double sum = 0;
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < 6; ++b)
      sum += s[a] * compliance[a * 6 + b] * s[b];
  return sum;
}

static Table stress_errors(Matrix<double> points, Matrix<std::int32_t> nodes,
                           const std::tuple<Matrix<double>, Tensor3<double>, Vector<double>> &rule, bool axisymmetric,
                           Matrix<double> stress, const std::tuple<Matrix<std::int32_t>, Matrix<double>> &recovered,
                           const std::tuple<Tensor3<double>, Numbers> &compliance) {
  const auto &[shapes, derivatives, weights] = rule;
  const auto &[own, nodal] = recovered;
  const auto &[compliances, body] = compliance;
  const std::size_t count = nodes.shape(0), n = nodes.shape(1), q = weights.shape(0), dim = points.shape(1);
  require((dim == 2 || dim == 3) && shapes.shape(0) == q && shapes.shape(1) == n && derivatives.shape(0) == q &&
          derivatives.shape(1) == n && derivatives.shape(2) == dim && stress.shape(0) == count * q &&
          stress.shape(1) == 6 && own.shape(0) == count && own.shape(1) == n && nodal.shape(1) == 6 &&
          body.shape(0) == count && compliances.shape(1) == 6 && compliances.shape(2) == 6);
  std::vector<double> result(count * 3), x(n * dim), s(n * 6);
  for (std::size_t cell = 0; cell < count; ++cell) {
    gather(points.data(), nodes.data() + cell * n, n, dim, x.data());
    gather(nodal.data(), own.data() + cell * n, n, 6, s.data());
    const double *own_compliance = compliances.data() + body.data()[cell] * 36;
    for (std::size_t k = 0; k < q; ++k) {
      const double *shape = shapes.data() + k * n, *d = derivatives.data() + k * n * dim;
      double volume =
          weights.data()[k] * (dim == 2 ? jacobian<2>(x.data(), n, d).det : jacobian<3>(x.data(), n, d).det);
      double smooth[6] = {0}, off[6], r = 0;
      for (std::size_t i = 0; i < n; ++i) {
        r += shape[i] * x[i * dim];
        for (int a = 0; a < 6; ++a)
          smooth[a] += shape[i] * s[i * 6 + a];
      }
      volume = std::abs(volume * (axisymmetric ? 2 * std::numbers::pi * r : 1));
      for (int a = 0; a < 6; ++a)
        off[a] = smooth[a] - stress.data()[(cell * q + k) * 6 + a];
      result[cell * 3] += volume * energy(off, own_compliance);
      result[cell * 3 + 1] += volume * energy(smooth, own_compliance);
      result[cell * 3 + 2] += volume;
    }
  }
  return to_numpy(std::move(result), {count, 3});
}

void bind_recovery(nb::module_ &m) {
  m.def("fit_patches", &fit_patches, nb::arg("samples"), nb::arg("cover"), nb::arg("images"), nb::arg("mirrors"),
        nb::arg("equations"), nb::arg("heavy"), nb::arg("only").noconvert(),
        "Polynomials fitted to the samples (positions (m, dim), stresses (m, 4 or 6), first (cells + 1,), mean and "
        "second moments of corners (cells, dim + 1, dim)) of the cells, images after them, of patches: cover: (centres "
        "(k, dim), cells that have the corner, patches of a cell's corners, both as (ranges, numbers), degrees (k,), "
        "whether cells around corners of cells count too (k,)); images: ((ranges, numbers) by patch, planes across "
        "each axis through the corner (k, dim), that made an image (images, dim)); planes through the centre mirror "
        "patches (planes (k, 3), normals (p, dim)); equations ((ranges, numbers) by patch, positions, coefficients, "
        "values). only: (r,) patches that are fitted. Coefficients (r, terms, 4 or 6) in each patch's own coordinates, "
        "and their metrics (r, dim, dim).");
  m.def("evaluate_patches", &evaluate_patches, nb::arg("x").noconvert(), nb::arg("patches_of").noconvert(),
        nb::arg("patches").noconvert(), nb::arg("weights").noconvert(), nb::arg("centre").noconvert(),
        nb::arg("coefficients").noconvert(), nb::arg("metrics").noconvert(),
        "Values (n, 4 or 6) at positions x (n, dim): sums of the weights of some patches times their polynomials.");
  m.def(
      "corner_stresses", &corner_stresses, nb::arg("corners").noconvert(), nb::arg("centre").noconvert(),
      nb::arg("coefficients").noconvert(), nb::arg("metrics").noconvert(),
      "Of cells whose corners are the middles of patches, corners (n, k), the mean of the polynomials of these at each "
      "of them, (n, k, 6).");
  m.def(
      "stress_errors", &stress_errors, nb::arg("points").noconvert(), nb::arg("nodes").noconvert(), nb::arg("rule"),
      nb::arg("axisymmetric"), nb::arg("stress").noconvert(), nb::arg("recovered"), nb::arg("compliance"),
      "Of each cell (n, 3): energy of the recovered less the given stress (cells q, 6), that of the recovered one, and "
      "volume. rule: shapes (q, n), derivatives (q, n, dim), weights (q,); recovered: own numbers (cells, n) of values "
      "(k, "
      "6); compliance: (b, 6, 6) and each cell's body (cells,).");
}

} // namespace abut

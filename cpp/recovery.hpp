// Superconvergent patch recovery: polynomials fitted to the stresses at the sampling points of the cells around a
// point, and to linear equations of the stress at its surface; theory (Z2), (Z3).
#pragma once
#include "mirror.hpp"
#include "patch_samples.hpp"
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace abut {

template <int dim> class PatchFit {
public:
  static constexpr int C = dim == 2 ? 4 : 6, T = (dim + 1) * (dim + 2) / 2, UNKNOWNS = C * T;
  // Of the weight of all samples: what keeps second derivatives small that samples cannot tell, and slopes across
  // samples that lie in a plane or on a line, of which their spread is less than a share of the cells'.
  static constexpr double RIDGE = 1e-4, FLAT = 1e-2;

  explicit PatchFit(const Patches &patches)
      : in(patches), single(T * T), rhs(T * C), coupled(UNKNOWNS * UNKNOWNS), coupled_rhs(UNKNOWNS),
        seen(patches.n_cells + patches.n_images, NONE), visited(patches.count, NONE) {}

  static int terms(int degree) { return degree == 2 ? T : degree == 1 ? 1 + dim : 1; }

  // 1, xi, products of xi.
  static void basis(const double *xi, double *p) {
    int k = 0;
    p[k++] = 1;
    for (int a = 0; a < dim; ++a)
      p[k++] = xi[a];
    for (int a = 0; a < dim; ++a)
      for (int b = a; b < dim; ++b)
        p[k++] = xi[a] * xi[b];
  }

  // x - centre in the patch's own coordinates, in which its cells are as long as wide: by the inverse of the lower
  // triangle ``metric``.
  static void own(const double *metric, const double *x, const double *centre, double *xi) {
    for (int a = 0; a < dim; ++a) {
      double sum = x[a] - centre[a];
      for (int b = 0; b < a; ++b)
        sum -= metric[a * dim + b] * xi[b];
      xi[a] = sum / metric[a * dim + a];
    }
  }

  // Coefficients (T, C) in the patch's own coordinates, and their metric (dim, dim).
  void fit(std::size_t k, double *coefficients, double *metric) {
    find_cells(k);
    find_images(k);
    find_metric(k, metric);
    n = terms(in.degree[k]);
    std::fill(single.begin(), single.end(), 0.0);
    std::fill(rhs.begin(), rhs.end(), 0.0);
    std::fill(coefficients, coefficients + T * C, 0.0);
    const std::int64_t any = in.first[cells.front()];
    std::copy(in.stress + any * C, in.stress + (any + 1) * C, level); // rounding is then that of differences
    if (n == T)
      add_samples<T>(k, metric);
    else if (n == 1)
      add_samples<1>(k, metric);
    else
      add_samples<1 + dim>(k, metric);
    add_ridges();
    if (in.rows_of.first[k] == in.rows_of.first[k + 1])
      solve(single.data(), T, n, rhs.data(), C, coefficients);
    else {
      couple();
      add_rows(k, metric);
      solve(coupled.data(), UNKNOWNS, n * C, coupled_rhs.data(), 1, coefficients);
    }
    for (int c = 0; c < C; ++c)
      coefficients[c] += level[c];
  }

private:
  static constexpr int AT[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  static constexpr double NEAR = 0.1;  // a sample at the centre counts by 100, one as far as cells reach by about 1
  static constexpr double SAME = 1e-6; // distance over the size of a patch
  using Image = std::array<std::int32_t, 3>; // planes, one after the other

  static constexpr std::int64_t NONE = -1;

  // Of a wide patch without the images by planes through its own corner, of which ``images`` are all.
  void find_cells(std::size_t k) {
    const std::int64_t mark = std::int64_t(k);
    const auto add = [&](std::int64_t cell) {
      if (seen[cell] != mark) {
        seen[cell] = mark;
        cells.push_back(cell);
      }
    };
    cells.clear();
    for (std::int64_t i = in.around.first[k]; i < in.around.first[k + 1]; ++i)
      add(in.around.numbers[i]);
    if (!in.wide[k])
      return;
    for (std::int64_t i = in.around.first[k]; i < in.around.first[k + 1]; ++i) {
      const std::int64_t cell = in.around.numbers[i];
      for (std::int64_t j = in.corners.first[cell]; j < in.corners.first[cell + 1]; ++j) {
        const std::int64_t other = in.corners.numbers[j];
        if (visited[other] == mark)
          continue;
        visited[other] = mark;
        for (std::int64_t l = in.around.first[other]; l < in.around.first[other + 1]; ++l)
          add(in.around.numbers[l]);
        for (std::int64_t l = in.images.first[other]; l < in.images.first[other + 1]; ++l)
          if (!through(k, in.images.numbers[l]))
            add(std::int64_t(in.n_cells) + in.images.numbers[l]);
      }
    }
  }

  // Whether an image was made by a plane through the patch's corner.
  bool through(std::size_t k, std::int64_t image) const {
    for (int a = 0; a < dim; ++a)
      if (in.by[image * dim + a] >= 0 && in.by[image * dim + a] == in.on[k * dim + a])
        return true;
    return false;
  }

  void find_images(std::size_t k) {
    images.assign(1, {-1, -1, -1});
    for (int a = 0; a < 3; ++a) {
      const std::int32_t plane = in.planes[k * 3 + a];
      if (plane < 0)
        continue;
      const std::size_t before = images.size();
      for (std::size_t i = 0; i < before; ++i) {
        Image image = images[i];
        bool square = true; // else the images of images are others
        int free = 0;
        for (; free < 3 && image[free] >= 0; ++free)
          square = square && std::abs(product(image[free], plane)) < 1e-6;
        if (square) {
          image[free] = plane;
          images.push_back(image);
        }
      }
    }
  }

  double product(std::int32_t a, std::int32_t b) const {
    double sum = 0;
    for (int c = 0; c < dim; ++c)
      sum += in.normals[a * dim + c] * in.normals[b * dim + c];
    return sum;
  }

  // x and what belongs to it (C), mirrored by planes through the centre.
  void mirror(const Image &image, const double *centre, double shear, double *x, double *s) const {
    for (int i = 0; i < 3 && image[i] >= 0; ++i) {
      const double *normal = in.normals + image[i] * dim;
      double away = 0;
      for (int a = 0; a < dim; ++a)
        away += (x[a] - centre[a]) * normal[a];
      for (int a = 0; a < dim; ++a)
        x[a] -= 2 * away * normal[a];
      reflect<dim>(normal, shear, s);
    }
  }

  template <class Call> void each_sample(std::size_t k, Call call) const {
    double x[dim], s[C];
    for (const std::int64_t cell : cells)
      for (std::int64_t j = in.first[cell]; j < in.first[cell + 1]; ++j) {
        call(in.x + j * dim, in.stress + j * C);
        for (std::size_t i = 1; i < images.size(); ++i) {
          std::copy(in.x + j * dim, in.x + (j + 1) * dim, x);
          std::copy(in.stress + j * C, in.stress + (j + 1) * C, s);
          mirror(images[i], in.centre + k * dim, 1, x, s);
          call(x, s);
        }
      }
  }

  static double weight(const double *xi) {
    double away = 0;
    for (int a = 0; a < dim; ++a)
      away += xi[a] * xi[a];
    return 1 / ((NEAR + away) * (NEAR + away));
  }

  // Cholesky's factor of the second moments of the corners of all cells about the centre.
  void find_metric(std::size_t k, double *metric) const {
    const double *centre = in.centre + k * dim;
    double moments[3][3] = {{0}};
    for (const std::int64_t cell : cells) {
      const double *mean = in.spread + cell * (dim + 1) * dim;
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b)
          moments[a][b] += mean[(a + 1) * dim + b] + (mean[a] - centre[a]) * (mean[b] - centre[b]);
    }
    double sum[dim][dim] = {{0}}, scale = 0;
    for (const Image &image : images) {
      double x[dim], s[C] = {0};
      std::copy(centre, centre + dim, x);
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b <= a; ++b)
          s[AT[a][b]] = moments[a][b];
      mirror(image, centre, 1, x, s);
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b)
          sum[a][b] += s[AT[a][b]];
    }
    const double count = double(images.size()) * double(cells.size());
    for (int a = 0; a < dim; ++a)
      scale += sum[a][a];
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b <= a; ++b) {
        double left = sum[a][b];
        for (int c = 0; c < b; ++c)
          left -= metric[a * dim + c] * metric[b * dim + c] * count;
        metric[a * dim + b] =
            a == b ? std::sqrt(std::max(left, 1e-14 * scale) / count) : left / count / metric[b * dim + b];
      }
  }

  // So that the fit exists where samples cannot tell all terms: on second derivatives, by their squares; on slopes
  // across the samples.
  void add_ridges() {
    const double all = single[0];
    double moments[dim][dim], axes[dim][dim];
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        moments[a][b] = n > 1 ? single[(1 + std::max(a, b)) * T + 1 + std::min(a, b)] / all -
                                    single[(1 + a) * T] * single[(1 + b) * T] / (all * all)
                              : 1;
    if (n > 1) {
      eigenvectors(moments, axes);
      for (int k = 0; k < dim; ++k)
        if (moments[k][k] < FLAT)
          for (int a = 0; a < dim; ++a)
            for (int b = 0; b <= a; ++b)
              single[(1 + a) * T + 1 + b] += FLAT * all * axes[a][k] * axes[b][k];
    }
    if (n == T)
      for (int a = 0, k = 1 + dim; a < dim; ++a)
        for (int b = a; b < dim; ++b, ++k)
          single[k * T + k] += RIDGE * all * (a == b ? 4 : 2);
  }

  // Jacobi's rotations: the diagonal becomes the eigenvalues, columns of ``axes`` their vectors.
  static void eigenvectors(double (&m)[dim][dim], double (&axes)[dim][dim]) {
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        axes[a][b] = a == b;
    for (int sweep = 0; sweep < (dim == 2 ? 1 : 12); ++sweep)
      for (int p = 0; p < dim; ++p)
        for (int q = p + 1; q < dim; ++q) {
          if (m[p][q] == 0)
            continue;
          const double angle = 0.5 * std::atan2(2 * m[p][q], m[q][q] - m[p][p]), c = std::cos(angle),
                       s = std::sin(angle);
          for (int i = 0; i < dim; ++i) {
            const double x = m[i][p], y = m[i][q], u = axes[i][p], v = axes[i][q];
            m[i][p] = c * x - s * y, m[i][q] = s * x + c * y;
            axes[i][p] = c * u - s * v, axes[i][q] = s * u + c * v;
          }
          for (int i = 0; i < dim; ++i) {
            const double x = m[p][i], y = m[q][i];
            m[p][i] = c * x - s * y, m[q][i] = s * x + c * y;
          }
        }
  }

  template <int terms> void add_samples(std::size_t k, const double *metric) {
    const double *centre = in.centre + k * dim;
    double xi[dim], p[T], products[terms][terms] = {{0}}, sums[terms][C] = {{0}};
    each_sample(k, [&](const double *x, const double *s) {
      own(metric, x, centre, xi);
      const double w = weight(xi);
      double off[C];
      for (int c = 0; c < C; ++c)
        off[c] = s[c] - level[c];
      basis(xi, p);
      for (int i = 0; i < terms; ++i) {
        const double weighted = w * p[i];
        for (int j = 0; j < terms; ++j) // the upper half too: loops of one length are quicker
          products[i][j] += weighted * p[j];
        for (int c = 0; c < C; ++c)
          sums[i][c] += weighted * off[c];
      }
    });
    for (int i = 0; i < terms; ++i) {
      std::copy(products[i], products[i] + i + 1, &single[i * T]);
      std::copy(sums[i], sums[i] + C, &rhs[i * C]);
    }
  }

  // The same fits as one system, term by term; what is minimised does not depend on the axes: shears count twice.
  void couple() {
    std::fill(coupled.begin(), coupled.end(), 0.0);
    std::fill(coupled_rhs.begin(), coupled_rhs.end(), 0.0);
    for (int i = 0; i < n; ++i)
      for (int c = 0; c < C; ++c) {
        for (int j = 0; j <= i; ++j)
          coupled[(i * C + c) * UNKNOWNS + j * C + c] = (c < 3 ? 1 : 2) * single[i * T + j];
        coupled_rhs[i * C + c] = (c < 3 ? 1 : 2) * rhs[i * C + c];
      }
  }

  // How many images of an equation are where it is: one in a plane is one equation of the whole body.
  int alike(std::int64_t e, const double *centre, const double *metric) const {
    int count = 0;
    for (const Image &image : images) {
      double x[dim], s[C] = {0}, away = 0, size = 0;
      std::copy(in.row_x + e * dim, in.row_x + (e + 1) * dim, x);
      mirror(image, centre, 2, x, s);
      for (int a = 0; a < dim; ++a) {
        away += std::abs(x[a] - in.row_x[e * dim + a]);
        size += metric[a * dim + a];
      }
      count += away < SAME * size;
    }
    return count;
  }

  void add_rows(std::size_t k, const double *metric) {
    const double *centre = in.centre + k * dim;
    double x[dim], xi[dim], s[C], p[T], all = 0;
    for (std::int64_t r = in.rows_of.first[k]; r < in.rows_of.first[k + 1]; ++r)
      all += double(images.size()) / double(alike(in.rows_of.numbers[r], centre, metric));
    for (std::int64_t r = in.rows_of.first[k]; r < in.rows_of.first[k + 1]; ++r) {
      const std::int64_t e = in.rows_of.numbers[r];
      const double part = in.heavy * single[0] / all / double(alike(e, centre, metric));
      for (const Image &image : images) {
        std::copy(in.row_x + e * dim, in.row_x + (e + 1) * dim, x);
        std::copy(in.row_coefficients + e * C, in.row_coefficients + (e + 1) * C, s);
        mirror(image, centre, 2, x, s);
        own(metric, x, centre, xi);
        const double w = part * weight(xi);
        basis(xi, p);
        int used[C], count = 0; // an equation has few components
        double value = in.row_values[e];
        for (int c = 0; c < C; ++c) {
          value -= s[c] * level[c];
          if (s[c] != 0)
            used[count++] = c;
        }
        for (int i = 0; i < n; ++i)
          for (int c = 0; c < count; ++c) {
            const double own = w * p[i] * s[used[c]];
            double *out = &coupled[(i * C + used[c]) * UNKNOWNS];
            for (int j = 0; j <= i; ++j)
              for (int l = 0; l < count; ++l)
                out[j * C + used[l]] += own * p[j] * s[used[l]]; // what lies above the diagonal is not read
            coupled_rhs[i * C + used[c]] += own * value;
          }
      }
    }
  }

  // Cholesky's factors of the lower half in place, column by column, so that the innermost loops are sums of rows. What
  // rounding leaves without a pivot stays 0.
  static void solve(double *m, int stride, int size, double *b, int columns, double *result) {
    std::array<bool, UNKNOWNS> left{};
    std::array<double, UNKNOWNS> column, before;
    for (int j = 0; j < size; ++j)
      before[j] = m[j * stride + j];
    for (int j = 0; j < size; ++j) {
      const double pivot = m[j * stride + j];
      left[j] = !(pivot > 1e-14 * before[j]);
      const double root = left[j] ? 1 : std::sqrt(pivot), scale = left[j] ? 0 : 1 / root;
      m[j * stride + j] = root;
      for (int l = j + 1; l < size; ++l)
        column[l] = m[l * stride + j] *= scale;
      for (int l = j + 1; l < size; ++l) {
        const double factor = column[l];
        double *row = m + l * stride;
        if (factor != 0)
          for (int i = j + 1; i <= l; ++i)
            row[i] -= factor * column[i];
      }
      for (int c = 0; c < columns; ++c) {
        const double value = result[j * columns + c] = b[j * columns + c] * scale;
        for (int l = j + 1; l < size; ++l)
          b[l * columns + c] -= column[l] * value;
      }
    }
    for (int j = size - 1; j >= 0; --j)
      for (int c = 0; c < columns; ++c) {
        const double value = result[j * columns + c] = left[j] ? 0 : result[j * columns + c] / m[j * stride + j];
        for (int l = 0; l < j; ++l)
          result[l * columns + c] -= m[j * stride + l] * value;
      }
  }

  const Patches &in;
  int n = 1;
  double level[C] = {0};
  std::vector<Image> images;
  std::vector<double> single, rhs, coupled, coupled_rhs;
  std::vector<std::int64_t> cells, seen, visited; // of the patch; by which patch a cell, a patch has been met last
};

} // namespace abut

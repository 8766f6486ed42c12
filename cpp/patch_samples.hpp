// What polynomials are fitted to around a point of a body: samples of cells and of their images, equations.
#pragma once
#include <cstddef>
#include <cstdint>

namespace abut {

// Lists of numbers: those of i from first[i] to first[i + 1].
struct Lists {
  const std::int64_t *first, *numbers;
};

// samples: x (any, dim), stress (any, C), of cell c from first[c] to first[c + 1], those of images of cells after those
// of the n_cells themselves; spread (cells, dim + 1, dim): mean of the cell's corners and their second moments about
// it. patches: centre (count, dim), the cells and the images that have its corner, degree, whether it takes the cells
// around the corners of its cells too, planes (count, 3) that mirror it or -1, and the numbers of the planes across
// each axis through its corner, on (count, dim), and that made an image, by (images, dim), or -1. corners: the patches
// in the middle of which a cell's corners are. equations: at x (any, dim), sum over the components of coefficients
// (any, C) times stress = value. heavy: weight of an equation beside that of a sample.
struct Patches {
  const double *x, *stress;
  const std::int64_t *first;
  const double *spread;
  std::size_t n_cells, n_images, count;
  const double *centre;
  Lists around, images, corners, rows_of;
  const std::int32_t *degree, *wide, *planes, *on, *by;
  const double *normals;
  const double *row_x, *row_coefficients, *row_values;
  double heavy;
};

} // namespace abut

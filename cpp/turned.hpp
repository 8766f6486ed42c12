// Tangents along axes of their own, and how they turn.
#pragma once
#include "materials.hpp"

namespace abut {

using Square = double[STRAINS][STRAINS];

// Strains with doubled shear along coordinates, by those along the columns of the axes, as its columns: of the latter's
// component m at [m][s]. Its transpose turns stresses' components likewise.
inline void strain_rotation(const double (&axes)[3][3], Square &result) {
  for (int s = 0; s < STRAINS; ++s) {
    const int a = s % 3, b = s < 3 ? a : (a + 1) % 3;
    const double doubled = s < 3 ? 1 : 2;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      result[s][i] = doubled * axes[i][a] * axes[i][b];
      result[s][3 + i] = doubled / 2 * (axes[i][a] * axes[j][b] + axes[j][a] * axes[i][b]);
    }
  }
}

// a b; written once, as zeros would take as long as a factor.
inline void multiply(const Square &a, const Square &b, Square &result) {
  for (int s = 0; s < STRAINS; ++s)
    for (int t = 0; t < STRAINS; ++t) {
      double sum = a[s][0] * b[0][t];
      for (int m = 1; m < STRAINS; ++m)
        sum += a[s][m] * b[m][t];
      result[s][t] = sum;
    }
}

// Turns a tangent to the coordinates, unless it is there.
inline void turn_back(Dense &tangent) {
  if (!tangent.turned)
    return;
  Square rotation, transposed, own, wide, result;
  strain_rotation(tangent.axes, rotation);
  for (int s = 0; s < STRAINS; ++s)
    for (int t = 0; t < STRAINS; ++t)
      transposed[s][t] = rotation[t][s], own[s][t] = tangent.c[s * STRAINS + t];
  multiply(own, rotation, wide);
  multiply(transposed, wide, result);
  std::copy_n(&result[0][0], STRAINS * STRAINS, tangent.c);
  tangent.turned = false;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      tangent.axes[a][b] = a == b;
}

} // namespace abut

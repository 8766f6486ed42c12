// Tensors beyond a plane of symmetry; theory (Z4).
#pragma once

namespace abut {

// A stress xx yy zz xy (yz zx) or the coefficients of an equation for it, mirrored by a plane with a normal n (dim).
// shear: 1 for stresses, 2 for coefficients, which are doubled there.
template <int dim> void reflect(const double *n, double shear, double *s) {
  constexpr int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  double full[3][3] = {{0}}, mirror[3][3], half[3][3], sum;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      if (dim == 3 || (a < 2 && b < 2) || a == b)
        full[a][b] = s[at[a][b]] / (a == b ? 1 : shear);
      mirror[a][b] = (a == b) - (a < dim && b < dim ? 2 * n[a] * n[b] : 0);
    }
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      sum = 0;
      for (int c = 0; c < 3; ++c)
        sum += mirror[a][c] * full[c][b];
      half[a][b] = sum;
    }
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b) {
      if (dim == 2 && b == 2 && a != b)
        continue;
      sum = 0;
      for (int c = 0; c < 3; ++c)
        sum += half[a][c] * mirror[c][b];
      s[at[a][b]] = sum * (a == b ? 1 : shear);
    }
}

} // namespace abut

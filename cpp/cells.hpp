// Shape functions of every cell and facet type, on reference domains:
// line [-1,1]; triangle {x,y >= 0, x+y <= 1}; quadrilateral, hexahedron [-1,1]^d; tetrahedron {x,y,z >= 0, sum <= 1};
// wedge: triangle x [-1,1]. Node order: src/abut/cells.py. Codes are the positions in that file's table.
#pragma once
#include <array>
#include <cstdint>

namespace abut {

enum Kind : std::uint8_t {
  LINE2,
  LINE3,
  TRI3,
  TRI6,
  QUAD4,
  QUAD8,
  QUAD9,
  TET4,
  TET10,
  HEX8,
  HEX20,
  HEX27,
  WEDGE6,
  WEDGE15,
  KIND_COUNT
};

constexpr int MAX_NODES = 27;
constexpr int MAX_FACET_NODES = 9;
constexpr std::array<int, KIND_COUNT> NODES{2, 3, 3, 6, 4, 8, 9, 4, 10, 8, 20, 27, 6, 15};
constexpr std::array<int, KIND_COUNT> DIM{1, 1, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3};
constexpr std::array<int, KIND_COUNT> CORNERS{2, 2, 3, 3, 4, 4, 4, 4, 4, 8, 8, 8, 6, 6};
constexpr bool quadratic(int kind) { return NODES[kind] != CORNERS[kind]; }
// The linear type with the same corners.
constexpr std::array<Kind, KIND_COUNT> LINEAR{LINE2, LINE2, TRI3, TRI3, QUAD4, QUAD4,  QUAD4,
                                              TET4,  TET4,  HEX8, HEX8, HEX8,  WEDGE6, WEDGE6};
// The facet type of second order with the same corners: its own where it has middle nodes.
constexpr std::array<Kind, 7> QUADRATIC{LINE3, LINE3, TRI6, TRI6, QUAD8, QUAD8, QUAD9};

namespace detail {

template <class T> struct Poly1 {
  T v[3], d[3];
}; // values and derivatives of a 1D basis

// Nodes at -1, 1 (linear); -1, 1, 0 (quadratic).
template <class T> Poly1<T> line_linear(T x) {
  return {{T(0.5) * (T(1) - x), T(0.5) * (T(1) + x), T(0)}, {T(-0.5), T(0.5), T(0)}};
}
template <class T> Poly1<T> line_quadratic(T x) {
  return {{T(0.5) * x * (x - T(1)), T(0.5) * x * (x + T(1)), T(1) - x * x}, {x - T(0.5), x + T(0.5), T(-2) * x}};
}

constexpr int QUAD9_INDEX[9][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {1, 2}, {2, 1}, {0, 2}, {2, 2}};
constexpr int HEX27_INDEX[27][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1},
                                    {0, 1, 1}, {2, 0, 0}, {1, 2, 0}, {2, 1, 0}, {0, 2, 0}, {2, 0, 1}, {1, 2, 1},
                                    {2, 1, 1}, {0, 2, 1}, {0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}, {0, 2, 2},
                                    {1, 2, 2}, {2, 0, 2}, {2, 1, 2}, {2, 2, 0}, {2, 2, 1}, {2, 2, 2}};
constexpr double QUAD_SIGN[8][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}};
constexpr int TRI_EDGE[3][2] = {{0, 1}, {1, 2}, {2, 0}};
constexpr int TET_EDGE[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};

template <class T> void simplex_quadratic(int dim, const T *x, T *n, T (*d)[3]) {
  const int corners = dim + 1;
  T l[4] = {T(1)};
  for (int a = 0; a < dim; ++a)
    l[0] = l[0] - x[a], l[a + 1] = x[a];
  auto dl = [dim](int i, int a) { return i == 0 ? T(-1) : T(i - 1 == a ? 1 : 0); };
  for (int i = 0; i < corners; ++i) {
    n[i] = l[i] * (T(2) * l[i] - T(1));
    for (int a = 0; a < dim; ++a)
      d[i][a] = (T(4) * l[i] - T(1)) * dl(i, a);
  }
  const int edges = dim == 2 ? 3 : 6;
  for (int e = 0; e < edges; ++e) {
    const int i = dim == 2 ? TRI_EDGE[e][0] : TET_EDGE[e][0], j = dim == 2 ? TRI_EDGE[e][1] : TET_EDGE[e][1];
    n[corners + e] = T(4) * l[i] * l[j];
    for (int a = 0; a < dim; ++a)
      d[corners + e][a] = T(4) * (dl(i, a) * l[j] + l[i] * dl(j, a));
  }
}

template <class T> void serendipity_quad(T x, T y, T *n, T (*d)[3]) {
  for (int i = 0; i < 8; ++i) {
    const T a = T(QUAD_SIGN[i][0]), b = T(QUAD_SIGN[i][1]);
    if (i < 4) {
      n[i] = T(0.25) * (T(1) + a * x) * (T(1) + b * y) * (a * x + b * y - T(1));
      d[i][0] = T(0.25) * a * (T(1) + b * y) * (T(2) * a * x + b * y);
      d[i][1] = T(0.25) * b * (T(1) + a * x) * (a * x + T(2) * b * y);
    } else if (i % 2 == 0) {
      n[i] = T(0.5) * (T(1) - x * x) * (T(1) + b * y);
      d[i][0] = -x * (T(1) + b * y);
      d[i][1] = T(0.5) * b * (T(1) - x * x);
    } else {
      n[i] = T(0.5) * (T(1) - y * y) * (T(1) + a * x);
      d[i][0] = T(0.5) * a * (T(1) - y * y);
      d[i][1] = -y * (T(1) + a * x);
    }
  }
}

template <class T> void serendipity_hex(const T *x, T *n, T (*d)[3]) {
  for (int i = 0; i < 20; ++i) {
    T s[3], f[3];
    int zero = -1;
    for (int k = 0; k < 3; ++k) {
      const int index = HEX27_INDEX[i][k];
      s[k] = T(index == 0 ? -1 : index == 1 ? 1 : 0);
      if (index == 2)
        zero = k;
      f[k] = T(1) + s[k] * x[k];
    }
    if (zero < 0) {
      const T sum = s[0] * x[0] + s[1] * x[1] + s[2] * x[2] - T(2);
      n[i] = T(0.125) * f[0] * f[1] * f[2] * sum;
      for (int k = 0; k < 3; ++k) {
        const T other = f[(k + 1) % 3] * f[(k + 2) % 3];
        d[i][k] = T(0.125) * s[k] * other * (sum + f[k]);
      }
    } else {
      const int p = (zero + 1) % 3, q = (zero + 2) % 3;
      const T bubble = T(1) - x[zero] * x[zero];
      n[i] = T(0.25) * bubble * f[p] * f[q];
      d[i][zero] = T(-0.5) * x[zero] * f[p] * f[q];
      d[i][p] = T(0.25) * bubble * s[p] * f[q];
      d[i][q] = T(0.25) * bubble * f[p] * s[q];
    }
  }
}

// Wedge: edge nodes 6-8 bottom, 9-11 top, 12-14 vertical.
template <class T> void wedge15(const T *x, T *n, T (*d)[3]) {
  const T l[3] = {T(1) - x[0] - x[1], x[0], x[1]}, z = x[2];
  const T dl[3][2] = {{T(-1), T(-1)}, {T(1), T(0)}, {T(0), T(1)}};
  for (int side = 0; side < 2; ++side) {
    const T s = T(side == 0 ? -1 : 1), h = T(1) + s * z;
    for (int i = 0; i < 3; ++i) {
      const int c = 3 * side + i;
      n[c] = T(0.5) * l[i] * h * (T(2) * l[i] - T(2) + s * z);
      for (int a = 0; a < 2; ++a)
        d[c][a] = T(0.5) * h * (T(4) * l[i] - T(2) + s * z) * dl[i][a];
      d[c][2] = T(0.5) * l[i] * s * (T(2) * l[i] - T(1) + T(2) * s * z);
      const int j = (i + 1) % 3, e = 6 + 3 * side + i;
      n[e] = T(2) * l[i] * l[j] * h;
      for (int a = 0; a < 2; ++a)
        d[e][a] = T(2) * h * (dl[i][a] * l[j] + l[i] * dl[j][a]);
      d[e][2] = T(2) * l[i] * l[j] * s;
    }
  }
  for (int i = 0; i < 3; ++i) {
    n[12 + i] = l[i] * (T(1) - z * z);
    for (int a = 0; a < 2; ++a)
      d[12 + i][a] = dl[i][a] * (T(1) - z * z);
    d[12 + i][2] = T(-2) * l[i] * z;
  }
}

template <class T> void simplex_linear(int dim, const T *x, T *n, T (*d)[3]) {
  n[0] = T(1);
  for (int a = 0; a < dim; ++a) {
    n[0] = n[0] - x[a], n[a + 1] = x[a], d[0][a] = T(-1);
    for (int b = 0; b < dim; ++b)
      d[a + 1][b] = T(a == b ? 1 : 0);
  }
}

template <class T> void line(const Poly1<T> &p, int nodes, T *n, T (*d)[3]) {
  for (int i = 0; i < nodes; ++i)
    n[i] = p.v[i], d[i][0] = p.d[i];
}

template <class T> void product_quad(const Poly1<T> &p, const Poly1<T> &q, int nodes, T *n, T (*d)[3]) {
  for (int i = 0; i < nodes; ++i) {
    const int a = QUAD9_INDEX[i][0], b = QUAD9_INDEX[i][1];
    n[i] = p.v[a] * q.v[b], d[i][0] = p.d[a] * q.v[b], d[i][1] = p.v[a] * q.d[b];
  }
}

template <class T> void product_hex(const Poly1<T> (&p)[3], int nodes, T *n, T (*d)[3]) {
  for (int i = 0; i < nodes; ++i) {
    const int *m = HEX27_INDEX[i];
    n[i] = p[0].v[m[0]] * p[1].v[m[1]] * p[2].v[m[2]];
    d[i][0] = p[0].d[m[0]] * p[1].v[m[1]] * p[2].v[m[2]];
    d[i][1] = p[0].v[m[0]] * p[1].d[m[1]] * p[2].v[m[2]];
    d[i][2] = p[0].v[m[0]] * p[1].v[m[1]] * p[2].d[m[2]];
  }
}

template <class T> void wedge6(const T *x, T *n, T (*d)[3]) {
  const T l[3] = {T(1) - x[0] - x[1], x[0], x[1]};
  const T dl[3][2] = {{T(-1), T(-1)}, {T(1), T(0)}, {T(0), T(1)}};
  for (int i = 0; i < 6; ++i) {
    const T s = T(i < 3 ? -0.5 : 0.5), h = T(0.5) + s * x[2];
    n[i] = l[i % 3] * h, d[i][0] = dl[i % 3][0] * h, d[i][1] = dl[i % 3][1] * h, d[i][2] = l[i % 3] * s;
  }
}

} // namespace detail

// Values n[i] and derivatives d[i][a] of all shape functions of `kind` at the reference point x.
template <class T> void shape(int kind, const T *x, T *n, T (*d)[3]) {
  using namespace detail;
  switch (kind) {
  case LINE2:
    return line(line_linear(x[0]), 2, n, d);
  case LINE3:
    return line(line_quadratic(x[0]), 3, n, d);
  case TRI3:
    return simplex_linear(2, x, n, d);
  case TRI6:
    return simplex_quadratic(2, x, n, d);
  case TET4:
    return simplex_linear(3, x, n, d);
  case TET10:
    return simplex_quadratic(3, x, n, d);
  case QUAD4:
    return product_quad(line_linear(x[0]), line_linear(x[1]), 4, n, d);
  case QUAD8:
    return serendipity_quad(x[0], x[1], n, d);
  case QUAD9:
    return product_quad(line_quadratic(x[0]), line_quadratic(x[1]), 9, n, d);
  case HEX8:
    return product_hex({line_linear(x[0]), line_linear(x[1]), line_linear(x[2])}, 8, n, d);
  case HEX20:
    return serendipity_hex(x, n, d);
  case HEX27:
    return product_hex({line_quadratic(x[0]), line_quadratic(x[1]), line_quadratic(x[2])}, 27, n, d);
  case WEDGE6:
    return wedge6(x, n, d);
  case WEDGE15:
    return wedge15(x, n, d);
  default:
    return;
  }
}

// Values of all shape functions of a facet type, without their derivatives.
inline void facet_values(int kind, const double *xi, double *n) {
  const double x = xi[0], y = xi[1];
  switch (kind) {
  case TRI3:
    n[0] = 1 - x - y, n[1] = x, n[2] = y;
    break;
  case TRI6: {
    const double l = 1 - x - y;
    n[0] = l * (2 * l - 1), n[1] = x * (2 * x - 1), n[2] = y * (2 * y - 1);
    n[3] = 4 * l * x, n[4] = 4 * x * y, n[5] = 4 * y * l;
    break;
  }
  case QUAD8: {
    const double a = 1 - x, b = 1 + x, c = 1 - y, d = 1 + y;
    n[0] = 0.25 * a * c * (-x - y - 1), n[1] = 0.25 * b * c * (x - y - 1);
    n[2] = 0.25 * b * d * (x + y - 1), n[3] = 0.25 * a * d * (y - x - 1);
    n[4] = 0.5 * a * b * c, n[5] = 0.5 * b * c * d, n[6] = 0.5 * a * b * d, n[7] = 0.5 * a * c * d;
    break;
  }
  default: { // products of one-dimensional functions
    const bool linear = kind == LINE2 || kind == QUAD4;
    const auto p = linear ? detail::line_linear(x) : detail::line_quadratic(x);
    const auto q = linear ? detail::line_linear(y) : detail::line_quadratic(y);
    for (int i = 0; i < NODES[kind]; ++i)
      n[i] = DIM[kind] == 1 ? p.v[i] : p.v[detail::QUAD9_INDEX[i][0]] * q.v[detail::QUAD9_INDEX[i][1]];
  }
  }
}

} // namespace abut

// Shape functions of facets as polynomials in the reference coordinates, and nodal values as one polynomial: to
// evaluate it takes a third of the work of the shape functions.
#pragma once
#include "cells.hpp"
#include <algorithm>

namespace abut {

// Monomials 1, x, y, xy, x2, y2, x2y, xy2, x2y2, in this order: every type of facet needs the first few.
constexpr int MONOMIALS = 9;
using Coefficients = std::array<std::array<double, MONOMIALS>, MAX_FACET_NODES>; // node, monomial

namespace detail {

constexpr int MONOMIAL_OF[3][3] = {{0, 2, 5}, {1, 3, 7}, {4, 6, 8}}; // by the powers of x and y
constexpr double LINEAR_LINE[3][3] = {{.5, -.5, 0}, {.5, .5, 0}, {0, 0, 0}};
constexpr double QUADRATIC_LINE[3][3] = {{0, -.5, .5}, {0, .5, .5}, {1, 0, -1}};

constexpr Coefficients product_coefficients(int nodes, const double (&line)[3][3]) {
  Coefficients c{};
  for (int i = 0; i < nodes; ++i)
    for (int p = 0; p < 3; ++p)
      for (int q = 0; q < 3; ++q)
        c[i][MONOMIAL_OF[p][q]] = line[QUAD9_INDEX[i][0]][p] * line[QUAD9_INDEX[i][1]][q];
  return c;
}

constexpr Coefficients line_coefficients(int nodes, const double (&line)[3][3]) {
  Coefficients c{};
  for (int i = 0; i < nodes; ++i)
    for (int p = 0; p < 3; ++p)
      c[i][MONOMIAL_OF[p][0]] = line[i][p];
  return c;
}

constexpr Coefficients quad8_coefficients() {
  Coefficients c{};
  for (int i = 0; i < 8; ++i) {
    const double a = QUAD_SIGN[i][0], b = QUAD_SIGN[i][1];
    if (i < 4)
      c[i] = {-.25, 0, 0, .25 * a * b, .25, .25, .25 * b, .25 * a, 0};
    else if (i % 2 == 0)
      c[i] = {.5, 0, .5 * b, 0, -.5, 0, -.5 * b, 0, 0};
    else
      c[i] = {.5, .5 * a, 0, 0, 0, -.5, 0, -.5 * a, 0};
  }
  return c;
}

constexpr Coefficients TRI3_COEFFICIENTS{{{1, -1, -1}, {0, 1}, {0, 0, 1}}};
constexpr Coefficients TRI6_COEFFICIENTS{{{1, -3, -3, 4, 2, 2},
                                          {0, -1, 0, 0, 2},
                                          {0, 0, -1, 0, 0, 2},
                                          {0, 4, 0, -4, -4},
                                          {0, 0, 0, 4},
                                          {0, 0, 4, -4, 0, -4}}};
constexpr std::array<Coefficients, QUAD9 + 1> COEFFICIENTS{line_coefficients(2, LINEAR_LINE),
                                                           line_coefficients(3, QUADRATIC_LINE),
                                                           TRI3_COEFFICIENTS,
                                                           TRI6_COEFFICIENTS,
                                                           product_coefficients(4, LINEAR_LINE),
                                                           quad8_coefficients(),
                                                           product_coefficients(9, QUADRATIC_LINE)};
constexpr std::array<int, QUAD9 + 1> TERMS{3, 6, 3, 6, 4, 8, 9};

} // namespace detail

// W components over a facet.
template <int W> struct Polynomial {
  int terms = 0; // how many of the coefficients are not zero for certain
  double c[MONOMIALS][W];

  // From nodal values (nodes of `kind`, 3), of which the first W components count. Differences from the first node are
  // exact where values are large and close together.
  void interpolate(int kind, const double (*values)[3]) {
    terms = detail::TERMS[kind];
    const Coefficients &own = detail::COEFFICIENTS[kind];
    for (int m = 0; m < terms; ++m)
      for (int a = 0; a < W; ++a)
        c[m][a] = m == 0 ? values[0][a] : 0;
    for (int i = 1; i < NODES[kind]; ++i) {
      double d[W];
      for (int a = 0; a < W; ++a)
        d[a] = values[i][a] - values[0][a];
      for (int m = 0; m < terms; ++m)
        for (int a = 0; a < W; ++a)
          c[m][a] += own[i][m] * d[a];
    }
  }

  void at(const double *xi, double *value) const {
    const double x = xi[0], y = xi[1];
    for (int a = 0; a < W; ++a)
      value[a] = c[0][a] + x * c[1][a] + y * c[2][a];
    if (terms > 3)
      for (int a = 0; a < W; ++a)
        value[a] += x * y * c[3][a];
    if (terms > 4)
      for (int a = 0; a < W; ++a)
        value[a] += x * x * c[4][a] + y * y * c[5][a];
    if (terms > 6)
      for (int a = 0; a < W; ++a)
        value[a] += x * x * y * c[6][a] + x * y * y * c[7][a];
    if (terms > 8)
      for (int a = 0; a < W; ++a)
        value[a] += x * x * y * y * c[8][a];
  }

  // Also the slopes along both reference coordinates.
  template <int S> void at(const double *xi, double *value, double (*slope)[S]) const {
    const double x = xi[0], y = xi[1];
    at(xi, value);
    for (int a = 0; a < W; ++a)
      slope[0][a] = c[1][a], slope[1][a] = c[2][a];
    if (terms > 3)
      for (int a = 0; a < W; ++a)
        slope[0][a] += y * c[3][a], slope[1][a] += x * c[3][a];
    if (terms > 4)
      for (int a = 0; a < W; ++a)
        slope[0][a] += 2 * x * c[4][a], slope[1][a] += 2 * y * c[5][a];
    if (terms > 6)
      for (int a = 0; a < W; ++a) {
        slope[0][a] += 2 * x * y * c[6][a] + y * y * c[7][a];
        slope[1][a] += x * x * c[6][a] + 2 * x * y * c[7][a];
      }
    if (terms > 8)
      for (int a = 0; a < W; ++a)
        slope[0][a] += 2 * x * y * y * c[8][a], slope[1][a] += 2 * x * x * y * c[8][a];
  }

  // Second derivatives xx, xy, yy.
  void second(const double *xi, double (*value)[W]) const {
    const double x = xi[0], y = xi[1];
    for (int a = 0; a < W; ++a) {
      value[0][a] = value[2][a] = 0;
      value[1][a] = terms > 3 ? c[3][a] : 0;
      if (terms > 4)
        value[0][a] += 2 * c[4][a], value[2][a] += 2 * c[5][a];
      if (terms > 6) {
        value[0][a] += 2 * y * c[6][a], value[2][a] += 2 * x * c[7][a];
        value[1][a] += 2 * x * c[6][a] + 2 * y * c[7][a];
      }
      if (terms > 8) {
        value[0][a] += 2 * y * y * c[8][a], value[2][a] += 2 * x * x * c[8][a];
        value[1][a] += 4 * x * y * c[8][a];
      }
    }
  }
};

} // namespace abut

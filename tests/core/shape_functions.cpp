// Shape functions of every cell type against what defines them; derivatives against complex steps, exact but for
// rounding.
#include "cells.hpp"
#include "check.hpp"
#include <complex>

using namespace abut;
using check::same;

namespace {

constexpr double ROUNDING = 1e-14; // some tens of operations on numbers of size one

struct Point {
  double x[3];
};

std::vector<Point> corners_of_simplex(int dim) {
  std::vector<Point> nodes{{{0, 0, 0}}};
  for (int a = 0; a < dim; ++a) {
    nodes.push_back({{0, 0, 0}});
    nodes.back().x[a] = 1;
  }
  return nodes;
}

Point middle(const Point &p, const Point &q) {
  return {{(p.x[0] + q.x[0]) / 2, (p.x[1] + q.x[1]) / 2, (p.x[2] + q.x[2]) / 2}};
}

// Reference coordinates of the nodes, in the order of src/abut/cells.py.
std::vector<Point> nodes_of(int kind) {
  std::vector<Point> nodes;
  const auto at = [](int index) { return index == 0 ? -1.0 : index == 1 ? 1.0 : 0.0; };
  if (kind <= LINE3) {
    nodes = {{{-1, 0, 0}}, {{1, 0, 0}}, {{0, 0, 0}}};
  } else if (kind == TRI3 || kind == TRI6) {
    nodes = corners_of_simplex(2);
    for (const auto &edge : detail::TRI_EDGE)
      nodes.push_back(middle(nodes[edge[0]], nodes[edge[1]]));
  } else if (kind <= QUAD9) {
    for (const auto &index : detail::QUAD9_INDEX)
      nodes.push_back({{at(index[0]), at(index[1]), 0}});
  } else if (kind <= TET10) {
    nodes = corners_of_simplex(3);
    for (const auto &edge : detail::TET_EDGE)
      nodes.push_back(middle(nodes[edge[0]], nodes[edge[1]]));
  } else if (kind <= HEX27) {
    for (const auto &index : detail::HEX27_INDEX)
      nodes.push_back({{at(index[0]), at(index[1]), at(index[2])}});
  } else {
    for (double z : {-1.0, 1.0})
      for (Point p : corners_of_simplex(2))
        nodes.push_back({{p.x[0], p.x[1], z}});
    for (int side : {0, 3})
      for (int i = 0; i < 3; ++i)
        nodes.push_back(middle(nodes[side + i], nodes[side + (i + 1) % 3]));
    for (int i = 0; i < 3; ++i)
      nodes.push_back(middle(nodes[i], nodes[i + 3]));
  }
  nodes.resize(NODES[kind]);
  return nodes;
}

const Point INSIDE[] = {{{0.21, 0.34, 0.13}}, {{0.07, 0.11, -0.4}}, {{0.5, 0.25, 0.2}}};

} // namespace

TEST(each_is_one_at_its_node_and_zero_at_the_others) {
  for (int kind = 0; kind < KIND_COUNT; ++kind) {
    const auto nodes = nodes_of(kind);
    for (int j = 0; j < NODES[kind]; ++j) {
      double n[MAX_NODES], d[MAX_NODES][3];
      shape(kind, nodes[j].x, n, d);
      for (int i = 0; i < NODES[kind]; ++i)
        same(n[i], i == j, ROUNDING, "value at a node");
    }
  }
}

TEST(together_they_are_one_and_the_coordinates) {
  for (int kind = 0; kind < KIND_COUNT; ++kind) {
    const auto nodes = nodes_of(kind);
    for (const Point &p : INSIDE) {
      double n[MAX_NODES], d[MAX_NODES][3], sum = 0, x[3] = {0, 0, 0}, slope[3] = {0, 0, 0};
      shape(kind, p.x, n, d);
      for (int i = 0; i < NODES[kind]; ++i) {
        sum += n[i];
        for (int a = 0; a < DIM[kind]; ++a)
          x[a] += n[i] * nodes[i].x[a], slope[a] += d[i][a];
      }
      same(sum, 1, ROUNDING, "sum of the values");
      for (int a = 0; a < DIM[kind]; ++a)
        same(x[a], p.x[a], ROUNDING, "coordinate"), same(slope[a], 0, ROUNDING, "sum of the derivatives");
    }
  }
}

TEST(derivatives_are_those_of_the_values) {
  using Complex = std::complex<double>;
  constexpr double step = 1e-30; // the imaginary part is the derivative: nothing is subtracted
  for (int kind = 0; kind < KIND_COUNT; ++kind)
    for (const Point &p : INSIDE)
      for (int a = 0; a < DIM[kind]; ++a) {
        double n[MAX_NODES], d[MAX_NODES][3];
        shape(kind, p.x, n, d);
        Complex x[3] = {p.x[0], p.x[1], p.x[2]}, value[MAX_NODES], slope[MAX_NODES][3];
        x[a] += Complex(0, step);
        shape(kind, x, value, slope);
        for (int i = 0; i < NODES[kind]; ++i)
          same(d[i][a], value[i].imag() / step, ROUNDING, "derivative");
      }
}

TEST(values_of_facets_are_those_of_their_type) {
  for (int kind = 0; kind <= QUAD9; ++kind)
    for (const Point &p : INSIDE) {
      double n[MAX_NODES], d[MAX_NODES][3], own[MAX_FACET_NODES];
      shape(kind, p.x, n, d);
      facet_values(kind, p.x, own);
      for (int i = 0; i < NODES[kind]; ++i)
        same(own[i], n[i], ROUNDING, "value on a facet");
    }
}

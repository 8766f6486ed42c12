// Dual numbers, by themselves and with the polynomials that facets are made of.
#include "check.hpp"
#include "dual.hpp"
#include "project.hpp"

using namespace abut;
using check::same;

namespace {

constexpr double ROUNDING = 1e-14;
using Number = Dual<2>;

// Differentiated by hand: f = sqrt(x y + 3) / x - 2 (x - y).
template <class T> T f(const T &x, const T &y) {
  using std::sqrt;
  return sqrt(x * y + T(3)) / x - 2.0 * (x - y);
}

} // namespace

TEST(every_operation) {
  const double x = 1.3, y = 0.7, root = std::sqrt(x * y + 3);
  const Number value = f(Number::seed(x, 0), Number::seed(y, 1));
  same(value.v, f(x, y), ROUNDING, "value");
  same(value.d[0], 0.5 * y / root / x - root / (x * x) - 2, ROUNDING, "by x");
  same(value.d[1], 0.5 / root + 2, ROUNDING, "by y");
}

TEST(sums) {
  Number sum(2);
  sum += Number::seed(3, 0), sum -= Number::seed(4, 1);
  const Number turned = -sum;
  same(turned.v, -1, 0, "value"), same(turned.d[0], -1, 0, "by x"), same(turned.d[1], 1, 0, "by y");
}

// The second derivatives of a facet's polynomial are those of the shape functions' first in dual numbers.
TEST(second_derivatives_of_facets) {
  for (const Kind kind : {LINE3, TRI3, TRI6, QUAD4, QUAD8, QUAD9}) {
    double values[MAX_FACET_NODES][3], at[2] = {0.3, DIM[kind] == 1 ? 0.0 : 0.2}, second[3][3];
    for (int i = 0; i < NODES[kind]; ++i)
      for (int a = 0; a < 3; ++a)
        values[i][a] = std::sin(3.0 * i + a);
    Polynomial<3> map;
    map.interpolate(kind, values);
    map.second(at, second);
    Number n[MAX_FACET_NODES], d[MAX_FACET_NODES][3], xi[2] = {Number::seed(at[0], 0), Number::seed(at[1], 1)};
    shape(kind, xi, n, d);
    for (int a = 0; a < 3; ++a) {
      double expected[3] = {0, 0, 0};
      for (int i = 0; i < NODES[kind]; ++i) {
        expected[0] += d[i][0].d[0] * values[i][a];
        if (DIM[kind] == 2)
          expected[1] += d[i][0].d[1] * values[i][a], expected[2] += d[i][1].d[1] * values[i][a];
      }
      for (int k = 0; k < (DIM[kind] == 2 ? 3 : 1); ++k)
        same(second[k][a], expected[k], 1e-13, "second derivative");
    }
  }
}

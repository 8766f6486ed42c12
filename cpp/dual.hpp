// Dual numbers: a value with its derivatives by N seeds.
#pragma once
#include <cmath>

namespace abut {

template <int N> struct Dual {
  double v = 0, d[N] = {0};

  Dual() = default;
  Dual(double value) : v(value) {}
  static Dual seed(double value, int which) {
    Dual out(value);
    out.d[which] = 1;
    return out;
  }

  Dual &operator+=(const Dual &b) {
    v += b.v;
    for (int i = 0; i < N; ++i)
      d[i] += b.d[i];
    return *this;
  }
  Dual &operator-=(const Dual &b) {
    v -= b.v;
    for (int i = 0; i < N; ++i)
      d[i] -= b.d[i];
    return *this;
  }
};

// f with its derivatives by a and b.
template <int N> Dual<N> chain(double f, double by_a, const Dual<N> &a, double by_b, const Dual<N> &b) {
  Dual<N> out(f);
  for (int i = 0; i < N; ++i)
    out.d[i] = by_a * a.d[i] + by_b * b.d[i];
  return out;
}
template <int N> Dual<N> chain(double f, double by_a, const Dual<N> &a) {
  Dual<N> out(f);
  for (int i = 0; i < N; ++i)
    out.d[i] = by_a * a.d[i];
  return out;
}

template <int N> Dual<N> operator-(const Dual<N> &a) { return chain(-a.v, -1, a); }
template <int N> Dual<N> operator+(const Dual<N> &a, const Dual<N> &b) { return chain(a.v + b.v, 1, a, 1, b); }
template <int N> Dual<N> operator-(const Dual<N> &a, const Dual<N> &b) { return chain(a.v - b.v, 1, a, -1, b); }
template <int N> Dual<N> operator*(const Dual<N> &a, const Dual<N> &b) { return chain(a.v * b.v, b.v, a, a.v, b); }
template <int N> Dual<N> operator/(const Dual<N> &a, const Dual<N> &b) {
  return chain(a.v / b.v, 1 / b.v, a, -a.v / (b.v * b.v), b);
}
template <int N> Dual<N> operator*(double a, const Dual<N> &b) { return chain(a * b.v, a, b); }
template <int N> Dual<N> sqrt(const Dual<N> &a) {
  const double root = std::sqrt(a.v);
  return chain(root, 0.5 / root, a);
}

} // namespace abut

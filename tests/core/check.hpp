// Tests of the compiled core by themselves: TEST(name) { ... } with `same` and `holds`; the program runs those it is
// told.
#pragma once
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

namespace check {

struct Test {
  const char *name;
  void (*run)();
};
inline std::vector<Test> tests;
inline int failures = 0;
struct Registered {
  Registered(const char *name, void (*run)()) { tests.push_back({name, run}); }
};

inline void holds(bool condition, const char *what) {
  if (!condition)
    ++failures, std::printf("not so: %s\n", what);
}
inline void same(double value, double expected, double tolerance, const char *what) {
  if (!(std::abs(value - expected) <= tolerance))
    ++failures, std::printf("%s: %.17g, expected %.17g within %g\n", what, value, expected, tolerance);
}

} // namespace check

#define TEST(name)                                                                                                     \
  static void name();                                                                                                  \
  static const check::Registered registered_##name(#name, name);                                                       \
  static void name()

int main(int count, char **names) {
  int run = 0;
  for (const check::Test &test : check::tests)
    for (int i = 1; i < count; ++i)
      if (!std::strcmp(test.name, names[i]))
        test.run(), ++run;
  return run == count - 1 && run > 0 && check::failures == 0 ? 0 : 1;
}

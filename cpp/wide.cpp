#include "wide.hpp"

// Elsewhere (Clang, musl, other processors) each is compiled once.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
#define ABUT_WIDE [[gnu::target_clones("avx2", "default"), gnu::flatten]]
#else
#define ABUT_WIDE
#endif

namespace abut {

ABUT_WIDE void write_stiffness(CornerModes<2> &modes, bool symmetric, const double *centre, double *block) {
  modes.write(symmetric, centre, block);
}
ABUT_WIDE void write_stiffness(CornerModes<3> &modes, bool symmetric, const double *centre, double *block) {
  modes.write(symmetric, centre, block);
}

ABUT_WIDE void write_moduli(const ReferenceLines<2> &lines, bool upper, const double *c, double factor,
                            double *result) {
  upper ? lines.moduli<true>(c, factor, result) : lines.moduli<false>(c, factor, result);
}
ABUT_WIDE void write_moduli(const ReferenceLines<3> &lines, bool upper, const double *c, double factor,
                            double *result) {
  upper ? lines.moduli<true>(c, factor, result) : lines.moduli<false>(c, factor, result);
}

} // namespace abut

// Long sums at integration points, which processors with registers of four numbers take in half the time: compiled for
// them (AVX2), too, where GCC and the system choose between both when the library is loaded. Neither fuses products
// with sums, so that results are the same on all of them, bit by bit.
#pragma once
#include "corner_modes.hpp"
#include "reference_moduli.hpp"

namespace abut {

// As ``CornerModes::write``.
void write_stiffness(CornerModes<2> &modes, bool symmetric, const double *centre, double *block);
void write_stiffness(CornerModes<3> &modes, bool symmetric, const double *centre, double *block);

// As ``ReferenceLines::moduli``.
void write_moduli(const ReferenceLines<2> &lines, bool upper, const double *c, double factor, double *result);
void write_moduli(const ReferenceLines<3> &lines, bool upper, const double *c, double factor, double *result);

} // namespace abut

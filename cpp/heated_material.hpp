// Laws at points whose constants depend on the temperature there, as materials that the integration sees.
#pragma once
#include "point_material.hpp"

namespace abut {

// temperature, swelling (points,): the thermal strain, alike in all directions, of which strains are whole ones. Laws:
// as ``J2OverTemperature``; histories and logarithmic as of ``PointMaterial``.
template <class Laws, bool logarithmic> struct HeatedMaterial {
  using Tangent = Dense;
  static constexpr bool stress_by_strain = true, tangent_by_strain = true;
  const Laws &laws;
  bool plane_stress;
  const double *temperature, *swelling;
  const double *before = nullptr;
  double *after = nullptr;

  bool symmetric() const { return laws.symmetric(); }

  Dense evaluate(const Point &at, double *strain, double *stress) const {
    const auto law = laws.at(temperature[at.number]);
    const PointMaterial<std::decay_t<decltype(law)>, logarithmic> cold{law, plane_stress, before, after};
    const double free = swelling[at.number];
    if constexpr (!logarithmic) {
      for (int a = 0; a < 3; ++a)
        strain[a] -= free;
      return cold.evaluate(at, strain, stress);
    } else {
      const double stretch = 1 + free, square = stretch * stretch;
      const Dense result = heated(cold, at, stretch, strain, stress);
      if (plane_stress) // the whole one again, by which the cell becomes thinner
        strain[2] = square * strain[2] + (square - 1) / 2;
      return result;
    }
  }
};

} // namespace abut

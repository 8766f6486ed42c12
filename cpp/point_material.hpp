// Laws at points as materials that the integration sees.
#pragma once
#include "logarithmic.hpp"
#include "point_laws.hpp"
#include "principal_laws.hpp"

namespace abut {

// histories (points, law.history): before (null: the initial one) and after (null: not asked for). logarithmic: strains
// are those of Green and Lagrange, and the law sees the logarithmic ones.
template <class Law, bool logarithmic> struct PointMaterial {
  using Tangent = Dense;
  static constexpr bool stress_by_strain = true, tangent_by_strain = true;
  const Law &law;
  bool plane_stress;
  const double *before = nullptr;
  double *after = nullptr;

  bool symmetric() const { return law.symmetric(); }

  Dense evaluate(const Point &at, double *strain, double *stress) const {
    const double *old = before ? before + at.number * law.history : nullptr;
    double *now = after && at.mine ? after + at.number * law.history : nullptr;
    double unasked[STRAINS];
    return respond(strain, old, now, stress ? stress : unasked, at.near ? at.near->axes : nullptr);
  }

  Dense respond(double *strain, const double *old, double *now, double *stress,
                const double (*near)[3] = nullptr) const {
    Dense result;
    if constexpr (!logarithmic) {
      result.sound = find(strain, old, now, stress, result);
    } else {
      Logarithm logarithm(strain, near);
      result.energy = 0;
      result.sound = logarithm.sound;
      if (!logarithm.sound)
        return result;
      double own[STRAINS];
      if constexpr (in_parts)
        if (!plane_stress) {
          Flowing parts;
          logarithm.strain(own);
          law.respond(own, old, now, stress, parts, result.energy);
          logarithm.back(stress, parts, result);
          return result;
        }
      if constexpr (principal)
        logarithm.principal(own);
      else
        logarithm.strain(own);
      result.sound = find(own, old, now, stress, result);
      if (plane_stress) {
        logarithm.thicken(own[2]);
        strain[2] = logarithm.across();
      }
      if constexpr (principal)
        logarithm.back_from_principal(stress, result);
      else
        logarithm.back(stress, result);
    }
    return result;
  }

private:
  static constexpr bool principal = requires { Law::principal; }; // it takes principal strains
  static constexpr bool in_parts = requires(const Law &law, Flowing &parts, double &energy) {
    law.respond(nullptr, nullptr, nullptr, nullptr, parts, energy);
  };

  bool find(double *strain, const double *old, double *now, double *stress, Dense &result) const {
    if (plane_stress)
      return respond_in_plane(law, strain, old, now, stress, result);
    law.respond(strain, old, now, stress, result);
    return true;
  }
};

} // namespace abut

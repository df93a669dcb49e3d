#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/on_rigid.hpp>

namespace tactoid {

template <int D>
double RigidPass<D>::stiffness_rate(const ParticleFields& body) const {
  std::vector<double> sum(body.mass.size(), 0.0);
  for (std::size_t q = 0; q < states_.size(); ++q)
    for (std::size_t k = 0; k < quadrature_.point(q).shape.size(); ++k)
      sum[surface_.facets[quadrature_.facet_of(q)][k]] += states_[q].stiffness_ahead * quadrature_.point(q).shape[k];
  double rate = 0.0;
  for (std::size_t i = 0; i < sum.size(); ++i) rate = std::max(rate, sum[i] / body.mass[i]);
  return rate;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template class RigidPass<2>;
template class RigidPass<3>;
}  // namespace tactoid
#endif

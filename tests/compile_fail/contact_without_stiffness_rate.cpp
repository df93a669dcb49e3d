// EXPECT: A Contact has `double stiffness_rate(
#include <tactoid/contact/contact.hpp>

using namespace tactoid;

struct Sticky {
  void initialize(const PointCloud<3>&, const ParticleFields&, const PointCloud<3>&, const ParticleFields&) {}
  TermEnergy apply(const ParticleFields&, const ParticleFields&, double) { return {}; }
};

template <Contact<3> C>
void use(C) {}

int main() { use(Sticky{}); }

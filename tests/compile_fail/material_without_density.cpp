// EXPECT: A Material has a member `double density` (kg/m^3, reference configuration).
#include <tactoid/material/all.hpp>

using namespace tactoid;

struct Linear {
  double stiffness = 1e3;
  double wave_speed() const { return 1.0; }
  template <class T>
  T energy(const Tensor<T>& F) const {
    return T(0.5 * stiffness) * contract(F, F);
  }
};

int main() { Materials materials{Region{"body", Linear{}}}; }

#include "studies.hpp"

namespace tactoid::verification {

void viscoelastic(Report&, Level) {}

}  // namespace tactoid::verification

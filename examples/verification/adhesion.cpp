#include "studies.hpp"

namespace tactoid::verification {

void adhesion(Report&, Level) {}

}  // namespace tactoid::verification

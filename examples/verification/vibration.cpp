#include "studies.hpp"

namespace tactoid::verification {

void vibration(Report&, Level) {}

}  // namespace tactoid::verification

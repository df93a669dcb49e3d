#include "studies.hpp"

namespace tactoid::verification {

void bouncing(Report&, Level) {}

}  // namespace tactoid::verification

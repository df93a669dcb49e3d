#include "studies.hpp"

namespace tactoid::verification {

void active_instability(Report&, Level) {}

}  // namespace tactoid::verification

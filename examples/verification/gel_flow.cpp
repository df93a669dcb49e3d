#include "studies.hpp"

namespace tactoid::verification {

void gel_flow(Report&, Level) {}

}  // namespace tactoid::verification

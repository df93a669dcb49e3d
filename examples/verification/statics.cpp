#include "studies.hpp"

namespace tactoid::verification {

void statics(Report&, Level) {}

}  // namespace tactoid::verification

#include "studies.hpp"

namespace tactoid::verification {

void drop(Report&, Level) {}

}  // namespace tactoid::verification

#include <tactoid/core/core.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/neighbors/all.hpp>
#include <tactoid/output/all.hpp>

#include <cstdio>

double mass_of_a_body();  // second.cpp

int main() {
  using namespace tactoid;
  if (!(mass_of_a_body() > 0.0)) return 1;
  const double time = parse_quantity("5us", Quantity::time, "time");
  std::printf("Tactoid %s, %d thread(s), %g s\n", version, thread_count(), time);
  return time == 5.0_us || time > 0.0 ? 0 : 1;
}

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include <tactoid/core/pages.hpp>
#include <tactoid/core/tensor.hpp>

namespace core_pages_test {

using namespace tactoid;

TEST_CASE("memory of elements that are not used is given back; the others keep their values, and all can be written to") {
  Field field(200000);
  for (std::size_t i = 0; i < field.size(); ++i) field[i].setConstant(1.0 + static_cast<double>(i));
  std::vector<Index> used = {0, 1, 777, 778, 150001, 199999};
  for (Index i = 60000; i < 70000; ++i) used.insert(used.end() - 2, i);
  REQUIRE(std::is_sorted(used.begin(), used.end()));
  give_back_unused(field, used);
  for (const Index i : used) CHECK(field[i] == Vector4::Constant(1.0 + i));
  std::size_t zeros = 0;
  for (const Vector4& x : field) zeros += x.isZero(0.0) ? 1 : 0;
#ifdef __linux__
  CHECK(zeros > field.size() - used.size() - 8 * 65536 / sizeof(Vector4));  // but for the pages at the ends of the gaps
#else
  CHECK(zeros == 0);
#endif
  std::fill(field.begin(), field.end(), Vector4::Ones());
  CHECK(std::all_of(field.begin(), field.end(), [](const Vector4& x) { return x == Vector4::Ones(); }));
  give_back_released();
  CHECK(field[100000] == Vector4::Ones());
}

TEST_CASE("nothing is given back where all is used, or where nothing is there") {
  std::vector<double> numbers(100000, 2.0), none;
  std::vector<Index> all(numbers.size());
  for (Index i = 0; i < all.size(); ++i) all[i] = i;
  give_back_unused(numbers, all);
  CHECK(std::count(numbers.begin(), numbers.end(), 2.0) == 100000);
  give_back_unused(none, all);
  give_back_unused(none, {});
  CHECK(none.empty());
}

}  // namespace core_pages_test

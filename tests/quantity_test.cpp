#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <string>

#include <tactoid/core/quantity.hpp>

#include "relative.hpp"

namespace quantity_test {

using namespace tactoid;

namespace {
std::string message(std::string_view text, const Quantity& quantity, std::string_view name = "--end-time") {
  try {
    (void)parse_quantity(text, quantity, name);
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "accepted";
}
}  // namespace

TEST_CASE("a quantity with a unit is the SI number to the last bit") {
  CHECK(parse_quantity("5us", Quantity::time, "t") == 5e-6);
  CHECK(parse_quantity("5 us", Quantity::time, "t") == 5e-6);
  CHECK(parse_quantity(" 5\tµs ", Quantity::time, "t") == 5e-6);
  CHECK(parse_quantity("5 μs", Quantity::time, "t") == 5e-6);
  CHECK(parse_quantity("0.3e3ns", Quantity::time, "t") == 3e-7);
  CHECK(parse_quantity("1e-9 s", Quantity::time, "t") == 1e-9);
  CHECK(parse_quantity("1E+2 ns", Quantity::time, "t") == 1e-7);
  CHECK(parse_quantity("0.3", Quantity::dimensionless, "x") == 0.3);
  CHECK(parse_quantity("+.5", Quantity::dimensionless, "x") == 0.5);
  CHECK(parse_quantity("7.", Quantity::dimensionless, "x") == 7.0);
  CHECK(parse_quantity("-12.5 kPa", Quantity::pressure, "p") == -12500.0);
  CHECK(parse_quantity("10 kPa", Quantity::pressure, "p") == 1e4);
  CHECK(parse_quantity("0.072 mN/m", Quantity::surface_tension, "s") == 7.2e-5);
  CHECK(parse_quantity("500 1/um2", Quantity::number_density, "n") == 5e14);
  CHECK(parse_quantity("100 N/kg", Quantity::acceleration, "g") == 100.0);
  CHECK(parse_quantity("90 deg", Quantity::angle, "a") == test::relative(std::acos(0.0)).epsilon(1e-15));
}

TEST_CASE("what is no quantity is refused in one sentence") {
  CHECK(message("5 parsecs", Quantity::time) ==
        "--end-time: \"5 parsecs\" has an unknown unit \"parsecs\"; allowed units of time are s, ms, us, ns, ps (or a "
        "plain number in s).");
  CHECK(message("5 Pa", Quantity::time).find("unknown unit \"Pa\"") != std::string::npos);
  CHECK(message("5 US", Quantity::time).find("unknown unit \"US\"") != std::string::npos);
  CHECK(message("5us6", Quantity::time).find("unknown unit \"us6\"") != std::string::npos);
  CHECK(message("0x10", Quantity::time).find("unknown unit \"x10\"") != std::string::npos);
  CHECK(message("1,5 us", Quantity::time).find("unknown unit \",5 us\"") != std::string::npos);
  CHECK(message("0.4 m", Quantity::dimensionless, "--nucleus") ==
        "--nucleus: \"0.4 m\" has a unit, but a plain number is needed.");
  CHECK(message("", Quantity::time) == "--end-time: the value is empty; time is needed.");
  CHECK(message(" \t", Quantity::dimensionless) == "--end-time: the value is empty; a number is needed.");
  for (const char* text : {"nan", "inf", "-inf", "NaN", "infinity", "abc", ".", "-", "+", "e5", "--5", "us"})
    CHECK_MESSAGE(message(text, Quantity::time).find("is not a finite number") != std::string::npos, text);
  for (const char* text : {"1e400", "-1e400", "1e306 GHz", "1e99999999999999999999", "1e-99999999999999999999"})
    CHECK_MESSAGE(message(text, Quantity::frequency).find("outside the range") != std::string::npos, text);
  CHECK(message("5\xff\n", Quantity::time) ==
        "--end-time: \"5\\xff\" has an unknown unit \"\\xff\"; allowed units of time are s, ms, us, ns, ps (or a plain "
        "number in s).");
}

TEST_CASE("a formatted quantity reads back exactly") {
  CHECK(format_quantity(5e-6, Quantity::time) == "5 us");
  CHECK(format_quantity(2.5e-7, Quantity::time) == "250 ns");
  CHECK(format_quantity(-12500.0, Quantity::pressure) == "-12.5 kPa");
  CHECK(format_quantity(0.0, Quantity::time) == "0 s");
  CHECK(format_quantity(3e7, Quantity::time) == "3e7 s");
  CHECK(format_quantity(0.382, Quantity::dimensionless) == "0.382");
  CHECK(format_quantity(1.23456e-6, Quantity::time, 3) == "1.23 us");
  CHECK(format_quantity(9.9996e-7, Quantity::time, 3) == "1 us");
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(-10.0, 10.0), power(-14.0, 12.0);
  for (int i = 0; i < 2000; ++i) {
    const double value = mantissa(random) * std::pow(10.0, power(random));
    for (const Quantity& quantity : {Quantity::time, Quantity::pressure, Quantity::angle, Quantity::dimensionless})
      REQUIRE(parse_quantity(format_quantity(value, quantity), quantity, "x") == value);
  }
}

TEST_CASE("quoted text shows what cannot be printed") {
  CHECK(in_quotes("a\tb") == "\"a\\x09b\"");
  CHECK(in_quotes("µ") == "\"µ\"");
  CHECK(in_quotes("\xC2") == "\"\\xc2\"");
  CHECK(in_quotes("\xED\xA0\x80") == "\"\\xed\\xa0\\x80\"");  // a surrogate
  CHECK(in_quotes("\xC0\xAF") == "\"\\xc0\\xaf\"");           // overlong
  CHECK(is_utf8("näh 😀"));
  CHECK_FALSE(is_utf8("\xF5\x80\x80\x80"));
  CHECK_FALSE(is_utf8("\xE2\x82"));
}

}  // namespace quantity_test

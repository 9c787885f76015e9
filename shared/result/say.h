#pragma once

#include <iomanip>
#include <sstream>
#include <string>

namespace soffit {

/// One line for people from parts that can be written to a stream; fractions have two digits.
template <class... Parts>
std::string Say(const Parts&... parts) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  (text << ... << parts);
  return text.str();
}

/// "(1.00, 2.00, 0.70)"
template <class Vector>
std::string SayPlace(const Vector& p) {
  return Say("(", p.x(), ", ", p.y(), ", ", p.z(), ")");
}

}  // namespace soffit

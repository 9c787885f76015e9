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

}  // namespace soffit

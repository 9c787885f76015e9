#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

namespace soffit {

/// What went wrong with something that came from outside: a message, a file, an option.
struct Error {
  enum class Code { kInternal, kInvalidInput, kNotFound, kTooLarge, kUnsupported, kUnavailable, kRefused };
  Code code = Code::kInternal;
  std::string message;  ///< What, where and what to do, for a person.
};

/// A value, or the error that kept it from being made. Reading the wrong one throws.
template <class T>
class Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool ok() const { return std::holds_alternative<T>(content_); }
  const T& value() const& { return std::get<T>(content_); }
  T& value() & { return std::get<T>(content_); }
  T&& value() && { return std::get<T>(std::move(content_)); }
  const Error& error() const { return std::get<Error>(content_); }

 private:
  std::variant<T, Error> content_;
};

/// Success, or an error.
using Status = Result<std::monostate>;
inline Status OkStatus() { return std::monostate{}; }

inline Error InvalidInput(std::string message) { return {Error::Code::kInvalidInput, std::move(message)}; }

/// A caller broke a documented precondition: a bug, not bad input.
class ContractViolation : public std::logic_error {
  using std::logic_error::logic_error;
};

}  // namespace soffit

#define SOFFIT_EXPECT(condition)                                                                    \
  do {                                                                                              \
    if (!(condition)) throw ::soffit::ContractViolation(std::string(__func__) + ": " + #condition); \
  } while (false)

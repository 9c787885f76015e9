#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace soffit {

// Both are made from the options as they are declared; nothing is said twice.

/// The manual page of a program with all its subcommands, for man(1).
std::string WriteManual(const CLI::App& app);

/// What bash has to source to complete subcommands, options and the values that an option is limited to;
/// files where an option takes anything.
std::string WriteBashCompletion(const CLI::App& app);

}  // namespace soffit

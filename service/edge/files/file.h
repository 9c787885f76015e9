#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "shared/result/result.h"

namespace soffit {

/// An error when there is no such regular file.
Status CheckFile(const std::filesystem::path& file);

/// All bytes of a regular file of at most `max_bytes`.
Result<std::vector<std::uint8_t>> ReadFile(const std::filesystem::path& file, std::uintmax_t max_bytes);

/// Replaces `file` as a whole: readers see the old content or the new one, never a part. Makes its folder.
Status WriteFile(const std::filesystem::path& file, std::string_view content);

/// A path to hand to a library that writes by itself; `CommitFile` then puts the finished file into its
/// place.
std::filesystem::path PartOf(const std::filesystem::path& file);
Status CommitFile(const std::filesystem::path& file);

}  // namespace soffit

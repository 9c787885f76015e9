#include "service/edge/files/file.h"

#include <fstream>
#include <system_error>

namespace soffit {
namespace fs = std::filesystem;
namespace {

Error CannotWrite(const fs::path& file, const std::string& why) {
  return {Error::Code::kUnavailable, "cannot write " + file.string() + ": " + why};
}

}  // namespace

Status CheckFile(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return Error{Error::Code::kNotFound, file.string() + ": no such file"};
  if (!fs::is_regular_file(file, error)) return InvalidInput(file.string() + ": not a regular file");
  return OkStatus();
}

Result<std::vector<std::uint8_t>> ReadFile(const fs::path& file, std::uintmax_t max_bytes) {
  if (const Status status = CheckFile(file); !status.ok()) return status.error();
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) return Error{Error::Code::kUnavailable, file.string() + ": " + error.message()};
  if (size > max_bytes) {
    return Error{Error::Code::kTooLarge, file.string() + ": " + std::to_string(size) + " bytes, at most " +
                                             std::to_string(max_bytes) + " are read"};
  }
  std::vector<std::uint8_t> bytes(size);
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!stream) return Error{Error::Code::kUnavailable, file.string() + ": cannot be read"};
  return bytes;
}

fs::path PartOf(const fs::path& file) { return file.parent_path() / (".part-" + file.filename().string()); }

Status CommitFile(const fs::path& file) {
  std::error_code error;
  fs::rename(PartOf(file), file, error);
  if (error) return CannotWrite(file, error.message());
  return OkStatus();
}

Status WriteFile(const fs::path& file, std::string_view content) {
  std::error_code error;
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), error);
  if (error) return CannotWrite(file, error.message());
  {
    std::ofstream stream(PartOf(file), std::ios::binary | std::ios::trunc);
    stream.write(content.data(), static_cast<std::streamsize>(content.size()));
    stream.flush();
    if (!stream) return CannotWrite(file, "the disk may be full or the folder not writable");
  }
  return CommitFile(file);
}

}  // namespace soffit
